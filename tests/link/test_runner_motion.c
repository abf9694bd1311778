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

/* ---- the target --------------------------------------------------------------------------- */

static int engine_target(void *arg, grobo_runner *from)
{
    return grobo_robot_target(grobo_session_robot(grobo_runner_session(from)), arg);
}

TEST_WITH(with_and_without_thread, a_target_is_sent_once)
{
    grobo_posture sent;

    runner_come_up();
    assert_int_equal(grobo_runner_start_motion(runner), GROBO_ERR_EMPTY);
    assert_int_equal(grobo_runner_set_joint(runner, ELBOW, grobo_rad_from_deg(10)), GROBO_OK);
    assert_int_equal(grobo_runner_start_motion(runner), GROBO_OK);
    assert_int_equal(grobo_runner_is_moving(runner), 1);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_is_moving(runner), 0);
    assert_int_equal(grobo_runner_command_count(runner), 0);
    runner_assert_elbow_at(10);
    assert_true(grobo_runner_call(runner, engine_target, &sent) > 0);
    assert_int_equal(sent.n_joints, 20);
    assert_true((sent.set & GROBO_JOINT_BIT(ELBOW)) != 0);
    assert_true(fabs(grobo_deg_from_rad(sent.angle_rad[ELBOW]) - 10) < 1e-9);

    assert_int_equal(grobo_runner_init_position(runner), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    runner_assert_elbow_at(0);

    grobo_posture init;
    grobo_posture posture;
    grobo_runner_get_init_posture(runner, &init);
    assert_int_equal(grobo_posture_set_deg(&init, ELBOW, -6), GROBO_OK);
    assert_int_equal(grobo_posture_set_deg(&init, ELBOW + 1, 12), GROBO_OK);
    init.time_us = 200000;
    assert_int_equal(grobo_runner_set_init_posture(runner, &init), GROBO_OK);
    assert_int_equal(grobo_runner_init_position(runner), GROBO_OK);
    grobo_runner_get_target_posture(runner, &posture);
    assert_true(grobo_posture_equal(&posture, &init));
    assert_int_equal(posture.time_us, 200000);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_read_posture(runner, &posture, 0), 20);
    assert_true(grobo_posture_near(&posture, &init, grobo_rad_from_deg(0.6)));
}

static int frames_sent(void *arg, grobo_runner *from)
{
    grobo_robot *robot = grobo_session_robot(grobo_runner_session(from));

    (void)arg;
    return (int)grobo_robot_get_counters(robot)->motion_frames;
}

/* Targets of a program's own rate: each leaves while the one before is on its way. */
TEST_WITH(with_and_without_thread, each_target_of_a_stream_is_sent)
{
    int frames;

    runner_come_up();
    assert_int_equal(grobo_runner_init_position(runner), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    frames = grobo_runner_call(runner, frames_sent, NULL);
    /* A minute each: a target that waits for the one before to be reached is not sent in time. */
    assert_int_equal(grobo_runner_set_motion_time_us(runner, 60000000), GROBO_OK);
    for (int i = 1; i <= 10; i++) {
        assert_int_equal(grobo_runner_set_joint(runner, ELBOW, grobo_rad_from_deg(i)), 0);
        assert_int_equal(grobo_runner_start_motion(runner), GROBO_OK);
        for (int rounds = 0; grobo_runner_call(runner, frames_sent, NULL) < frames + i; rounds++) {
            assert_in_range(rounds, 0, 1000); /* 10 s */
            (void)grobo_runner_svc(runner);
        }
        assert_int_equal(grobo_runner_command_count(runner), 1);
        assert_int_equal(grobo_runner_is_moving(runner), 1);
    }
    assert_int_equal(grobo_runner_set_motion_time_us(runner, 100000), GROBO_OK);
    assert_int_equal(grobo_runner_start_motion(runner), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_call(runner, frames_sent, NULL) - frames, 11);
    runner_assert_elbow_at(10);
}

/* Asks for a move behind a reading that is under way: it has to wait for its turn. */
static int ask_behind_a_reading(void *arg, grobo_runner *from)
{
    int r = grobo_robot_sense(grobo_session_robot(grobo_runner_session(from)), EVERY_JOINT,
                              GROBO_SENSE_FULL);

    (void)arg;
    for (int i = 0; i < 2 && r >= 0; i++) {
        r = grobo_runner_start_motion(from);
    }
    return r < 0 ? r : grobo_runner_command_count(from);
}

TEST_WITH(with_and_without_thread, a_target_that_waits_is_counted)
{
    runner_come_up();
    assert_int_equal(grobo_runner_set_joint(runner, ELBOW, grobo_rad_from_deg(5)), GROBO_OK);
    assert_int_equal(grobo_runner_call(runner, ask_behind_a_reading, NULL), 1);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_command_count(runner), 0);
    runner_assert_elbow_at(5);

    /* And may be taken back before it is sent. */
    assert_int_equal(grobo_runner_set_joint(runner, ELBOW, grobo_rad_from_deg(9)), GROBO_OK);
    assert_int_equal(grobo_runner_call(runner, ask_behind_a_reading, NULL), 1);
    assert_int_equal(grobo_robot_stop(grobo_runner_robot(runner), false), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_ERR_CANCELED);
    assert_int_equal(grobo_robot_stop(grobo_runner_robot(runner), false), GROBO_ERR_STATE);
}

/* ---- the motion --------------------------------------------------------------------------- */

static grobo_posture nth(size_t n)
{
    grobo_motion *motion = NULL;
    grobo_posture posture;

    assert_true(grobo_runner_get_motion(runner, &motion) > (int)n);
    assert_int_equal(grobo_motion_get(motion, n, &posture), GROBO_OK);
    grobo_motion_free(motion);
    return posture;
}

TEST_WITH(with_and_without_thread, the_motion_is_kept)
{
    grobo_motion *copy = NULL;

    assert_int_equal(runner_motion_size(runner), 0);
    runner_have_motion(3);
    assert_int_equal(grobo_runner_get_motion(runner, &copy), 3);
    for (size_t n = 0; n < 3; n++) {
        grobo_posture same;
        grobo_posture posture = nth(n);
        assert_true(posture.set == EVERY_JOINT);
        assert_int_equal(lround(grobo_deg_from_rad(posture.angle_rad[ELBOW])), 2 * (n + 1));
        assert_int_equal(grobo_motion_get(copy, n, &same), 0);
        assert_true(grobo_posture_equal(&posture, &same));
        assert_int_equal(same.time_us, posture.time_us);
    }
    grobo_runner_clear_motion(runner);
    assert_int_equal(runner_motion_size(runner), 0);
    assert_int_equal(grobo_motion_size(copy), 3);
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
    assert_int_equal(grobo_runner_set_joint(runner, ELBOW, grobo_rad_from_deg(10)), GROBO_OK);
    assert_int_equal(grobo_runner_start_motion(runner), GROBO_OK);
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

/* An emptied motion holds absolute postures, whatever it was. */
TEST_WITH(with_and_without_thread, an_emptied_motion_takes_postures)
{
    runner_come_up();
    for (int i = 0; i < 2; i++) {
        grobo_motion *motion = NULL;
        have_increments();
        if (i == 0) {
            grobo_runner_clear_motion(runner);
        } else {
            assert_true(grobo_runner_load_motion(runner, "nowhere", NULL) < 0);
        }
        assert_int_equal(grobo_runner_get_motion(runner, &motion), 0);
        assert_int_equal(grobo_motion_get_kind(motion), GROBO_MOTION_POSTURES);
        grobo_motion_free(motion);
    }
}

static int total_ms(void *arg, grobo_runner *from)
{
    grobo_play_progress progress;

    (void)arg;
    grobo_robot_progress(grobo_session_robot(grobo_runner_session(from)), &progress);
    return (int)(progress.total_us / 1000);
}

/* Postures without a time take the time that is reported, also where none was set. */
TEST_WITH(with_and_without_thread, the_default_time_is_what_is_played)
{
    grobo_posture posture;
    grobo_motion *motion = NULL;
    int64_t default_us = grobo_runner_get_default_time_us(runner);

    assert_int_equal(default_us, GROBO_POSTURE_TIME_US);
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
    assert_int_equal(grobo_runner_call(runner, total_ms, NULL), 2 * default_us / 1000);
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
    assert_true(grobo_runner_is_playing(runner));
    assert_int_equal(grobo_runner_is_moving(runner), 1);
    assert_true(grobo_runner_is_playing(runner)); /* begun by now */
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_ERR_STATE);
    int left = grobo_runner_command_count(runner);
    assert_in_range(left, 1, 4);
    grobo_runner_clear_motion(runner); /* what is played is not touched */
    assert_in_range(grobo_runner_command_count(runner), 0, left); /* one after the other goes */
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_false(grobo_runner_is_playing(runner));
    assert_int_equal(grobo_runner_call(runner, play_state, NULL), GROBO_SEQUENCER_FINISHED);
    assert_int_equal(grobo_runner_command_count(runner), 0);
    runner_assert_elbow_at(8);
}

/* On the loop, where nothing has begun yet. */
static int ask_to_play(void *arg, grobo_runner *from)
{
    int r = grobo_runner_play_motion(from, arg);

    return r < 0 ? r : grobo_runner_command_count(from);
}

TEST_WITH(with_and_without_thread, every_repetition_is_counted)
{
    const grobo_play_options at_a_rate = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                          .rate_hz = 20};
    int most = 3 * 4;
    int left;

    runner_come_up();
    runner_have_motion(4);
    assert_int_equal(grobo_runner_set_motion_count(runner, -3), GROBO_OK);
    assert_int_equal(grobo_runner_call(runner, ask_to_play, NULL), most);
    left = grobo_runner_command_count(runner);
    assert_in_range(left, 5, most); /* not only the first pass, which has 4 */
    while (grobo_runner_is_playing(runner)) {
        left = grobo_runner_command_count(runner);
        assert_in_range(left, 0, most);
        most = left;
        (void)grobo_runner_svc(runner);
    }
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_command_count(runner), 0);

    /* More than there are numbers for. */
    assert_int_equal(grobo_runner_set_motion_count(runner, INT_MIN), GROBO_OK);
    assert_int_equal(grobo_runner_play_motion(runner, &at_a_rate), GROBO_OK);
    assert_int_equal(grobo_runner_command_count(runner), INT_MAX);
    assert_int_equal(grobo_runner_wait(runner, 300000), GROBO_ERR_PENDING);
    assert_int_equal(grobo_runner_command_count(runner), INT_MAX);
    assert_int_equal(grobo_robot_stop(grobo_runner_robot(runner), true), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_ERR_CANCELED);
}

TEST_WITH(with_and_without_thread, a_negative_count_plays_in_reverse)
{
    const grobo_play_options at_a_rate = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE};
    const grobo_play_options too_fast = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                         .rate_hz = 1000};

    runner_come_up();
    runner_have_motion(4);
    assert_int_equal(grobo_runner_set_motion_count(runner, 3), GROBO_OK);
    assert_false(grobo_runner_is_reverse(runner));
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_call(runner, passes_of, NULL), 3);
    runner_assert_elbow_at(8);
    assert_int_equal(grobo_runner_set_motion_count(runner, -2), GROBO_OK);
    assert_true(grobo_runner_is_reverse(runner));
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_call(runner, passes_of, NULL), 2);
    runner_assert_elbow_at(2);
    assert_int_equal(grobo_runner_set_motion_count(runner, 1), GROBO_OK);
    assert_int_equal(grobo_runner_play_motion(runner, &too_fast), GROBO_ERR_UNWATCHED);
    assert_false(grobo_runner_is_playing(runner));
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_ERR_UNWATCHED);
    runner_assert_elbow_at(2);
    assert_int_equal(grobo_runner_play_motion(runner, &at_a_rate), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    runner_assert_elbow_at(8);
    assert_false(grobo_runner_is_reverse(runner));
    grobo_runner_set_reverse(runner, true);
    assert_true(grobo_runner_is_reverse(runner));
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    runner_assert_elbow_at(2);
}

TEST_WITH(with_and_without_thread, playing_is_stopped)
{
    runner_come_up();
    runner_have_motion(4);
    assert_int_equal(grobo_runner_set_motion_count(runner, 10000), GROBO_OK);
    for (int at_once = 0; at_once < 2; at_once++) {
        assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_OK);
        assert_int_equal(grobo_runner_wait(runner, 400000), GROBO_ERR_PENDING);
        assert_true(grobo_runner_command_count(runner) >= 0);
        assert_int_equal(grobo_robot_stop(grobo_runner_robot(runner), at_once != 0), GROBO_OK);
        assert_int_equal(grobo_runner_wait(runner, 0), GROBO_ERR_CANCELED);
    }
    /* A motion that has not begun yet is forgotten. */
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_OK);
    assert_int_equal(grobo_runner_estop(runner), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_ERR_CANCELED);
    assert_false(grobo_runner_is_playing(runner));
}

/* What cannot be done now is refused now, and changes nothing. */
TEST_WITH(with_and_without_thread, what_the_engine_refuses_is_told_at_once)
{
    runner_come_up();
    runner_have_motion(4);
    assert_int_equal(grobo_runner_set_motion_count(runner, 10000), GROBO_OK);
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_OK);
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_ERR_STATE);
    const grobo_robot *robot = grobo_runner_robot(runner);
    for (int rounds = 0; grobo_robot_job(robot) != GROBO_JOB_NONE; rounds++) {
        assert_in_range(rounds, 0, 1000); /* 10 s of preparing */
        (void)grobo_runner_svc(runner);
    }
    assert_int_equal(grobo_runner_init_position(runner), GROBO_ERR_STATE); /* it sets them all */
    assert_int_equal(grobo_runner_is_playing(runner), 1);
    assert_int_equal(grobo_robot_stop(grobo_runner_robot(runner), true), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_ERR_CANCELED);
    assert_int_equal(grobo_runner_init_position(runner), GROBO_OK);
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_ERR_STATE); /* it moves */
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_OK);
}
