/* SPDX-License-Identifier: MIT */
/* Times and angles of targets on their way to the wire: rounded, clamped and counted. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/rig.h"
#include "tests/support/test.h"

static grobo_test_rig rig;

TEST(times_are_rounded_to_the_unit)
{
    static const struct {
        int64_t asked_us;
        int sent_ms;
    } rows[] = {{1, 10},
                {4999, 10},
                {5000, 10},
                {14999, 10},
                {15000, 20},
                {24999, 20},
                {25000, 30},
                {500000, 500},
                {0, 250},
                {-7, 250},
                {163829999, 163830},
                {163830000, 163830},
                {163840000, 163830}};
    grobo_robot_config config = quiet;
    config.default_time_us = 250000;
    rig_start_at(&rig, 0, &config);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        grobo_posture target = rig_posture(&rig, NECK, 0, 0);
        target.time_us = rows[i].asked_us;
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 30000);
        assert_int_equal(rig_sent_ms(&rig, NECK_ID), rows[i].sent_ms);
    }
}

/* What was given is what the wire can say, and the robot stands when it is over. */
TEST(a_time_beyond_the_wire_ends_with_the_longest)
{
    rig_start_at(&rig, 0, &quiet);
    grobo_posture target = rig_posture(&rig, NECK, 5, 0);
    target.time_us = INT64_C(1000000000000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 163000000);
    assert_true(grobo_robot_moving(&rig.robot));
    rig_run(&rig, 1000000);
    assert_false(grobo_robot_moving(&rig.robot));
}

/* One joint is clamped; another that has no number at all ends it. */
TEST(clamping_counts_joints_and_takes_no_others)
{
    grobo_robot_config config = quiet;
    config.limit_policy = GROBO_LIMIT_CLAMP;
    rig_start_at(&rig, 0, &config);
    double value;
    grobo_posture target = rig_posture(&rig, NECK, 60, 3000);
    assert_int_equal(grobo_posture_set_deg(&target, CHEST, 170), 0);
    assert_int_equal(grobo_posture_set_deg(&target, R_KNEE, -20), 0);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    assert_int_equal(grobo_robot_get_counters(&rig.robot)->clamped, 2);
    target.angle_rad[R_ELBOW] = NAN;
    target.set |= GROBO_JOINT_BIT(R_ELBOW);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_NAN);
    assert_int_equal(grobo_robot_fault(&rig.robot, &value), -1);
    assert_int_equal(grobo_robot_get_counters(&rig.robot)->clamped, 2);
}

/* A frame counts when it left, whatever became of those that were replaced. */
TEST(motion_frames_are_those_that_left)
{
    rig_start_at(&rig, 0, &quiet);
    uint64_t before = grobo_robot_get_counters(&rig.robot)->motion_frames;
    for (int i = 0; i < 4; i++) { /* the first leaves, the last takes the place of the others */
        grobo_posture target = rig_posture(&rig, NECK, i + 1, 500);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        if (i == 0) {
            rig_run(&rig, 100);
        }
    }
    rig_run(&rig, 1000000);
    assert_int_equal(rig.n_sent, 2);
    assert_int_equal(grobo_robot_get_counters(&rig.robot)->motion_frames - before, 2);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 4) < 0.06);
    assert_int_equal(grobo_robot_get_counters(&rig.robot)->late_frames, 0);
}
