/* SPDX-License-Identifier: MIT */
/* Emergency stops across programs: a session and the marks of its device. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <event2/event.h>

#include <grobo/core/loop.h>
#include <grobo/core/runner.h>
#include <grobo/estop.h>

#include "ports/common/notes.h"
#include "src/link/session/session.h"
#include "tests/support/loop.h"
#include "tests/support/os.h"
#include "tests/support/test.h"

enum { ELBOW = 16, FRAME_BYTES = 256 };

/* What a session told. */
typedef struct seen {
    int ups, fails, estops, result, losts;
    bool listens; /* for the next frame: */
    uint8_t frame[FRAME_BYTES];
    size_t size;
} seen;

static struct event_base *base;
static grobo_sim_server *server;
static char device[GROBO_DEVICE_MAX_BYTES];
static seen at;

static void on_event(void *ctx, grobo_session *session, grobo_session_event event, int error)
{
    seen *s = ctx;

    (void)session;
    (void)error;
    s->ups += event == GROBO_SESSION_EVENT_UP;
    s->losts += event == GROBO_SESSION_EVENT_LOST;
    s->fails += event == GROBO_SESSION_EVENT_FAILED;
    event_base_loopbreak(base);
}

static void on_robot(void *ctx, const grobo_event *event)
{
    seen *s = ctx;

    if (event->kind == GROBO_EVENT_JOB && event->u.job.kind == GROBO_JOB_ESTOP) {
        s->estops++;
        s->result = event->u.job.result;
        event_base_loopbreak(base);
    }
}

static void on_tap(void *ctx, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                   size_t size)
{
    seen *s = ctx;

    (void)now_us;
    if (s->listens && direction == GROBO_DIR_TX) {
        s->listens = false;
        s->size = size < FRAME_BYTES ? size : FRAME_BYTES;
        memcpy(s->frame, bytes, s->size);
    }
}

static int set_up(void)
{
    memset(&at, 0, sizeof at);
    base = grobo_loop_new();
    assert_non_null(base);
    server = loop_serve(base, (grobo_sim_server_config){GROBO_SIM_SERVER_CONFIG_INIT,
                                                        .no_pty = true, .tcp = "tcp:127.0.0.1:0"});
    snprintf(device, sizeof device, "%s", grobo_sim_server_device(server));
    return 0;
}

static int tear_down(void)
{
    assert_int_equal(grobo_estop_clear(device, NULL), GROBO_OK);
    grobo_sim_server_free(server);
    event_base_free(base);
    return 0;
}

static const test_fixture fixture[] = {{NULL, set_up, tear_down}};

static grobo_session *open_session(void)
{
    const grobo_session_config config = {
        GROBO_SESSION_CONFIG_INIT, .base = base,         .device = device, .reconnect = true,
        .on_event = on_event,      .on_robot = on_robot, .on_tap = on_tap, .ctx = &at};
    grobo_session *session = NULL;
    int ups = at.ups;

    assert_int_equal(grobo_session_new(&config, &session), GROBO_OK);
    assert_int_equal(grobo_session_open(session), GROBO_OK);
    loop_run_until(base, &at.ups, ups + 1);
    return session;
}

static int move(grobo_session *session, double angle_deg, int64_t time_us)
{
    grobo_posture target;

    assert_int_equal(grobo_posture_init(&target, 20), GROBO_OK);
    assert_int_equal(grobo_posture_set_deg(&target, ELBOW, angle_deg), GROBO_OK);
    target.time_us = time_us;
    return grobo_robot_move(grobo_session_robot(session), &target);
}

static grobo_sim_view look(void)
{
    grobo_sim_view view;

    assert_int_equal(grobo_sim_look(grobo_sim_server_sim(server), ELBOW, &view), 0);
    return view;
}

/* Refuses everything that moves or switches torque on, and nothing else. */
static void assert_latched(grobo_session *session)
{
    assert_int_equal(move(session, -20, 500000), GROBO_ERR_LATCHED);
    assert_int_equal(
        grobo_robot_torque(grobo_session_robot(session), GROBO_JOINT_BIT(ELBOW), GROBO_TORQUE_ON),
        GROBO_ERR_LATCHED);
    assert_int_equal(grobo_robot_free(grobo_session_robot(session), GROBO_JOINT_BIT(ELBOW), true),
                     GROBO_ERR_LATCHED);
    assert_true(grobo_robot_sense(grobo_session_robot(session), GROBO_JOINT_BIT(ELBOW),
                                  GROBO_SENSE_FULL) > 0);
    loop_run_for(base, 100000);
}

static grobo_estop_holder ask(const grobo_estop *stop)
{
    grobo_estop_holder holder;

    assert_int_equal(grobo_estop_ask(device, stop, &holder), GROBO_OK);
    return holder;
}

/* ---- a mark that stands ------------------------------------------------------------------- */

TEST_WITH(fixture, one_that_did_not_reach_the_robot_does_when_a_session_opens)
{
    grobo_estop stop;
    grobo_session *session;

    assert_int_equal(grobo_estop_set(device, &stop, NULL), GROBO_OK);
    assert_true(grobo_estop_stands(device));
    assert_int_equal(ask(&stop).answer, GROBO_ESTOP_NOBODY);
    session = open_session();
    assert_int_equal(at.estops, 1);
    assert_int_equal(at.result, GROBO_OK);
    assert_int_equal(look().torque, GROBO_TORQUE_BRAKE);
    assert_int_equal(ask(&stop).answer, GROBO_ESTOP_DONE);
    assert_latched(session);
    grobo_session_free(session);
}

TEST_WITH(fixture, one_that_did_latches_and_sends_nothing)
{
    grobo_session *session;

    assert_int_equal(grobo_estop_set(device, NULL, NULL), GROBO_OK);
    grobo_session_free(open_session());
    assert_int_equal(at.estops, 1);
    session = open_session();
    assert_latched(session);
    loop_run_for(base, 3 * GROBO_ESTOP_WATCH_US);
    assert_int_equal(at.estops, 1);
    grobo_session_free(session);
}

TEST_WITH(fixture, a_reset_clears_it_for_all)
{
    grobo_session *session;

    assert_int_equal(grobo_estop_set(device, NULL, NULL), GROBO_OK);
    session = open_session();
    assert_latched(session);
    assert_int_equal(grobo_robot_reset(grobo_session_robot(session)), GROBO_OK);
    assert_false(grobo_estop_stands(device));
    assert_true(move(session, -5, 200000) > 0);
    grobo_session_free(session);
    session = open_session();
    assert_true(move(session, 0, 200000) > 0);
    grobo_session_free(session);
    assert_int_equal(at.estops, 1);
}

/* Not restarted by somebody else's hand: ISO 13850. */
TEST_WITH(fixture, cleared_by_another_program_the_session_stays_latched)
{
    grobo_session *session;

    session = open_session();
    assert_int_equal(grobo_estop_set(device, NULL, NULL), GROBO_OK);
    loop_run_until(base, &at.estops, 1);
    assert_int_equal(grobo_estop_clear(device, NULL), GROBO_OK);
    loop_run_for(base, 3 * GROBO_ESTOP_WATCH_US);
    assert_latched(session);
    assert_int_equal(grobo_robot_reset(grobo_session_robot(session)), GROBO_OK);
    assert_true(move(session, -5, 200000) > 0);
    grobo_session_free(session);
}

/* The stop of a reason of the engine's own is no answer to a mark. */
TEST_WITH(fixture, a_reset_obeys_a_mark_that_was_just_set)
{
    grobo_session *session = open_session();

    assert_int_equal(grobo_estop_set(device, NULL, NULL), GROBO_OK);
    assert_int_equal(grobo_robot_reset(grobo_session_robot(session)), GROBO_ERR_STATE);
    assert_true(grobo_estop_stands(device));
    loop_run_until(base, &at.estops, 1);
    assert_latched(session);
    grobo_session_free(session);
}

/* Between the look of a reset and its end another program may set one. */
TEST_WITH(fixture, one_that_was_not_heard_is_not_cleared)
{
    static grobo_i_estop_watch watch;
    grobo_os_cause cause;
    bool pending = false;

    memset(&watch, 0, sizeof watch);
    grobo_i_estop_watch_begin(&watch, device);
    assert_int_equal(grobo_estop_set(device, NULL, &cause), GROBO_OK);
    assert_true(grobo_i_estop_watch_look(&watch, &pending));
    assert_int_equal(grobo_estop_set(device, NULL, &cause), GROBO_OK);
    assert_int_equal(grobo_i_estop_watch_clear(&watch, &cause), GROBO_ERR_STATE);
    assert_true(grobo_estop_stands(device));
    assert_true(grobo_i_estop_watch_look(&watch, &pending));
    assert_true(pending);
    assert_int_equal(grobo_i_estop_watch_clear(&watch, &cause), GROBO_OK);
    assert_false(grobo_estop_stands(device));
    grobo_i_estop_watch_end(&watch);
}

TEST_WITH(fixture, a_runner_obeys_it_too)
{
    /* The simulator runs on this thread's loop, not while this thread waits. */
    const grobo_runner_config config = {
        GROBO_RUNNER_CONFIG_INIT,
        .session = &(grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = device},
        .skip_exit = true};
    grobo_runner *runner;
    grobo_estop stop;

    assert_int_equal(grobo_runner_new(&config, &runner), GROBO_OK);
    assert_int_equal(grobo_runner_start(runner), GROBO_OK);
    assert_int_equal(grobo_runner_open(runner), GROBO_OK);
    for (int i = 0; i < 1000 && !grobo_runner_is_connected(runner); i++) {
        (void)loop_run(base, 10000);
    }
    assert_int_equal(grobo_estop_set(device, &stop, NULL), GROBO_OK);
    for (int i = 0; i < 1000 && ask(&stop).answer != GROBO_ESTOP_DONE; i++) {
        (void)loop_run(base, 10000);
    }
    assert_int_equal(ask(&stop).answer, GROBO_ESTOP_DONE);
    assert_int_equal(look().torque, GROBO_TORQUE_BRAKE);
    for (int i = 0; i < 1000 && grobo_runner_reset(runner) != GROBO_OK; i++) {
        (void)loop_run(base, 10000);
    }
    assert_false(grobo_estop_stands(device));
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
}

/* ---- while a session is open -------------------------------------------------------------- */

TEST_WITH(fixture, a_moving_robot_stops)
{
    grobo_session *session = open_session();
    grobo_estop stop;
    int32_t before_mdeg = look().angle_mdeg;
    int64_t set_us;

    assert_true(grobo_robot_torque(grobo_session_robot(session), GROBO_JOINT_BIT(ELBOW),
                                   GROBO_TORQUE_ON) > 0);
    loop_run_for(base, 300000);
    assert_true(move(session, -100, 20000000) > 0);
    for (int i = 0; i < 1000 && look().angle_mdeg > before_mdeg - 3000; i++) {
        loop_run_for(base, 10000);
    }
    assert_true(look().angle_mdeg <= before_mdeg - 3000);
    before_mdeg = look().angle_mdeg;
    assert_int_equal(grobo_estop_set(device, &stop, NULL), GROBO_OK);
    set_us = grobo_now_us();
    loop_run_until(base, &at.estops, 1);
    print_message("# from the mark to the verified stop: %d ms\n",
                  (int)((grobo_now_us() - set_us) / 1000));
    assert_int_equal(at.result, GROBO_OK);
    assert_int_equal(look().torque, GROBO_TORQUE_BRAKE);
    assert_true(before_mdeg - look().angle_mdeg < 3000);
    assert_int_equal(ask(&stop).answer, GROBO_ESTOP_DONE);
    assert_latched(session);
    grobo_session_free(session);
    assert_int_equal(ask(NULL).answer, GROBO_ESTOP_NOBODY);
}

TEST_WITH(fixture, a_second_mark_is_answered_too)
{
    grobo_session *session = open_session();
    grobo_estop first;
    grobo_estop second;

    assert_int_equal(grobo_estop_set(device, &first, NULL), GROBO_OK);
    loop_run_until(base, &at.estops, 1);
    assert_int_equal(grobo_estop_set(device, &second, NULL), GROBO_OK);
    assert_string_not_equal(first.id, second.id);
    assert_int_equal(ask(&second).answer, GROBO_ESTOP_SILENT);
    loop_run_until(base, &at.estops, 2);
    assert_int_equal(ask(&second).answer, GROBO_ESTOP_DONE);
    grobo_session_free(session);
}

TEST_WITH(fixture, a_session_that_reads_nothing_sleeps)
{
    const grobo_robot_config robot = {GROBO_ROBOT_CONFIG_INIT,
                                      .sense_interval_us = GROBO_SENSE_NEVER};
    const grobo_session_config config = {
        GROBO_SESSION_CONFIG_INIT, .base = base,    .device = device, .on_event = on_event,
        .on_robot = on_robot,      .robot = &robot, .ctx = &at};
    grobo_socket watch = grobo_i_note_watch_open();
    grobo_session *session = NULL;
    grobo_estop stop;

    grobo_i_note_watch_close(watch);
    if (watch == GROBO_SOCKET_NULL) {
        skip(); /* the marks are looked at by the clock */
    }
    assert_int_equal(grobo_session_new(&config, &session), GROBO_OK);
    assert_int_equal(grobo_session_open(session), GROBO_OK);
    loop_run_until(base, &at.ups, 1);
    loop_run_for(base, 200000); /* what it asks for at the beginning */
    assert_int_equal(grobo_i_session_estop_deadline(session), GROBO_NEVER_US);
    assert_int_equal(grobo_robot_deadline(&session->robot, grobo_now_us()), GROBO_NEVER_US);
    assert_int_equal(grobo_estop_set(device, &stop, NULL), GROBO_OK);
    loop_run_until(base, &at.estops, 1);
    assert_int_equal(ask(&stop).answer, GROBO_ESTOP_DONE);
    grobo_session_free(session);
}

/* A program that was stopped, or busy: the mark comes before whatever was due meanwhile. */
TEST_WITH(fixture, who_was_held_up_looks_before_it_sends)
{
    grobo_session *session = open_session();
    uint8_t stop_frame[FRAME_BYTES];
    size_t stop_bytes;
    int64_t end_us;

    at.listens = true;
    assert_true(grobo_robot_estop(grobo_session_robot(session)) > 0);
    stop_bytes = at.size;
    assert_true(stop_bytes > 0);
    memcpy(stop_frame, at.frame, stop_bytes);
    loop_run_until(base, &at.estops, 1);
    assert_int_equal(grobo_robot_reset(grobo_session_robot(session)), GROBO_OK);
    loop_run_for(base, 200000);

    end_us = grobo_now_us() + 4 * GROBO_ESTOP_WATCH_US;
    while (grobo_now_us() < end_us) { /* the loop stands still */
        (void)grobo_port_wait(GROBO_SOCKET_NULL, 0, 1000);
    }
    assert_int_equal(grobo_estop_set(device, NULL, NULL), GROBO_OK);
    at.listens = true;
    (void)move(session, -30, 500000);
    loop_run_until(base, &at.estops, 2);
    assert_int_equal(at.size, stop_bytes);
    assert_memory_equal(at.frame, stop_frame, stop_bytes);
    grobo_session_free(session);
}

/* An emergency stop that the session hears behind the loss of its line. */
static void hear_without_a_line(grobo_estop *stop)
{
    assert_int_equal(grobo_sim_server_plug(server, false), GROBO_OK);
    loop_run_until(base, &at.losts, 1);
    assert_int_equal(grobo_estop_set(device, stop, NULL), GROBO_OK);
    for (int i = 0; i < 200 && ask(stop).answer == GROBO_ESTOP_SILENT; i++) {
        loop_run_for(base, 10000);
    }
    assert_int_equal(ask(stop).answer, GROBO_ESTOP_HEARD);
}

TEST_WITH(fixture, without_a_line_it_is_carried_out_when_that_is_back)
{
    grobo_session *session = open_session();
    grobo_estop stop;

    hear_without_a_line(&stop);
    assert_int_equal(grobo_sim_server_plug(server, true), GROBO_OK);
    loop_run_until(base, &at.ups, 2);
    assert_int_equal(at.estops, 1);
    assert_int_equal(ask(&stop).answer, GROBO_ESTOP_DONE);
    assert_latched(session);
    grobo_session_free(session);
}

/* The program that heard it has exited before it could send it. */
TEST_WITH(fixture, the_next_session_carries_out_what_one_owed)
{
    grobo_session *session = open_session();
    grobo_estop stop;

    hear_without_a_line(&stop);
    grobo_session_free(session);
    assert_int_equal(ask(&stop).answer, GROBO_ESTOP_NOBODY);
    assert_int_equal(grobo_sim_server_plug(server, true), GROBO_OK);
    session = open_session();
    assert_int_equal(at.estops, 1);
    assert_int_equal(look().torque, GROBO_TORQUE_BRAKE);
    assert_int_equal(ask(&stop).answer, GROBO_ESTOP_DONE);
    grobo_session_free(session);
}

/* ---- who has it --------------------------------------------------------------------------- */

TEST_WITH(fixture, a_loop_that_stands_still_is_silent)
{
    grobo_session *session = open_session();
    grobo_estop stop;
    grobo_i_process self;

    grobo_i_process_self(&self);
    assert_int_equal(grobo_estop_set(device, &stop, NULL), GROBO_OK);
    assert_int_equal(ask(&stop).answer, GROBO_ESTOP_SILENT);
    assert_int_equal(ask(&stop).pid, self.pid);
    assert_false(ask(&stop).stopped);
    grobo_session_free(session);
}

/* A number that another process has by now is not the one that registered. */
TEST_WITH(fixture, a_process_that_has_exited_has_nothing)
{
    char note[NOTE_NAME_BYTES];
    char text[64];
    grobo_i_process self;
    grobo_os_cause cause;

    snprintf(note, sizeof note, "holder-%.200s", device);
    for (char *c = note; *c != '\0'; c++) {
        *c = *c == ':' ? '!' : *c;
    }
    grobo_i_process_self(&self);
    snprintf(text, sizeof text, "%d %llu\n", self.pid, (unsigned long long)self.started);
    assert_true(grobo_i_note_write(note, text, &cause) > 0);
    assert_int_equal(ask(NULL).answer, GROBO_ESTOP_SILENT);
    if (self.started != 0) {
        snprintf(text, sizeof text, "%d %llu\n", self.pid, (unsigned long long)self.started - 1);
        assert_true(grobo_i_note_write(note, text, &cause) > 0);
        assert_int_equal(ask(NULL).answer, GROBO_ESTOP_NOBODY);
    }
    assert_int_equal(grobo_i_note_remove(note, &cause), GROBO_OK);
}

TEST_WITH(fixture, what_callers_get_wrong)
{
    char name[2 * GROBO_DEVICE_MAX_BYTES];
    grobo_estop_holder holder;

    memset(name, 'x', sizeof name);
    name[sizeof name - 1] = '\0';
    assert_int_equal(grobo_estop_set(NULL, NULL, NULL), GROBO_ERR_ARG);
    assert_int_equal(grobo_estop_set("", NULL, NULL), GROBO_ERR_ARG);
    assert_int_equal(grobo_estop_set(GROBO_DEVICE_AUTO, NULL, NULL), GROBO_ERR_ARG);
    assert_int_equal(grobo_estop_set(name, NULL, NULL), GROBO_ERR_ARG);
    assert_int_equal(grobo_estop_clear(NULL, NULL), GROBO_ERR_ARG);
    assert_false(grobo_estop_stands(NULL));
    assert_int_equal(grobo_estop_ask(device, NULL, NULL), GROBO_ERR_ARG);
    assert_int_equal(grobo_estop_ask(GROBO_DEVICE_AUTO, NULL, &holder), GROBO_ERR_ARG);
    assert_int_equal(grobo_estop_set(GROBO_DEVICE_SIM, NULL, NULL), GROBO_OK);
    assert_false(grobo_estop_stands(GROBO_DEVICE_SIM));
}

/* A name as long as they come, of a device that is not there. */
TEST_WITH(fixture, a_long_name_is_marked)
{
    char name[GROBO_DEVICE_MAX_BYTES];
    char other[GROBO_DEVICE_MAX_BYTES];

    memset(name, 'x', sizeof name);
    memcpy(name, "/nowhere/", 9);
    name[sizeof name - 1] = '\0';
    memcpy(other, name, sizeof other);
    other[10] = 'y';
    assert_int_equal(grobo_estop_set(name, NULL, NULL), GROBO_OK);
    assert_true(grobo_estop_stands(name));
    assert_false(grobo_estop_stands(other));
    assert_int_equal(grobo_estop_clear(name, NULL), GROBO_OK);
    assert_false(grobo_estop_stands(name));
}
