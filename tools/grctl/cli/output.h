/* SPDX-License-Identifier: MIT */
/*
 * Standard output and standard error. While a robot is connected, what is printed goes to a queue
 * and a thread writes it (writer.h): neither a full pipe nor a terminal after Ctrl-S holds up the
 * loop. What does not fit into the queue is dropped and counted. Without a robot, printing waits
 * for its reader, as it does everywhere.
 */
#ifndef GRCTL_OUTPUT_H
#define GRCTL_OUTPUT_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* From here on nothing waits for a reader. False where memory or a thread is missing. */
bool output_detach(void);

/* Messages that were dropped since output_detach(): their readers were too slow. */
typedef struct output_dropped {
    uint64_t out, err;
} output_dropped;

/* From here on readers are waited for, first for all that is queued. */
output_dropped output_attach(void);

/* Writes out what was printed; false when it cannot be, now or at an earlier call. */
bool output_flush(void);

/* Why standard output cannot be written: errno of the first failure, 0 none. */
int output_error(void);

/* Text for standard output, as vprintf() does it. */
void output_print(const char *format, va_list list);

/* Bytes for standard output. */
void output_bytes(const void *bytes, size_t size);

/* For what prints to a stream itself: standard output, to be flushed. It waits for the reader. */
FILE *output_stream(void);

/* Text for standard error, written out at once. */
void output_complain(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* True while stdout or stderr has not taken what it was given: what is soon stale can wait. */
bool output_is_behind(const FILE *stream);

#endif
