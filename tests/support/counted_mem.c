/* SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include "tests/support/counted_mem.h"

static void *resize(void *ctx, void *ptr, size_t old_bytes, size_t new_bytes)
{
    counted_mem *counter = ctx;

    if (new_bytes > 0 && ++counter->calls == counter->fail_at) {
        counter->failed = true;
        return NULL;
    }
    counter->bytes += new_bytes - old_bytes;
    if (counter->bytes > counter->bytes_peak) {
        counter->bytes_peak = counter->bytes;
    }
    if (new_bytes == 0) {
        free(ptr);
        return NULL;
    }
    return realloc(ptr, new_bytes);
}

grobo_mem counted_mem_of(counted_mem *counter)
{
    return (grobo_mem){resize, counter};
}
