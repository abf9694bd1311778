/* SPDX-License-Identifier: MIT */
/*
 * Memory from the caller's functions; where mem is NULL, from the heap. Sizes are what was asked
 * for, as grobo_mem wants them. NULL comes back when there is none; NULL may be freed.
 */
#ifndef GROBO_BASE_MEMORY_H
#define GROBO_BASE_MEMORY_H

#include <stddef.h>

#include <grobo/mem.h>

void *grobo_i_alloc(const grobo_mem *mem, size_t bytes);
/* The same, all zero. */
void *grobo_i_new(const grobo_mem *mem, size_t bytes);
void grobo_i_free(const grobo_mem *mem, void *ptr, size_t bytes);
/* A copy of text[0..length-1] with a NUL; freed by grobo_i_free_text(). */
char *grobo_i_copy_text(const grobo_mem *mem, const char *text, size_t length);
void grobo_i_free_text(const grobo_mem *mem, char *text);

#endif
