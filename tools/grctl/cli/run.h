/* SPDX-License-Identifier: MIT */
/* A command line, parsed and run. */
#ifndef GRCTL_RUN_H
#define GRCTL_RUN_H

#include "tools/grctl/cli/app.h"

/*
 * Parses and runs. `prepare` (or NULL) is called between the two; what it returns other than 0
 * ends it. Returns the exit status.
 */
int run_line(app *a, int argc, char **argv, int (*prepare)(void *ctx, app *a), void *ctx);

#endif
