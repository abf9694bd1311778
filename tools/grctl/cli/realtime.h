/* SPDX-License-Identifier: MIT */
/* --realtime of the commands that keep a deadline: before what else runs on the machine. */
#ifndef GRCTL_REALTIME_H
#define GRCTL_REALTIME_H

#include "tools/grctl/cli/app.h"

/* A row of a table of options. */
#define REALTIME_OPTION                                                                            \
    OPTION_TEXT("realtime", 0, "PRIORITY[@CPU,...]",                                               \
                "run before other programs: 1 to 99, in locked memory")

/*
 * Has this thread run as the option says until the program ends: before a port is opened, so that
 * the first frame is in time too. Memory that cannot be locked is a note. Returns 0, or the exit
 * status after it has said what else the system refused; the option not given is 0.
 */
int realtime_begin(app *a, int option);

#endif
