/* SPDX-License-Identifier: MIT */
/* A command that speaks to one line, on a robot that has several. */
#ifndef GRCTL_EACH_LINE_H
#define GRCTL_EACH_LINE_H

#include "tools/grctl/cli/app.h"

/*
 * Runs the command of the line as its cli_command.lines says: for the whole robot, for each line,
 * for the one that its first argument is on. Where it runs for each line, a heading is before what
 * is printed of it, its name is before complaints, and with --json each object has a key "line".
 * Returns the exit status, of several the largest.
 */
int each_line_run(app *a);

/* Of a command that has a connection for each of several lines: one trace is not of all of them.
 * Returns 0, or the exit status with the reason said. */
int each_line_refuse_trace(app *a);

/* Of a command that has the whole robot, but not for this: runs it for each line. */
int each_line_all(app *a);

#endif
