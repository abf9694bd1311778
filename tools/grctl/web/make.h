/* SPDX-License-Identifier: MIT */
/* A motion that was drawn, as a file of any format. */
#ifndef GRCTL_WEB_MAKE_H
#define GRCTL_WEB_MAKE_H

#include <grobo/motion_io.h>

#include "tools/grctl/cli/app.h"

/*
 * A file of the format that its name tells, to be freed with free(). The app's line is that of
 * `play`, whose options say how legs are solved. lost: gets what the format has no place for.
 * Returns 0 or an error; GROBO_ERR_UNREACHABLE where the app has said which leg was not solved.
 */
int make_write(app *a, const char *name, const grobo_motion *motion, grobo_diagnostics *lost,
               char **bytes, size_t *size);

#endif
