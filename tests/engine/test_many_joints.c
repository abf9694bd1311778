/* SPDX-License-Identifier: MIT */
/* A robot of as many joints as there may be: the last one is a joint like the others, and nothing
 * is looked for behind it. A checked build (make check-san) traps where something is. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/robot.h>

#include "tests/support/many_joints.h"
#include "tests/support/rig.h"
#include "tests/support/test.h"

enum { LAST = GROBO_JOINTS_MAX - 1 };

static grobo_test_rig rig;
static const grobo_robot_config reading = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 500000};

static void start(bool arm, const grobo_robot_config *config)
{
    grobo_driver *driver = many_joints(rig_wiring, GROBO_JOINTS_MAX);
    driver->arm = arm;
    rig_start_driver(&rig, driver, config, NULL);
    rig_power(&rig);
    rig_forget(&rig);
}

/* All joints by so much from where they stand at first. */
static grobo_posture all_at(double deg)
{
    grobo_posture target;
    grobo_posture_init_pose(&target, rig.driver->model);
    for (int j = 0; j <= LAST; j++) {
        target.angle_rad[j] += grobo_rad_from_deg(deg);
    }
    (void)grobo_posture_clamp(&target, rig.driver->model);
    target.time_us = 1000000;
    return target;
}

static double target_deg(const grobo_posture *target, int joint)
{
    return grobo_deg_from_rad(target->angle_rad[joint]);
}

static void expect_there(const grobo_posture *target)
{
    for (int j = 0; j <= LAST; j++) {
        assert_true(fabs(rig_angle_deg(&rig, j) - target_deg(target, j)) < 0.1);
    }
}

TEST_WITH(rig_wirings, all_move_and_stop)
{
    for (int arm = 0; arm < 2; arm++) {
        start(arm != 0, &quiet);
        grobo_posture target = all_at(5);
        rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
        expect_there(&target);
        target = all_at(-5);
        target.time_us = 3000000;
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 1000000);
        assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_OK);
        rig_run(&rig, 400000);
        double here_deg = rig_angle_deg(&rig, LAST);
        assert_true(fabs(here_deg - target_deg(&target, LAST)) > 3);
        rig_run(&rig, 3000000);
        assert_true(fabs(rig_angle_deg(&rig, LAST) - here_deg) < 0.01);
    }
}

static int sway_key(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    (void)ctx;
    *posture = all_at(i == 0 ? 5 : -5);
    *at_us = (int64_t)i * 2000000;
    return 0;
}

static int sway_sample(void *ctx, int64_t t_us, grobo_posture *posture)
{
    (void)ctx;
    *posture = all_at(5 - 5 * (double)t_us / 1e6);
    return 0;
}

TEST_WITH(rig_wirings, all_are_played_and_watched)
{
    const grobo_clip sway = {.key = sway_key,
                             .sample = sway_sample,
                             .n_joints = GROBO_JOINTS_MAX,
                             .n_keys = 2,
                             .length_us = 2000000};
    for (int i = 0; i < 2; i++) {
        const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT,
                                            .mode = i == 0 ? GROBO_PLAY_KEY : GROBO_PLAY_RATE,
                                            .rate_hz = 4, .unwatched = true};
        start(i == 0, &reading);
        rig_expect(&rig, grobo_robot_play(&rig.robot, &sway, &options), GROBO_OK);
        rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
        rig_run(&rig, 500000);
        assert_int_equal(grobo_robot_pause(&rig.robot), GROBO_OK);
        rig_run(&rig, 500000);
        assert_int_equal(grobo_robot_resume(&rig.robot), GROBO_OK);
        rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
        rig_run(&rig, 5000000);
        grobo_posture last = all_at(-5);
        expect_there(&last);
        assert_int_equal(grobo_sim_set_temperature(&rig.sim, LAST, 75), 0);
        rig_run(&rig, 2000000);
        assert_non_null(rig_last(&rig, GROBO_EVENT_TRIP));
        assert_int_equal(rig_last(&rig, GROBO_EVENT_TRIP)->u.trip.joint, LAST);
    }
}

static int raw_goal(double deg, uint16_t time_cs)
{
    uint8_t frame[GROBO_FRAME_MAX_BYTES];
    const grobo_rs30x_goal goal = {LAST + 1, (int16_t)lround(deg * 10), time_cs};
    int n = grobo_frame_goal(grobo_wiring_protocol(rig_wiring), &goal, frame, sizeof frame);
    return grobo_robot_raw(&rig.robot, frame, (size_t)n);
}

/* Raw frames, settings and free mode. */
TEST_WITH(rig_wirings, the_last_is_one_of_them)
{
    static const uint8_t limit[2] = {0x08, 0x07}; /* 180 degrees */
    const grobo_register_io io = {LAST + 1, GROBO_RS30X_CW_LIMIT, 2, limit};
    start(false, &reading);
    double here_deg = rig_angle_deg(&rig, LAST);
    rig_expect(&rig, raw_goal(here_deg + 5, 100), GROBO_OK);
    rig_run(&rig, 1200000);
    assert_true(fabs(rig_angle_deg(&rig, LAST) - here_deg - 5) < 0.1);
    assert_int_equal(raw_goal(here_deg - 90, 1), GROBO_ERR_SPEED);
    assert_int_equal(grobo_robot_registers(&rig.robot, &io), GROBO_ERR_STATE);
    assert_int_equal(grobo_robot_free(&rig.robot, GROBO_JOINT_BIT(LAST) | 1, true), GROBO_OK);
    assert_int_equal(grobo_sim_set_load(&rig.sim, LAST, 900), 0);
    rig_run(&rig, 500000);
    assert_int_equal(rig_torque(&rig, LAST), GROBO_TORQUE_BRAKE);
    assert_int_equal(grobo_sim_set_load(&rig.sim, LAST, 0), 0);
    rig_run(&rig, 1000000);
    assert_int_equal(rig_torque(&rig, LAST), GROBO_TORQUE_ON);
}

/* In a move all take the time of the slowest, the odd one as well. */
TEST_WITH(rig_wirings, an_odd_number_moves_together)
{
    rig_start_driver(&rig, many_joints(rig_wiring, 3), &quiet, NULL);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, 0, 10, 10);
    for (int j = 1; j < 3; j++) {
        assert_int_equal(grobo_posture_set_deg(&target, j, rig_angle_deg(&rig, j) + 1), 0);
    }
    rig_forget(&rig);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    const uint8_t *p = NULL;
    for (size_t i = 0; i < rig.n_sent; i++) {
        const uint8_t *at;
        if (rig_packet(&rig.sent[i], &at) > 8 && at[2] == 0 && at[4] == GROBO_RS30X_GOAL) {
            p = at;
        }
    }
    assert_non_null(p);
    assert_int_equal(p[6], 3);
    for (int k = 1; k < 3; k++) {
        assert_memory_equal(p + 7 + k * p[5] + 3, p + 7 + 3, 2);
    }
}

TEST_WITH(rig_wirings, all_are_left_well)
{
    static const grobo_exit_policy policies[] = {GROBO_EXIT_HOLD, GROBO_EXIT_OFF, GROBO_EXIT_SIT};
    for (int i = 0; i < 4; i++) {
        start(false, &quiet);
        grobo_posture target = all_at(5);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 300000);
        rig_expect(
            &rig, i < 3 ? grobo_robot_exit(&rig.robot, policies[i]) : grobo_robot_estop(&rig.robot),
            GROBO_OK);
        double here_deg = rig_angle_deg(&rig, LAST);
        assert_int_equal(rig_torque(&rig, LAST) == GROBO_TORQUE_ON, i == 0);
        rig_run(&rig, 2000000);
        assert_true(fabs(rig_angle_deg(&rig, LAST) - here_deg) < 0.01);
    }
}
