/* SPDX-License-Identifier: MIT */
/* Bytes on the heap that grow as they are put together, as of a file that is written whole. */
#ifndef GRCTL_HEAP_H
#define GRCTL_HEAP_H

#include <stdbool.h>
#include <stddef.h>

#include <jansson.h>

/* Begins as {0}. Where memory runs out it has no bytes, and takes none any more. */
typedef struct heap {
    char *bytes; /* a NUL is behind them; NULL: there are none. free() frees them */
    size_t size;
    /* private */
    size_t room;
    bool failed;
} heap;

void heap_add(heap *to, const void *bytes, size_t size);
/* As the write() of a grobo_sink, with a heap as its ctx: 0, or GROBO_ERR_NOMEM. */
int heap_sink(void *to, const void *bytes, size_t size);
void heap_print(heap *to, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* JSON as the command writes it, on one line; takes the reference. */
void heap_json(heap *to, json_t *object);

#endif
