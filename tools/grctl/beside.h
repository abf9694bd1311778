/* SPDX-License-Identifier: MIT */
/* Commands that are programs beside grctl: beside.c. */
#ifndef GRCTL_BESIDE_H
#define GRCTL_BESIDE_H

#include "tools/grctl/cli/app.h"

/* Becomes that program; the exit status where it cannot. */
int beside_run(app *a, const char *program);

#endif
