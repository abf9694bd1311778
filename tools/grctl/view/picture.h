/* SPDX-License-Identifier: MIT */
/* Pictures to files: SVG as it is, PNG by a program that can draw SVG. */
#ifndef GRCTL_PICTURE_H
#define GRCTL_PICTURE_H

#include "tools/grctl/cli/app.h"
#include "tools/grctl/view/svg.h"

typedef enum picture_format { PICTURE_NONE, PICTURE_SVG, PICTURE_PNG } picture_format;

/* What the extension of a path says, in any case. */
picture_format picture_format_of(const char *path);

/*
 * Writes a drawing to a path ("-": SVG to standard output). An old file is replaced whole or stays
 * as it was. On failure says why and returns the exit status, else 0.
 */
int picture_save(app *a, const svg *drawing, const char *path, picture_format format);

/* True if there is something at the path that is no drawing of ours. */
bool picture_is_foreign(const char *path);

#endif
