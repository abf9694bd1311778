/* SPDX-License-Identifier: MIT */
/* Ports, sessions, threads and their like refuse NULL for each thing that must be there.
 * grobo_guard_run() takes it: NULL stands for all defaults. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <event2/event.h>

#include <grobo/core/lines.h>
#include <grobo/core/loop.h>
#include <grobo/core/robot.h>
#include <grobo/core/runner.h>
#include <grobo/core/static.h>
#include <grobo/core/virtual.h>
#include <grobo/estop.h>
#include <grobo/guard.h>
#include <grobo/session.h>
#include <grobo/sim_server.h>

#include "tests/support/tables.h"
#include "tests/support/test.h"

#define REFUSES(call) assert_int_equal(call, GROBO_ERR_ARG)

static uint8_t bytes[256];
static char text[] = "CHEST";
static double reals[64];
static uint64_t counts[2];
static grobo_motion *motion;
static grobo_clip clip;
static grobo_estop mark;
static grobo_os_cause cause;
static grobo_estop_holder holder;
static grobo_robot robot;
static grobo_posture posture;
static FILE *stream;
static grobo_play_options play_options = {GROBO_PLAY_OPTIONS_INIT};
static grobo_guard_config guard_config = {GROBO_GUARD_CONFIG_INIT};
static struct event_base *base;
static grobo_timer *timer;
static grobo_timer *made_timer;
static grobo_diagnostics *list;
static grobo_thread thread;
static grobo_robot_config robot_config = {GROBO_ROBOT_CONFIG_INIT};
static grobo_register_io io;
static grobo_serial_config serial_config = {GROBO_SERIAL_CONFIG_INIT};
static grobo_serial *serial;
static grobo_serial_counters counters;
static grobo_session_config session_config = {GROBO_SESSION_CONFIG_INIT};
static grobo_session *session;
static grobo_session *made_session;
static grobo_sim_server_config server_config = {GROBO_SIM_SERVER_CONFIG_INIT};
static grobo_sim_server *made_server;
static grobo_runner_config runner_config = {GROBO_RUNNER_CONFIG_INIT};
static const grobo_session_config runner_session = {GROBO_SESSION_CONFIG_INIT,
                                                    .device = GROBO_DEVICE_SIM};
static grobo_runner *runner;
static grobo_runner_event runner_event = {GROBO_RUNNER_EVENT_INIT};
static grobo_snapshot snapshot = {GROBO_SNAPSHOT_INIT};
static grobo_runner *made_runner;

static void on_timer(void *ctx, grobo_timer *from, int64_t late_us)
{
    (void)from;
    (void)late_us;
    (void)ctx;
}

static int on_runner(void *arg, grobo_runner *from)
{
    (void)from;
    (void)arg;
    return 0;
}

static int set_up(void)
{
    base = grobo_loop_new();
    assert_non_null(base);
    assert_int_equal(grobo_timer_new(base, on_timer, NULL, NULL, &timer), GROBO_OK);
    assert_int_equal(grobo_serial_new(NULL, &serial), GROBO_OK);
    session_config =
        (grobo_session_config){GROBO_SESSION_CONFIG_INIT, .base = base, .device = GROBO_DEVICE_SIM};
    assert_int_equal(grobo_session_new(&session_config, &session), GROBO_OK);
    runner_config.session = &runner_session;
    assert_int_equal(grobo_runner_new(&runner_config, &runner), GROBO_OK);
    assert_int_equal(grobo_motion_new(GROBO_MOTION_POSTURES, 20, NULL, &motion), GROBO_OK);
    assert_int_equal(
        grobo_robot_init(&robot, grobo_gr001_driver(GROBO_WIRING_BOARD), NULL, NULL, 0), GROBO_OK);
    grobo_posture_init_pose(&posture, &grobo_i_gr001_model);
    stream = tmpfile();
    assert_non_null(stream);
    return 0;
}

static int tear_down(void)
{
    (void)fclose(stream);
    grobo_motion_free(motion);
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    grobo_session_free(session);
    grobo_serial_free(serial);
    grobo_timer_free(timer);
    event_base_free(base);
    return 0;
}

TEST(estop_refuses_null)
{
    REFUSES(grobo_estop_set(NULL, &mark, &cause));
    REFUSES(grobo_estop_clear(NULL, &cause));
    assert_false(grobo_estop_stands(NULL));
    REFUSES(grobo_estop_force(NULL, GROBO_ESTOP_BY_GUARD));
    REFUSES(grobo_estop_ask(NULL, &mark, &holder));
    REFUSES(grobo_estop_ask(text, &mark, NULL));
}

TEST(guard_refuses_null)
{
    REFUSES(grobo_guard_new(&guard_config, NULL));
    grobo_guard_free(NULL);
    REFUSES(grobo_guard_pid(NULL));
}

TEST(loop_refuses_null)
{
    REFUSES(grobo_timer_new(NULL, on_timer, NULL, grobo_mem_default(), &made_timer));
    REFUSES(grobo_timer_new(base, NULL, NULL, grobo_mem_default(), &made_timer));
    REFUSES(grobo_timer_new(base, on_timer, NULL, grobo_mem_default(), NULL));
    grobo_timer_free(NULL);
    REFUSES(grobo_timer_set(NULL, 0));
    assert_true(grobo_timer_deadline(NULL) == GROBO_NEVER_US);
}

TEST(serial_refuses_null_in_its_first_functions)
{
    REFUSES(grobo_serial_new(&serial_config, NULL));
    grobo_serial_free(NULL);
    REFUSES(grobo_serial_set_device(NULL, text));
    assert_null(grobo_serial_device(NULL));
    REFUSES(grobo_serial_set_mode(NULL, 0));
    assert_int_equal(grobo_serial_get_mode(NULL), GROBO_SERIAL_SYNC);
    REFUSES(grobo_serial_set_baud(NULL, 115200));
    REFUSES(grobo_serial_baud(NULL));
    REFUSES(grobo_serial_set_low_latency(NULL));
    REFUSES(grobo_serial_low_latency(NULL));
    REFUSES(grobo_serial_open(NULL));
    grobo_serial_close(NULL);
    assert_false(grobo_serial_is_open(NULL));
    assert_int_equal(grobo_serial_handle(NULL), GROBO_HANDLE_NULL);
    assert_null(grobo_serial_cause(NULL));
    grobo_serial_get_counters(NULL, &counters);
    grobo_serial_get_counters(serial, NULL);
}

TEST(serial_refuses_null_in_its_second_functions)
{
    REFUSES(grobo_serial_read(NULL, bytes, 1));
    REFUSES(grobo_serial_read(serial, NULL, 1));
    REFUSES(grobo_serial_write(NULL, bytes, 1));
    REFUSES(grobo_serial_write(serial, NULL, 1));
    REFUSES(grobo_serial_receive(NULL, bytes, 1));
    REFUSES(grobo_serial_receive(serial, NULL, 1));
    REFUSES(grobo_serial_send(NULL, bytes, 1));
    REFUSES(grobo_serial_send(serial, NULL, 1));
    assert_int_equal(grobo_serial_pending(NULL), 0);
    assert_int_equal(grobo_serial_unsent(NULL), 0);
    REFUSES(grobo_serial_waiting(NULL));
    REFUSES(grobo_serial_discard(NULL));
    grobo_serial_discard_output(NULL);
    REFUSES(grobo_hex(bytes, 1, NULL, sizeof bytes));
    REFUSES(grobo_hex(NULL, 1, text, sizeof bytes));
    REFUSES(grobo_hex_print(bytes, 1, NULL));
    REFUSES(grobo_hex_print(NULL, 1, stream));
}

TEST(session_refuses_null_in_its_first_functions)
{
    REFUSES(grobo_session_new(NULL, &made_session));
    REFUSES(grobo_session_new(&session_config, NULL));
    grobo_session_free(NULL);
    REFUSES(grobo_session_open(NULL));
    grobo_session_close(NULL);
    REFUSES(grobo_session_set_device(NULL, text));
    REFUSES(grobo_session_set_device(session, NULL));
    REFUSES(grobo_session_configure(NULL, &robot_config));
    assert_int_equal(grobo_session_get_state(NULL), GROBO_SESSION_CLOSED);
    assert_null(grobo_session_device(NULL));
    assert_null(grobo_session_cause(NULL));
    assert_null(grobo_session_robot(NULL));
    assert_null(grobo_session_sim(NULL));
    assert_null(grobo_session_serial(NULL));
    REFUSES(grobo_session_tapped(NULL));
    grobo_session_bytes(NULL, counts, counts);
    grobo_session_bytes(session, NULL, counts);
    grobo_session_bytes(session, counts, NULL);
    REFUSES(grobo_robot_check(grobo_session_robot(NULL)));
    REFUSES(grobo_robot_sense(grobo_session_robot(NULL), 1, 0));
    REFUSES(grobo_robot_torque(grobo_session_robot(NULL), 1, 0));
    REFUSES(grobo_robot_move(grobo_session_robot(NULL), &posture));
    REFUSES(grobo_robot_move(grobo_session_robot(session), NULL));
    REFUSES(grobo_robot_retarget(grobo_session_robot(NULL), &posture));
    REFUSES(grobo_robot_retarget(grobo_session_robot(session), NULL));
    REFUSES(grobo_robot_raw(grobo_session_robot(NULL), bytes, 1));
}

TEST(session_refuses_null_in_its_second_functions)
{
    REFUSES(grobo_robot_raw(grobo_session_robot(session), NULL, 1));
    REFUSES(grobo_robot_raw_until(grobo_session_robot(NULL), bytes, 1, 1000));
    REFUSES(grobo_robot_raw_until(grobo_session_robot(session), NULL, 1, 1000));
    REFUSES(grobo_robot_registers(grobo_session_robot(NULL), &io));
    REFUSES(grobo_robot_registers(grobo_session_robot(session), NULL));
    REFUSES(grobo_robot_command(grobo_session_robot(NULL), 1, 0));
    REFUSES(grobo_robot_stored(grobo_session_robot(NULL), 0, 1));
    REFUSES(grobo_robot_exit(grobo_session_robot(NULL), 0));
    REFUSES(grobo_robot_estop(grobo_session_robot(NULL)));
    REFUSES(grobo_robot_reset(grobo_session_robot(NULL)));
    REFUSES(grobo_robot_cancel(grobo_session_robot(NULL)));
    REFUSES(grobo_robot_play(grobo_session_robot(NULL), &clip, &play_options));
    REFUSES(grobo_robot_play(grobo_session_robot(session), NULL, &play_options));
    REFUSES(grobo_robot_enqueue(grobo_session_robot(NULL), &clip, &play_options));
    REFUSES(grobo_robot_enqueue(grobo_session_robot(session), NULL, &play_options));
    REFUSES(grobo_robot_pause(grobo_session_robot(NULL)));
    REFUSES(grobo_robot_resume(grobo_session_robot(NULL)));
    REFUSES(grobo_robot_stop(grobo_session_robot(NULL), true));
    REFUSES(grobo_robot_seek(grobo_session_robot(NULL), 0));
    REFUSES(grobo_robot_speed(grobo_session_robot(NULL), 0));
    REFUSES(grobo_robot_free(grobo_session_robot(NULL), 1, true));
    REFUSES(grobo_session_post_estop(NULL));
    REFUSES(grobo_session_post_stop(NULL, true));
    REFUSES(grobo_session_post_exit(NULL, 0));
    assert_false(grobo_session_is_latched(NULL));
}

TEST(sim_server_refuses_null)
{
    REFUSES(grobo_sim_server_new(NULL, &made_server, &cause));
    REFUSES(grobo_sim_server_new(&server_config, NULL, &cause));
    grobo_sim_server_free(NULL);
    assert_null(grobo_sim_server_device(NULL));
    REFUSES(grobo_sim_server_tcp_port(NULL));
    assert_null(grobo_sim_server_sim(NULL));
    grobo_sim_server_pump(NULL);
    REFUSES(grobo_sim_server_plug(NULL, true));
}

TEST(thread_refuses_null_in_its_first_functions)
{
    REFUSES(grobo_runner_new(NULL, &made_runner));
    REFUSES(grobo_runner_new(&runner_config, NULL));
    assert_int_equal(grobo_runner_free(NULL), GROBO_OK);
    REFUSES(grobo_runner_start(NULL));
    REFUSES(grobo_runner_stop(NULL));
    assert_false(grobo_runner_is_active(NULL));
    REFUSES(grobo_runner_thread(NULL, &thread));
    REFUSES(grobo_runner_thread(runner, NULL));
    REFUSES(grobo_runner_svc(NULL));
    REFUSES(grobo_runner_run(NULL));
    REFUSES(grobo_runner_next_event(NULL, &runner_event));
    REFUSES(grobo_runner_next_event(runner, NULL));
    assert_true(grobo_runner_event_socket(NULL) == GROBO_SOCKET_NULL);
    REFUSES(grobo_runner_snapshot(NULL, &snapshot));
    REFUSES(grobo_runner_snapshot(runner, NULL));
    REFUSES(grobo_runner_call(NULL, on_runner, NULL));
    REFUSES(grobo_runner_call(runner, NULL, NULL));
    REFUSES(grobo_runner_post(NULL, on_runner, NULL));
    REFUSES(grobo_runner_post(runner, NULL, NULL));
    assert_null(grobo_runner_session(NULL));
    assert_null(grobo_runner_name(NULL));
    REFUSES(grobo_runner_joints(NULL));
}

TEST(thread_refuses_null_in_its_second_functions)
{
    REFUSES(grobo_runner_set_device(NULL, text));
    REFUSES(grobo_runner_set_device(runner, NULL));
    REFUSES(grobo_runner_get_device(NULL, text, sizeof bytes));
    REFUSES(grobo_runner_get_device(runner, NULL, sizeof bytes));
    REFUSES(grobo_runner_open(NULL));
    REFUSES(grobo_runner_close(NULL, 1000));
    REFUSES(grobo_runner_connect(NULL, 1000));
    assert_false(grobo_runner_is_connected(NULL));
    REFUSES(grobo_runner_get_cause(NULL, &cause));
    REFUSES(grobo_runner_get_cause(runner, NULL));
    REFUSES(grobo_runner_read_posture(NULL, &posture, 1000));
    REFUSES(grobo_runner_read_posture(runner, NULL, 1000));
    REFUSES(grobo_runner_read_angle(NULL, 1, reals, 1000));
    REFUSES(grobo_runner_read_angle(runner, 1, NULL, 1000));
}

TEST(thread_refuses_null_in_its_third_functions)
{
    REFUSES(grobo_runner_wait_job(NULL, 1, 0));
    REFUSES(grobo_runner_request(NULL, on_runner, NULL, 0));
    REFUSES(grobo_runner_request(runner, NULL, NULL, 0));
    REFUSES(grobo_runner_torque(NULL, 1, GROBO_TORQUE_ON, 0));
    assert_null(grobo_runner_robot(NULL));
    REFUSES(grobo_runner_wait(NULL, 1000));
    REFUSES(grobo_runner_set_motion(NULL, motion));
    REFUSES(grobo_runner_set_motion(runner, NULL));
    REFUSES(grobo_runner_load_motion(NULL, text, list));
    REFUSES(grobo_runner_load_motion(runner, NULL, list));
}

TEST(thread_refuses_null_in_its_fourth_functions)
{
    REFUSES(grobo_runner_play_motion(NULL, &play_options));
    REFUSES(grobo_runner_estop(NULL));
    assert_false(grobo_runner_is_latched(NULL));
    REFUSES(grobo_runner_reset(NULL));
    REFUSES(grobo_runner_exit(NULL, 0, 1000));
    REFUSES(grobo_runner_post_exit(NULL, 0));
    REFUSES(grobo_runner_post_stop(NULL, true));
}

TEST(a_virtual_robot_refuses_null)
{
    static const grobo_virtual_config unreal = {GROBO_VIRTUAL_CONFIG_INIT};
    grobo_virtual *unmade = NULL;
    REFUSES(grobo_virtual_new(NULL, &unmade));
    REFUSES(grobo_virtual_new(&unreal, NULL));
    REFUSES(grobo_virtual_run(NULL, 1000));
    REFUSES(grobo_virtual_now_us(NULL));
    assert_null(grobo_virtual_robot(NULL));
    assert_null(grobo_virtual_sim(NULL));
    assert_null(grobo_virtual_line_sim(NULL, 0));
    grobo_virtual_free(NULL);
    REFUSES(grobo_loop_run(NULL, 1000));
    grobo_loop_free(NULL);
}

TESTS_BETWEEN(set_up, tear_down)
