/* SPDX-License-Identifier: MIT */
#ifndef GRCTL_PIPE_H
#define GRCTL_PIPE_H

#include <stdbool.h>

#include <grobo/core/motion_io.h>

/* Is the file a pipe, such as a shell makes of <(command)? */
bool pipe_is(const char *path);

/*
 * As grobo_motion_read_file(), for a pipe: waits for a writer to come (one second, then it counts
 * as empty), and as long as one is there.
 */
int pipe_read(const char *path, const grobo_read_options *options, grobo_diagnostics *list,
              grobo_motion **motion);

#endif
