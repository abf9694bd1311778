/* SPDX-License-Identifier: MIT */
/* What tests ask of the operating system, a file a system in os/. */
#ifndef GROBO_TESTS_OS_H
#define GROBO_TESTS_OS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Makes a new folder among the temporary files; fails the test where that does not work. */
void test_folder_new(char *path, size_t path_bytes);

/* Makes a folder, removes an empty one: 0, else something else. */
int test_folder_make(const char *path);
int test_folder_remove(const char *path);

/* A locale with a decimal comma for numbers of this process, made for it where none is installed.
 * False where neither can be had. */
bool test_locale_with_comma(void);

/* Processor time that this process has used. */
int64_t test_cpu_us(void);

#endif
