/* SPDX-License-Identifier: MIT */
/* The word that a mistyped one was meant to be. */
#ifndef GROBO_MOTION_NEAREST_H
#define GROBO_MOTION_NEAREST_H

#include <stddef.h>

/* The nearest one so far; all zero: none. */
typedef struct grobo_i_nearest {
    const char *word;
    int edits;
} grobo_i_nearest;

/* Takes a candidate that is at most two edits from the mistyped word, and nearer than the last. */
void grobo_i_nearest_try(grobo_i_nearest *nearest, const char *typed, const char *candidate);

#endif
