/* SPDX-License-Identifier: MIT */
/* Text on its way to a sink, in blocks; the first error sticks, so that callers ask once. */
#ifndef GROBO_MOTION_OUT_H
#define GROBO_MOTION_OUT_H

#include <grobo/core/motion_io.h>

typedef struct grobo_i_out {
    const grobo_sink *sink;
    int result;
    size_t used;
    char buffer[4096];
} grobo_i_out;

void grobo_i_out_begin(grobo_i_out *out, const grobo_sink *sink);
void grobo_i_put(grobo_i_out *out, const char *text, size_t length);
void grobo_i_put_text(grobo_i_out *out, const char *text);
/* Room for length bytes, at most 64, to be written and added to `used` by the caller. */
char *grobo_i_reserve(grobo_i_out *out, size_t length);
/* As grobo_i_format_number(). */
void grobo_i_put_number(grobo_i_out *out, double value);
void grobo_i_put_int(grobo_i_out *out, long value);
/* In double quotes, with YAML's escapes for what a line cannot show. */
void grobo_i_put_quoted(grobo_i_out *out, const char *text, size_t length);
/* Plain if that is one word that stays itself in a flow list, else quoted. */
void grobo_i_put_scalar(grobo_i_out *out, const char *text, size_t length);
/* A key or name: as a scalar, but quoted if it would read as a number, as nothing or as a flag. */
void grobo_i_put_name(grobo_i_out *out, const char *text, size_t length);
/* Sends what is left. @return the first error, or 0. */
int grobo_i_out_end(grobo_i_out *out);

/* A text that grows, and a sink into it. */
typedef struct grobo_i_text {
    const grobo_mem *mem;
    char *data; /* not ended by a NUL */
    size_t length, room, cap;
} grobo_i_text;

/* The sink of a text: GROBO_ERR_CAP beyond its cap, GROBO_ERR_NOMEM. */
int grobo_i_text_write(void *text, const void *data, size_t size);
void grobo_i_text_free(grobo_i_text *text);

#endif
