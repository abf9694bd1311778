/* SPDX-License-Identifier: MIT */
/*
 * The far end of a serial line for tests: a pty whose slave is the device under test; or, where
 * GROBO_TEST_SERIAL names two ports joined by a null-modem cable ("/dev/ttyS1,/dev/ttyS2"), the
 * second of them.
 */
#ifndef GROBO_TESTS_LINE_H
#define GROBO_TESTS_LINE_H

#include <stdbool.h>
#include <stddef.h>

#include <grobo/core/serial.h>

typedef struct test_line {
    int fd;          /* the far end, non-blocking; -1 when closed */
    char device[64]; /* what to open */
} test_line;

/* Makes a line; fails the test where that does not work. */
void test_line_open(test_line *line);

/* Makes one and opens a serial port on it; `silence_ms` as of grobo_serial_config. */
grobo_serial *test_line_open_serial(test_line *line, int silence_ms);

/* Skips the test on a cable: it needs `what`, which only a pty does. */
void test_line_needs_pty(const char *what);

/* Closes the far end. A pty hangs up then: the device is gone for whoever has it open. */
void test_line_close(test_line *line);

/* Writes all bytes; fails the test when the line does not take them. */
void test_line_write(test_line *line, const void *bytes, size_t size);

/* Writes what the line takes at once. */
size_t test_line_write_some(test_line *line, const void *bytes, size_t size);

/* Returns when what was written has arrived; on a cable when it must have. */
void test_line_await_arrival(test_line *line);

/* Reads exactly size bytes; fails the test when they do not come in 5 s. */
void test_line_read(test_line *line, void *bytes, size_t size);

/* Reads what is there. */
size_t test_line_read_some(test_line *line, void *bytes, size_t size);

#endif
