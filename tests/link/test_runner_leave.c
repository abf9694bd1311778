/* SPDX-License-Identifier: MIT */
/* Stops and exits of a runner that their callers cannot wait for. */
#include <stdint.h>

#include "src/link/runner/runner.h"
#include "tests/support/stop_kit.h"
#include "tests/support/test.h"

static int leave_off(grobo_runner *from)
{
    return grobo_runner_exit(from, GROBO_EXIT_OFF, 0);
}

static int post_nothing(void *arg, grobo_runner *from)
{
    (void)from;
    (void)arg;
    return 0;
}

/* Fills all slots; on_svc blocks. */
static void have_no_slot(caller callers[4])
{
    for (int i = 0; i < GROBO_RUNNER_CALLS_MAX; i++) {
        assert_int_equal(grobo_runner_post(runner, post_nothing, NULL), GROBO_OK);
    }
    for (int i = 0; i < 4; i++) {
        begin_call(&callers[i], leave_off, GROBO_RUNNER_CALLS_MAX + 1 + i);
    }
}

/* A stop is the engine's at once, and leaves when the loop turns. */
TEST(a_stop_waits_for_no_loop)
{
    for (int at_once = 0; at_once < 2; at_once++) {
        stop_kit_start((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true});
        move_for_long();
        hold_begin(&gate);
        assert_int_equal(grobo_robot_stop(grobo_runner_robot(runner), at_once), GROBO_OK);
        hold_end(&gate);
        assert_int_equal(grobo_runner_wait(runner, LONG_US), GROBO_ERR_CANCELED);
        assert_false(grobo_runner_is_latched(runner));

        play_for_long();
        hold_begin(&gate);
        assert_int_equal(grobo_robot_stop(grobo_runner_robot(runner), at_once), GROBO_OK);
        hold_end(&gate);
        assert_int_equal(grobo_runner_wait(runner, LONG_US), GROBO_ERR_CANCELED);
        assert_int_equal(grobo_runner_call(runner, copy_seen, &told), 0);
        assert_true((told.stop_us < STOP_US * 9 / 10) == at_once);
        stop_kit_end();
    }
}

TEST(calls_give_up_in_the_configured_time)
{
    const grobo_runner_config bad = {
        GROBO_RUNNER_CONFIG_INIT,
        .session = &(grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM},
        .timeout_us = -1};
    grobo_runner *made;
    int64_t begun_us;

    assert_int_equal(grobo_runner_new(&bad, &made), GROBO_ERR_ARG);
    stop_kit_start(
        (grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true, .timeout_us = SHORT_US});
    hold_begin(&gate);
    begun_us = grobo_now_us();
    assert_int_equal(grobo_runner_open(runner), GROBO_ERR_TIMEOUT);
    assert_in_range(grobo_now_us() - begun_us, SHORT_US, GROBO_RUNNER_TIMEOUT_US - 1);
    hold_end(&gate);
    stop_kit_end();
}

/* A function that is not over when its caller's time is: the caller waits for its return only. */
static hold other_gate;

static int hold_and_go_on(void *arg, grobo_runner *from)
{
    (void)from;
    (void)arg;
    hold_here(&other_gate);
    return CALL_PENDING;
}

static int wait_shortly(grobo_runner *from)
{
    return grobo_i_runner_wait(from, hold_and_go_on, NULL, SHORT_US);
}

TEST(a_caller_gives_up_when_its_function_returns)
{
    int64_t end_us = grobo_now_us() + LONG_US / 2;
    caller other;
    bool impatient;

    stop_kit_start((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true});
    hold_init(&other_gate);
    other_gate.wanted = true;
    begin_call(&other, wait_shortly, 0);
    hold_begin(&other_gate);
    do {
        grobo_i_runner_lock(runner);
        impatient = runner->slot[0].impatient;
        grobo_i_runner_unlock(runner);
        assert_true(grobo_now_us() < end_us);
    } while (!impatient);
    hold_end(&other_gate);
    assert_int_equal(end_call(&other), GROBO_ERR_TIMEOUT);
    hold_deinit(&other_gate);
    stop_kit_end();
}

TEST(a_posted_stop_is_smooth_or_at_once)
{
    stop_kit_start((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true});
    for (int kinds = 1; kinds <= 3; kinds++) {
        play_for_long();
        hold_begin(&gate);
        if ((kinds & 1) != 0) {
            assert_int_equal(grobo_runner_post_stop(runner, true), GROBO_OK);
        }
        if ((kinds & 2) != 0) {
            assert_int_equal(grobo_runner_post_stop(runner, false), GROBO_OK);
        }
        hold_end(&gate);
        assert_int_equal(grobo_runner_wait(runner, LONG_US), GROBO_ERR_CANCELED);
        assert_int_equal(grobo_runner_call(runner, copy_seen, &told), 0);
        assert_true((told.stop_us >= STOP_US * 9 / 10) == (kinds == 2)); /* at once prevails */
    }
    stop_kit_end();
}

/* The runner's thread sleeps for a second if nothing wakes it. */
TEST(calls_wake_a_loop_that_is_closed)
{
    int64_t end_us;

    stop_kit_make(
        (grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true, .period_us = 1000000});
    assert_int_equal(grobo_runner_start(runner), GROBO_OK);
    runner_come_up();
    assert_int_equal(grobo_runner_close(runner, 0), GROBO_OK);
    end_us = grobo_now_us() + 10000000;
    for (int i = 0; i < 20; i++) {
        assert_int_equal(grobo_runner_call(runner, tripped, NULL), 0);
    }
    assert_true(grobo_now_us() < end_us);
    stop_kit_end();
}

TEST(an_exit_that_nobody_awaits_is_carried_out)
{
    stop_kit_start((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true});
    move_for_long();
    hold_begin(&gate);
    assert_int_equal(grobo_runner_exit(runner, GROBO_EXIT_OFF, SHORT_US), GROBO_ERR_TIMEOUT);
    hold_end(&gate);
    (void)grobo_runner_wait(runner, 0);
    assert_int_equal(grobo_runner_call(runner, copy_seen, &told), 0);
    assert_int_equal(told.exits, 1);
    assert_int_equal(told.exit_result, GROBO_OK);
    assert_int_equal(runner_torque_of(runner, ELBOW), GROBO_TORQUE_OFF);
    stop_kit_end();
}

TEST(an_exit_that_has_begun_is_not_begun_again)
{
    stop_kit_start((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true});
    assert_int_equal(grobo_runner_exit(runner, GROBO_EXIT_SIT, 300000), GROBO_ERR_TIMEOUT);
    (void)grobo_runner_wait(runner, LONG_US);
    assert_int_equal(grobo_runner_call(runner, copy_seen, &told), 0);
    assert_int_equal(told.exits, 1);
    assert_int_equal(told.exit_result, GROBO_OK);
    stop_kit_end();
}

TEST(no_table_is_too_full_for_a_stop)
{
    caller callers[4];

    stop_kit_start(
        (grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true, .timeout_us = LONG_US});
    move_for_long();
    hold_begin(&gate);
    have_no_slot(callers);
    assert_int_equal(grobo_robot_stop(grobo_runner_robot(runner), true), GROBO_OK);
    assert_int_equal(grobo_runner_exit(runner, GROBO_EXIT_OFF, 0), GROBO_ERR_FULL);
    assert_int_equal(grobo_runner_estop(runner), GROBO_OK);
    hold_end(&gate);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(end_call(&callers[i]), GROBO_OK); /* one exit serves for all */
    }
    (void)grobo_runner_wait(runner, 0);
    assert_int_equal(grobo_runner_call(runner, copy_seen, &told), 0);
    assert_int_equal(told.estops, 1);
    assert_in_range(told.exits, 1, 2); /* one of them may come when it has ended */
    assert_int_equal(runner_torque_of(runner, ELBOW), GROBO_TORQUE_OFF);
    stop_kit_end();
}

static int leave_it(grobo_runner *from)
{
    return grobo_runner_exit(from, (grobo_exit_policy)9, 0) == GROBO_ERR_ARG &&
           grobo_runner_exit(from, GROBO_EXIT_OFF, 0) == GROBO_ERR_STATE &&
           grobo_robot_stop(grobo_runner_robot(from), true) == GROBO_OK;
}

TEST(a_callback_may_stop_and_leave)
{
    stop_kit_start((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true});
    move_for_long();
    hold_begin(&gate);
    in_callback = leave_it;
    hold_end(&gate);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_ERR_CANCELED);
    do {
        assert_int_equal(grobo_runner_call(runner, copy_seen, &told), 0);
    } while (told.exits == 0);
    assert_int_equal(callback_result, 1);
    assert_int_equal(runner_torque_of(runner, ELBOW), GROBO_TORQUE_OFF);
    stop_kit_end();
}

TEST(a_posted_stop_ends_what_is_asked_for_before_its_turn)
{
    stop_kit_start((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true});
    hold_begin(&gate);
    assert_true(runner_move_elbow(runner, 6, 0) > 0);
    assert_int_equal(grobo_runner_post_stop(runner, false), GROBO_OK);
    hold_end(&gate);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_ERR_CANCELED);
    runner_assert_elbow_at(0);
    hold_begin(&gate);
    assert_int_equal(grobo_runner_post_stop(runner, false), GROBO_OK);
    assert_true(runner_move_elbow(runner, 6, 0) > 0);
    hold_end(&gate);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_ERR_CANCELED);
    assert_true(runner_move_elbow(runner, 6, 0) > 0);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    runner_assert_elbow_at(6);

    runner_have_motion(1);
    hold_begin(&gate);
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_OK);
    assert_int_equal(grobo_runner_post_stop(runner, false), GROBO_OK);
    hold_end(&gate);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_ERR_CANCELED);
    assert_false(runner_plays(runner));
    hold_begin(&gate);
    assert_int_equal(grobo_runner_post_exit(runner, GROBO_EXIT_HOLD), GROBO_OK);
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_OK);
    hold_end(&gate);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_ERR_CANCELED);
    assert_int_equal(grobo_runner_play_motion(runner, NULL), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    runner_assert_elbow_at(2);
    assert_int_equal(grobo_runner_post_exit(runner, (grobo_exit_policy)-1), GROBO_ERR_ARG);
    assert_int_equal(grobo_runner_post_exit(NULL, GROBO_EXIT_OFF), GROBO_ERR_ARG);
    assert_int_equal(grobo_runner_post_stop(NULL, true), GROBO_ERR_ARG);
    stop_kit_end();
}

TEST(the_last_policy_prevails)
{
    stop_kit_start((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true});
    hold_begin(&gate);
    assert_int_equal(grobo_runner_post_exit(runner, GROBO_EXIT_OFF), GROBO_OK);
    assert_int_equal(grobo_runner_post_exit(runner, GROBO_EXIT_HOLD), GROBO_OK);
    hold_end(&gate);
    (void)grobo_runner_wait(runner, 0);
    assert_int_equal(grobo_runner_call(runner, copy_seen, &told), 0);
    assert_int_equal(told.exits, 1);
    assert_int_equal(runner_torque_of(runner, ELBOW), GROBO_TORQUE_ON);
    stop_kit_end();
}

TEST(a_port_is_not_closed_before_the_robot_is_left)
{
    static const grobo_robot_config leave_off = {GROBO_ROBOT_CONFIG_INIT,
                                                 .on_exit = GROBO_EXIT_OFF};

    stop_kit_start((grobo_runner_config){
        GROBO_RUNNER_CONFIG_INIT,
        .session = &(grobo_session_config){GROBO_SESSION_CONFIG_INIT, .robot = &leave_off},
        .timeout_us = LONG_US});
    hold_begin(&gate);
    assert_int_equal(grobo_runner_close(runner, SHORT_US), GROBO_ERR_TIMEOUT);
    hold_end(&gate);
    (void)grobo_runner_wait(runner, LONG_US / 2);
    assert_true(grobo_runner_is_connected(runner));
    assert_int_equal(grobo_runner_call(runner, copy_seen, &told), 0);
    assert_int_equal(told.exits, 1);
    assert_int_equal(runner_torque_of(runner, ELBOW), GROBO_TORQUE_OFF);
    stop_kit_end();
}
