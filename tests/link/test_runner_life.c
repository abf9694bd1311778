/* SPDX-License-Identifier: MIT */
/* The life of a runner: its thread or the caller's, its rounds, its end; one caller at a time. */
#include <stdint.h>
#include <stdio.h>

#include "tests/support/runner_kit.h"
#include "tests/support/test.h"

enum { CALLS = 100 };

/* Under `runner`'s exclusion, or asked for when nothing runs. */
static int rounds; /* of on_svc */
static int exits;  /* exit policies that were carried out */
static int inside, together, calls;

static int on_svc(void *arg, grobo_runner *from)
{
    assert_ptr_equal(from, runner);
    assert_ptr_equal(arg, &rounds);
    rounds++;
    return 0;
}

static void on_robot(void *ctx, const grobo_event *event)
{
    assert_ptr_equal(ctx, &rounds);
    if (event->kind == GROBO_EVENT_JOB && event->u.job.kind == GROBO_JOB_EXIT) {
        assert_int_equal(event->u.job.result, GROBO_OK);
        exits++;
    }
}

static void make_with(int64_t period_us)
{
    static const grobo_robot_config robot = {GROBO_ROBOT_CONFIG_INIT, .on_exit = GROBO_EXIT_OFF};
    const grobo_runner_config config = {
        GROBO_RUNNER_CONFIG_INIT,
        .session = &(grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM,
                                           .baud_bps = 1000000, .robot = &robot,
                                           .on_robot = on_robot, .ctx = &rounds},
        .period_us = period_us, .on_svc = on_svc};
    rounds = exits = inside = together = calls = 0;
    assert_int_equal(grobo_runner_new(&config, &runner), GROBO_OK);
}

static void make(void)
{
    make_with(2000);
}

static int rounds_so_far(void *arg, grobo_runner *from)
{
    (void)from;
    (void)arg;
    return rounds;
}

/* Waits until the loop has gone round n times. */
static void await_rounds(int n)
{
    int64_t end_us = grobo_now_us() + 5000000;
    while (grobo_runner_call(runner, rounds_so_far, NULL) < n) {
        assert_true(grobo_now_us() < end_us);
    }
}

static int torque_on(void)
{
    return runner_torque(runner, GROBO_JOINTS_ALL(20), GROBO_TORQUE_ON, 0);
}

/* On the loop: whether its thread is this one. */
static int is_self(void *arg, grobo_runner *from)
{
    const grobo_thread *thread = arg;

    (void)from;
    return grobo_thread_is_self(*thread);
}

TEST(the_thread_runs_until_it_is_told_to_stop)
{
    grobo_thread thread;

    make();
    assert_false(grobo_runner_is_active(runner));
    assert_int_equal(grobo_runner_stop(runner), GROBO_ERR_STATE);
    assert_int_equal(grobo_runner_thread(runner, &thread), GROBO_ERR_STATE);
    assert_int_equal(grobo_runner_start(runner), GROBO_OK);
    assert_true(grobo_runner_is_active(runner));
    assert_int_equal(grobo_runner_start(runner), GROBO_ERR_STATE);
    assert_int_equal(grobo_runner_thread(runner, &thread), GROBO_OK);
    assert_false(grobo_thread_is_self(thread));
    assert_int_equal(grobo_runner_call(runner, is_self, &thread), 1);
    await_rounds(5);

    assert_int_equal(grobo_runner_connect(runner, 0), GROBO_OK);
    assert_int_equal(torque_on(), GROBO_OK);
    assert_int_equal(grobo_runner_stop(runner), GROBO_OK);
    assert_false(grobo_runner_is_active(runner));
    assert_int_equal(exits, 1); /* and the port stayed open */
    assert_int_equal(runner_torque_of(runner, 0), GROBO_TORQUE_OFF);
    assert_true(grobo_runner_is_connected(runner));
    assert_int_equal(grobo_runner_start(runner), GROBO_OK); /* again */
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
}

/* On the loop: the thread is asked to stop, and ends behind this function. */
static int stop_inside(void *arg, grobo_runner *from)
{
    (void)arg;
    assert_true(grobo_runner_is_active(from));
    assert_int_equal(grobo_runner_stop(from), GROBO_OK);
    return grobo_runner_is_active(from) ? 1 : 0;
}

TEST(a_thread_that_was_asked_to_stop_is_not_active)
{
    make();
    assert_int_equal(grobo_runner_start(runner), GROBO_OK);
    assert_int_equal(grobo_runner_call(runner, stop_inside, NULL), 0);
    assert_false(grobo_runner_is_active(runner));
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
}

TEST(closing_lets_the_robot_go_first)
{
    for (int threaded = 0; threaded < 2; threaded++) {
        make();
        if (threaded) {
            assert_int_equal(grobo_runner_start(runner), GROBO_OK);
        }
        assert_int_equal(grobo_runner_connect(runner, 0), GROBO_OK);
        assert_int_equal(torque_on(), GROBO_OK);
        assert_int_equal(grobo_runner_close(runner, 0), GROBO_OK);
        assert_int_equal(exits, 1);
        assert_int_equal(grobo_runner_free(runner), GROBO_OK);
        assert_int_equal(exits, 1);
    }
}

TEST(freeing_lets_the_robot_go_first)
{
    for (int threaded = 0; threaded < 2; threaded++) {
        make();
        if (threaded) {
            assert_int_equal(grobo_runner_start(runner), GROBO_OK);
        }
        assert_int_equal(grobo_runner_connect(runner, 0), GROBO_OK);
        assert_int_equal(torque_on(), GROBO_OK);
        assert_int_equal(grobo_runner_free(runner), GROBO_OK);
        assert_int_equal(exits, 1);
    }
}

TEST(rounds_are_made_by_whoever_asks)
{
    make();
    int64_t end_us = grobo_now_us() + 5000000;
    while (rounds < 5) {
        assert_int_equal(grobo_runner_svc(runner), 1);
        assert_true(grobo_now_us() < end_us);
    }
    assert_int_equal(grobo_runner_start(runner), GROBO_OK);
    assert_int_equal(grobo_runner_svc(runner), 0); /* the thread makes them */
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
}

/* How long n more rounds take. */
static int64_t time_of_rounds(int n)
{
    int64_t begun_us = grobo_now_us();
    await_rounds(grobo_runner_call(runner, rounds_so_far, NULL) + n);
    return grobo_now_us() - begun_us;
}

TEST(rounds_keep_the_period_that_is_set)
{
    make_with(100000);
    assert_int_equal(grobo_runner_start(runner), GROBO_OK);
    assert_true(time_of_rounds(4) > 250000); /* the first is under way already */
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    make();
    assert_int_equal(grobo_runner_start(runner), GROBO_OK);
    int64_t end_us = grobo_now_us() + 5000000;
    while (time_of_rounds(4) > 100000) { /* on a busy machine another time */
        assert_true(grobo_now_us() < end_us);
    }
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
}

static int run_result;

static GROBO_THREAD_FUNC run_it(void *arg)
{
    run_result = grobo_runner_run(arg);
    GROBO_THREAD_RETURN;
}

TEST(the_loop_runs_on_a_thread_of_ones_own)
{
    grobo_thread mine;
    grobo_thread none;

    make();
    assert_int_equal(grobo_thread_start(&mine, run_it, runner), GROBO_OK);
    int64_t end_us = grobo_now_us() + 5000000;
    while (!grobo_runner_is_active(runner)) {
        assert_true(grobo_now_us() < end_us);
    }
    await_rounds(5);
    assert_int_equal(grobo_runner_run(runner), GROBO_ERR_STATE);
    assert_int_equal(grobo_runner_thread(runner, &none), GROBO_ERR_STATE);
    assert_int_equal(grobo_runner_stop(runner), GROBO_OK);
    assert_int_equal(grobo_thread_join(mine), GROBO_OK);
    assert_int_equal(run_result, GROBO_OK);
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
}

/* Would be entered by two at a time if callers were not kept apart. */
static int count_call(void *arg, grobo_runner *from)
{
    (void)from;
    (void)arg;
    int64_t end_us = grobo_now_us() + 100;
    together += inside;
    inside++;
    calls++;
    while (grobo_now_us() < end_us) { /* long enough for another to come in, if it could */
    }
    inside--;
    return calls;
}

static GROBO_THREAD_FUNC call_often(void *arg)
{
    int *failed = arg;
    for (int i = 0; i < CALLS; i++) {
        *failed += grobo_runner_call(runner, count_call, NULL) < 1;
    }
    GROBO_THREAD_RETURN;
}

TEST(callers_are_kept_apart)
{
    for (int threaded = 0; threaded < 2; threaded++) {
        grobo_thread thread[3];
        int failed[3] = {0, 0, 0};
        make();
        if (threaded) {
            assert_int_equal(grobo_runner_start(runner), GROBO_OK);
        }
        for (int i = 0; i < 3; i++) {
            assert_int_equal(grobo_thread_start(&thread[i], call_often, &failed[i]), GROBO_OK);
        }
        for (int i = 0; i < 3; i++) {
            assert_int_equal(grobo_thread_join(thread[i]), GROBO_OK);
            assert_int_equal(failed[i], 0);
        }
        assert_int_equal(calls, 3 * CALLS);
        assert_int_equal(together, 0);
        assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    }
}

/* A thread that cannot be what it asked for is none; the runner works on as without one. */
TEST(a_realtime_that_is_refused)
{
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM};
    grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session,
                                  .realtime = {.policy = GROBO_REALTIME_FIFO}};
    int torque = 0;

    assert_int_equal(grobo_runner_new(&config, &runner), GROBO_OK);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(grobo_runner_start(runner), GROBO_ERR_ARG);
        assert_false(grobo_runner_is_active(runner));
        assert_int_equal(grobo_runner_run(runner), GROBO_ERR_ARG);
        assert_false(grobo_runner_is_active(runner));
    }
    assert_int_equal(grobo_runner_stop(runner), GROBO_ERR_STATE);
    assert_int_equal(grobo_runner_connect(runner, 0), GROBO_OK);
    torque = grobo_robot_torque(grobo_runner_robot(runner), GROBO_JOINTS_ALL(20), GROBO_TORQUE_ON);
    assert_int_equal(grobo_runner_wait_job(runner, torque, 0), GROBO_OK);
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
}

static int keeps_to_a_cpu(void *arg, grobo_runner *from)
{
    char line[256];
    unsigned long long mask = 0;
    FILE *file = fopen("/proc/thread-self/status", "r");

    (void)from;
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        (void)sscanf(line, "Cpus_allowed: %llx", &mask);
    }
    if (file != NULL) {
        (void)fclose(file);
    }
    *(bool *)arg = mask == 1;
    return GROBO_OK;
}

/* Granted when the start returns, to that thread alone; and again after a stop. */
TEST(a_realtime_that_is_granted)
{
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM};
    const grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session,
                                        .realtime = {.cpus = 1}};

    assert_int_equal(grobo_runner_new(&config, &runner), GROBO_OK);
    for (int i = 0; i < 2; i++) {
        bool kept = false;
        int r = grobo_runner_start(runner);

        if (r == GROBO_ERR_NOTFOUND || r == GROBO_ERR_UNSUPPORTED) {
            assert_int_equal(grobo_runner_free(runner), GROBO_OK);
            skip();
        }
        assert_int_equal(r, GROBO_OK);
        assert_int_equal(grobo_runner_call(runner, keeps_to_a_cpu, &kept), GROBO_OK);
        assert_true(kept);
        assert_int_equal(grobo_runner_start(runner), GROBO_ERR_STATE);
        assert_int_equal(grobo_runner_stop(runner), GROBO_OK);
    }
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
}
