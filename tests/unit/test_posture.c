/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/posture.h>

#include "tests/support/tables.h"
#include "tests/support/test.h"

#define PI 3.14159265358979323846

/* cmocka 1.1 compares in float only. */
#define assert_near(a, b, delta) assert_true(fabs((a) - (b)) <= (delta))

static grobo_posture make(int n_joints)
{
    grobo_posture p;
    assert_int_equal(grobo_posture_init(&p, n_joints), 0);
    return p;
}

TEST(angles_round_to_the_nearest_unit_of_the_wire)
{
    static const struct {
        double rad;
        int ddeg;
    } rows[] = {
        {0.34906585, 200}, /* truncation would give 199 */
        {-0.34906585, -200},
        {0.0, 0},
        {PI / 2, 900},
        {-PI / 2, -900},
        {0.04 * PI / 180, 0},
        {0.06 * PI / 180, 1},
        {-0.06 * PI / 180, -1},
        {1e9, INT16_MAX},
        {-1e9, INT16_MIN},
        {(double)INFINITY, INT16_MAX},
        {-(double)INFINITY, INT16_MIN},
        {(double)NAN, 0},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        assert_int_equal(grobo_ddeg_from_rad(rows[i].rad), rows[i].ddeg);
    }
    for (int ddeg = -1800; ddeg <= 1800; ddeg++) {
        assert_int_equal(grobo_ddeg_from_rad(grobo_rad_from_ddeg(ddeg)), ddeg);
        assert_int_equal(grobo_ddeg_from_rad(grobo_rad_from_deg(ddeg / 10.0)), ddeg);
    }
    assert_near(grobo_rad_from_deg(180.0), PI, 1e-15);
    assert_near(grobo_deg_from_rad(PI / 6), 30.0, 1e-13);
    assert_near(grobo_rad_from_ddeg(-300), -PI / 6, 1e-15);
}

/* To the bit what one division and round() give, around each tie and far beyond the wire. */
TEST(however_an_angle_is_rounded_it_is_the_same)
{
    for (int k = -70000; k <= 70000; k++) {
        const double tie_rad = k * 0.5 * PI / 1800.0;
        const double near_rad[] = {
            tie_rad,        nextafter(tie_rad, 100), nextafter(tie_rad, -100),
            tie_rad + 2e-8, tie_rad - 2e-8,          k * 0.05 / 180.0 * PI};
        for (size_t i = 0; i < sizeof near_rad / sizeof *near_rad; i++) {
            double ddeg = fmax(fmin(round(near_rad[i] * 1800.0 / PI), INT16_MAX), INT16_MIN);
            if (grobo_ddeg_from_rad(near_rad[i]) != (int16_t)ddeg) {
                fail_msg("%.17g rad: %d", near_rad[i], grobo_ddeg_from_rad(near_rad[i]));
            }
        }
    }
}

TEST(a_fresh_posture_sets_nothing)
{
    grobo_posture p = make(20);
    double value = 7.0;
    assert_int_equal(p.n_joints, 20);
    assert_true(p.set == 0);
    assert_int_equal(p.time_us, 100000);
    assert_int_equal(grobo_posture_get_rad(&p, 0, &value), GROBO_ERR_EMPTY);
    assert_int_equal(grobo_posture_get_deg(&p, 19, &value), GROBO_ERR_EMPTY);
    assert_near(value, 7.0, 0.0);
    assert_int_equal(grobo_posture_init(&p, 0), 0);
    for (int n = 0; n <= GROBO_JOINTS_MAX; n++) {
        assert_int_equal(grobo_posture_init(&p, n), 0);
        assert_int_equal(p.n_joints, n);
    }
    assert_int_equal(grobo_posture_init(&p, GROBO_JOINTS_MAX + 1), GROBO_ERR_CAP);
    assert_int_equal(grobo_posture_init(&p, -1), GROBO_ERR_CAP);
}

TEST(degrees_and_radians_are_one_truth)
{
    grobo_posture p = make(20);
    double rad, deg;
    assert_int_equal(grobo_posture_set_deg(&p, 3, -40.0), 0);
    assert_int_equal(grobo_posture_get_rad(&p, 3, &rad), 0);
    assert_near(rad, -40.0 * PI / 180.0, 1e-15);
    assert_int_equal(grobo_posture_set_rad(&p, 3, 0.5), 0);
    assert_int_equal(grobo_posture_get_deg(&p, 3, &deg), 0);
    assert_near(deg, 28.64788975654116, 1e-12);
    assert_true(p.set == GROBO_JOINT_BIT(3));
    assert_int_equal(grobo_posture_set_rad(&p, 20, 0.0), GROBO_ERR_ARG);
    assert_int_equal(grobo_posture_set_rad(&p, -1, 0.0), GROBO_ERR_ARG);
    assert_int_equal(grobo_posture_get_rad(&p, 20, &rad), GROBO_ERR_ARG);
    assert_int_equal(grobo_posture_set_rad(&p, 3, (double)NAN), GROBO_ERR_NAN);
    assert_int_equal(grobo_posture_set_deg(&p, 3, (double)INFINITY), GROBO_ERR_NAN);
    assert_int_equal(grobo_posture_get_rad(&p, 3, &rad), 0);
    assert_near(rad, 0.5, 0.0);
}

TEST(all_angles_come_with_nan_for_those_not_set)
{
    grobo_posture p = make(3);
    double rad[3], deg[3];
    grobo_posture_set_deg(&p, 0, 90.0);
    grobo_posture_set_deg(&p, 2, -45.0);
    assert_int_equal(grobo_posture_all_rad(&p, rad, 3), 3);
    assert_int_equal(grobo_posture_all_deg(&p, deg, 3), 3);
    assert_near(rad[0], PI / 2, 1e-15);
    assert_near(deg[2], -45.0, 1e-13);
    assert_true(isnan(rad[1]) && isnan(deg[1]));
    assert_int_equal(grobo_posture_all_rad(&p, rad, 2), GROBO_ERR_SPACE);
    assert_int_equal(grobo_posture_all_deg(&p, deg, 0), GROBO_ERR_SPACE);
}

TEST(times_are_what_a_register_can_hold)
{
    grobo_posture p = make(1);
    assert_int_equal(grobo_posture_set_time_ms(&p, 250.0), 0);
    assert_int_equal(p.time_us, 250000);
    assert_int_equal(grobo_posture_set_time_ms(&p, 0.0), 0);
    assert_int_equal(p.time_us, 0);
    assert_int_equal(grobo_posture_set_time_ms(&p, 163830.0), 0);
    assert_int_equal(p.time_us, 163830000);
    static const double bad[] = {-0.001, 163830.1, (double)NAN, (double)INFINITY};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(grobo_posture_set_time_ms(&p, bad[i]), GROBO_ERR_ARG);
    }
    assert_int_equal(p.time_us, 163830000);
}

TEST(a_copy_stands_alone)
{
    grobo_posture copy;
    {
        grobo_posture posture = make(4);
        assert_int_equal(grobo_posture_set_deg(&posture, 2, 30), 0);
        posture.time_us = 5000;
        copy = posture;
        assert_int_equal(grobo_posture_set_deg(&posture, 2, 50), 0);
        assert_int_equal(grobo_posture_set_deg(&posture, 3, 50), 0);
        posture.time_us = 0;
    } /* nothing to free, and the copy outlives it */
    double value_deg = 0;
    assert_int_equal(copy.n_joints, 4);
    assert_int_equal(copy.time_us, 5000);
    assert_true(copy.set == GROBO_JOINT_BIT(2));
    assert_int_equal(grobo_posture_get_deg(&copy, 2, &value_deg), 0);
    assert_near(value_deg, 30, 1e-12);
}

TEST(copying_keeps_the_copys_own_number_of_joints)
{
    grobo_posture src = make(4);
    grobo_posture dst = make(6);
    double value;
    src.time_us = 5000;
    grobo_posture_set_rad(&src, 0, 0.1);
    grobo_posture_set_rad(&src, 3, 0.4);
    grobo_posture_set_rad(&dst, 1, 9.0);
    grobo_posture_set_rad(&dst, 5, 5.0);

    assert_int_equal(grobo_posture_copy(&dst, &src, 0), 4);
    assert_int_equal(dst.n_joints, 6);
    assert_int_equal(dst.time_us, 5000);
    assert_true(dst.set == (GROBO_JOINT_BIT(0) | GROBO_JOINT_BIT(3) | GROBO_JOINT_BIT(5)));
    assert_int_equal(grobo_posture_get_rad(&dst, 5, &value), 0);
    assert_near(value, 5.0, 0.0);

    grobo_posture two = make(2);
    assert_int_equal(grobo_posture_copy(&two, &src, 2), 2);
    assert_true(two.set == GROBO_JOINT_BIT(1));
    assert_near(two.angle_rad[1], 0.4, 0.0);
    assert_int_equal(grobo_posture_copy(&two, &src, 0), 2); /* no more than it has */
    assert_true(two.set == GROBO_JOINT_BIT(0));
    assert_int_equal(two.n_joints, 2);
    assert_int_equal(grobo_posture_copy(&two, &src, 4), 0);
    assert_int_equal(grobo_posture_copy(&two, &src, 5), GROBO_ERR_ARG);
    assert_int_equal(grobo_posture_copy(&two, &src, -1), GROBO_ERR_ARG);
}

TEST(copying_reaches_the_last_joint_there_can_be)
{
    grobo_posture src = make(GROBO_JOINTS_MAX);
    grobo_posture dst = make(GROBO_JOINTS_MAX);
    grobo_posture_set_rad(&src, GROBO_JOINTS_MAX - 1, 1.5);
    assert_int_equal(grobo_posture_copy(&dst, &src, 0), GROBO_JOINTS_MAX);
    assert_true(grobo_posture_equal(&dst, &src));
    assert_int_equal(grobo_posture_copy(&dst, &src, GROBO_JOINTS_MAX - 1), 1);
    assert_near(dst.angle_rad[0], 1.5, 0.0);
    assert_int_equal(grobo_posture_copy(&dst, &src, GROBO_JOINTS_MAX), 0);
}

TEST(merging_takes_over_what_is_set)
{
    grobo_posture p = make(3);
    grobo_posture over = make(3);
    grobo_posture_set_rad(&p, 0, 0.1);
    grobo_posture_set_rad(&p, 1, 0.2);
    grobo_posture_set_rad(&over, 1, 1.2);
    grobo_posture_set_rad(&over, 2, 1.3);
    over.time_us = 1;
    grobo_posture_merge(&p, &over);
    assert_near(p.angle_rad[0], 0.1, 0.0);
    assert_near(p.angle_rad[1], 1.2, 0.0);
    assert_near(p.angle_rad[2], 1.3, 0.0);
    assert_true(p.set == 7);
    assert_int_equal(p.time_us, 100000);
    grobo_posture wide = make(5);
    grobo_posture_set_rad(&wide, 4, 4.0);
    grobo_posture_merge(&p, &wide);
    assert_true(p.set == 7);
}

TEST(comparing_looks_at_what_is_set_only)
{
    grobo_posture a = make(3);
    grobo_posture b = make(3);
    assert_true(grobo_posture_equal(&a, &b));
    grobo_posture_set_rad(&a, 1, 0.5);
    assert_false(grobo_posture_equal(&a, &b));
    assert_false(grobo_posture_near(&a, &b, 10.0));
    grobo_posture_set_rad(&b, 1, 0.5);
    b.angle_rad[0] = 99.0;
    b.time_us = 3;
    assert_true(grobo_posture_equal(&a, &b));
    grobo_posture_set_rad(&b, 1, 0.5 + 1e-12);
    assert_false(grobo_posture_equal(&a, &b));
    assert_true(grobo_posture_near(&a, &b, 1e-9));
    grobo_posture_set_rad(&b, 1, 0.75);
    assert_false(grobo_posture_near(&a, &b, 0.25)); /* less than, not up to */
    assert_true(grobo_posture_near(&a, &b, 0.26));
    b = make(4);
    grobo_posture_set_rad(&b, 1, 0.5);
    assert_false(grobo_posture_equal(&a, &b));
}

TEST(the_mirror_swaps_sides_and_comes_back)
{
    grobo_posture p = make(20);
    grobo_posture_set_deg(&p, 14, 30.0);  /* R_SHOULDER_P */
    grobo_posture_set_deg(&p, 3, -70.0);  /* R_KNEE_P */
    grobo_posture_set_deg(&p, 12, -10.0); /* CHEST_P */
    grobo_posture_set_deg(&p, 13, 25.0);  /* NECK_Y */
    grobo_posture before = p;
    assert_int_equal(grobo_posture_mirror(&p, &grobo_i_gr001_model), 0);
    assert_true(p.set == (GROBO_JOINT_BIT(17) | GROBO_JOINT_BIT(9) | GROBO_JOINT_BIT(12) |
                          GROBO_JOINT_BIT(13)));
    assert_near(p.angle_rad[17], -30.0 * PI / 180, 1e-15);
    assert_near(p.angle_rad[9], 70.0 * PI / 180, 1e-15);
    assert_near(p.angle_rad[12], -10.0 * PI / 180, 1e-15);
    assert_near(p.angle_rad[13], -25.0 * PI / 180, 1e-15);
    assert_int_equal(grobo_posture_mirror(&p, &grobo_i_gr001_model), 0);
    assert_true(grobo_posture_equal(&p, &before));
    p = make(19);
    assert_int_equal(grobo_posture_mirror(&p, &grobo_i_gr001_model), GROBO_ERR_ARG);
}

TEST(limits_are_kept_on_the_grid_of_the_wire)
{
    static const struct {
        double deg;
        int result;
        double clamped_deg;
    } rows[] = {
        /* R_KNEE_P: -130..0 */
        {0.0, 0, 0.0},
        {0.049, 0, 0.049},
        {0.051, GROBO_ERR_LIMIT, 0.0},
        {-130.0, 0, -130.0},
        {-130.049, 0, -130.049},
        {-130.051, GROBO_ERR_LIMIT, -130.0},
        {5000.0, GROBO_ERR_LIMIT, 0.0},
        {-5000.0, GROBO_ERR_LIMIT, -130.0},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        grobo_posture p = make(20);
        int joint = -5;
        grobo_posture_set_deg(&p, 3, rows[i].deg);
        assert_int_equal(grobo_posture_check(&p, &grobo_i_gr001_model, &joint), rows[i].result);
        assert_int_equal(joint, rows[i].result == 0 ? -5 : 3);
        assert_int_equal(grobo_posture_check(&p, &grobo_i_gr001_model, NULL), rows[i].result);
        assert_int_equal(grobo_posture_clamp(&p, &grobo_i_gr001_model), rows[i].result != 0);
        assert_near(grobo_deg_from_rad(p.angle_rad[3]), rows[i].clamped_deg, 1e-12);
    }
}

TEST(what_is_no_number_is_found_and_never_clamped)
{
    grobo_posture p = make(20);
    int joint = -5;
    p.angle_rad[2] = (double)NAN; /* not set: means nothing */
    grobo_posture_set_deg(&p, 3, 50.0);
    assert_int_equal(grobo_posture_check(&p, &grobo_i_gr001_model, &joint), GROBO_ERR_LIMIT);
    p.angle_rad[7] = (double)INFINITY;
    p.set |= GROBO_JOINT_BIT(7);
    assert_int_equal(grobo_posture_clamp(&p, &grobo_i_gr001_model), GROBO_ERR_NAN);
    assert_near(grobo_deg_from_rad(p.angle_rad[3]), 50.0, 1e-12);
    grobo_posture_set_deg(&p, 3, -50.0);
    assert_int_equal(grobo_posture_check(&p, &grobo_i_gr001_model, &joint), GROBO_ERR_NAN);
    assert_int_equal(joint, 7);
    p.n_joints = 5;
    assert_int_equal(grobo_posture_check(&p, &grobo_i_gr001_model, &joint), GROBO_ERR_ARG);
    assert_int_equal(grobo_posture_clamp(&p, &grobo_i_gr001_model), GROBO_ERR_ARG);
}

static int parse(grobo_posture *p, const char *text)
{
    return grobo_posture_parse(p, &grobo_i_gr001_model, text, strlen(text));
}

TEST(a_line_is_a_time_and_angles_in_motor_order)
{
    grobo_posture p;
    grobo_posture pose;
    assert_int_equal(parse(&p, "250  0 0 200 0 -200 -200 0 200 0 200 0 -400 -200 0 0 -200 0 400 "
                               "200 0\r\n"),
                     20);
    assert_int_equal(p.time_us, 250000);
    grobo_posture_init_pose(&pose, &grobo_i_gr001_model);
    assert_true(grobo_posture_near(&p, &pose, 1e-12));

    assert_int_equal(parse(&p, "\t0 -100 +5"), 2);
    assert_int_equal(p.time_us, 0);
    assert_true(p.set == (GROBO_JOINT_BIT(12) | GROBO_JOINT_BIT(13)));
    assert_near(p.angle_rad[12], -10.0 * PI / 180, 1e-15);
    assert_near(p.angle_rad[13], 0.5 * PI / 180, 1e-15);
    assert_int_equal(parse(&p, "163830"), 0);
    assert_int_equal(p.time_us, 163830000);
}

/* A servo may have id 0, and one of another line the id of one of this. */
TEST(motor_order_goes_line_by_line_and_from_id_0)
{
    static const grobo_joint joints[] = {
        {.name = "b", .motor = 2, .line = 1, .mirror = 0, .gear = 1},
        {.name = "c", .motor = 0, .line = 1, .mirror = 1, .gear = 1},
        {.name = "d", .motor = 2, .line = 0, .mirror = 2, .gear = 1},
        {.name = "e", .motor = 0, .line = 0, .mirror = 3, .gear = 1},
        {.name = "f", .motor = 1, .line = 0, .mirror = 4, .gear = 1},
    };
    static const uint8_t order[] = {3, 4, 2, 1, 0};
    const grobo_model model = {
        .joint_size = sizeof joints[0], .name = "both", .joints = joints, .n_joints = 5};
    uint8_t found[GROBO_JOINTS_MAX];
    grobo_posture p;

    assert_int_equal(grobo_model_motor_order(&model, found), 5);
    assert_memory_equal(found, order, sizeof order);
    assert_int_equal(grobo_model_motor_order(NULL, found), GROBO_ERR_ARG);
    assert_int_equal(grobo_model_motor_order(&model, NULL), GROBO_ERR_ARG);
    assert_int_equal(grobo_posture_parse(&p, &model, "100 10 20 30 40 50", 18), 5);
    for (int i = 0; i < 5; i++) {
        assert_near(p.angle_rad[order[i]], (i + 1) * PI / 180, 1e-12);
    }
    assert_int_equal(grobo_posture_parse(&p, &model, "100 1 2 3 4 5 6", 15), GROBO_ERR_CAP);
}

TEST(a_bad_line_leaves_the_posture_alone)
{
    static const struct {
        const char *text;
        int result;
    } rows[] = {
        {"", GROBO_ERR_SYNTAX},
        {"  \r\n", GROBO_ERR_SYNTAX},
        {"x 1", GROBO_ERR_SYNTAX},
        {"-1 0", GROBO_ERR_SYNTAX},
        {"163831 0", GROBO_ERR_SYNTAX},
        {"100 1.5", GROBO_ERR_SYNTAX},
        {"100 1e2", GROBO_ERR_SYNTAX},
        {"100 -", GROBO_ERR_SYNTAX},
        {"100 --1", GROBO_ERR_SYNTAX},
        {"100 32768", GROBO_ERR_SYNTAX},
        {"100 99999999999999999999", GROBO_ERR_SYNTAX},
        {"99999999999999999999", GROBO_ERR_SYNTAX},
        {"100 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0", GROBO_ERR_CAP},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        grobo_posture p = make(7);
        grobo_posture before = p;
        assert_int_equal(parse(&p, rows[i].text), rows[i].result);
        assert_memory_equal(&p, &before, sizeof p);
    }
    /* The length rules, not a NUL. */
    grobo_posture p;
    assert_int_equal(grobo_posture_parse(&p, &grobo_i_gr001_model, "100 12xyz", 6), 1);
}
