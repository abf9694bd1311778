/* SPDX-License-Identifier: MIT */
/* What the files of src/link share. */
#ifndef GROBO_LINK_LINK_H
#define GROBO_LINK_LINK_H

#include <sys/time.h>

#include <grobo/mem.h>
#include <grobo/types.h>

/* Zeroed memory of a caller's allocator (NULL: the C library's); NULL when there is none. */
void *grobo_i_link_new(const grobo_mem *mem, size_t bytes);

/* Gives memory of grobo_i_link_new() back; NULL is fine. */
void grobo_i_link_free(const grobo_mem *mem, void *ptr, size_t bytes);

/* A span of time as libevent takes it; negative is 0. */
struct timeval grobo_i_link_timeval(int64_t span_us);

#endif
