/* SPDX-License-Identifier: MIT */
/* Standard output as it was handed to us: full, or left by a reader. */
#ifndef GRCTL_OUTPUT_H
#define GRCTL_OUTPUT_H

#include "app.h"

/* Writes out what was printed; false when it cannot be, now or at an earlier call. */
bool output_flush(void);

/*
 * The end of the program: `status`, or, when what was printed could not all be written,
 * EXIT_ROBOT with a line of complaint. A reader that left is not complained about: that is
 * EXIT_SIGNAL + OS_BROKEN_PIPE, as without a handler.
 */
int output_finish(app *a, int status);

#endif
