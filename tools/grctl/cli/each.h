/* SPDX-License-Identifier: MIT */
/* A command for each robot of a group, all at the same time. */
#ifndef GRCTL_EACH_H
#define GRCTL_EACH_H

#include "tools/grctl/cli/config.h"

/*
 * Runs this very command line once for each robot of app.group, in a grctl of its own: one that
 * hangs holds nobody up. What each prints stands behind its name, in the order of the group; with
 * --json every object gets a key "name". Returns the largest exit status of all.
 */
int each_run(app *a, int argc, char *const *argv);

#endif
