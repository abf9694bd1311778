/* SPDX-License-Identifier: MIT */
/* Lines that a person types: edit/libedit.c, or edit/plain.c where libedit is missing. */
#ifndef GRCTL_EDIT_H
#define GRCTL_EDIT_H

#include <stdbool.h>
#include <stddef.h>

#include <event2/event.h>

/* Instead of a line. LINE_NEWS: there is something to tell. */
enum { LINE_END = -1, LINE_INTERRUPTED = -2, LINE_NEWS = -3, LINE_TOO_LONG = -4 };

/* Tells what a word may be; whole is false where more must follow (a folder). */
typedef void (*line_found_fn)(void *ctx, const char *word, bool whole);

/* Whose lines they are. */
typedef struct line_owner {
    void *ctx;
    struct event_base *base; /* of the loop that wait() runs */
    /* Waits for standard input. Returns 0, LINE_INTERRUPTED or LINE_NEWS. */
    int (*wait)(void *ctx);
    /* Prints what LINE_NEWS was about, while a line is typed. */
    void (*tell)(void *ctx);
    /*
     * What may stand at the end of the `length` bytes of a line: found() is called for each.
     * Returns how many bytes at the end they replace.
     */
    size_t (*complete)(void *ctx, const char *line, size_t length, line_found_fn found,
                       void *found_ctx);
} line_owner;

typedef struct line_reader line_reader;

/* NULL when there is no memory. */
line_reader *line_open(const line_owner *owner);
/*
 * A line without its end; what was printed has gone out. Returns its length, LINE_END,
 * LINE_INTERRUPTED by a signal, or LINE_TOO_LONG.
 */
int line_read(line_reader *reader, const char *prompt, char *line, size_t capacity);
void line_close(line_reader *reader);

#endif
