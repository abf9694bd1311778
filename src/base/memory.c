/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "src/base/memory.h"

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

void *grobo_i_alloc(const grobo_mem *mem, size_t bytes)
{
    mem = mem != NULL ? mem : grobo_mem_default();
    return mem->resize(mem->ctx, NULL, 0, bytes);
}

void *grobo_i_new(const grobo_mem *mem, size_t bytes)
{
    void *ptr = grobo_i_alloc(mem, bytes);
    if (ptr != NULL) {
        memset(ptr, 0, bytes);
    }
    return ptr;
}

void grobo_i_free(const grobo_mem *mem, void *ptr, size_t bytes)
{
    mem = mem != NULL ? mem : grobo_mem_default();
    if (ptr != NULL) {
        (void)mem->resize(mem->ctx, ptr, bytes, 0);
    }
}

char *grobo_i_copy_text(const grobo_mem *mem, const char *text, size_t length)
{
    char *copy = grobo_i_alloc(mem, length + 1);
    if (copy != NULL) {
        memcpy(copy, text, length);
        copy[length] = '\0';
    }
    return copy;
}

void grobo_i_free_text(const grobo_mem *mem, char *text)
{
    if (text != NULL) {
        grobo_i_free(mem, text, strlen(text) + 1);
    }
}
