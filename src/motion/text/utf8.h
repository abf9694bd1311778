/* SPDX-License-Identifier: MIT */
#ifndef GROBO_MOTION_UTF8_H
#define GROBO_MOTION_UTF8_H

#include <stdbool.h>
#include <stddef.h>

/* Bytes of the character at text, of which so many are left; 0 for NUL and what is none. */
size_t grobo_i_utf8_length(const char *text, size_t left);
/* True for well-formed UTF-8 without NUL. */
bool grobo_i_utf8_ok(const char *text, size_t length);

#endif
