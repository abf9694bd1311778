/* SPDX-License-Identifier: MIT */
/* No command hands over a pipe by its name here: every path is a file's. */
#include "tools/grctl/os/pipe.h"

bool pipe_is(const char *path)
{
    (void)path;
    return false;
}

int pipe_read(const char *path, const grobo_read_options *options, grobo_diagnostics *list,
              grobo_motion **motion)
{
    return grobo_motion_read_file(path, options, list, motion);
}
