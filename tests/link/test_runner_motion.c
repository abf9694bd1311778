/* SPDX-License-Identifier: MIT */
/*
 * A runner's target and motion over the simulator, from a thread that is not the loop's: once
 * while a runner's thread runs the loop, and once without, where the calls run it themselves.
 */
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/motion.h>
#include <grobo/core/robot.h>

#include "tests/support/runner_kit.h"
#include "tests/support/test.h"

/* ---- moves -------------------------------------------------------------------------------- */

TEST_WITH(with_and_without_thread, a_wait_is_for_the_last_move)
{
    grobo_posture sent;
    grobo_robot *robot = grobo_runner_robot(runner);

    runner_come_up();
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_true(runner_move_elbow(runner, 10, 0) > 0);
    assert_true(runner_moves(runner));
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_false(runner_moves(runner));
    runner_assert_elbow_at(10);
    assert_true(grobo_robot_target(robot, &sent) > 0);
    assert_true((sent.set & GROBO_JOINT_BIT(ELBOW)) != 0);
    assert_true(fabs(grobo_deg_from_rad(sent.angle_rad[ELBOW]) - 10) < 1e-9);

    assert_true(runner_go_to_zero(runner) > 0);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    runner_assert_elbow_at(0);
}

/* How it ended is known, also where nobody waits for its job. */
TEST_WITH(with_and_without_thread, a_wait_tells_that_a_move_was_stopped)
{
    runner_come_up();
    assert_true(runner_move_elbow(runner, 10, 20000000) > 0);
    assert_int_equal(grobo_runner_wait(runner, 100000), GROBO_ERR_PENDING);
    assert_int_equal(grobo_robot_stop(grobo_runner_robot(runner), false), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_ERR_CANCELED);
    assert_int_equal(grobo_robot_stop(grobo_runner_robot(runner), false), GROBO_ERR_STATE);
    assert_true(runner_move_elbow(runner, 1, 0) > 0);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
}

/* ---- the motion --------------------------------------------------------------------------- */

static grobo_posture nth(size_t n)
{
    grobo_motion *motion = runner_motion(runner);
    grobo_posture posture;

    assert_int_equal(grobo_motion_get(motion, n, &posture), GROBO_OK);
    grobo_motion_free(motion);
    return posture;
}

TEST_WITH(with_and_without_thread, the_motion_is_kept)
{
    assert_int_equal(runner_motion_size(runner), 0);
    runner_have_motion(3);
    grobo_motion *copy = runner_motion(runner);
    assert_int_equal(grobo_motion_size(copy), 3);
    for (size_t n = 0; n < 3; n++) {
        grobo_posture posture = nth(n);
        assert_true(posture.set == EVERY_JOINT);
        assert_int_equal(lround(grobo_deg_from_rad(posture.angle_rad[ELBOW])), 2 * (n + 1));
    }
    assert_int_equal(grobo_runner_set_motion(runner, copy), 3);
    assert_int_equal(grobo_motion_delete(copy, 0), 0); /* the runner's own stays whole */
    assert_int_equal(nth(2).time_us, 40000);
    assert_int_equal(grobo_motion_set_joints(copy, 21), 21);
    assert_int_equal(grobo_runner_set_motion(runner, copy), GROBO_ERR_ARG);
    grobo_motion_free(copy);
}

/* A motion of increments: the elbow by 3 degrees, and by 3 more, from where it is. */
static void have_increments(void)
{
    grobo_motion *steps = NULL;
    grobo_posture posture;

    assert_int_equal(grobo_motion_new(GROBO_MOTION_STEPS, 20, NULL, &steps), 0);
    (void)grobo_posture_init(&posture, 20);
    (void)grobo_posture_set_deg(&posture, ELBOW, 3);
    posture.time_us = 300000;
    assert_int_equal(grobo_motion_append(steps, &posture), 0);
    assert_int_equal(grobo_motion_append(steps, &posture), 0);
    assert_int_equal(grobo_runner_set_motion(runner, steps), 2);
    grobo_motion_free(steps);
}

/* Resolved where the robot is, so that each posture can be had and gone to. */
TEST_WITH(with_and_without_thread, increments_become_postures)
{
    grobo_posture posture;

    runner_come_up();
    assert_true(runner_move_elbow(runner, 10, 0) > 0);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_read_posture(runner, &posture, 0), 20);
    have_increments();
    assert_float_equal(grobo_deg_from_rad(nth(0).angle_rad[ELBOW]), 13, 0.11);
    assert_float_equal(grobo_deg_from_rad(nth(1).angle_rad[ELBOW]), 16, 0.11);
    assert_int_equal(nth(1).set, GROBO_JOINT_BIT(ELBOW));
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    runner_assert_elbow_at(16);
}

/* A motion that could not be loaded leaves an empty one of postures, whatever it was. */
TEST_WITH(with_and_without_thread, an_emptied_motion_takes_postures)
{
    runner_come_up();
    have_increments();
    assert_true(grobo_runner_load_motion(runner, "nowhere", NULL) < 0);
    grobo_motion *motion = runner_motion(runner);
    assert_int_equal(grobo_motion_size(motion), 0);
    assert_int_equal(grobo_motion_get_kind(motion), GROBO_MOTION_POSTURES);
    grobo_motion_free(motion);
}

static int total_ms(void *arg, grobo_runner *from)
{
    grobo_play_progress progress;

    (void)arg;
    grobo_robot_progress(grobo_session_robot(grobo_runner_session(from)), &progress);
    return (int)(progress.total_us / 1000);
}

/* Postures without a time take the default time, or that of the options. */
TEST_WITH(with_and_without_thread, the_default_time_is_what_is_played)
{
    grobo_posture posture;
    grobo_motion *motion = NULL;
    const grobo_play_options slower = {GROBO_PLAY_OPTIONS_INIT, .default_time_us = 150000};

    assert_int_equal(grobo_motion_new(GROBO_MOTION_POSTURES, 20, NULL, &motion), 0);
    (void)grobo_posture_init(&posture, 20);
    (void)grobo_posture_set_deg(&posture, ELBOW, 0);
    posture.time_us = 0;
    for (int i = 0; i < 3; i++) {
        assert_int_equal(grobo_motion_append(motion, &posture), 0);
    }
    assert_int_equal(grobo_runner_set_motion(runner, motion), 3);
    grobo_motion_free(motion);
    runner_come_up();
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    /* The way to the first is the approach. */
    assert_int_equal(grobo_runner_call(runner, total_ms, NULL), 2 * GROBO_POSTURE_TIME_US / 1000);
    assert_int_equal(grobo_runner_play_motion(runner, &slower), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_call(runner, total_ms, NULL), 2 * 150);
}

/* ---- playing ------------------------------------------------------------------------------ */

static int passes_of(void *arg, grobo_runner *from)
{
    grobo_play_progress progress;

    (void)arg;
    grobo_robot_progress(grobo_session_robot(grobo_runner_session(from)), &progress);
    return progress.passes;
}

static int play_state(void *arg, grobo_runner *from)
{
    (void)arg;
    return (int)grobo_robot_play_state(grobo_session_robot(grobo_runner_session(from)));
}

TEST_WITH(with_and_without_thread, the_motion_is_played)
{
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_ERR_CLOSED);
    runner_come_up();
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_ERR_EMPTY);
    runner_have_motion(4);
    assert_int_equal(grobo_runner_call(runner, play_state, NULL), GROBO_SEQUENCER_IDLE);
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_OK);
    assert_true(runner_plays(runner));
    assert_true(runner_moves(runner));
    assert_true(runner_plays(runner)); /* begun by now */
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_ERR_STATE);
    runner_have_motion(1); /* what is played is not touched */
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_false(runner_plays(runner));
    assert_int_equal(grobo_runner_call(runner, play_state, NULL), GROBO_SEQUENCER_FINISHED);
    runner_assert_elbow_at(8);
}

static const grobo_play_options *times(int32_t repeat)
{
    static grobo_play_options options;

    options = (grobo_play_options){GROBO_PLAY_OPTIONS_INIT, .repeat = repeat};
    return &options;
}

TEST_WITH(with_and_without_thread, a_negative_count_plays_in_reverse)
{
    const grobo_play_options at_a_rate = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE};
    const grobo_play_options too_fast = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                         .rate_hz = 1000};

    runner_come_up();
    runner_have_motion(4);
    assert_int_equal(grobo_runner_play_motion(runner, times(3)), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_call(runner, passes_of, NULL), 3);
    runner_assert_elbow_at(8);
    assert_int_equal(grobo_runner_play_motion(runner, times(-2)), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_call(runner, passes_of, NULL), 2);
    runner_assert_elbow_at(2);
    assert_int_equal(grobo_runner_play_motion(runner, &too_fast), GROBO_ERR_UNWATCHED);
    assert_false(runner_plays(runner));
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_ERR_UNWATCHED);
    runner_assert_elbow_at(2);
    assert_int_equal(grobo_runner_play_motion(runner, &at_a_rate), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    runner_assert_elbow_at(8);
    const grobo_play_options back = {GROBO_PLAY_OPTIONS_INIT, .reverse = true};
    assert_int_equal(grobo_runner_play_motion(runner, &back), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    runner_assert_elbow_at(2);
}

TEST_WITH(with_and_without_thread, playing_is_stopped)
{
    runner_come_up();
    runner_have_motion(4);
    for (int at_once = 0; at_once < 2; at_once++) {
        assert_int_equal(grobo_runner_play_motion(runner, times(10000)), GROBO_OK);
        assert_int_equal(grobo_runner_wait(runner, 400000), GROBO_ERR_PENDING);
        assert_int_equal(grobo_robot_stop(grobo_runner_robot(runner), at_once != 0), GROBO_OK);
        assert_int_equal(grobo_runner_wait(runner, 0), GROBO_ERR_CANCELED);
    }
    /* A motion that has not begun yet is forgotten. */
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_OK);
    assert_int_equal(grobo_runner_estop(runner), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_ERR_CANCELED);
    assert_false(runner_plays(runner));
}

/* What cannot be done now is refused now, and changes nothing. */
TEST_WITH(with_and_without_thread, what_the_engine_refuses_is_told_at_once)
{
    runner_come_up();
    runner_have_motion(4);
    assert_int_equal(grobo_runner_play_motion(runner, times(10000)), GROBO_OK);
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_ERR_STATE);
    const grobo_robot *robot = grobo_runner_robot(runner);
    for (int rounds = 0; grobo_robot_job(robot) != GROBO_JOB_NONE; rounds++) {
        assert_in_range(rounds, 0, 1000); /* 10 s of preparing */
        (void)grobo_runner_svc(runner);
    }
    assert_int_equal(runner_go_to_zero(runner), GROBO_ERR_STATE); /* it sets them all */
    assert_true(runner_plays(runner));
    assert_int_equal(grobo_robot_stop(grobo_runner_robot(runner), true), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_ERR_CANCELED);
    assert_true(runner_go_to_zero(runner) > 0);
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_ERR_STATE); /* it moves */
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_OK);
}
