/* SPDX-License-Identifier: MIT */
/* What `doctor` finds: a list of checks, each with the line that mends what is wrong. */
#ifndef GRCTL_CHECKUP_H
#define GRCTL_CHECKUP_H

#include "tools/grctl/cli/app.h"

typedef struct checkup {
    app *a;
    json_t *checks; /* NULL: as text, at once */
    bool aside;     /* the text is no result: on standard error */
    int n, failed;
} checkup;

void checkup_start(checkup *k, app *a);

/*
 * What was looked at, and how it is. fix: NULL, or it is wrong, and this line mends it; "": it is
 * well, and said as text with -v only. ctx is the checkup.
 */
void checkup_found(void *ctx, const char *name, const char *fix, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* The end of it. Returns EXIT_DONE, or EXIT_ROBOT when a check failed. */
int checkup_end(checkup *k);

/* The port itself: is it there, may it be opened, who holds it, is it quick. True: go on. */
bool checkup_port(checkup *k, const char *device);

#endif
