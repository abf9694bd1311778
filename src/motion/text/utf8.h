/* SPDX-License-Identifier: MIT */
#ifndef GROBO_MOTION_UTF8_H
#define GROBO_MOTION_UTF8_H

#include <stdbool.h>
#include <stddef.h>

/* True for well-formed UTF-8 without NUL. */
bool grobo_i_utf8_ok(const char *text, size_t length);

#endif
