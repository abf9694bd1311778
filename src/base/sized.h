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

#include <grobo/limits.h>

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

/*
 * Tables of the caller's that are borrowed (GROBO_TABLE, types.h), and so read where they are.
 * GROBO_I_FITS is what a check says of one: `last` is the last member that its first version had.
 * What came behind that is read by GROBO_I_MEMBER, which is zero in an older program's.
 */
#if GROBO_TABLES_FIXED
#define GROBO_I_FITS(table, last) true
#define GROBO_I_MEMBER(table, size, member) ((table)->member)
#else
#define GROBO_I_END_OF(table, member)                                                              \
    ((size_t)((const char *)(&(table)->member + 1) - (const char *)(table)))
#define GROBO_I_FITS(table, last)                                                                  \
    grobo_i_table_fits(table, (table)->size, sizeof *(table), GROBO_I_END_OF(table, last))
#define GROBO_I_MEMBER(table, size, member)                                                        \
    (GROBO_I_END_OF((table), member) <= (size) ? (table)->member : 0)
#endif

/* Whether a table of `size` bytes has what its first version had, and nothing set that the library
 * does not know, whose own table has `known` bytes. */
bool grobo_i_table_fits(const void *table, size_t size, size_t known, size_t least);

/* Copies a table into one of another size, which it keeps: what `from` does not have is zero. */
void grobo_i_table_copy(void *to, size_t to_bytes, const void *from, size_t from_bytes);

#endif
