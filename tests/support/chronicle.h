/* SPDX-License-Identifier: MIT */
/* The last frames, requests and events of a run, to be printed where a rule is broken. */
#ifndef GROBO_TEST_CHRONICLE_H
#define GROBO_TEST_CHRONICLE_H

#include <grobo/types.h>

enum { CHRONICLE_LINES = 64, CHRONICLE_BYTES = 160 };

typedef struct chronicle_line {
    int64_t at_us;
    uint8_t n;      /* bytes of a frame; 0: a text */
    unsigned asked; /* not 0: so many frames, one after the other, that only ask */
    uint8_t bytes[CHRONICLE_BYTES];
} chronicle_line;

typedef struct chronicle {
    chronicle_line lines[CHRONICLE_LINES]; /* ring */
    unsigned n;
} chronicle;

/* Adds a line of text. */
void chronicle_note(chronicle *c, int64_t at_us, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Adds a frame that left. */
void chronicle_frame(chronicle *c, int64_t at_us, const uint8_t *bytes, size_t n);
/* Adds a frame that only asks; such frames in a row share a line. */
void chronicle_asked(chronicle *c, int64_t at_us);
/* Prints the lines, the oldest first. */
void chronicle_print(const chronicle *c);

#endif
