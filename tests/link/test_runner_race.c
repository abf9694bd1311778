/* SPDX-License-Identifier: MIT */
/* A runner called by many threads at once, in its callbacks, while it starts, stops and goes. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "tests/support/runner_kit.h"
#include "tests/support/test.h"

/* What threads of a test count of their calls; each has its own. */
typedef struct worker {
    grobo_thread thread;
    grobo_runner *runner;
    int number;
    int calls;
    int wrong; /* the first result that should not be, 0 none */
} worker;

static void expect(worker *self, bool as_it_should, int result)
{
    self->calls++;
    if (!as_it_should && self->wrong == 0) {
        self->wrong = result != 0 ? result : 1;
    }
}

static void run_together(grobo_thread_fn fn, worker *workers, int n)
{
    for (int i = 0; i < n; i++) {
        workers[i].runner = runner;
        workers[i].number = i;
        assert_int_equal(grobo_thread_start(&workers[i].thread, fn, &workers[i]), GROBO_OK);
    }
    for (int i = 0; i < n; i++) {
        assert_int_equal(grobo_thread_join(workers[i].thread), GROBO_OK);
        assert_int_equal(workers[i].wrong, 0);
        assert_true(workers[i].calls > 0);
    }
}

/* ---- many threads ------------------------------------------------------------------------- */

static void ask(worker *self)
{
    grobo_robot *robot = grobo_runner_robot(self->runner);
    grobo_posture posture;
    grobo_snapshot snapshot = {GROBO_SNAPSHOT_INIT};
    double angle_rad;
    int r = grobo_runner_read_angle(self->runner, self->number, &angle_rad, 0);

    expect(self, r == GROBO_OK, r);
    r = grobo_robot_posture(robot, GROBO_NEVER_US, &posture);
    expect(self, r > 0, r);
    r = grobo_runner_snapshot(self->runner, &snapshot);
    expect(self, r == 20, r);
    r = runner_check(self->runner, 0);
    expect(self, r == GROBO_OK, r);
}

static void change(worker *self, int i)
{
    int r;

    if (i % 4 == 3) {
        grobo_motion *motion = runner_motion(self->runner);
        r = grobo_runner_set_motion(self->runner, motion);
        expect(self, r >= 0, r);
        grobo_motion_free(motion);
    }
    r = runner_move_elbow(self->runner, i % 5, 20000 + 10000 * (i % 3));
    /* Another thread has moved it, or moves it now. */
    expect(self, r > 0 || r == GROBO_ERR_FULL || r == GROBO_ERR_STATE, r);
}

static GROBO_THREAD_FUNC hammer(void *arg)
{
    worker *self = arg;

    for (int i = 0; i < 12; i++) {
        if (self->number < 2) {
            ask(self);
        } else {
            change(self, i);
        }
    }
    GROBO_THREAD_RETURN;
}

TEST_WITH(with_and_without_thread, many_threads_call_at_once)
{
    worker workers[4] = {0};

    runner_come_up();
    run_together(hammer, workers, 4);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
}

static GROBO_THREAD_FUNC cycle(void *arg)
{
    worker *self = arg;

    for (int i = 0; i < 15; i++) {
        int r =
            self->number == 0 ? grobo_runner_start(self->runner) : grobo_runner_stop(self->runner);

        expect(self, r == GROBO_OK || r == GROBO_ERR_STATE, r);
        r = runner_check(self->runner, 0);
        expect(self, r == GROBO_OK || r == GROBO_ERR_CANCELED, r);
    }
    GROBO_THREAD_RETURN;
}

static const test_fixture alone[] = {{NULL, runner_set_up, runner_tear_down}};

TEST_WITH(alone, the_thread_is_started_and_stopped_while_others_call)
{
    worker workers[3] = {0};

    runner_come_up();
    run_together(cycle, workers, 3);
}

/* A thread that stops the runner's thread, and tells when that has returned. */
typedef struct stopper {
    grobo_thread thread;
    grobo_mutex lock;
    bool is_back;
    int result;
} stopper;

static GROBO_THREAD_FUNC stop_it(void *arg)
{
    stopper *self = arg;
    int r = grobo_runner_stop(runner);

    grobo_mutex_lock(&self->lock);
    self->is_back = true;
    self->result = r;
    grobo_mutex_unlock(&self->lock);
    GROBO_THREAD_RETURN;
}

static bool is_back(stopper *of)
{
    bool back;

    grobo_mutex_lock(&of->lock);
    back = of->is_back;
    grobo_mutex_unlock(&of->lock);
    return back;
}

/* Who waits for the end of one thread does not wait for that of the next. */
TEST_WITH(alone, a_stop_returns_though_the_thread_is_started_again)
{
    runner_come_up();
    for (int i = 0; i < 200; i++) {
        stopper other = {.is_back = false};
        int64_t end_us;
        bool back;

        assert_int_equal(grobo_mutex_init(&other.lock), GROBO_OK);
        assert_int_equal(grobo_runner_start(runner), GROBO_OK);
        assert_int_equal(grobo_thread_start(&other.thread, stop_it, &other), GROBO_OK);
        while (grobo_runner_start(runner) != GROBO_OK) {
        }
        end_us = grobo_now_us() + 5000000;
        do {
            back = is_back(&other);
        } while (!back && grobo_now_us() < end_us);
        assert_int_equal(grobo_runner_stop(runner), GROBO_OK);
        assert_int_equal(grobo_thread_join(other.thread), GROBO_OK);
        grobo_mutex_deinit(&other.lock);
        assert_true(back);
        assert_int_equal(other.result, GROBO_OK);
    }
}

TEST_WITH(alone, the_thread_starts_and_stops)
{
    grobo_thread thread;
    double angle_rad;

    runner_come_up();
    assert_int_equal(grobo_runner_stop(runner), GROBO_ERR_STATE);
    for (int i = 0; i < 10; i++) {
        assert_false(grobo_runner_is_active(runner));
        assert_int_equal(grobo_runner_thread(runner, &thread), GROBO_ERR_STATE);
        assert_int_equal(grobo_runner_start(runner), GROBO_OK);
        assert_true(grobo_runner_is_active(runner));
        assert_int_equal(grobo_runner_start(runner), GROBO_ERR_STATE);
        assert_int_equal(grobo_runner_run(runner), GROBO_ERR_STATE);
        assert_int_equal(grobo_runner_thread(runner, &thread), GROBO_OK);
        assert_false(grobo_thread_is_self(thread));
        assert_int_equal(grobo_runner_svc(runner), 0);
        assert_int_equal(grobo_runner_read_angle(runner, ELBOW, &angle_rad, 0), GROBO_OK);
        assert_int_equal(grobo_runner_stop(runner), GROBO_OK);
    }
}

static GROBO_THREAD_FUNC run_it(void *arg)
{
    worker *self = arg;
    int r = grobo_runner_run(self->runner);

    expect(self, r == GROBO_OK, r);
    GROBO_THREAD_RETURN;
}

TEST_WITH(alone, a_thread_of_the_callers_may_be_the_runners_thread)
{
    worker self = {.runner = runner};
    grobo_thread thread;
    double angle_rad;

    runner_come_up();
    assert_int_equal(grobo_thread_start(&self.thread, run_it, &self), GROBO_OK);
    while (!grobo_runner_is_active(runner)) {
        assert_true(grobo_runner_svc(runner) >= 0);
    }
    assert_int_equal(grobo_runner_start(runner), GROBO_ERR_STATE);
    assert_int_equal(grobo_runner_thread(runner, &thread), GROBO_ERR_STATE);
    assert_int_equal(grobo_runner_read_angle(runner, ELBOW, &angle_rad, 0), GROBO_OK);
    assert_int_equal(grobo_runner_stop(runner), GROBO_OK);
    assert_int_equal(grobo_thread_join(self.thread), GROBO_OK);
    assert_int_equal(self.wrong, 0);
    assert_int_equal(self.calls, 1);
}

/* ---- the loop by hand --------------------------------------------------------------------- */

static int count(void *arg, grobo_runner *from)
{
    int *n = arg;

    (void)from;
    return ++*n;
}

TEST_WITH(alone, rounds_may_be_the_callers)
{
    int64_t end_us = grobo_now_us() + 5000000;

    assert_int_equal(grobo_runner_open(runner), GROBO_OK);
    while (!grobo_runner_is_connected(runner)) {
        assert_int_equal(grobo_runner_svc(runner), 1);
        assert_true(grobo_now_us() < end_us);
    }
}

TEST_WITH(alone, what_is_posted_is_done_once)
{
    int n = 0;

    assert_int_equal(grobo_runner_post(runner, NULL, &n), GROBO_ERR_ARG);
    assert_int_equal(grobo_runner_call(runner, NULL, &n), GROBO_ERR_ARG);
    for (int i = 0; i < GROBO_RUNNER_CALLS_MAX; i++) {
        assert_int_equal(grobo_runner_post(runner, count, &n), GROBO_OK);
    }
    assert_int_equal(n, 0);
    /* The table is full: nothing waits for a place, and nothing that is there is lost. */
    assert_int_equal(grobo_runner_post(runner, count, &n), GROBO_ERR_FULL);
    assert_int_equal(grobo_runner_open(runner), GROBO_ERR_FULL);
    assert_int_equal(grobo_runner_connect(runner, 0), GROBO_ERR_FULL);
    assert_int_equal(grobo_runner_start(runner), GROBO_OK);
    assert_int_equal(grobo_runner_stop(runner), GROBO_OK);
    while (n < GROBO_RUNNER_CALLS_MAX) {
        assert_true(grobo_runner_svc(runner) == 1);
    }
    assert_int_equal(grobo_runner_call(runner, count, &n), GROBO_RUNNER_CALLS_MAX + 1);
}

/* Posts another; n[0] is how many were taken, n[1] how many were called. */
static int post_another(void *arg, grobo_runner *of)
{
    int *n = arg;

    n[0] += grobo_runner_post(of, count, &n[1]) >= 0;
    return GROBO_OK;
}

TEST(what_is_posted_last_is_done_by_free)
{
    grobo_runner_config config = {
        GROBO_RUNNER_CONFIG_INIT,
        .session = &(grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM}};
    grobo_runner *other;
    int n = 0;
    int chain[2] = {0, 0};

    for (int skip = 0; skip < 2; skip++) {
        config.skip_exit = skip == 1;
        assert_int_equal(grobo_runner_new(&config, &other), GROBO_OK);
        assert_int_equal(grobo_runner_post(other, count, &n), GROBO_OK);
        assert_int_equal(grobo_runner_post(other, post_another, chain), GROBO_OK);
        assert_int_equal(grobo_runner_free(other), GROBO_OK);
        assert_int_equal(n, skip + 1);
        assert_int_equal(chain[1], chain[0]);
    }
}

TEST_WITH(with_and_without_thread, a_call_gives_up_in_its_time)
{
    grobo_posture posture = {.n_joints = 7};
    double angle_rad;

    runner_come_up();
    for (int i = 0; i < 20; i++) {
        assert_int_equal(grobo_runner_read_posture(runner, &posture, 1), GROBO_ERR_TIMEOUT);
    }
    assert_int_equal(posture.n_joints, 7);
    assert_int_equal(grobo_runner_read_angle(runner, ELBOW, &angle_rad, 0), GROBO_OK);
}

/* ---- in callbacks ------------------------------------------------------------------------- */

/* What a callback found; told to the test through grobo_runner_call(). */
static struct {
    int rounds, events, ups;
    int wrong; /* number of the check that failed first */
    bool stop;
} seen;

static void check(int number, bool as_it_should)
{
    if (!as_it_should && seen.wrong == 0) {
        seen.wrong = number;
    }
}

static void call_back(grobo_runner *from, int at)
{
    grobo_robot *robot = grobo_runner_robot(from);
    grobo_snapshot snapshot = {GROBO_SNAPSHOT_INIT};
    grobo_posture posture;
    double angle_rad;
    int n = 0;

    check(at + 1, grobo_runner_snapshot(from, &snapshot) == 20);
    check(at + 2, grobo_robot_posture(robot, GROBO_NEVER_US, &posture) >= 0);
    check(at + 4, grobo_runner_call(from, count, &n) == 1);
    check(at + 5, grobo_runner_read_angle(from, ELBOW, &angle_rad, 0) == GROBO_ERR_STATE);
    check(at + 6, grobo_runner_connect(from, 0) == GROBO_ERR_STATE);
    check(at + 7, grobo_runner_wait(from, GROBO_NEVER_US) == GROBO_ERR_STATE);
    check(at + 8, grobo_runner_close(from, 0) == GROBO_ERR_STATE);
    check(at + 9, grobo_runner_free(from) == GROBO_ERR_STATE);
    check(at + 10, grobo_runner_svc(from) == GROBO_ERR_STATE);
    check(at + 11, grobo_runner_run(from) == GROBO_ERR_STATE);
}

static int on_svc(void *ctx, grobo_runner *from)
{
    check(1, ctx == &seen);
    seen.rounds++;
    call_back(from, 100);
    if (seen.stop) {
        seen.stop = false;
        check(2, grobo_runner_stop(from) == GROBO_OK);
        check(3, !grobo_runner_is_active(from));
    }
    return 0;
}

static void on_robot(void *ctx, const grobo_event *event)
{
    check(4, ctx == &seen);
    (void)event;
    seen.events++;
    call_back(runner, 200);
}

static void on_event(void *ctx, grobo_session *session, grobo_session_event event, int error)
{
    check(5, ctx == &seen);
    check(6, session == grobo_runner_session(runner));
    check(7, error <= 0);
    seen.ups += event == GROBO_SESSION_EVENT_UP;
    call_back(runner, 300);
}

static int copy_seen(void *arg, grobo_runner *from)
{
    (void)from;
    memcpy(arg, &seen, sizeof seen);
    return 0;
}

static int order_stop(void *arg, grobo_runner *from)
{
    (void)arg;
    (void)from;
    seen.stop = true;
    return 0;
}

TEST(callbacks_may_call)
{
    grobo_runner_config config = {
        GROBO_RUNNER_CONFIG_INIT,
        .session = &(grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM,
                                           .baud_bps = 1000000, .on_event = on_event,
                                           .on_robot = on_robot, .ctx = &seen},
        .period_us = 2000,
        .on_svc = on_svc,
    };
    grobo_posture posture;

    for (int threaded = 0; threaded < 2; threaded++) {
        memset(&seen, 0, sizeof seen);
        assert_int_equal(grobo_runner_new(&config, &runner), GROBO_OK);
        if (threaded) {
            assert_int_equal(grobo_runner_start(runner), GROBO_OK);
        }
        runner_come_up();
        assert_int_equal(grobo_runner_read_posture(runner, &posture, 0), 20);
        assert_int_equal(grobo_runner_call(runner, copy_seen, &seen), 0);
        if (threaded) {
            assert_int_equal(grobo_runner_call(runner, order_stop, NULL), 0);
        }
        while (threaded && grobo_runner_is_active(runner)) {
            assert_true(grobo_runner_svc(runner) >= 0);
        }
        assert_int_equal(grobo_runner_free(runner), GROBO_OK);
        assert_int_equal(seen.wrong, 0);
        assert_int_equal(seen.ups, 1);
        assert_true(seen.rounds > 0);
        assert_true(seen.events > 20);
    }
}

/* The other runner's callback: its own way out is barred, and so is that of the first. */
static int on_inner(void *ctx, grobo_runner *inner)
{
    grobo_runner *outer = *(grobo_runner **)ctx;
    double angle_rad;
    char device[GROBO_DEVICE_MAX_BYTES];

    check(11, grobo_runner_read_angle(inner, 0, &angle_rad, 0) == GROBO_ERR_STATE);
    check(12, grobo_runner_read_angle(outer, 0, &angle_rad, 0) == GROBO_ERR_STATE);
    check(13, grobo_runner_get_device(outer, device, sizeof device) == 3);
    seen.events++;
    return 0;
}

static int ask_other(void *arg, grobo_runner *outer)
{
    grobo_runner *inner = arg;
    double angle_rad;

    (void)outer;
    return grobo_runner_read_angle(inner, 0, &angle_rad, 0);
}

TEST_WITH(with_and_without_thread, a_callback_may_wait_for_another_robot)
{
    grobo_runner *other;
    grobo_runner_config config = {
        GROBO_RUNNER_CONFIG_INIT,
        .session = &(grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM,
                                           .baud_bps = 1000000, .ctx = &runner},
        .period_us = 1000,
        .on_svc = on_inner,
    };

    memset(&seen, 0, sizeof seen);
    assert_int_equal(grobo_runner_new(&config, &other), GROBO_OK);
    assert_int_equal(grobo_runner_connect(other, 0), GROBO_OK);
    memset(&seen, 0, sizeof seen); /* only what was inside of both counts */
    for (int i = 0; i < 20; i++) {
        assert_int_equal(grobo_runner_call(runner, ask_other, other), GROBO_OK);
    }
    assert_int_equal(seen.wrong, 0);
    assert_true(seen.events > 0);
    assert_int_equal(grobo_runner_free(other), GROBO_OK);
}

/* A stabilizer follows another robot: it runs within a call to its own, which waits for no loop. */
static int follow(const grobo_driver *self, void *ctx, const grobo_posture *sensed,
                  grobo_posture *target)
{
    grobo_posture leader;
    double angle_rad;

    (void)self;
    (void)sensed;
    check(14, grobo_robot_posture(grobo_runner_robot(ctx), GROBO_NEVER_US, &leader) > 0);
    check(15, !grobo_robot_moving(grobo_runner_robot(ctx)));
    check(16, grobo_posture_get_rad(&leader, ELBOW, &angle_rad) == GROBO_OK &&
                  grobo_posture_set_rad(target, ELBOW, angle_rad) == GROBO_OK);
    seen.events++;
    return GROBO_OK;
}

TEST_WITH(with_and_without_thread, a_stabilizer_may_ask_another_robot)
{
    grobo_driver driver = *grobo_gr001_driver(GROBO_WIRING_BOARD);
    grobo_session_config session = {GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM,
                                    .baud_bps = 1000000, .driver = &driver, .driver_ctx = runner};
    const grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session};
    grobo_posture posture;
    grobo_runner *follower;
    double angle_rad;

    runner_come_up();
    assert_true(runner_move_elbow(runner, 10, 0) > 0);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_read_posture(runner, &posture, 0), 20);
    driver.stabilize = follow;
    memset(&seen, 0, sizeof seen);
    assert_int_equal(grobo_runner_new(&config, &follower), GROBO_OK);
    assert_int_equal(grobo_runner_connect(follower, 0), GROBO_OK);
    assert_true(runner_move_elbow(follower, 0, 0) > 0);
    assert_int_equal(grobo_runner_wait(follower, 0), GROBO_OK);
    assert_int_equal(grobo_runner_read_angle(follower, ELBOW, &angle_rad, 0), GROBO_OK);
    assert_true(fabs(grobo_deg_from_rad(angle_rad) - 10) < 1);
    assert_int_equal(grobo_runner_free(follower), GROBO_OK);
    assert_int_equal(seen.wrong, 0);
    assert_true(seen.events > 0);
}
