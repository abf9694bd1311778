/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "src/motion/store/container.h"

void *grobo_i_alloc(const grobo_mem *mem, size_t bytes)
{
    return mem->resize(mem->ctx, NULL, 0, bytes);
}

void grobo_i_free(const grobo_mem *mem, void *ptr, size_t bytes)
{
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
