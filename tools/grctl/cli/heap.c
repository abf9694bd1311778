/* SPDX-License-Identifier: MIT */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/error.h>

#include "tools/grctl/cli/heap.h"

enum { FIRST_BYTES = 1024 };

static void fail(heap *to)
{
    free(to->bytes);
    *to = (heap){.failed = true};
}

/* Where so many bytes and a NUL may be written behind those that are there; NULL: nowhere. */
static char *make_room(heap *to, size_t size)
{
    size_t room = to->room ? to->room : FIRST_BYTES;
    while (room - to->size <= size) {
        room *= 2;
    }
    char *bytes = to->failed ? NULL : room == to->room ? to->bytes : realloc(to->bytes, room);
    if (!bytes) {
        fail(to);
        return NULL;
    }
    to->bytes = bytes;
    to->room = room;
    return bytes + to->size;
}

void heap_add(heap *to, const void *bytes, size_t size)
{
    char *at = make_room(to, size);
    if (at) {
        memcpy(at, bytes, size);
        at[size] = '\0';
        to->size += size;
    }
}

int heap_sink(void *to, const void *bytes, size_t size)
{
    heap_add(to, bytes, size);
    return ((heap *)to)->failed ? GROBO_ERR_NOMEM : GROBO_OK;
}

void heap_print(heap *to, const char *format, ...)
{
    va_list list, again;
    va_start(list, format);
    va_copy(again, list);
    int n = vsnprintf(NULL, 0, format, list);
    char *at = n < 0 ? NULL : make_room(to, (size_t)n);
    if (at) {
        vsnprintf(at, (size_t)n + 1, format, again);
        to->size += (size_t)n;
    }
    va_end(again);
    va_end(list);
}

static int add_part(const char *bytes, size_t size, void *ctx)
{
    heap_add(ctx, bytes, size);
    return 0;
}

void heap_json(heap *to, json_t *object)
{
    if (json_dump_callback(object, add_part, to, JSON_COMPACT | JSON_REAL_PRECISION(12)) != 0) {
        fail(to);
    }
    json_decref(object);
}
