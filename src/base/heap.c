/* SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include <grobo/mem.h>

static void *resize(void *ctx, void *ptr, size_t old_bytes, size_t new_bytes)
{
    (void)ctx;
    (void)old_bytes;
    if (new_bytes == 0) {
        free(ptr);
        return NULL;
    }
    return realloc(ptr, new_bytes);
}

const grobo_mem *grobo_mem_default(void)
{
    static const grobo_mem mem = {resize, NULL};

    return &mem;
}
