/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "motion/number.h"

enum {
    DIGITS_MAX = 19,     /* that fit into 64 bits whatever they are */
    EXPONENT_MAX = 9999, /* beyond it a number is 0 or too large */
    TEXT_MAX = 512       /* longest number that the C library is asked about */
};

/* A number taken apart: digits * 10^exponent, and whether digits were left out. */
typedef struct decimal {
    uint64_t digits;
    int exponent;
    bool negative;
    bool inexact;
} decimal;

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Takes digits; *scale is what one of them does to the exponent once taken (0 or -1). */
static const char *take_digits(const char *p, const char *end, decimal *number, int *n_digits,
                               int scale)
{
    for (; p < end && is_digit(*p); p++) {
        if (*n_digits < DIGITS_MAX) {
            number->digits = number->digits * 10 + (uint64_t)(*p - '0');
            *n_digits += number->digits != 0;
            number->exponent += scale;
        } else {
            number->inexact = number->inexact || *p != '0';
            number->exponent += 1 + scale;
        }
    }
    return p;
}

/* Takes "e-019"; NULL if there is an e and no exponent. */
static const char *take_exponent(const char *p, const char *end, decimal *number)
{
    bool negative = false;
    int exponent = 0;

    if (p == end || (*p != 'e' && *p != 'E')) {
        return p;
    }
    p++;
    if (p < end && (*p == '+' || *p == '-')) {
        negative = *p++ == '-';
    }
    if (p == end || !is_digit(*p)) {
        return NULL;
    }
    for (; p < end && is_digit(*p); p++) {
        exponent = exponent < EXPONENT_MAX ? exponent * 10 + (*p - '0') : exponent;
    }
    number->exponent += negative ? -exponent : exponent;
    return p;
}

/* True if all of the text is a number. */
static bool take_apart(const char *text, size_t length, decimal *number)
{
    const char *p = text, *end = text + length;
    int n_digits = 0;

    memset(number, 0, sizeof *number);
    if (p < end && (*p == '+' || *p == '-')) {
        number->negative = *p++ == '-';
    }
    const char *first = p;
    p = take_digits(p, end, number, &n_digits, 0);
    ptrdiff_t seen = p - first;
    if (p < end && *p == '.') {
        const char *point = ++p;
        p = take_digits(p, end, number, &n_digits, -1);
        seen += p - point;
    }
    if (seen == 0) {
        return false;
    }
    p = take_exponent(p, end, number);
    return p == end;
}

/*
 * Powers of ten that a double holds exactly. With digits below 2^53 one multiplication or division
 * by them rounds once, so the result is the nearest double (Clinger 1990).
 */
static const double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
enum { POWER_MAX = 22 };

static bool exact_value(const decimal *number, double *value)
{
    if (number->inexact || number->digits > (uint64_t)1 << 53) {
        return false;
    }
    if (number->digits == 0) {
        *value = 0;
    } else if (number->exponent < -POWER_MAX || number->exponent > POWER_MAX) {
        return false;
    } else if (number->exponent < 0) {
        *value = (double)number->digits / powers[-number->exponent];
    } else {
        *value = (double)number->digits * powers[number->exponent];
    }
    *value = number->negative ? -*value : *value;
    return true;
}

/* The locale's decimal point, as the C library itself writes it. */
static size_t locale_point(char point[8])
{
    char text[16];
    int length = snprintf(text, sizeof text, "%.1f", 0.5);
    size_t bytes = length > 2 && length < 10 ? (size_t)length - 2 : 1;

    memcpy(point, text + 1, bytes);
    return bytes;
}

/* Asks the C library. ERANGE is no error here: a denormal is a number, HUGE_VAL is not finite. */
static bool library_value(const char *text, size_t length, double *value)
{
    char copy[TEXT_MAX + 16];
    const char *point = memchr(text, '.', length);
    size_t used = 0;

    if (length > TEXT_MAX) {
        return false;
    }
    if (point != NULL) {
        char local[8];
        size_t bytes = locale_point(local);
        used = (size_t)(point - text);
        memcpy(copy, text, used);
        memcpy(copy + used, local, bytes);
        used += bytes;
        length -= (size_t)(point - text) + 1;
        text = point + 1;
    }
    memcpy(copy + used, text, length);
    copy[used + length] = '\0';
    *value = strtod(copy, NULL);
    return isfinite(*value);
}

bool grobo_i_parse_number(const char *text, size_t length, double *value)
{
    decimal number;
    double found;

    if (!take_apart(text, length, &number) ||
        (!exact_value(&number, &found) && !library_value(text, length, &found))) {
        return false;
    }
    *value = found;
    return true;
}

bool grobo_i_parse_int(const char *text, size_t length, long low, long high, long *value)
{
    bool negative = length > 0 && text[0] == '-';
    size_t i = negative || (length > 0 && text[0] == '+');
    long found = 0;

    if (i == length || length - i > 9) {
        return false;
    }
    for (; i < length; i++) {
        if (!is_digit(text[i])) {
            return false;
        }
        found = found * 10 + (text[i] - '0');
    }
    found = negative ? -found : found;
    if (found < low || found > high) {
        return false;
    }
    *value = found;
    return true;
}

static size_t format_digits(double value, int digits, char text[GROBO_I_NUMBER_BYTES])
{
    char local[8];
    int length = snprintf(text, GROBO_I_NUMBER_BYTES, "%.*g", digits, value);
    size_t n = (size_t)length;

    if (memchr(text, '.', n) == NULL && value != floor(value)) {
        /* Not a whole number and yet no point: the locale has another one, of `bytes` bytes. */
        size_t bytes = locale_point(local);
        char *place = local[0] != '.' ? memchr(text, local[0], n) : NULL;
        if (place != NULL) {
            size_t rest = n - (size_t)(place - text) - bytes;
            place[0] = '.';
            memmove(place + 1, place + bytes, rest + 1);
            n -= bytes - 1;
        }
    }
    return n;
}

size_t grobo_i_format_number(double value, char text[GROBO_I_NUMBER_BYTES])
{
    double back;
    size_t length = format_digits(value, 9, text);

    if (!grobo_i_parse_number(text, length, &back) || back != value) {
        length = format_digits(value, 17, text);
    }
    return length;
}

size_t grobo_i_format_scaled(double value, double numerator, double denominator,
                             char text[GROBO_I_NUMBER_BYTES])
{
    double guess = value * denominator / numerator;
    double low = guess, high = guess;
    double back;
    size_t length = format_digits(guess, 9, text);

    if (grobo_i_parse_number(text, length, &back) && back * numerator / denominator == value) {
        return length;
    }
    for (int i = 0; i < 8; i++) {
        if (low * numerator / denominator == value) {
            return format_digits(low, 17, text);
        }
        if (high * numerator / denominator == value) {
            return format_digits(high, 17, text);
        }
        low = nextafter(low, -HUGE_VAL);
        high = nextafter(high, HUGE_VAL);
    }
    return format_digits(guess, 17, text);
}
