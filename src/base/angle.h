/* SPDX-License-Identifier: MIT */
/*
 * What is sure of angles, and soon found. A processor that emulates doubles takes 50 instructions
 * to compare two, and 264 for their product: there the bits of a double (IEEE 754) say it, by
 * integers. What is too close for that they leave open, and doubles decide. The soft functions
 * never say yes where the hard ones, of processors that have doubles, say no
 * (tests/unit/test_angle.c).
 */
#ifndef GROBO_BASE_ANGLE_H
#define GROBO_BASE_ANGLE_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

_Static_assert(DBL_MANT_DIG == 53 && DBL_MAX_EXP == 1024, "a double has 64 bits");

/* ---- by the bits ----------------------------------------------------------------------------- */

static inline uint64_t grobo_i_bits(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* Numbers in their order: the greater of two of these is of the greater double. NaN is beyond both
 * ends. */
static inline int32_t grobo_i_order(double value)
{
    uint32_t high = (uint32_t)(grobo_i_bits(value) >> 32);
    return high >> 31 != 0 ? -1 - (int32_t)(high & 0x7FFFFFFF) : (int32_t)high;
}

static inline bool grobo_i_soft_inside(double min, double value, double max)
{
    int32_t order = grobo_i_order(value);
    return order > grobo_i_order(min) && order < grobo_i_order(max);
}

#define GROBO_I_NOT_FINE INT32_MIN

/* In 2^-26 of the unit, rounded towards 0; GROBO_I_NOT_FINE from 32 on, and for NaN. */
static inline int32_t grobo_i_fine(double value)
{
    uint64_t bits = grobo_i_bits(value);
    uint32_t high = (uint32_t)(bits >> 32), low = (uint32_t)bits;
    int exponent = (int)(high >> 20 & 0x7FF) - 1023;
    if (exponent > 4) {
        return GROBO_I_NOT_FINE;
    }
    uint32_t fraction = UINT32_C(1) << 31 | (high & 0xFFFFF) << 11 | low >> 21;
    int32_t fine = exponent < -26 ? 0 : (int32_t)(fraction >> (5 - exponent));
    return high >> 31 != 0 ? -fine : fine;
}

static inline bool grobo_i_soft_ddeg(double angle_rad, int16_t *ddeg)
{
    const int64_t by = INT64_C(2403159173); /* 1800 / PI * 2^-26 * 2^48 */
    int32_t fine = grobo_i_fine(angle_rad);
    uint64_t product = (uint64_t)(fine * by) + (UINT64_C(1) << 63);
    uint32_t above_least = (uint32_t)(product >> 32) + 0x8000; /* in 2^-16 of the unit */
    uint32_t rest = above_least & 0xFFFF;
    *ddeg = (int16_t)((int32_t)(above_least >> 16) - 0x8000);
    return fine != GROBO_I_NOT_FINE && rest > 3 && rest < 0xFFFC;
}

/* In 2^-28 s, a millionth less; 15 s at most. */
static inline uint32_t grobo_i_soft_span(int64_t time_us, int pct)
{
    const uint64_t by = 1441150439; /* 2^28 / 10^8 * 2^29, a millionth less */
    uint32_t least_us = time_us > 15000000 ? 15000000 : time_us < 0 ? 0 : (uint32_t)time_us;
    return (uint32_t)(least_us * (uint32_t)pct * by >> 29);
}

static inline bool grobo_i_soft_gets_there(double from_rad, double to_rad, double speed_rad_s,
                                           uint32_t span)
{
    int32_t from = grobo_i_fine(from_rad), to = grobo_i_fine(to_rad);
    int32_t pace = grobo_i_fine(speed_rad_s);
    uint32_t way = from < to ? (uint32_t)to - (uint32_t)from : (uint32_t)from - (uint32_t)to;
    return from != GROBO_I_NOT_FINE && to != GROBO_I_NOT_FINE && pace > 0 &&
           ((uint64_t)way + 2) << 28 <= (uint64_t)(uint32_t)pace * span;
}

/* ---- by doubles ------------------------------------------------------------------------------ */

static inline bool grobo_i_hard_inside(double min, double value, double max)
{
    return value >= min && value <= max && isfinite(value);
}

static inline bool grobo_i_hard_ddeg(double angle_rad, int16_t *ddeg)
{
    if (!(angle_rad > -50 && angle_rad < 50)) {
        return false;
    }
    int32_t fine = (int32_t)(angle_rad * (1800.0 / 3.14159265358979323846 * 65536)) + 0x8000;
    uint32_t above_least = (uint32_t)fine + (UINT32_C(1) << 31);
    uint32_t rest = above_least & 0xFFFF;
    *ddeg = (int16_t)((int32_t)(above_least >> 16) - 0x8000);
    return rest > 1 && rest < 0xFFFE;
}

static inline double grobo_i_hard_span(int64_t time_us, int pct)
{
    const double rounding = 1 - 1e-6;
    return (double)time_us * pct * (rounding * 1e-8);
}

static inline bool grobo_i_hard_gets_there(double from_rad, double to_rad, double speed_rad_s,
                                           double span)
{
    return fabs(to_rad - from_rad) <= speed_rad_s * span;
}

/* ---- what is asked --------------------------------------------------------------------------- */

#ifndef GROBO_I_SOFT
#define GROBO_I_SOFT (SIZE_MAX <= UINT32_MAX)
#endif

/* True of 0, where what is done with it is emulated. */
static inline bool grobo_i_soft_zero(double value)
{
    return GROBO_I_SOFT && grobo_i_bits(value) << 1 == 0;
}

/*
 * inside:      True: min <= value <= max, and it is finite.
 * ddeg:        Rounds to 0.1 deg. False: it is something else, or a tie.
 * span_of:     A time at a part of the speed, as gets_there() has it.
 * gets_there:  True: the way takes no longer than that at this speed, by more than the rounding.
 */
#if GROBO_I_SOFT
typedef uint32_t grobo_i_span;
#define grobo_i_inside grobo_i_soft_inside
#define grobo_i_ddeg grobo_i_soft_ddeg
#define grobo_i_span_of grobo_i_soft_span
#define grobo_i_gets_there grobo_i_soft_gets_there
#else
typedef double grobo_i_span;
#define grobo_i_inside grobo_i_hard_inside
#define grobo_i_ddeg grobo_i_hard_ddeg
#define grobo_i_span_of grobo_i_hard_span
#define grobo_i_gets_there grobo_i_hard_gets_there
#endif

#endif
