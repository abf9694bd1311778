/* SPDX-License-Identifier: MIT */
/*
 * Bytes on their way to a file whose reader may stop reading (a pipe, a terminal after Ctrl-S, a
 * disk that is busy). A thread writes them, so that the loop that moves a robot never waits for it.
 *
 * Each writer has a queue of a fixed size. A record is queued whole or dropped whole, and what is
 * dropped is counted. One thread serves all writers: it writes the records of all of them in the
 * order in which they were queued, but those of a file that takes nothing now stay behind those of
 * the others. It runs while there is a writer. All functions are for one and the same thread.
 */
#ifndef GRCTL_WRITER_H
#define GRCTL_WRITER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct writer writer;

/*
 * A writer for a file, of which nothing may be buffered, and which nobody else uses until
 * writer_free(). Returns NULL where memory or a thread is missing.
 */
writer *writer_new(FILE *to, size_t capacity);

/* Queues a record. Once the file has failed, records vanish: see writer_look(). */
void writer_put(writer *w, const void *bytes, size_t size);

typedef struct writer_state {
    bool behind;      /* something is queued or being written */
    int error;        /* errno of the first write that failed, 0 none */
    uint64_t dropped; /* records, because the queue was full */
} writer_state;
writer_state writer_look(const writer *w);

/* Waits until everything queued is written or the file has failed. */
void writer_drain(writer *w);

/* The same, and ends it. The file stays open. NULL is allowed. */
void writer_free(writer *w);

#endif
