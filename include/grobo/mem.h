/* SPDX-License-Identifier: MIT */
/**
 * @file mem.h
 * @brief The allocator that a caller may give to whatever allocates.
 */
#ifndef GROBO_MEM_H
#define GROBO_MEM_H

#include <stddef.h>

#include <grobo/export.h>

GROBO_BEGIN_DECLS

/**
 * An allocator. A NULL pointer to one, wherever one is asked for, means the C library's.
 * The struct is borrowed: it must outlive every object made with it.
 */
typedef struct grobo_mem {
    /**
     * Allocates (ptr NULL), resizes, or frees (new_bytes 0, returns NULL). old_bytes is what was
     * asked for before. On failure NULL, and the old block is as it was. Must be safe to call
     * from every thread that uses an object made with it.
     */
    void *(*resize)(void *ctx, void *ptr, size_t old_bytes, size_t new_bytes);
    void *ctx; /**< handed back to resize */
} grobo_mem;

/** The C library's allocator, what NULL stands for. */
GROBO_API const grobo_mem *grobo_mem_default(void);

GROBO_END_DECLS

#endif
