/* SPDX-License-Identifier: MIT */
/* An allocator that counts and can fail: for every test of what allocates. */
#ifndef GROBO_TESTS_COUNTED_MEM_H
#define GROBO_TESTS_COUNTED_MEM_H

#include <stdbool.h>
#include <stddef.h>

#include <grobo/mem.h>

typedef struct counted_mem {
    size_t bytes;      /* allocated now; ends at 0 if old_bytes is always told truly */
    size_t bytes_peak; /* most at a time */
    size_t calls;      /* allocations asked for, and blocks made larger */
    size_t fail_at;    /* the allocation that fails, counted from 1; 0: none */
    bool failed;       /* it has */
} counted_mem;

/* The allocator that counts in *counter, which must outlive it. */
grobo_mem counted_mem_of(counted_mem *counter);

#endif
