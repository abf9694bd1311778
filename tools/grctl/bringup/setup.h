/* SPDX-License-Identifier: MIT */
/* The first five minutes with a robot: its port, what it is, a name for it. */
#ifndef GRCTL_SETUP_H
#define GRCTL_SETUP_H

#include "tools/grctl/cli/app.h"

/* Asks its way through. Returns the exit status. */
int setup_run(app *a);

/* Takes back what it wrote into the configuration. As above. */
int setup_undo(app *a);

#endif
