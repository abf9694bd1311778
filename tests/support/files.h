/* SPDX-License-Identifier: MIT */
/* Files of tests, and of the reference material beside the checkout. */
#ifndef GROBO_TESTS_FILES_H
#define GROBO_TESTS_FILES_H

#include <stddef.h>

/* All of a file, NUL-terminated, for free(); NULL if it cannot be read. size may be NULL. */
char *file_text(const char *path, size_t *size);

/* Writes a file; fails the test if that fails. */
void put_file(const char *path, const char *text);

/* Fails the test if this is not all that the file has. */
void assert_file(const char *path, const char *text);

/* The path of a file of the reference material; skips the test, saying so, where it is missing. */
const char *shared_file(const char *name);

#endif
