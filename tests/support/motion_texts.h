/* SPDX-License-Identifier: MIT */
/* Motion files for tests: from texts, and from the reference material beside the checkout. */
#ifndef TESTS_SUPPORT_MOTION_FILES_H
#define TESTS_SUPPORT_MOTION_FILES_H

#include <stdbool.h>
#include <stddef.h>

#include <grobo/motion_io.h>

/* One of everything that a key pose may have. */
extern const char full_pose[];

/* Reads a motion from a text; fails the test if that fails. */
grobo_motion *motion_of(const char *text, grobo_motion_format format);
/* Reads a text with these options and gives the result; what was read is freed. */
int read_result(const char *text, const grobo_read_options *options, grobo_diagnostics *list);
/* What a motion is written as; NUL-terminated, to be freed by free(). *size may be NULL. */
char *written_as(const grobo_motion *motion, grobo_motion_format format,
                 const grobo_write_options *options, size_t *size);
/* True if the list has a diagnostic of this code at this place (column 0: any). */
bool has_diagnostic(const grobo_diagnostics *list, const char *code, unsigned line,
                    unsigned column);
/* Angle of a joint of posture n; NAN where it is not set. */
double angle_of(const grobo_motion *motion, size_t n, int joint);
/* All of a file, NUL-terminated, to be freed by free(); NULL if it cannot be read. */
char *file_text(const char *path, size_t *size);
/* Writes a file; fails the test if that fails. */
void put_file(const char *path, const char *text);
/* Fails the test if this is not all that the file has. */
void assert_file(const char *path, const char *text);
/* The path of a file of the reference material; skips the test, saying so, where it is missing. */
const char *shared_file(const char *name);

#endif
