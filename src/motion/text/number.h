/* SPDX-License-Identifier: MIT */
/* Numbers as text, the same in every locale. */
#ifndef GROBO_MOTION_NUMBER_H
#define GROBO_MOTION_NUMBER_H

#include <stdbool.h>
#include <stddef.h>

/* Bytes that any number written here needs, with the NUL. */
enum { GROBO_I_NUMBER_BYTES = 32 };

/*
 * Parses all of text[0..length-1] as a decimal number: sign, digits, point, exponent; correctly
 * rounded, denormals included. False for anything else: nan, inf, hexadecimal, blanks, nothing,
 * or a number too large for a double.
 */
bool grobo_i_parse_number(const char *text, size_t length, double *value);

/* Parses all of text as a whole number within low..high. */
bool grobo_i_parse_int(const char *text, size_t length, long low, long high, long *value);

/* Writes value as %.9g if that reads back as value, else as %.17g. @return its length. */
size_t grobo_i_format_number(double value, char text[GROBO_I_NUMBER_BYTES]);

/*
 * Writes the decimal number d, near `guess`, for which d * numerator / denominator is exactly
 * value: what a file must say so that reading it, which computes just that, gives value again.
 * Where none is found, guess. @return its length.
 */
size_t grobo_i_format_scaled(double value, double numerator, double denominator,
                             char text[GROBO_I_NUMBER_BYTES]);

#endif
