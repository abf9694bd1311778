/* SPDX-License-Identifier: MIT */
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/motion/text/number.h"

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

/* Takes digits, any number of them: those that do not fit only move the exponent. */
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

/* Takes digits of which there are so few that all fit. */
static const char *take_few(const char *p, const char *end, uint64_t *digits)
{
    uint64_t taken = *digits;

    for (; p < end && is_digit(*p); p++) {
        taken = taken * 10 + (uint64_t)(*p - '0');
    }
    *digits = taken;
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
    bool few = end - p <= DIGITS_MAX;
    p = few ? take_few(p, end, &number->digits) : take_digits(p, end, number, &n_digits, 0);
    ptrdiff_t seen = p - first;
    if (p < end && *p == '.') {
        const char *point = ++p;
        if (few) {
            p = take_few(p, end, &number->digits);
            number->exponent = (int)(point - p);
        } else {
            p = take_digits(p, end, number, &n_digits, -1);
        }
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
 * by them rounds once, so the result is the nearest double (Clinger 1990). Where expressions are
 * not rounded to double (FLT_EVAL_METHOD), the C library does it.
 */
static const double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
enum { POWER_MAX = 22 };

static bool exact_value(uint64_t digits, int exponent, double *value)
{
    if (FLT_EVAL_METHOD != 0 || digits > (uint64_t)1 << 53 || exponent < -POWER_MAX ||
        exponent > POWER_MAX) {
        return false;
    }
    *value = exponent < 0 ? (double)digits / powers[-exponent] : (double)digits * powers[exponent];
    return true;
}

/*
 * Digits of 54 to 64 bits, as %.17g gives them: computed with twice the precision of a double, as
 * sum + rest. sum is the nearest double if rest lies clearly within half a unit of its last
 * place: if a slightly larger rest still rounds to sum. The error is some 2^-104 of the value, the
 * margin 2^-40 of a rest that, where it matters, is 2^-54 of it.
 */
static bool wide_value(uint64_t digits, int exponent, double *value)
{
    uint64_t low = digits & 0x7FF;
    double high_part = (double)(digits - low), low_part = (double)low;
    double quotient, rest;

    if (FLT_EVAL_METHOD != 0 || exponent < -POWER_MAX || exponent > POWER_MAX) {
        return false;
    }
    if (exponent < 0) {
        double power = powers[-exponent];
        quotient = high_part / power;
        rest = (fma(-quotient, power, high_part) + low_part) / power;
    } else {
        double power = powers[exponent];
        quotient = high_part * power;
        rest = fma(high_part, power, -quotient) + low_part * power;
    }
    double sum = quotient + rest;
    rest -= sum - quotient;
    *value = sum;
    return sum + rest * (1 + 0x1p-40) == sum;
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
    double found = strtod(copy, NULL);
    if (isfinite(found)) {
        *value = found;
    }
    return isfinite(found);
}

bool grobo_i_parse_number(const char *text, size_t length, double *value)
{
    decimal number;
    double found;

    if (!take_apart(text, length, &number)) {
        return false;
    }
    if (number.digits == 0 ||
        (!number.inexact && (exact_value(number.digits, number.exponent, &found) ||
                             wide_value(number.digits, number.exponent, &found)))) {
        found = number.digits == 0 ? 0 : found;
        *value = number.negative ? -found : found;
        return true;
    }
    return library_value(text, length, value);
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

/* floor(log10(value)), or one more or less: value > 0. */
static int magnitude(double value)
{
    int binary;

    (void)frexp(value, &binary);
    return (int)floor((binary - 1) * 0.30102999566398120);
}

/*
 * The whole number nearest to value * 10^shift, if that has just as many digits as asked for.
 * The product is exact, in two parts.
 */
static bool scaled_digits(double value, int shift, uint64_t least, uint64_t *digits)
{
    double power = powers[shift < 0 ? -shift : shift];
    double high, low = 0;

    if (shift < 0) {
        high = value / power;
    } else {
        high = value * power;
        low = fma(value, power, -high);
    }
    double whole = floor(high);
    double part = (high - whole) + low;
    *digits = (uint64_t)((int64_t)whole + (int64_t)floor(part + 0.5));
    return *digits >= least && *digits < 10 * least;
}

/* Digits without their last zeros, as text in C's %g form. */
static size_t put_digits(uint64_t digits, int count, int exponent, bool negative, char *text)
{
    char plain[24];
    char *p = text;

    while (digits % 10 == 0 && count > 1) {
        digits /= 10;
        count--;
    }
    for (int i = count; i-- > 0; digits /= 10) {
        plain[i] = (char)('0' + digits % 10);
    }
    if (negative) {
        *p++ = '-';
    }
    if (exponent < 0) {
        *p++ = '0';
        *p++ = '.';
        for (int i = exponent + 1; i < 0; i++) {
            *p++ = '0';
        }
    }
    for (int i = 0; i < count || i <= exponent; i++) {
        *p++ = i < count ? plain[i] : '0';
        if (i == exponent && i + 1 < count) {
            *p++ = '.';
        }
    }
    return (size_t)(p - text);
}

static size_t put_whole(int32_t value, char *text)
{
    uint32_t digits = value < 0 ? (uint32_t)-value : (uint32_t)value;
    char plain[12];
    size_t count = 0, length = 0;

    do {
        plain[count++] = (char)('0' + digits % 10);
        digits /= 10;
    } while (digits > 0);
    if (value < 0) {
        text[length++] = '-';
    }
    while (count > 0) {
        text[length++] = plain[--count];
    }
    return length;
}

/* As "%.*g" would write it, if that reads back as value and is easily found; 0 if not. */
static size_t format_fast(double value, int count, char text[GROBO_I_NUMBER_BYTES])
{
    uint64_t least = count == 9 ? 100000000U : 10000000000000000U;
    double size = fabs(value), back;
    uint64_t digits;

    /* Only what %g writes without an exponent. */
    if (!(size >= 1e-4 && size < 1e8)) {
        return 0;
    }
    int exponent = magnitude(size);
    bool found = scaled_digits(size, count - 1 - exponent, least, &digits);
    if (!found) {
        exponent++;
        found = scaled_digits(size, count - 1 - exponent, least, &digits);
    }
    int shift = exponent - (count - 1);
    if (!found || !(exact_value(digits, shift, &back) || wide_value(digits, shift, &back)) ||
        back != size) {
        return 0;
    }
    return put_digits(digits, count, exponent, value < 0, text);
}

size_t grobo_i_format_number(double value, char text[GROBO_I_NUMBER_BYTES])
{
    double back;
    size_t length;

    if (value == 0 && !signbit(value)) {
        text[0] = '0';
        return 1;
    }
    length = format_fast(value, 9, text);
    if (length > 0) {
        return length;
    }
    length = format_digits(value, 9, text);
    if (grobo_i_parse_number(text, length, &back) && back == value) {
        return length;
    }
    length = format_fast(value, 17, text);
    return length > 0 ? length : format_digits(value, 17, text);
}

size_t grobo_i_format_scaled(double value, double numerator, double denominator,
                             char text[GROBO_I_NUMBER_BYTES])
{
    double guess = value * (denominator / numerator);
    double low = guess, high = guess, back;

    if (fabs(guess) < 1e9) {
        int32_t whole = (int32_t)(guess < 0 ? guess - 0.5 : guess + 0.5);
        if (whole * numerator / denominator == value && (value != 0 || !signbit(value))) {
            return put_whole(whole, text);
        }
    }
    size_t length = format_digits(guess, 9, text);
    if (grobo_i_parse_number(text, length, &back) && back * numerator / denominator == value) {
        return length;
    }
    for (int i = 0; i < 8; i++) {
        if (low * numerator / denominator == value) {
            return grobo_i_format_number(low, text);
        }
        if (high * numerator / denominator == value) {
            return grobo_i_format_number(high, text);
        }
        low = nextafter(low, -HUGE_VAL);
        high = nextafter(high, HUGE_VAL);
    }
    return grobo_i_format_number(guess, text);
}
