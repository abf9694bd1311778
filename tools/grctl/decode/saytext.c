/* SPDX-License-Identifier: MIT */
#include <stdarg.h>
#include <stdio.h>

#include "tools/grctl/decode/saytext.h"

void say(text *t, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    int n = vsnprintf(t->to + t->used, t->capacity - t->used, format, list);
    va_end(list);
    if (n > 0) {
        t->used += (size_t)n < t->capacity - t->used ? (size_t)n : t->capacity - t->used - 1;
    }
}

void say_bad(text *t, const char *what)
{
    say(t, "%s%s%s", t->color ? "\033[31m" : "", what, t->color ? "\033[0m" : "");
}

void say_hex(text *t, const uint8_t *bytes, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        say(t, " %02X", bytes[i]);
    }
}

void say_servo(text *t, int id)
{
    const char *name = talk_joint(t->talk, id);
    say(t, "servo %d", id);
    if (name) {
        say(t, " (%s)", name);
    }
}
