/* SPDX-License-Identifier: MIT */
/* Lines of an IMU (grctl --imu): what is a reading, and what is none. */
#include <math.h>

#include "tests/support/test.h"
#include "tools/grctl/conn/imu.h"

#define DEG (3.14159265358979323846 / 180)

static bool near_deg(double rad, double deg)
{
    return fabs(rad - deg * DEG) < 1e-9;
}

TEST(five_numbers_are_a_reading)
{
    static const char *const lines[] = {"1.5 -20 3 -4.25 5e1", "1.5,-20,3,-4.25,50",
                                        "  1.5\t-20 , 3,-4.25 50", "1.5 -20 3 -4.25 50 21.5 more"};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        grobo_imu got = {0};
        assert_true(imu_parse(lines[i], &got));
        assert_true(near_deg(got.roll_rad, 1.5) && near_deg(got.pitch_rad, -20));
        assert_true(near_deg(got.rate_rad_s[0], 3) && near_deg(got.rate_rad_s[1], -4.25) &&
                    near_deg(got.rate_rad_s[2], 50));
    }
}

TEST(anything_else_is_none)
{
    static const char *const lines[] = {
        "",           " ",         "1 2 3 4",
        "1 2 3 4 ",   "1 2 3 4 x", "roll 1 2 3 4",
        "1 2 3 4 5,", "1;2;3;4;5", "1 2 3 4 0000000000000000000000000000000000000000000000005",
        "#1 2 3 4 5"};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        grobo_imu got = {9, 9, {9, 9, 9}};
        bool five = i == 6; /* what follows is not looked at */
        assert_true(imu_parse(lines[i], &got) == five);
        assert_true(five || got.roll_rad == 9);
    }
}
