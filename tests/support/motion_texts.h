/* SPDX-License-Identifier: MIT */
/* Motions of tests: from texts, and written to them. */
#ifndef GROBO_TESTS_MOTION_TEXTS_H
#define GROBO_TESTS_MOTION_TEXTS_H

#include <stdbool.h>
#include <stddef.h>

#include <grobo/core/motion_io.h>

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
/* Time of posture n. */
double time_of(const grobo_motion *motion, size_t n);

#endif
