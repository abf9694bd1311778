/* SPDX-License-Identifier: MIT */
/* The first contact with a real robot: does it do what docs/design.md and docs/simulator.md assume
 * of it? First it is only read, then one joint moves by two degrees, each step confirmed. */
#ifndef GRCTL_CONTACT_H
#define GRCTL_CONTACT_H

#include "tools/grctl/cli/app.h"

typedef struct contact_orders {
    int joint;         /* that moves; -1: the last one */
    const char *out;   /* how the files of the report begin; NULL: first-contact-ROBOT */
    const char *other; /* another report, to be compared with; NULL: none */
} contact_orders;

/* Returns the exit status: EXIT_ROBOT where something is not as assumed. */
int contact_run(app *a, const contact_orders *orders);

#endif
