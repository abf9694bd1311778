/* SPDX-License-Identifier: MIT */
/* Standard input, output and error as they were handed to us: closed, full, or left by a reader. */
#ifndef GRCTL_OUTPUT_H
#define GRCTL_OUTPUT_H

#include "app.h"

/*
 * Fills the descriptors 0 to 2 where they are closed, so that no file opened later gets one of
 * them: what is printed would go into it, and it may be the robot's line. Reading from and writing
 * to those filled in fails as with closed ones. Before anything is opened.
 */
void output_guard(void);

/* Writes out what was printed; false when it cannot be, now or at an earlier call. */
bool output_flush(void);

/*
 * The end of the program: `status`, or, when what was printed could not all be written,
 * EXIT_ROBOT with a line of complaint. A reader that left is not complained about: that is
 * EXIT_SIGNAL + SIGPIPE, as without a handler.
 */
int output_finish(app *a, int status);

#endif
