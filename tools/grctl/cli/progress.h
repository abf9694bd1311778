/* SPDX-License-Identifier: MIT */
/* A progress bar on standard error: only on a terminal, never wider than it. */
#ifndef GRCTL_PROGRESS_H
#define GRCTL_PROGRESS_H

#include "tools/grctl/cli/app.h"

typedef struct progress {
    bool shown;  /* false: no terminal, quiet or JSON; nothing is ever drawn */
    bool drawn;  /* something is on the line now */
    bool blocks; /* the terminal knows UTF-8 */
} progress;

void progress_start(progress *p, const app *a);
/* fraction 0..1; the text stands right of the bar. Below 0: no bar, the text alone. */
void progress_draw(progress *p, double fraction, const char *text);
/* Clears the line, so that something else can be said. */
void progress_clear(progress *p);

#endif
