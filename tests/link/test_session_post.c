/* SPDX-License-Identifier: MIT */
/* Stops that signal handlers post, to a runner and to a session, with nothing to be had. */
#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <stdint.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <event2/event.h>

#include <grobo/core/robot.h>

#include "src/link/runner/runner.h"
#include "src/link/session/session.h"
#include "tests/support/hold.h"
#include "tests/support/loop.h"
#include "tests/support/runner_kit.h"
#include "tests/support/session_kit.h"
#include "tests/support/test.h"

enum { ERRNO = 4711, SLOW_US = GROBO_CALLBACK_SLOW_US + 5000 };

static hold gate;

/* What the handler found. */
static volatile sig_atomic_t handled, failed;

static void on_signal(int number)
{
    int kept = errno;

    errno = ERRNO;
    if (number == SIGUSR1) {
        failed = grobo_runner_estop(runner) < 0 || !grobo_runner_is_latched(runner);
    } else {
        failed = grobo_runner_post_stop(runner, true) < 0 ||
                 grobo_runner_post_exit(runner, GROBO_EXIT_OFF) < 0;
    }
    failed = failed || errno != ERRNO;
    handled++;
    errno = kept;
}

static void have_handlers(void)
{
    const struct sigaction action = {.sa_handler = on_signal};

    handled = failed = 0;
    assert_int_equal(sigaction(SIGUSR1, &action, NULL), 0);
    assert_int_equal(sigaction(SIGUSR2, &action, NULL), 0);
}

static void have_descriptors(bool any)
{
    static struct rlimit before;
    static bool taken;
    struct rlimit none;

    if (any && taken) {
        assert_int_equal(setrlimit(RLIMIT_NOFILE, &before), 0);
        taken = false;
    } else if (!any) {
        taken = true;
        assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
        none = before;
        none.rlim_cur = 1;
        assert_int_equal(setrlimit(RLIMIT_NOFILE, &none), 0);
    }
}

/* What grobo_runner_new() returns in a child that may have so many descriptors more. */
static int new_with_descriptors(rlim_t more)
{
    grobo_session_config on_sim = {GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM};
    const grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &on_sim, .events = 1};
    int status = 0;
    pid_t child = fork();

    if (child == 0) {
        grobo_runner *made = NULL;
        int next = dup(0);
        const struct rlimit few = {(rlim_t)next + more, (rlim_t)next + more};

        (void)close(next);
        int r = setrlimit(RLIMIT_NOFILE, &few) == 0 ? grobo_runner_new(&config, &made) : -100;
        _exit(-r);
    }
    assert_true(child > 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    return -WEXITSTATUS(status);
}

/* libevent ends a program that has no descriptor for a loop: the library returns before. */
TEST(no_descriptor_for_a_loop_is_an_error)
{
    for (rlim_t more = 0; more < 8; more++) { /* a loop and two pairs need them */
        assert_int_equal(new_with_descriptors(more), GROBO_ERR_NOMEM);
    }
    assert_int_equal(new_with_descriptors(16), GROBO_OK);
}

/* ---- a runner ---------------------------------------------------------------------------- */

static int on_svc(void *ctx, grobo_runner *from)
{
    (void)from;
    (void)ctx;
    hold_here(&gate);
    return 0;
}

static void start_with(bool threaded, const grobo_robot_config *robot)
{
    const grobo_runner_config config = {
        GROBO_RUNNER_CONFIG_INIT,
        .session = &(grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM,
                                           .baud_bps = 1000000, .robot = robot},
        .period_us = 1000, .skip_exit = true, .on_svc = on_svc};

    hold_init(&gate);
    assert_int_equal(grobo_runner_new(&config, &runner), GROBO_OK);
    if (threaded) {
        assert_int_equal(grobo_runner_start(runner), GROBO_OK);
    }
    runner_come_up();
    assert_int_equal(runner_torque(runner, EVERY_JOINT, GROBO_TORQUE_ON, 0), 0);
    have_handlers();
}

static void start(bool threaded)
{
    start_with(threaded, NULL);
}

static void end(void)
{
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    hold_deinit(&gate);
}

static void assert_braked(void)
{
    (void)grobo_runner_wait(runner, 0);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(runner_torque_of(runner, j), GROBO_TORQUE_BRAKE);
    }
}

/* The handler runs while the loop is held, and while its own thread has the runner's lock. */
TEST(a_handler_needs_no_lock)
{
    start(true);
    hold_begin(&gate);
    grobo_i_runner_lock(runner);
    assert_int_equal(raise(SIGUSR1), 0);
    assert_int_equal(raise(SIGUSR2), 0);
    grobo_i_runner_unlock(runner);
    assert_int_equal(handled, 2);
    assert_int_equal(failed, 0);
    hold_end(&gate);
    (void)grobo_runner_wait(runner, 0);
    assert_true(grobo_runner_is_latched(runner));
    assert_int_equal(runner_torque_of(runner, ELBOW), GROBO_TORQUE_OFF);
    end();
}

/* More of them than the wake-up socket takes bytes. */
TEST(a_handler_never_waits)
{
    start(true);
    hold_begin(&gate);
    for (int i = 0; i < 20000; i++) {
        assert_int_equal(raise(SIGUSR1), 0);
        assert_int_equal(failed, 0);
    }
    hold_end(&gate);
    assert_braked();
    end();
}

/* In a callback of the loop, or anywhere in it: a thread has signals sent to this one meanwhile. */
static int raise_it(void *arg, grobo_runner *from)
{
    (void)from;
    (void)arg;
    return raise(SIGUSR1);
}

TEST(a_handler_may_interrupt_the_loop)
{
    start(false);
    assert_int_equal(grobo_runner_call(runner, raise_it, NULL), 0);
    assert_int_equal(failed, 0);
    assert_braked();
    end();
}

typedef struct sender {
    grobo_thread thread;
    pthread_t to;
    _Atomic bool stop;
} sender;

static GROBO_THREAD_FUNC send_signals(void *arg)
{
    sender *self = arg;

    while (!self->stop) {
        (void)pthread_kill(self->to, SIGUSR1);
    }
    GROBO_THREAD_RETURN;
}

TEST(handlers_may_interrupt_anything)
{
    sender self = {.to = pthread_self()};
    double angle_rad;

    start(false);
    assert_int_equal(grobo_thread_start(&self.thread, send_signals, &self), GROBO_OK);
    for (int i = 0; i < 20; i++) {
        (void)grobo_runner_svc(runner);
        (void)grobo_runner_read_angle(runner, ELBOW, &angle_rad, 1000);
    }
    self.stop = true;
    assert_int_equal(grobo_thread_join(self.thread), GROBO_OK);
    assert_true(handled > 0);
    assert_int_equal(failed, 0);
    assert_braked();
    end();
}

static GROBO_THREAD_FUNC wait_for_rest(void *arg)
{
    *(int *)arg = grobo_runner_wait(runner, GROBO_NEVER_US);
    GROBO_THREAD_RETURN;
}

static int have_all_descriptors(void)
{
    have_descriptors(true);
    return 0;
}

/* They are back however the test ends: those behind it need some. */
static const test_fixture descriptors_back[] = {{NULL, NULL, have_all_descriptors}};

TEST_WITH(descriptors_back, nothing_takes_a_descriptor)
{
    grobo_thread other;
    int result = 1;

    start(true);
    assert_true(runner_move_elbow(runner, 45, 60000000) > 0);
    have_descriptors(false);
    assert_int_equal(grobo_thread_start(&other, wait_for_rest, &result), GROBO_OK);
    assert_true(runner_moves(runner));
    assert_int_equal(grobo_robot_stop(grobo_runner_robot(runner), true), GROBO_OK);
    assert_int_equal(grobo_thread_join(other), GROBO_OK);
    assert_int_equal(result, GROBO_ERR_CANCELED);
    assert_int_equal(grobo_runner_exit(runner, GROBO_EXIT_HOLD, 0), GROBO_OK);
    assert_int_equal(grobo_runner_estop(runner), GROBO_OK);
    assert_braked();
    assert_int_equal(grobo_runner_reset(runner), GROBO_OK);
    assert_int_equal(grobo_runner_exit(runner, GROBO_EXIT_OFF, 0), GROBO_OK);
    assert_int_equal(runner_torque_of(runner, ELBOW), GROBO_TORQUE_OFF);
    assert_int_equal(grobo_runner_stop(runner), GROBO_OK);
    assert_int_equal(grobo_runner_close(runner, 0), GROBO_OK);
    have_descriptors(true);
    end();
}

/* What another thread has asked the engine for, and has not woken the loop for yet. */
static _Thread_local int asks;
static grobo_robot_host host;
static hold waking;

/* Of its two requests the loop hears by the second, when that is let go. */
static void wake_late(void *ctx)
{
    if (asks > 1) {
        hold_here(&waking);
    }
    if (asks == 1) {
        asks = 2;
    } else {
        host.wake(ctx);
    }
}

static int be_late(void *arg, grobo_runner *from)
{
    grobo_robot *robot = grobo_runner_robot(from);
    grobo_robot_host late = robot->host;

    (void)arg;
    host = late;
    late.wake = wake_late;
    grobo_robot_set_host(robot, &late);
    return 0;
}

static GROBO_THREAD_FUNC move_and_stop(void *arg)
{
    bool *done = arg;

    asks = 1;
    *done = runner_move_elbow(runner, 45, 60000000) > 0 &&
            grobo_robot_stop(grobo_runner_robot(runner), true) == GROBO_OK;
    GROBO_THREAD_RETURN;
}

/* The move is over, and the loop, which looks at the robot each period, was not told. */
TEST(a_wait_is_over_when_the_end_was_told)
{
    const grobo_robot_config unread = {GROBO_ROBOT_CONFIG_INIT,
                                       .sense_interval_us = GROBO_SENSE_NEVER};
    grobo_thread waiter, stopper;
    int waited = 1;
    bool done = false;

    start_with(true, &unread);
    assert_int_equal(grobo_runner_call(runner, be_late, NULL), 0);
    hold_init(&waking);
    waking.wanted = true;
    assert_int_equal(grobo_thread_start(&stopper, move_and_stop, &done), GROBO_OK);
    hold_begin(&waking);
    hold_begin(&gate);
    atomic_store(&runner->woken, true); /* the call does not wake it either */
    assert_int_equal(grobo_thread_start(&waiter, wait_for_rest, &waited), GROBO_OK);
    while (atomic_load(&runner->calls) == 0) {
        (void)sched_yield();
    }
    hold_end(&gate);
    assert_int_equal(grobo_thread_join(waiter), GROBO_OK);
    hold_end(&waking);
    assert_int_equal(grobo_thread_join(stopper), GROBO_OK);
    assert_true(done);
    assert_int_equal(waited, GROBO_ERR_CANCELED);
    end();
    hold_deinit(&waking);
}

/* ---- a session ---------------------------------------------------------------------------- */

static int set_up(void)
{
    session_kit_begin();
    session_kit_make((grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM,
                                            .baud_bps = 1000000});
    return 0;
}

static int tear_down(void)
{
    session_kit_end();
    return 0;
}

static const test_fixture on_loop[] = {{NULL, set_up, tear_down}};

static void come_up(void)
{
    assert_int_equal(grobo_session_open(session), GROBO_OK);
    loop_run_until(base, &seen.ups, 1);
}

static int posted, estops, exits, exit_result;

static void post_it(const grobo_event *event)
{
    if (event->kind == GROBO_EVENT_JOINT && posted == 0) {
        posted = 1;
        assert_int_equal(grobo_session_post_exit(session, GROBO_EXIT_OFF), GROBO_OK);
        assert_int_equal(grobo_session_post_stop(session, false), GROBO_OK);
        assert_false(grobo_session_is_latched(session));
        assert_int_equal(grobo_session_post_estop(session), GROBO_OK);
        assert_true(grobo_session_is_latched(session));
    }
    if (event->kind == GROBO_EVENT_JOB) {
        estops += event->u.job.kind == GROBO_JOB_ESTOP;
        exits += event->u.job.kind == GROBO_JOB_EXIT;
        if (event->u.job.kind == GROBO_JOB_EXIT) {
            exit_result = event->u.job.result;
            assert_int_equal(estops, 1);
        }
    }
}

TEST_WITH(on_loop, a_session_takes_all_three)
{
    grobo_joint_info info;

    come_up();
    assert_int_equal(session_kit_await(grobo_robot_torque(grobo_session_robot(session), EVERY_JOINT,
                                                          GROBO_TORQUE_ON)),
                     GROBO_OK);
    posted = estops = exits = 0;
    seen.then_robot = post_it;
    loop_run_until(base, &exits, 1);
    assert_int_equal(exit_result, GROBO_OK);
    assert_int_equal(estops, 1);
    assert_true(grobo_session_is_latched(session));
    assert_int_equal(grobo_robot_joint(grobo_session_robot(session), ELBOW, &info), 0);
    assert_int_equal(info.state.torque, GROBO_TORQUE_OFF);
    assert_int_equal(grobo_robot_reset(grobo_session_robot(session)), GROBO_OK);
    assert_false(grobo_session_is_latched(session));
    assert_int_equal(grobo_session_post_estop(NULL), GROBO_ERR_ARG);
    assert_int_equal(grobo_session_post_stop(NULL, true), GROBO_ERR_ARG);
    assert_int_equal(grobo_session_post_exit(NULL, GROBO_EXIT_OFF), GROBO_ERR_ARG);
    assert_int_equal(grobo_session_post_exit(session, (grobo_exit_policy)4), GROBO_ERR_ARG);
}

static GROBO_THREAD_FUNC post_from_far(void *arg)
{
    *(int *)arg = grobo_session_post_estop(session);
    GROBO_THREAD_RETURN;
}

/* Nothing else wakes this loop. */
TEST_WITH(on_loop, another_thread_wakes_the_loop)
{
    static const grobo_robot_config still = {GROBO_ROBOT_CONFIG_INIT,
                                             .sense_interval_us = GROBO_SENSE_NEVER};
    grobo_thread other;
    int result = 1;

    come_up();
    assert_int_equal(grobo_session_configure(session, &still), GROBO_OK);
    posted = 1;
    estops = exits = 0;
    seen.then_robot = post_it;
    loop_run_for(base, 50000);
    assert_int_equal(grobo_timer_deadline(session->timer), GROBO_NEVER_US);
    assert_int_equal(grobo_thread_start(&other, post_from_far, &result), GROBO_OK);
    loop_run_until(base, &estops, 1);
    assert_int_equal(grobo_thread_join(other), GROBO_OK);
    assert_int_equal(result, GROBO_OK);
}

/* As where another thread posts between the last look for requests and the sending. */
TEST_WITH(on_loop, nothing_is_sent_before_a_posted_stop)
{
    static const grobo_robot_config still = {GROBO_ROBOT_CONFIG_INIT,
                                             .sense_interval_us = GROBO_SENSE_NEVER};
    size_t sent;

    come_up();
    assert_int_equal(grobo_session_configure(session, &still), GROBO_OK);
    loop_run_for(base, 50000); /* the line is quiet */
    posted = 1;
    estops = 0;
    seen.then_robot = post_it;
    for (int stop = 0; stop < 2; stop++) {
        sent = seen.tapped[GROBO_DIR_TX];
        session->depth++; /* in a callback, say: the request sends nothing by itself */
        assert_true(grobo_robot_check(&session->robot) > 0);
        session->depth--;
        if (stop) {
            assert_int_equal(grobo_session_post_estop(session), GROBO_OK);
        }
        grobo_i_session_send(session);
        assert_true((seen.tapped[GROBO_DIR_TX] == sent) == (stop == 1));
        loop_run_for(base, 50000);
    }
    loop_run_until(base, &estops, 1);
}

TEST_WITH(on_loop, a_closed_session_keeps_no_loop_alive)
{
    assert_int_equal(event_base_dispatch(base), 1); /* 1: there is nothing to wait for */
    come_up();
    grobo_session_close(session);
    assert_int_equal(event_base_dispatch(base), 1);
    assert_int_equal(grobo_session_set_device(session, "/nowhere/tty"), GROBO_OK);
    assert_int_equal(grobo_session_open(session), GROBO_ERR_NOENT);
    assert_int_equal(event_base_dispatch(base), 1);

    assert_int_equal(grobo_session_post_exit(session, GROBO_EXIT_OFF), GROBO_OK); /* nobody there */
    assert_int_equal(grobo_session_post_estop(session), GROBO_OK);
    assert_int_equal(grobo_session_set_device(session, GROBO_DEVICE_SIM), GROBO_OK);
    posted = 1;
    estops = exits = 0;
    seen.then_robot = post_it;
    assert_int_equal(grobo_session_open(session), GROBO_OK);
    loop_run_until(base, &seen.ups, 2);
    loop_run_until(base, &estops, 1);
    assert_int_equal(exits, 0);
    assert_true(grobo_session_is_latched(session));
    assert_int_equal(grobo_robot_reset(grobo_session_robot(session)),
                     GROBO_OK); /* a reset clears what came before */
    assert_int_equal(grobo_session_post_estop(session), GROBO_OK);
    assert_int_equal(grobo_robot_reset(grobo_session_robot(session)), GROBO_ERR_STATE);
    loop_run_until(base, &estops, 2);
}

/* ---- slow callbacks ----------------------------------------------------------------------- */

/* Reports, by the callback, and the last one; since_us is set by the callback that was slow. */
static int reports[GROBO_CALLBACK_CALL + 1];
static grobo_event_slow last;
static grobo_callback slow_one; /* the callback to be slow, once */
static bool slow_wanted;

static void be_slow(grobo_callback callback)
{
    if (slow_wanted && slow_one == callback) {
        int64_t end_us = grobo_now_us() + SLOW_US;

        slow_wanted = false;
        while (grobo_now_us() < end_us) {
        }
    }
}

static int slow_svc(void *ctx, grobo_runner *from)
{
    (void)from;
    (void)ctx;
    be_slow(GROBO_CALLBACK_SVC);
    return 0;
}

static void slow_robot(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_EVENT_SLOW_CALLBACK) {
        reports[event->u.slow.callback]++;
        last = event->u.slow;
        assert_true(event->now_us > 0);
        assert_true(event->u.slow.count >= 1);
        slow_wanted = slow_wanted || slow_one == GROBO_CALLBACK_ROBOT;
    }
    be_slow(GROBO_CALLBACK_ROBOT);
}

static void slow_tap(void *ctx, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                     size_t size)
{
    (void)direction;
    (void)now_us;
    (void)bytes;
    (void)size;
    (void)ctx;
    be_slow(GROBO_CALLBACK_TAP);
}

static void slow_event(void *ctx, grobo_session *from, grobo_session_event event, int error)
{
    (void)from;
    (void)event;
    (void)error;
    (void)ctx;
    be_slow(GROBO_CALLBACK_EVENT);
}

static int slow_call(void *arg, grobo_runner *from)
{
    (void)from;
    (void)arg;
    be_slow(GROBO_CALLBACK_CALL);
    return 0;
}

static int ask_reports(void *arg, grobo_runner *from)
{
    const int *callback = arg;

    (void)from;
    return reports[*callback];
}

TEST(a_slow_callback_is_reported)
{
    const grobo_runner_config config = {
        GROBO_RUNNER_CONFIG_INIT,
        .session = &(grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM,
                                           .baud_bps = 1000000, .on_event = slow_event,
                                           .on_robot = slow_robot, .on_tap = slow_tap},
        .period_us = 1000, .skip_exit = true, .on_svc = slow_svc};

    for (int c = GROBO_CALLBACK_EVENT; c <= GROBO_CALLBACK_CALL; c++) {
        int64_t end_us = grobo_now_us() + 20000000;

        assert_int_equal(grobo_runner_new(&config, &runner), GROBO_OK);
        reports[c] = 0;
        slow_one = (grobo_callback)c;
        slow_wanted = true;
        runner_come_up();
        assert_int_equal(grobo_runner_call(runner, slow_call, NULL), 0);
        assert_true(c != GROBO_CALLBACK_CALL || reports[c] > 0); /* before the call is over */
        do { /* on a busy machine another callback may be reported too */
            assert_int_equal(grobo_runner_call(runner, slow_call, NULL), 0);
            assert_true(grobo_now_us() < end_us);
        } while (grobo_runner_call(runner, ask_reports, &c) == 0);
        for (int i = 0; i < 100; i++) { /* a slow report is not reported */
            assert_int_equal(grobo_runner_call(runner, slow_call, NULL), 0);
        }
        assert_int_equal(grobo_runner_free(runner), GROBO_OK);
        assert_true(last.held_us > GROBO_CALLBACK_SLOW_US);
        assert_true(reports[c] < 50);
    }
}

/* A machine that is busy may make any callback slow, but not each of many. */
TEST_WITH(on_loop, a_quick_callback_is_not_reported)
{
    int64_t since_us;

    do {
        session->slow.count = 0;
        since_us = grobo_i_session_enter_callback(session);
        grobo_i_session_leave_callback(session, GROBO_CALLBACK_TAP, since_us);
    } while (grobo_now_us() - since_us > GROBO_CALLBACK_SLOW_US);
    assert_int_equal(session->slow.count, 0);

    /* Of what is nested only the outer one counts, and of several the longest is told. */
    since_us = grobo_i_session_enter_callback(session);
    (void)grobo_i_session_enter_callback(session);
    grobo_i_session_leave_callback(session, GROBO_CALLBACK_TAP, since_us - 90000);
    assert_int_equal(session->slow.count, 0);
    grobo_i_session_leave_callback(session, GROBO_CALLBACK_ROBOT, since_us - 90000);
    assert_int_equal(session->slow.count, 1);
    (void)grobo_i_session_enter_callback(session);
    grobo_i_session_leave_callback(session, GROBO_CALLBACK_TAP, grobo_now_us() - 30000);
    assert_int_equal(session->slow.count, 2);
    assert_int_equal(session->slow.callback, GROBO_CALLBACK_ROBOT);
    assert_true(session->slow.held_us >= 90000);
}
