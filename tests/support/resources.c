/* SPDX-License-Identifier: MIT */
#include <stddef.h>

#include "resources.h"

static void *resize(void *ctx, void *ptr, size_t old_bytes, size_t new_bytes)
{
    test_mem *mem = ctx;
    const grobo_mem *real = grobo_mem_default();
    void *made = NULL;

    if (new_bytes == 0) {
        mem->blocks -= ptr != NULL ? 1 : 0;
        return real->resize(real->ctx, ptr, old_bytes, 0);
    }
    if (mem->allocations_left > 0) {
        mem->allocations_left--;
        made = real->resize(real->ctx, ptr, old_bytes, new_bytes);
        mem->blocks += made != NULL && ptr == NULL ? 1 : 0;
    }
    return made;
}

void test_mem_init(test_mem *mem, int allocations_left)
{
    mem->mem.resize = resize;
    mem->mem.ctx = mem;
    mem->allocations_left = allocations_left;
    mem->blocks = 0;
}
