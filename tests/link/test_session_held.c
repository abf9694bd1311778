/* SPDX-License-Identifier: MIT */
/* A line that holds bytes back: nothing waits behind the judgement of the engine, and what has not
 * left by a stop never moves the robot. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <event2/event.h>

#include <grobo/core/sim.h>

#include "src/link/serial/serial.h"
#include "src/link/session/session.h"
#include "tests/support/far_robot.h"
#include "tests/support/folder.h"
#include "tests/support/loop.h"
#include "tests/support/session_kit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { NECK = 13, GOALS = 110, TORQUES = 50, UNLIMITED = 1 << 30 };

static const grobo_robot_config quiet = {GROBO_ROBOT_CONFIG_INIT,
                                         .sense_interval_us = GROBO_SENSE_NEVER,
                                         .bus.margin_us = 1000000}; /* of a busy machine */
static far_robot far;
static const grobo_port_ops *true_ops;
static grobo_port_ops slow_ops;
static int budget_bytes; /* what the line still takes */
static int unsent_bytes; /* what it says of what it took */
static int questions;    /* how often it was asked for that */
static uint8_t written[4096];
static size_t n_written;
static int tries; /* to write */

static int write_slowly(grobo_port *port, const void *buf, size_t size, grobo_os_cause *cause)
{
    int done = 0;

    tries++;
    if (budget_bytes > 0) {
        done = true_ops->write(port, buf, size < (size_t)budget_bytes ? size : (size_t)budget_bytes,
                               cause);
    }
    if (done > 0) {
        assert_true(n_written + (size_t)done <= sizeof written);
        memcpy(written + n_written, buf, (size_t)done);
        n_written += (size_t)done;
        budget_bytes -= done;
    }
    return done;
}

static int say_unsent(const grobo_port *port)
{
    (void)port;
    questions++;
    return unsent_bytes;
}

static grobo_robot *robot(void)
{
    return grobo_session_robot(session);
}

/* A robot that holds, on a line that does as it is told. */
static int set_up(void)
{
    grobo_joint_mask all = GROBO_JOINTS_ALL(20);

    assert_int_equal(folder_set_up(), 0);
    far_robot_start(&far, in_folder("robot"));
    session_kit_begin();
    session_kit_make((grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = far.link,
                                            .baud_bps = FAR_ROBOT_BPS, .robot = &quiet});
    assert_int_equal(grobo_session_open(session), GROBO_OK);
    loop_run_until(base, &seen.ups, 1);
    assert_int_equal(
        session_kit_await(grobo_robot_torque(grobo_session_robot(session), all, GROBO_TORQUE_ON)),
        GROBO_OK);
    true_ops = session->wire[0].serial->ops;
    slow_ops = *true_ops;
    slow_ops.write = write_slowly;
    slow_ops.unsent = say_unsent;
    session->wire[0].serial->ops = &slow_ops;
    budget_bytes = UNLIMITED;
    unsent_bytes = 0;
    n_written = 0;
    return 0;
}

static int tear_down(void)
{
    static const char *const names[] = {"robot"};

    session_kit_end();
    far_robot_end(&far);
    folder_remove(names, 1);
    return 0;
}

static const test_fixture fixture[] = {{NULL, set_up, tear_down}};

/* Sends every joint somewhere, of which the line takes so many bytes. */
static void send_goals(int taken_bytes)
{
    grobo_posture target;

    grobo_posture_init_pose(&target, &grobo_i_gr001_model);
    target.time_us = 2000000;
    target.angle_rad[NECK] = grobo_rad_from_deg(40);
    budget_bytes = taken_bytes;
    tries = 0;
    assert_int_equal(grobo_robot_send(robot(), &target), GROBO_OK);
    loop_run_until(base, &tries, 1); /* behind a reply that is late */
    assert_int_equal(n_written, taken_bytes);
}

static uint8_t sum_of(const uint8_t *frame, size_t size)
{
    uint8_t sum = 0;

    for (size_t i = 4; i < size; i++) {
        sum ^= frame[i];
    }
    return sum;
}

static void assert_stop_at(size_t at)
{
    assert_true(n_written >= at + TORQUES);
    assert_memory_equal(written + at, "\x53\x30\xFA\xAF\x00\x00\x24\x02\x14", 9);
    assert_int_equal(sum_of(written + at, TORQUES), 0);
}

static double neck_deg(void)
{
    grobo_joint_info info;
    grobo_joint_mask neck = GROBO_JOINT_BIT(NECK);

    assert_int_equal(
        session_kit_await(grobo_robot_sense(grobo_session_robot(session), neck, GROBO_SENSE_FULL)),
        GROBO_OK);
    assert_int_equal(grobo_robot_joint(robot(), NECK, &info), 0);
    return grobo_deg_from_rad(info.state.angle_rad);
}

/* A stop while the line has taken so much of a frame; then it takes everything again. */
static int stop_and_let_go(int taken_bytes)
{
    int job;

    send_goals(taken_bytes);
    job = grobo_robot_estop(grobo_session_robot(session));
    assert_true(job > 0);
    assert_true(loop_run(base, 60000)); /* the frame would be over by now */
    budget_bytes = UNLIMITED;
    return session_kit_await(job);
}

TEST_WITH(fixture, a_frame_that_has_not_left_by_a_stop_never_does)
{
    assert_int_equal(stop_and_let_go(0), GROBO_OK);
    assert_stop_at(0);
    assert_true(neck_deg() < 0.2);
}

/* Its rest is awaited at the other end: it comes, with a wrong sum, and the stop behind it is
 * understood at once. */
TEST_WITH(fixture, a_torn_frame_is_spoilt_by_a_stop)
{
    static const int taken[] = {1, 2, 40, GOALS - 1};

    for (size_t i = 0; i < sizeof taken / sizeof taken[0]; i++) {
        n_written = 0;
        assert_int_equal(stop_and_let_go(taken[i]), GROBO_OK);
        assert_int_equal(written[0], 0x53);
        assert_int_equal(written[1], GOALS - 2);
        assert_int_equal(sum_of(written, GOALS), 0xFF);
        assert_stop_at(GOALS);
        assert_int_equal(far_robot_torqued(&far), 0);
        assert_true(neck_deg() < 0.2);
        assert_int_equal(grobo_robot_reset(grobo_session_robot(session)), GROBO_OK);
        n_written = 0;
        assert_int_equal(session_kit_await(grobo_robot_torque(
                             grobo_session_robot(session), GROBO_JOINTS_ALL(20), GROBO_TORQUE_ON)),
                         GROBO_OK);
    }
}

/* A stop that is held back itself is not taken back, however long its readings wait behind it. */
TEST_WITH(fixture, a_stop_is_not_taken_back)
{
    int job;

    budget_bytes = 20;
    job = grobo_robot_estop(grobo_session_robot(session));
    assert_true(loop_run(base, 60000));
    assert_int_equal(n_written, 20);
    budget_bytes = UNLIMITED;
    assert_int_equal(session_kit_await(job), GROBO_OK);
    assert_stop_at(0);
}

/* What the system holds back counts as well. */
TEST_WITH(fixture, no_frame_is_taken_behind_one_that_has_not_left)
{
    send_goals(GOALS);
    budget_bytes = UNLIMITED;
    unsent_bytes = 1;
    assert_true(loop_run(base, 60000));
    grobo_posture target;
    grobo_posture_init_pose(&target, &grobo_i_gr001_model);
    assert_int_equal(grobo_robot_send(robot(), &target), GROBO_OK);
    assert_true(loop_run(base, 20000));
    assert_int_equal(n_written, GOALS);
    unsent_bytes = 0;
    assert_true(loop_run(base, 20000)); /* nobody tells: it is looked at again */
    assert_int_equal(n_written, 2 * GOALS);
}

/* A frame that was answered has left: nothing is asked, until one goes that nothing answers. */
TEST_WITH(fixture, the_line_is_not_asked_about_what_was_answered)
{
    (void)neck_deg();
    questions = 0;
    (void)neck_deg();
    (void)neck_deg();
    assert_int_equal(questions, 0);
    n_written = 0;
    send_goals(GOALS);
    assert_int_equal(questions, 0);
    budget_bytes = UNLIMITED;
    (void)neck_deg();
    assert_true(questions > 0);
}

/* ---- the simulator --------------------------------------------------------------------------- */

static int set_up_sim(void)
{
    session_kit_begin();
    session_kit_make((grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM,
                                            .robot = &quiet});
    assert_int_equal(grobo_session_open(session), GROBO_OK);
    loop_run_until(base, &seen.ups, 1);
    assert_int_equal(
        session_kit_await(grobo_robot_torque(robot(), GROBO_JOINTS_ALL(20), GROBO_TORQUE_ON)),
        GROBO_OK);
    return 0;
}

static int tear_down_sim(void)
{
    session_kit_end();
    return 0;
}

static const test_fixture on_sim[] = {{NULL, set_up_sim, tear_down_sim}};

/* Moves what is on the line to the simulator, and what will be, in time. */
static void delay_line(grobo_sim *sim, int64_t span_ns)
{
    sim->in.free_ns = (sim->in.free_ns > sim->now_ns ? sim->in.free_ns : sim->now_ns) + span_ns;
    for (int i = 0; i < sim->in.used; i++) {
        sim->in.at_ns[(sim->in.head + i) % GROBO_SIM_WIRE_BYTES] += span_ns;
    }
}

/* Its line stands still until it takes a frame in part. */
TEST_WITH(on_sim, what_the_simulator_has_not_taken_by_a_stop_moves_nothing)
{
    enum { GOAL = 30, FRAMES_MAX = 2 * GROBO_SIM_WIRE_BYTES / GOALS };
    const int64_t hour_ns = INT64_C(3600000000000);
    grobo_sim *sim = grobo_session_sim(session);
    int32_t goal_ddeg = -1;
    int n = 0;

    delay_line(sim, hour_ns);
    while (session->wire[0].backlog_bytes == 0 && n < FRAMES_MAX) {
        grobo_posture target;

        grobo_posture_init_pose(&target, &grobo_i_gr001_model);
        target.time_us = 2000000;
        target.angle_rad[NECK] = grobo_rad_from_deg(++n);
        assert_int_equal(grobo_robot_send(robot(), &target), GROBO_OK);
        assert_true(loop_run(base, 12000));
    }
    assert_in_range(session->wire[0].backlog_bytes, 3, GOALS - 1);
    assert_true(grobo_robot_estop(robot()) > 0);
    assert_true(loop_run(base, 20000)); /* what it holds is taken back */
    assert_int_equal(session->wire[0].given_bytes, 0);
    delay_line(sim, -hour_ns);
    while (session->wire[0].backlog_bytes > 0 || grobo_sim_rx_room(sim) < GROBO_SIM_WIRE_BYTES) {
        (void)loop_run(base, 20000);
    }
    int servo = grobo_sim_find(sim, grobo_i_gr001_model.joints[NECK].motor);
    assert_int_equal(grobo_sim_get_register(sim, servo, GOAL, &goal_ddeg), GROBO_OK);
    assert_in_range(goal_ddeg, 10, 10 * (n - 1));
}
