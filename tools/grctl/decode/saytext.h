/* SPDX-License-Identifier: MIT */
/* Text that grows up to a cap; what does not fit is left out. */
#ifndef GRCTL_SAYTEXT_H
#define GRCTL_SAYTEXT_H

#include "tools/grctl/decode/talk.h"

typedef struct text {
    char *to;
    size_t capacity, used;
    bool color;
    const talk *talk; /* for names; may be NULL */
} text;

void say(text *t, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* What is wrong. */
void say_bad(text *t, const char *what);
void say_hex(text *t, const uint8_t *bytes, size_t n);
/* "servo 3 (R_SHOULDER_P)" */
void say_servo(text *t, int id);

#endif
