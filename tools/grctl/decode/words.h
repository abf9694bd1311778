/* SPDX-License-Identifier: MIT */
/* Frames in words, for people and for scripts. */
#ifndef GRCTL_WORDS_H
#define GRCTL_WORDS_H

#include "tools/grctl/cli/app.h"
#include "tools/grctl/decode/frames.h"

/* The longest text that words_say() makes of a frame, with its NUL. */
enum { WORDS_BYTES = 8192 };

/*
 * What a frame says: one line that ends in `note`, then an indented one for each servo of a long
 * packet; each ends in a newline. Colours as `color` says.
 */
void words_say(const frame *f, bool color, const char *note, char *text, size_t capacity);

/* The same for scripts; a new object. */
json_t *words_json(const frame *f);

/* "host", "robot"; "unknown". */
const char *words_side(frames_side side);

#endif
