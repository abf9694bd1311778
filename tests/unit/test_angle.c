/* SPDX-License-Identifier: MIT */
/* What is sure of angles: by the bits of doubles, as on processors without them, and by doubles. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "src/base/angle.h"
#include "tests/support/next_random.h"
#include "tests/support/test.h"

#define PI 3.14159265358979323846

enum { MANY = 400000 };

static double of_bits(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Of all sizes there are; infinities and NaN among them. */
static double any_double(uint32_t *seed)
{
    uint64_t bits =
        (uint64_t)next_random(seed) << 40 ^ (uint64_t)next_random(seed) << 20 ^ next_random(seed);
    return of_bits(next_random(seed) % 8 == 0 ? bits | UINT64_C(0x7FF) << 52 : bits);
}

/* As those of joints. */
static double any_angle(uint32_t *seed)
{
    double part = (double)next_random(seed) / 0xFFFFFF;
    return (2 * part - 1) * (next_random(seed) % 4 == 0 ? 40 : PI);
}

/* What doubles say: inside, or not. */
static bool is_inside(double min, double value, double max)
{
    return isfinite(value) && value >= min && value <= max;
}

TEST(inside_is_never_said_of_what_is_outside)
{
    static const double special[] = {0.0, -0.0, 5e-324, -5e-324, 1.0, -1.0, 1e308, -1e308};
    uint32_t seed = 1;
    for (int i = 0; i < MANY; i++) {
        double a = i % 2 == 0 ? any_double(&seed) : any_angle(&seed);
        double b = i % 2 == 0 ? any_double(&seed) : any_angle(&seed);
        double min = fmin(a, b), max = fmax(a, b);
        const double values[] = {min,
                                 max,
                                 nextafter(min, -INFINITY),
                                 nextafter(min, INFINITY),
                                 nextafter(max, INFINITY),
                                 (min + max) / 2,
                                 any_double(&seed),
                                 any_angle(&seed),
                                 special[i % 8],
                                 (double)NAN,
                                 -(double)NAN,
                                 (double)INFINITY,
                                 -(double)INFINITY};
        for (size_t k = 0; k < sizeof values / sizeof *values; k++) {
            bool is = is_inside(min, values[k], max);
            assert_int_equal(grobo_i_hard_inside(min, values[k], max), is);
            assert_true(is || !grobo_i_soft_inside(min, values[k], max));
        }
    }
    assert_true(grobo_i_soft_inside(-1, -0.99999, 1) && grobo_i_soft_inside(-1, 0.99999, 1));
    assert_true(grobo_i_soft_inside(-1, -0.0, 1) && grobo_i_soft_inside(1e-300, 1, INFINITY));
}

/* The unit of the wire that is nearest, where that is said. */
TEST(units_are_the_nearest_or_left_open)
{
    uint32_t seed = 2;
    int said = 0;
    for (int i = 0; i < MANY; i++) {
        double tie_rad = (i - MANY / 2) / 20.0 * PI / 1800;
        const double rads[] = {any_angle(&seed), tie_rad, tie_rad + 3e-8, tie_rad - 3e-8,
                               any_double(&seed)};
        for (size_t k = 0; k < sizeof rads / sizeof *rads; k++) {
            double units = round(rads[k] * 1800.0 / PI);
            int16_t soft, hard;
            bool soft_said = grobo_i_soft_ddeg(rads[k], &soft);
            assert_true(!soft_said || units == soft);
            assert_true(!grobo_i_hard_ddeg(rads[k], &hard) || units == hard);
            said += k == 0 && (soft_said || fabs(rads[k]) >= 32);
        }
    }
    assert_in_range(said, MANY / 1000 * 999, MANY);
}

/* A way takes its time; what is nearer than a millionth is left open. */
TEST(no_joint_gets_there_sooner_than_it_can)
{
    static const double parts[] = {0, 0.5, 0.99, 0.9999, 1, 1 + 1e-9, 1.00001, 1.5};
    uint32_t seed = 3;
    for (int i = 0; i < MANY; i++) {
        int64_t time_us = (int64_t)(next_random(&seed) % 1638) * 10000 + (i % 7 == 0);
        int pct = 1 + (int)(next_random(&seed) % 100);
        double speed_rad_s = i % 50 == 0 ? any_double(&seed) : fabs(any_angle(&seed));
        double from_rad = any_angle(&seed);
        double most_rad = (double)time_us * 1e-6 * speed_rad_s * pct / 100;
        uint32_t soft = grobo_i_soft_span(time_us, pct);
        double hard = grobo_i_hard_span(time_us, pct);
        for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
            double to_rad = from_rad + (i % 2 == 0 ? parts[k] : -parts[k]) * most_rad;
            bool can = fabs(to_rad - from_rad) <= most_rad * (1 - 0.5e-6);
            assert_true(can || !grobo_i_soft_gets_there(from_rad, to_rad, speed_rad_s, soft));
            assert_true(can || !grobo_i_hard_gets_there(from_rad, to_rad, speed_rad_s, hard));
        }
    }
    assert_false(grobo_i_soft_gets_there(0, 0, 6, grobo_i_soft_span(-5, 100)));
    assert_false(grobo_i_soft_gets_there((double)NAN, 0, 6, grobo_i_soft_span(5000000, 100)));
    assert_false(grobo_i_soft_gets_there(0, 0, (double)INFINITY, grobo_i_soft_span(1000000, 100)));
}

/* At the speed of a servo nearly all that can be is said to be. */
TEST(little_is_left_open)
{
    for (int64_t time_us = 20000; time_us <= 4000000; time_us += 20000) {
        for (int pct = 10; pct <= 100; pct += 10) {
            double most_rad = (double)time_us * 1e-6 * 6.5 * pct / 100;
            uint32_t span = grobo_i_soft_span(time_us, pct);
            assert_true(grobo_i_soft_gets_there(-1.5, -1.5 + most_rad * 0.99999, 6.5, span));
            assert_true(grobo_i_soft_gets_there(1.5, 1.5 - most_rad * 0.99999, 6.5, span));
        }
    }
}
