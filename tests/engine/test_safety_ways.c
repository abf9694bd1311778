/* SPDX-License-Identifier: MIT */
/* Limits by every way in, speed under every control, times out of the ordinary. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/rig.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

static grobo_test_rig rig;
static rig_clip clip, other;

/* ---- limits ---------------------------------------------------------------------------------- */

/* The neck may turn to 50 degrees; this is beyond it. Negative where a mirror makes it so. */
#define TOO_FAR_DEG 50.2

static const rig_key beyond[] = {{0, {{NECK, 0}}}, {1000, {{NECK, TOO_FAR_DEG}}}};
static const rig_key below[] = {{0, {{NECK, 0}}}, {1000, {{NECK, -TOO_FAR_DEG}}}};
static const rig_key within[] = {{0, {{NECK, 0}}}, {300, {{NECK, 10}}}};

static int by_move(void)
{
    grobo_posture target = rig_posture(&rig, NECK, TOO_FAR_DEG, 3000);
    return grobo_robot_move(&rig.robot, &target);
}

static int by_send(void)
{
    grobo_posture target = rig_posture(&rig, NECK, TOO_FAR_DEG, 3000);
    return grobo_robot_send(&rig.robot, &target);
}

static int play(const rig_key *keys, const grobo_play_options *options)
{
    rig_clip_init(&clip, keys, 2);
    return grobo_robot_play(&rig.robot, &clip.clip, options);
}

static int by_keys(void)
{
    return play(beyond, NULL);
}

static int at_a_rate(void)
{
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE, .rate_hz = 30};
    return play(beyond, &options);
}

static int backwards(void)
{
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .reverse = true};
    return play(beyond, &options);
}

static int mirrored(void)
{
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mirror = true};
    return play(below, &options);
}

static int as_the_second(void)
{
    int number = play(within, NULL);
    rig_expect(&rig, number, GROBO_OK);
    rig_clip_init(&other, beyond, 2);
    assert_int_equal(grobo_robot_enqueue(&rig.robot, &other.clip, NULL), 1);
    return number;
}

static int turn_neck(const grobo_driver *self, void *ctx, const grobo_posture *sensed,
                     grobo_posture *target)
{
    (void)self;
    (void)ctx;
    (void)sensed;
    if ((target->set & GROBO_JOINT_BIT(NECK)) != 0) {
        target->angle_rad[NECK] += grobo_rad_from_deg(40.2);
    }
    return 0;
}

static int by_the_stabilizer(void)
{
    return play(within, NULL);
}

/* All but the raw frame, which is as it is: refused or clamped as configured, and counted. */
TEST_WITH(rig_wirings, every_way_in_is_held_to_the_limits)
{
    static int (*const ways[])(void) = {by_move,   by_send,  by_keys,       at_a_rate,
                                        backwards, mirrored, as_the_second, by_the_stabilizer};
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        for (int clamps = 0; clamps < 2; clamps++) {
            grobo_robot_config config = quiet;
            grobo_driver driver = *grobo_gr001_driver(GROBO_WIRING_BOARD);
            config.limit_policy = clamps ? GROBO_LIMIT_CLAMP : GROBO_LIMIT_REFUSE;
            driver.stabilize = ways[i] == by_the_stabilizer ? turn_neck : NULL;
            rig_start_driver(&rig, &driver, &config, NULL);
            rig_power(&rig);
            int result = ways[i]();
            double most_deg = rig_angle_deg(&rig, NECK);
            for (int t = 0; t < 80; t++) { /* the rig looks at each frame on its way */
                rig_run(&rig, 100000);
                most_deg = fmax(most_deg, rig_angle_deg(&rig, NECK));
            }
            const grobo_event *trip = rig_last(&rig, GROBO_EVENT_TRIP);
            if (clamps) {
                assert_true(result >= 0 && most_deg > 49 && most_deg < 50.1);
                assert_true(grobo_robot_get_counters(&rig.robot)->clamped > 0);
                assert_null(trip);
            } else if (result < 0) {
                assert_int_equal(result, GROBO_ERR_LIMIT);
                assert_true(fabs(most_deg) < 0.1);
            } else {
                assert_non_null(trip);
                assert_int_equal(trip->u.trip.trip, GROBO_TRIP_LIMIT);
                assert_int_equal(trip->u.trip.joint, NECK);
                assert_true(fabs(trip->u.trip.value - TOO_FAR_DEG) < 1e-9);
            }
        }
    }
}

/* ---- speed ----------------------------------------------------------------------------------- */

/* Keys that ask for more than servos can do, and all that may be done to a motion meanwhile: the
 * rig holds every frame against each joint's speed. */
static void control(int which)
{
    switch (which) {
    case 0:
        (void)grobo_robot_pause(&rig.robot);
        rig_run(&rig, 700000);
        (void)grobo_robot_resume(&rig.robot);
        break;
    case 1:
        (void)grobo_robot_speed(&rig.robot, 1000);
        break;
    case 2:
        (void)grobo_robot_seek(&rig.robot, 900000);
        break;
    case 3:
        (void)grobo_robot_enqueue(&rig.robot, &other.clip, NULL);
        break;
    case 4:
        (void)grobo_robot_pause(&rig.robot);
        (void)grobo_robot_seek(&rig.robot, 100000);
        (void)grobo_robot_resume(&rig.robot);
        break;
    case 5:
        (void)grobo_robot_stop(&rig.robot, true);
        (void)grobo_robot_play(&rig.robot, &other.clip, NULL);
        break;
    case 6:
        (void)grobo_robot_stop(&rig.robot, false);
        rig_run(&rig, 400000);
        (void)grobo_robot_play(&rig.robot, &other.clip, NULL);
        break;
    default:
        rig_stall(&rig, 200000);
        break;
    }
}

TEST_WITH(rig_wirings, no_control_of_a_motion_makes_it_too_fast)
{
    static const rig_key wild[] = {{0, {{NECK, -50}}},
                                   {200, {{NECK, 50}, {R_KNEE, -120}}},
                                   {400, {{NECK, -50}}},
                                   {1000, {{R_KNEE, -10}}}};
    static const rig_key back[] = {{0, {{NECK, 50}, {R_KNEE, -100}}}, {100, {{NECK, -50}}}};
    uint64_t stretched = 0;
    for (int i = 0; i < 2 * 8 * 8; i++) {
        grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT,
                                      .mode = i % 2 ? GROBO_PLAY_RATE : GROBO_PLAY_KEY,
                                      .rate_hz = 30, .repeat = 20, .reverse = i % 5 == 0};
        rig_start(&rig, &quiet, NULL);
        rig_clip_init(&clip, wild, 4);
        rig_clip_init(&other, back, 2);
        rig_power(&rig);
        rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &options), GROBO_OK);
        rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
        rig_run(&rig, 37000 * (1 + i % 7));
        control(i / 2 % 8);
        rig_run(&rig, 53000 * (1 + i % 11));
        control(i / 16);
        rig_run(&rig, 3000000);
        stretched += grobo_robot_get_counters(&rig.robot)->stretched;
    }
    assert_true(stretched > 128); /* it was asked for */
}

/* The wire has no time that long: what would be sent instead is faster than allowed. */
TEST_WITH(rig_wirings, a_move_that_cannot_be_slow_enough_is_refused)
{
    grobo_robot_config config = quiet;
    config.approach_dps = 0.1;
    rig_start(&rig, &config, NULL);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, NECK, 40, 100);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_ERR_SPEED);
    assert_true(fabs(rig_angle_deg(&rig, NECK)) < 0.1);
}

TEST_WITH(rig_wirings, a_time_out_of_all_reason_is_the_longest_there_is)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, NECK, 40, 0);
    target.time_us = INT64_MAX;
    rig_forget(&rig);
    int number = grobo_robot_move(&rig.robot, &target);
    rig_run(&rig, 1000000);
    assert_int_equal(rig_sent_ms(&rig, NECK_ID), 163830);
    assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_OK);
    rig_expect(&rig, number, GROBO_ERR_CANCELED);
}

/* ---- frames that are lost -------------------------------------------------------------------- */

/* Where the servo has said that its goal is another one, the joint is not on the way, however near
 * to it it was read then. */
TEST_WITH(rig_wirings, a_goal_that_was_not_taken_is_no_way)
{
    static const grobo_sense_kind kinds[] = {GROBO_SENSE_GOAL, GROBO_SENSE_FULL};
    rig_start_at(&rig, -45, &quiet);
    grobo_posture target = rig_posture(&rig, NECK, 45, 3000);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 50000);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_IN), 0);
    for (int i = 0; i < 2; i++) { /* the second tells nothing of the goal */
        int number = grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(NECK), kinds[i]);
        rig_expect(&rig, number, GROBO_OK);
    }
    rig_run(&rig, 1000000);
    target = rig_posture(&rig, NECK, 0, 20);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 20000);
    assert_true(rig_sent_ms(&rig, NECK_ID) >= 45 * 1000 / 375);
}
