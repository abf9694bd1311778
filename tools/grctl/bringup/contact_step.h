/* SPDX-License-Identifier: MIT */
/* What the steps of a first contact share. */
#ifndef GRCTL_CONTACT_STEP_H
#define GRCTL_CONTACT_STEP_H

#include "tools/grctl/cli/heap.h"
#include "tools/grctl/conn/conn.h"

enum { CONTACT_PATH_BYTES = 1024 };

typedef struct contact {
    app *a;
    conn c;
    char prefix[CONTACT_PATH_BYTES], trace[CONTACT_PATH_BYTES];
    heap text; /* the report */
    json_t *steps, *servos;
    json_t *other; /* NULL, or a report that this one is compared with */
    int joint, n_bad;
    double before_deg;
    bool was_on;
    int64_t sent_us, came_us; /* of the last exchange */
} contact;

typedef enum verdict { AS_ASSUMED, NOT_AS_ASSUMED, NOT_DONE } verdict;

/* A line of the report. */
__attribute__((format(printf, 4, 5))) void contact_note(contact *k, const char *name, verdict v,
                                                        const char *format, ...);

/* Questions are asked while no line is open: each part opens it, with a trace of its own. As
 * conn_open() and conn_close(). */
int contact_open(contact *k, const char *part, bool moves);
int contact_close(contact *k, int status);

/* Reads the joint. Returns GROBO_OK or the error. */
int contact_sense(contact *k, grobo_joint_info *is);

#endif
