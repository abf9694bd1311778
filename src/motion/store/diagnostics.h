/* SPDX-License-Identifier: MIT */
/* What readers, writers and checks share. */
#ifndef GROBO_MOTION_IO_PRIVATE_H
#define GROBO_MOTION_IO_PRIVATE_H

#include <stdarg.h>

#include <grobo/core/motion_io.h>

#if defined(__GNUC__)
#define GROBO_I_FORMAT(text, first) __attribute__((format(printf, text, first)))
#else
#define GROBO_I_FORMAT(text, first)
#endif

/* Where and what kind of thing is said. */
typedef struct grobo_i_said {
    const char *file;
    const char *code;
    uint32_t line, column;
    grobo_severity severity;
} grobo_i_said;

/* Adds a diagnostic; numbers with a point are formatted by number.h, sizes as unsigned long. */
void grobo_i_say(grobo_diagnostics *list, const grobo_i_said *said, const char *format, ...)
    GROBO_I_FORMAT(3, 4);

/* One line of text, cut to size: whatever is formatted into it, it has no control characters. */
void grobo_i_format_message(char *message, size_t size, const char *format, va_list args)
    GROBO_I_FORMAT(3, 0);

#endif
