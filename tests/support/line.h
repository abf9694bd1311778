/* SPDX-License-Identifier: MIT */
/* The far end of a serial line for tests: a pty whose slave is the device under test. */
#ifndef GROBO_TESTS_LINE_H
#define GROBO_TESTS_LINE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct test_line {
    int fd;          /* the master, non-blocking; -1 when hung up */
    char device[64]; /* the slave's path */
} test_line;

/* Makes a pty; fails the test where that does not work. */
void test_line_open(test_line *line);

/* Hangs up: the slave is gone for whoever has it open. */
void test_line_close(test_line *line);

/* Writes all bytes; fails the test when the pty does not take them. */
void test_line_write(test_line *line, const void *bytes, size_t size);

/* Reads exactly size bytes; fails the test when they do not come in 5 s. */
void test_line_read(test_line *line, void *bytes, size_t size);

/* Reads what is there. */
size_t test_line_read_some(test_line *line, void *bytes, size_t size);

#endif
