/* SPDX-License-Identifier: MIT */
/* A minimal pseq reader for tests of the body room: key poses into the body's neutral input,
 * trusted files only. */
#ifndef GROBO_TESTS_BODY_PSEQ_H
#define GROBO_TESTS_BODY_PSEQ_H

#include <grobo/body.h>

struct body_pseq {
    grobo_body_key *keys;
    size_t n_keys;
};

/* False if the file cannot be read. Freed by body_pseq_free(). */
bool body_pseq_read(struct body_pseq *pseq, const char *path, const grobo_body_model *model);
void body_pseq_free(struct body_pseq *pseq);

#endif
