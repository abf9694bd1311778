/* SPDX-License-Identifier: MIT */
/*
 * Structures that cross the binary interface and may grow: the first member, `size`, is what the
 * program was compiled with (GROBO_SIZED). The compiled size of a structure is a size_t at least,
 * and what an older program does not know is zero.
 */
#ifndef GROBO_BASE_SIZED_H
#define GROBO_BASE_SIZED_H

#include <stdbool.h>
#include <stddef.h>

/* Longer than any structure will be. */
#define SIZED_MAX_BYTES 65536

/*
 * Copies a structure of the caller's into one of the library's, whose `size` is that of the library
 * then; NULL for one that is all zero. GROBO_ERR_ARG: `size` is nonsense, or something is set that
 * this library does not know; the copy is untouched then.
 */
int grobo_i_sized_take(void *to, size_t to_bytes, const void *from);

/* Copies a structure of the library's as far as the caller's has room; `to` keeps its size. False:
 * its size is nonsense. */
bool grobo_i_sized_give(void *to, const void *from, size_t from_bytes);

#endif
