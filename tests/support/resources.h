/* SPDX-License-Identifier: MIT */
/* What a test counts: memory that is handed out. */
#ifndef GROBO_TESTS_RESOURCES_H
#define GROBO_TESTS_RESOURCES_H

#include <grobo/mem.h>

/* An allocator that counts its blocks and refuses when it has handed out so many. */
typedef struct test_mem {
    grobo_mem mem;        /* give &mem to what is tested */
    int allocations_left; /* requests that will still succeed */
    int blocks;           /* blocks that were not given back */
} test_mem;

/* Makes one with so many allocations left. */
void test_mem_init(test_mem *mem, int allocations_left);

#endif
