/* SPDX-License-Identifier: MIT */
/* An allocator that counts and can fail: for every test of what allocates. */
#ifndef TESTS_SUPPORT_MOTION_MEM_H
#define TESTS_SUPPORT_MOTION_MEM_H

#include <stdbool.h>
#include <stddef.h>

#include <grobo/mem.h>

typedef struct motion_mem {
    size_t bytes;      /* allocated now; ends at 0 if old_bytes is always told truly */
    size_t bytes_peak; /* most at a time */
    size_t calls;      /* allocations asked for, and blocks made larger */
    size_t fail_at;    /* the allocation that fails, counted from 1; 0: none */
    bool failed;       /* it has */
} motion_mem;

/* The allocator that counts in *counter, which must outlive it. */
grobo_mem motion_mem_of(motion_mem *counter);

#endif
