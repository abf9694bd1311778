/* SPDX-License-Identifier: MIT */
/* Key poses as a page edits them: what it does not give stays as it is in the file. */
#ifndef GRCTL_WEB_EDIT_H
#define GRCTL_WEB_EDIT_H

#include <jansson.h>

#include <grobo/core/motion_io.h>

#include "tools/grctl/cli/app.h"

typedef struct edit_result {
    grobo_motion *motion; /* the caller's */
    char complaint[384];  /* one line, where there is an error */
} edit_result;

/*
 * A motion of the key poses that `edit` lists, which refer to those of `base`; base NULL: a new one
 * for this format. Returns 0 or an error.
 */
int edit_apply(const json_t *edit, const grobo_model *model, const grobo_motion *base,
               grobo_motion_format format, edit_result *result);

/*
 * A motion as a file, to be freed with free(). lost: gets what the format has no place for; may be
 * NULL. Returns 0 or an error: GROBO_ERR_CAP where the file would be larger than files are read.
 */
int edit_write(const grobo_motion *motion, grobo_motion_format format, const grobo_model *model,
               grobo_diagnostics *lost, char **bytes, size_t *size);

/*
 * The same of the format that its name tells, with its legs solved where the format has no place
 * for their targets. The app's line is that of `play`, whose options say how. Also
 * GROBO_ERR_UNREACHABLE, where the app has said which leg was not solved.
 */
int edit_file(app *a, const char *name, const grobo_motion *motion, grobo_diagnostics *lost,
              char **bytes, size_t *size);

#endif
