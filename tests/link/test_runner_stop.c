/* SPDX-License-Identifier: MIT */
/* Emergency stops of a runner whose loop is held, has no thread, or has no line. */
#include <stdint.h>

#include <grobo/core/board.h>
#include <grobo/core/robot.h>

#include "tests/support/stop_kit.h"
#include "tests/support/test.h"

/* ---- emergency stops ---------------------------------------------------------------------- */

TEST(an_emergency_stop_stands_while_a_callback_blocks)
{
    stop_kit_start((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true});
    move_for_long();
    hold_begin(&gate);
    assert_false(grobo_runner_is_latched(runner));
    assert_int_equal(grobo_runner_estop(runner), GROBO_OK);
    assert_true(grobo_runner_is_latched(runner));
    hold_end(&gate);
    assert_int_equal(grobo_runner_call(runner, tripped, NULL), 1);
    assert_stopped(1);
    assert_int_equal(runner_torque(runner, GROBO_JOINT_BIT(ELBOW), GROBO_TORQUE_ON, 0),
                     GROBO_ERR_LATCHED);
    assert_int_equal(grobo_runner_reset(runner), GROBO_OK);
    assert_false(grobo_runner_is_latched(runner));
    assert_int_equal(runner_torque(runner, GROBO_JOINT_BIT(ELBOW), GROBO_TORQUE_ON, 0), GROBO_OK);
    stop_kit_end();
}

/* Whoever asks for a motion behind it is told so at once, and not by the loop that drops it. */
TEST(nothing_that_moves_is_taken_behind_an_emergency_stop)
{
    static const grobo_rs30x_goal far = {5, 100, 1000};
    uint8_t raw[GROBO_FRAME_MAX_BYTES];
    int n = grobo_frame_goals(grobo_wiring_protocol(GROBO_WIRING_BOARD), &far, 1, raw, sizeof raw);
    stop_kit_start((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true});
    grobo_robot *robot = grobo_runner_robot(runner);
    grobo_posture target;
    (void)grobo_posture_init(&target, 20);
    (void)grobo_posture_set_deg(&target, ELBOW, 5);
    hold_begin(&gate);
    int taken = grobo_robot_send(robot, &target);
    int stopped = grobo_runner_estop(runner);
    const int behind[] = {grobo_robot_send(robot, &target),
                          grobo_robot_move(robot, &target),
                          grobo_robot_retarget(robot, &target),
                          grobo_robot_torque(robot, EVERY_JOINT, GROBO_TORQUE_ON),
                          grobo_robot_free(robot, EVERY_JOINT, true),
                          grobo_robot_stored(robot, GROBO_STORED_SLOT, 1),
                          grobo_robot_resume(robot),
                          grobo_robot_start_at(robot, 0),
                          grobo_robot_raw(robot, raw, (size_t)n)};
    hold_end(&gate);
    assert_int_equal(taken, GROBO_OK);
    assert_int_equal(stopped, GROBO_OK);
    for (size_t i = 0; i < sizeof behind / sizeof behind[0]; i++) {
        assert_int_equal(behind[i], GROBO_ERR_LATCHED);
    }
    assert_stopped(1);
    assert_int_equal(grobo_runner_reset(runner), GROBO_OK);
    assert_true(grobo_robot_torque(robot, EVERY_JOINT, GROBO_TORQUE_ON) > 0);
    stop_kit_end();
}

TEST(an_emergency_stop_needs_no_lock_of_the_programs)
{
    stop_kit_start((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true});
    move_for_long();
    grobo_mutex_lock(&users);
    assert_int_equal(grobo_runner_estop(runner), GROBO_OK); /* on_svc waits, or soon will */
    assert_true(grobo_runner_is_latched(runner));
    grobo_mutex_unlock(&users);
    assert_stopped(1);
    stop_kit_end();
}

TEST(several_emergency_stops_are_one)
{
    stop_kit_start((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true});
    move_for_long();
    hold_begin(&gate);
    for (int i = 0; i < 1000; i++) {
        assert_int_equal(grobo_runner_estop(runner), GROBO_OK);
    }
    hold_end(&gate);
    assert_stopped(1);
    assert_int_equal(told.trips, 1);
    assert_int_equal(grobo_runner_estop(NULL), GROBO_ERR_ARG);
    stop_kit_end();
}

TEST(the_next_frame_is_the_stop)
{
    for (int round = 0; round < 5; round++) {
        stop_kit_start((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true});
        play_for_long();
        hold_begin(&gate);
        saw.listen = true;
        told = saw; /* the loop is held */
        int goals = told.goals;
        if (round > 0) { /* a stop besides sends nothing */
            assert_int_equal(grobo_runner_post_stop(runner, round == 1), GROBO_OK);
        }
        assert_int_equal(grobo_runner_estop(runner), GROBO_OK);
        hold_end(&gate);
        assert_stopped(1);
        assert_int_equal(told.first, TORQUE);
        assert_int_equal(told.goals, goals);
        stop_kit_end();
    }
}

/* The robot has just been found, and a frame that reads a joint is about to leave. */
static void stop_when_up(void *ctx, grobo_session *session, grobo_session_event event, int error)
{
    (void)error;
    (void)ctx;
    if (event == GROBO_SESSION_EVENT_UP) {
        saw.listen = true;
        assert_true(grobo_robot_sense(grobo_session_robot(session), EVERY_JOINT, GROBO_SENSE_FULL) >
                    0);
        assert_int_equal(grobo_session_post_estop(session), GROBO_OK);
    }
}

TEST(no_frame_leaves_before_a_posted_stop)
{
    stop_kit_make((grobo_runner_config){
        GROBO_RUNNER_CONFIG_INIT, .skip_exit = true,
        .session = &(grobo_session_config){GROBO_SESSION_CONFIG_INIT, .on_event = stop_when_up}});
    runner_come_up();
    assert_stopped(1);
    assert_int_equal(told.first, TORQUE);
    stop_kit_end();
}

TEST(without_a_thread_the_next_call_stops_first)
{
    stop_kit_make((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true});
    assert_int_equal(grobo_runner_estop(runner), GROBO_OK); /* nothing is open yet */
    assert_true(grobo_runner_is_latched(runner));
    assert_int_equal(grobo_runner_call(runner, tripped, NULL), 1);
    runner_come_up();
    assert_stopped(1);
    assert_int_equal(grobo_runner_reset(runner), GROBO_OK);

    assert_int_equal(runner_torque(runner, EVERY_JOINT, GROBO_TORQUE_ON, 0), 0);
    move_for_long();
    assert_int_equal(grobo_runner_call(runner, begin_to_listen, NULL), 0);
    assert_int_equal(grobo_runner_estop(runner), GROBO_OK);
    assert_stopped(2);
    assert_int_equal(told.first, TORQUE);
    stop_kit_end();
}

static int stop_twice(grobo_runner *from)
{
    int r = grobo_runner_estop(from);
    bool at_once = grobo_runner_is_latched(from);

    /* A call in a callback is done at once, and the stop goes before it. */
    return r == GROBO_OK && at_once && grobo_runner_call(from, tripped, NULL) == 1 &&
           grobo_runner_estop(from) == GROBO_OK && grobo_runner_reset(from) == GROBO_ERR_STATE;
}

TEST(a_callback_may_stop)
{
    stop_kit_start((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true});
    move_for_long();
    hold_begin(&gate);
    in_callback = stop_twice;
    hold_end(&gate);
    while (!grobo_runner_is_latched(runner)) {
        assert_int_equal(grobo_runner_svc(runner), 0);
    }
    (void)grobo_runner_wait(runner, 0);
    assert_int_equal(callback_result, 1);
    assert_stopped(1); /* the second found the first under way */
    stop_kit_end();
}

TEST(an_emergency_stop_waits_for_the_line)
{
    stop_kit_start((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true});
    assert_int_equal(grobo_runner_close(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_estop(runner), GROBO_OK);
    assert_true(grobo_runner_is_latched(runner));
    assert_int_equal(grobo_runner_call(runner, tripped, NULL), 1);
    runner_come_up();
    assert_stopped(1);
    stop_kit_end();
}

TEST(a_program_that_ends_is_stopped_before)
{
    for (int threaded = 0; threaded < 2; threaded++) {
        stop_kit_start((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true});
        if (!threaded) {
            assert_int_equal(grobo_runner_stop(runner), GROBO_OK);
        }
        assert_int_equal(grobo_runner_estop(runner), GROBO_OK);
        stop_kit_end();
        assert_int_equal(saw.estops, 1);
        assert_int_equal(saw.estop_result, GROBO_OK);
    }
}

/* ---- resets ------------------------------------------------------------------------------- */

TEST(a_reset_does_not_clear_a_later_stop)
{
    caller other;

    stop_kit_start(
        (grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true, .timeout_us = LONG_US});
    assert_int_equal(grobo_runner_close(runner, 0), GROBO_OK); /* it stays latched then */
    assert_int_equal(grobo_runner_estop(runner), GROBO_OK);
    hold_begin(&gate);
    begin_call(&other, grobo_runner_reset, 1);
    assert_int_equal(grobo_runner_estop(runner), GROBO_OK);
    hold_end(&gate);
    assert_int_equal(end_call(&other), GROBO_ERR_STATE);
    assert_true(grobo_runner_is_latched(runner));
    runner_come_up();
    assert_stopped(1);
    stop_kit_end();
}

static int stop_session(grobo_runner *from)
{
    return grobo_robot_estop(grobo_session_robot(grobo_runner_session(from)));
}

TEST(nor_one_that_a_callback_made)
{
    caller other;

    stop_kit_start(
        (grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true, .timeout_us = LONG_US});
    assert_int_equal(grobo_runner_close(runner, 0), GROBO_OK);
    hold_begin(&gate);
    begin_call(&other, grobo_runner_reset, 1);
    in_callback = stop_session;
    hold_end(&gate);
    assert_int_equal(end_call(&other), GROBO_ERR_STATE);
    assert_int_equal(callback_result, GROBO_ERR_CLOSED);
    assert_true(grobo_runner_is_latched(runner));
    stop_kit_end();
}
