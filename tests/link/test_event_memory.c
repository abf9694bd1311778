/* SPDX-License-Identifier: MIT */
/*
 * libevent's own allocations fail, the n-th alone or all from there on: a session and a runner
 * are made, opened, move and end, or say that memory lacks. Nothing hangs, nothing goes on moving.
 */
#include <math.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>

#include <event2/event.h>

#include <grobo/core/loop.h>
#include <grobo/core/port.h>
#include <grobo/core/runner.h>
#include <grobo/session.h>
#include <grobo/sim_server.h>

#include "tests/support/test.h"

enum { ELBOW = 13, OTHERS = 7, BOUND_US = 5000000 };

/* ---- memory that fails ----------------------------------------------------------------------- */

static atomic_size_t asked, fail_at;
static atomic_bool fails_on;

static bool fails(void)
{
    size_t n = atomic_fetch_add(&asked, 1) + 1, at = atomic_load(&fail_at);
    return at > 0 && (n == at || (n > at && atomic_load(&fails_on)));
}

static void *take(size_t size)
{
    return fails() ? NULL : malloc(size);
}

static void *more(void *old, size_t size)
{
    return fails() ? NULL : realloc(old, size);
}

static void begin_failing(size_t at, bool on)
{
    atomic_store(&asked, 0);
    atomic_store(&fails_on, on);
    atomic_store(&fail_at, at);
}

/* ---- a session ------------------------------------------------------------------------------- */

static struct {
    bool up, over;
    int error, job;
    bool job_over;
    int job_result;
} told;

static void on_session(void *ctx, grobo_session *session, grobo_session_event event, int error)
{
    (void)ctx;
    (void)session;
    told.up = told.up || event == GROBO_SESSION_EVENT_UP;
    if (event == GROBO_SESSION_EVENT_FAILED || event == GROBO_SESSION_EVENT_LOST) {
        told.over = true;
        told.error = error;
    }
}

static void on_robot(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_EVENT_JOB && event->u.job.number == told.job) {
        told.job_over = true;
        told.job_result = event->u.job.result;
    }
}

static void on_beat(evutil_socket_t fd, short what, void *ctx)
{
    (void)fd;
    (void)what;
    (void)ctx;
}

/* Runs the loop until *done or the session is over; its beat ends a round that would last for
 * ever. */
static int run_until(struct event_base *base, const bool *done)
{
    int64_t end_us = grobo_now_us() + BOUND_US;
    while (!*done && !told.over && grobo_now_us() < end_us) {
        event_base_loop(base, EVLOOP_ONCE);
    }
    assert_true(*done || told.over);
    return *done ? GROBO_OK : told.error;
}

static int move_once(struct event_base *base, grobo_session *session)
{
    grobo_posture target;
    assert_int_equal(grobo_posture_init(&target, 20), GROBO_OK);
    assert_int_equal(grobo_posture_set_deg(&target, ELBOW, 1), GROBO_OK);
    target.time_us = 20000;
    told.job = grobo_robot_move(grobo_session_robot(session), &target);
    assert_true(told.job > 0);
    int r = run_until(base, &told.job_over);
    return r < 0 ? r : told.job_result;
}

static int open_and_move(struct event_base *base, const char *device)
{
    const grobo_session_config config = {GROBO_SESSION_CONFIG_INIT, .base = base,
                                         .device = device,          .baud_bps = 1000000,
                                         .on_event = on_session,    .on_robot = on_robot};
    const struct timeval period = {0, 20000};
    grobo_session *session;
    struct event *beat = event_new(base, -1, EV_PERSIST, on_beat, NULL);
    if (beat == NULL || event_add(beat, &period) != 0) {
        free(beat);
        return GROBO_ERR_NOMEM;
    }
    int r = grobo_session_new(&config, &session);
    if (r < 0) {
        event_free(beat);
        return r;
    }
    r = grobo_session_open(session);
    r = r < 0 ? r : run_until(base, &told.up);
    r = r < 0 ? r : move_once(base, session);
    assert_int_equal(grobo_robot_moving(grobo_session_robot(session)), 0);
    grobo_session_close(session);
    grobo_session_free(session);
    event_free(beat);
    return r;
}

static void on_other(void *ctx, grobo_timer *timer, int64_t late_us)
{
    (void)ctx;
    (void)timer;
    (void)late_us;
}

/* Timers of the user's own and the beat fill what libevent has at first, for 8: the session's needs
 * more. */
static int with_others(struct event_base *base, int count, const char *device)
{
    grobo_timer *others[OTHERS] = {NULL};
    int r = GROBO_OK;
    for (int i = 0; i < count && r >= 0; i++) {
        r = grobo_timer_new(base, on_other, NULL, NULL, &others[i]);
        r = r < 0 ? r : grobo_timer_set(others[i], grobo_now_us() + INT64_C(3600000000));
    }
    r = r < 0 ? r : open_and_move(base, device);
    for (int i = 0; i < OTHERS; i++) {
        grobo_timer_free(others[i]);
    }
    return r;
}

static int in_process(void)
{
    struct event_base *base = grobo_loop_new();
    if (base == NULL) {
        return GROBO_ERR_NOMEM;
    }
    told.up = told.over = told.job_over = false;
    int r = with_others(base, OTHERS, GROBO_DEVICE_SIM);
    event_base_free(base);
    return r;
}

/* A simulator behind a pseudo-terminal, on the same loop. */
static int behind_a_port(void)
{
    struct event_base *base = grobo_loop_new();
    grobo_sim_server *server;
    if (base == NULL) {
        return GROBO_ERR_NOMEM;
    }
    told.up = told.over = told.job_over = false;
    const grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .baud_bps = 1000000};
    const grobo_sim_server_config config = {GROBO_SIM_SERVER_CONFIG_INIT, .base = base,
                                            .sim = &sim};
    int r = grobo_sim_server_new(&config, &server, NULL);
    if (r >= 0) {
        r = with_others(base, OTHERS - 1, grobo_sim_server_device(server)); /* it has a timer */
        grobo_sim_server_free(server);
    }
    event_base_free(base);
    return r;
}

/* ---- a runner ------------------------------------------------------------------------------- */

static int threaded(void)
{
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM,
                                          .baud_bps = 1000000};
    const grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session};
    grobo_runner *runner;
    int r = grobo_runner_new(&config, &runner);
    if (r < 0) {
        return r;
    }
    r = grobo_runner_start(runner);
    r = r < 0 ? r : grobo_runner_connect(runner, BOUND_US);
    if (r >= 0) {
        grobo_posture target;
        assert_int_equal(grobo_posture_init(&target, 20), GROBO_OK);
        assert_int_equal(grobo_posture_set_deg(&target, ELBOW, 1), GROBO_OK);
        target.time_us = 20000;
        int job = grobo_robot_move(grobo_runner_robot(runner), &target);
        r = grobo_runner_wait_job(runner, job, BOUND_US);
        r = r < 0 ? r : grobo_runner_wait(runner, BOUND_US);
        assert_false(grobo_robot_moving(grobo_runner_robot(runner)));
    }
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    return r;
}

/* ---- each of them ---------------------------------------------------------------------------- */

static void each_fails(int (*run)(void))
{
    begin_failing(0, false);
    assert_int_equal(run(), GROBO_OK);
    size_t all = atomic_load(&asked);
    print_message("%zu allocations\n", all);
    assert_true(all > 5);
    for (size_t n = 1; n <= all; n++) {
        for (int on = 0; on < 2; on++) {
            int64_t began_us = grobo_now_us();
            begin_failing(n, on);
            int r = run();
            begin_failing(0, false);
            if (r != GROBO_OK && r != GROBO_ERR_NOMEM) {
                print_message("%zu%s: %s\n", n, on ? " and on" : "", grobo_error_name(r));
            }
            assert_true(r == GROBO_OK || r == GROBO_ERR_NOMEM);
            assert_true(grobo_now_us() - began_us < BOUND_US);
        }
    }
}

TEST(a_session_without_memory_of_the_loop)
{
    each_fails(in_process);
}

TEST(nor_behind_a_port)
{
    each_fails(behind_a_port);
}

TEST(nor_with_a_thread)
{
    each_fails(threaded);
}

static void quiet(int severity, const char *text)
{
    (void)severity;
    (void)text;
}

int main(int argc, char **argv)
{
    event_set_mem_functions(take, more, free);
    event_set_log_callback(quiet);
    return test_main(argc, argv);
}
