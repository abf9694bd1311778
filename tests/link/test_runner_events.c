/* SPDX-License-Identifier: MIT */
/* A runner's events and snapshot, for who wants no code on its loop. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <grobo/core/robot.h>

#include "tests/support/runner_kit.h"
#include "tests/support/test.h"

enum { CAPACITY = 8 };

/* What the callback is told, on the loop. */
typedef struct chronicle {
    unsigned told;
    int job; /* the last that ended */
    uint8_t data[64];
    size_t size;
} chronicle;

static chronicle heard;

static void on_robot(void *ctx, const grobo_event *event)
{
    chronicle *all = ctx;
    all->told++;
    if (event->kind == GROBO_EVENT_JOB) {
        all->job = event->u.job.number;
        if (event->u.job.size > 0) {
            assert_true(event->u.job.size <= sizeof all->data);
            memcpy(all->data, event->u.job.data, event->u.job.size);
            all->size = event->u.job.size;
        }
    }
}

static void on_event(void *ctx, grobo_session *session, grobo_session_event event, int error)
{
    chronicle *all = ctx;
    (void)session;
    (void)event;
    (void)error;
    all->told++;
}

static int set_up(void)
{
    const grobo_robot_config robot = {GROBO_ROBOT_CONFIG_INIT,
                                      .sense_interval_us = GROBO_SENSE_NEVER};
    const grobo_runner_config config = {
        GROBO_RUNNER_CONFIG_INIT,
        .session =
            &(grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM,
                                    .baud_bps = 1000000, .robot = &robot, .on_robot = on_robot,
                                    .on_event = on_event, .ctx = &heard},
        .skip_exit = true,
        .events = CAPACITY,
    };
    heard = (chronicle){.told = 0};
    assert_int_equal(grobo_runner_new(&config, &runner), GROBO_OK);
    return 0;
}

static int set_up_threaded(void)
{
    (void)set_up();
    assert_int_equal(grobo_runner_start(runner), GROBO_OK);
    return 0;
}

static int tear_down(void)
{
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    return 0;
}

static const test_fixture threaded[] = {{NULL, set_up_threaded, tear_down}};

static const test_fixture alone[] = {{NULL, set_up, tear_down}};

/* Whether the descriptor says that there are events. */
static bool says_so(void)
{
    grobo_socket socket = grobo_runner_event_socket(runner);
    return grobo_port_wait(socket, GROBO_PORT_READABLE, 0) == GROBO_PORT_READABLE;
}

/* Waits for the descriptor and takes one. */
static grobo_runner_event next(void)
{
    grobo_runner_event event = {GROBO_RUNNER_EVENT_INIT};
    grobo_socket socket = grobo_runner_event_socket(runner);
    assert_int_equal(grobo_port_wait(socket, GROBO_PORT_READABLE, 5000000), GROBO_PORT_READABLE);
    assert_int_equal(grobo_runner_next_event(runner, &event), 1);
    return event;
}

/* Takes events until the end of a job. */
static grobo_runner_event next_end(void)
{
    grobo_runner_event event;
    do {
        event = next();
    } while (event.of_line || event.event.kind != GROBO_EVENT_JOB);
    return event;
}

static grobo_posture elbow_at(double angle_deg)
{
    grobo_posture target;
    assert_int_equal(grobo_posture_init(&target, 20), GROBO_OK);
    assert_int_equal(grobo_posture_set_deg(&target, ELBOW, angle_deg), GROBO_OK);
    target.time_us = 50000;
    return target;
}

/* ---- events ------------------------------------------------------------------------------- */

TEST_WITH(alone, a_descriptor_tells_of_events)
{
    grobo_runner_event event = {GROBO_RUNNER_EVENT_INIT};
    assert_false(says_so());
    assert_int_equal(grobo_runner_next_event(runner, &event), 0);
    runner_come_up();
    assert_true(says_so());
    bool up = false;
    while (grobo_runner_next_event(runner, &event) == 1) {
        up = up || (event.of_line && event.line == GROBO_SESSION_EVENT_UP);
        assert_int_equal(event.lost, 0);
    }
    assert_true(up);
    assert_false(says_so());
}

TEST_WITH(threaded, a_job_ends_in_the_ring)
{
    runner_come_up();
    grobo_posture target = elbow_at(10);
    int job = grobo_robot_move(grobo_runner_robot(runner), &target);
    assert_true(job > 0);
    grobo_runner_event event = next_end();
    assert_int_equal(event.event.u.job.number, job);
    assert_int_equal(event.event.u.job.kind, GROBO_JOB_MOVE);
    assert_int_equal(event.event.u.job.result, GROBO_OK);
    assert_null(event.event.u.job.data);
}

TEST_WITH(threaded, what_was_read_of_registers_is_in_the_event)
{
    runner_come_up();
    const grobo_register_io io = {.id = 14, .address = 0, .length = 4};
    int job = grobo_robot_registers(grobo_runner_robot(runner), &io);
    assert_int_equal(grobo_runner_wait_job(runner, job, 0), GROBO_OK);
    grobo_runner_event event;
    do {
        event = next_end();
    } while (event.event.u.job.number != job);
    assert_int_equal(event.event.u.job.size, 4);
    assert_int_equal(heard.size, 4);
    assert_memory_equal(event.data, heard.data, 4);
}

TEST_WITH(alone, data_of_an_event_is_the_takers_own)
{
    grobo_runner_event event = {GROBO_RUNNER_EVENT_INIT};
    runner_come_up();
    const grobo_register_io io = {.id = 14, .address = 0, .length = 4};
    int job = grobo_robot_registers(grobo_runner_robot(runner), &io);
    assert_int_equal(grobo_runner_wait_job(runner, job, 0), GROBO_OK);
    bool found = false;
    while (grobo_runner_next_event(runner, &event) == 1) {
        bool with_data = !event.of_line && event.event.kind == GROBO_EVENT_JOB &&
                         event.event.u.job.number == job;
        if (with_data) {
            assert_ptr_equal(event.event.u.job.data, event.data);
            found = true;
        }
    }
    assert_true(found);
}

/* ---- a flood ------------------------------------------------------------------------------ */

TEST_WITH(alone, a_flood_of_readings_displaces_no_end_of_a_job)
{
    grobo_robot *robot = grobo_runner_robot(runner);
    grobo_runner_event event = {GROBO_RUNNER_EVENT_INIT};
    int jobs[CAPACITY / 2];
    runner_come_up();
    while (grobo_runner_next_event(runner, &event) == 1) {
    }
    unsigned before = heard.told;
    for (int i = 0; i < CAPACITY / 2; i++) {
        jobs[i] = grobo_robot_sense(robot, EVERY_JOINT, GROBO_SENSE_POSITION);
        assert_int_equal(grobo_runner_wait_job(runner, jobs[i], 0), GROBO_OK);
    }
    assert_true(heard.told - before >= CAPACITY / 2 * 21);
    unsigned taken = 0;
    unsigned readings = 0;
    uint64_t lost = 0;
    int ends = 0;
    while (grobo_runner_next_event(runner, &event) == 1) {
        taken++;
        lost += event.lost;
        readings += event.event.kind == GROBO_EVENT_JOINT;
        if (event.event.kind == GROBO_EVENT_JOB) {
            assert_int_equal(event.event.u.job.number, jobs[ends]);
            ends++;
        }
    }
    assert_int_equal(ends, CAPACITY / 2);
    assert_int_equal(readings, CAPACITY);
    assert_int_equal(lost + taken, heard.told - before);
    assert_false(says_so());
}

TEST_WITH(alone, the_newest_of_too_many_ends_are_kept)
{
    grobo_runner_event event = {GROBO_RUNNER_EVENT_INIT};
    enum { MANY = CAPACITY * 3 };
    int jobs[MANY];
    runner_come_up();
    while (grobo_runner_next_event(runner, &event) == 1) {
    }
    for (int i = 0; i < MANY; i++) {
        jobs[i] = grobo_robot_check(grobo_runner_robot(runner));
        assert_int_equal(grobo_runner_wait_job(runner, jobs[i], 0), GROBO_OK);
    }
    for (int i = MANY - CAPACITY; i < MANY; i++) {
        assert_true(says_so());
        assert_int_equal(grobo_runner_next_event(runner, &event), 1);
        assert_int_equal(event.event.u.job.number, jobs[i]);
        assert_int_equal(event.lost, i == MANY - CAPACITY ? MANY - CAPACITY : 0);
    }
    assert_int_equal(grobo_runner_next_event(runner, &event), 0);
    assert_false(says_so());
}

/* ---- threads, processes ------------------------------------------------------------------- */

enum { MOVES = 40 };

typedef struct listener {
    grobo_thread thread;
    int last;  /* job to wait for; set before the thread starts */
    int wrong; /* jobs out of order, bad sizes */
    unsigned ends;
    uint64_t lost;
} listener;

/* Takes events and snapshots until all moves have ended, as another language would. */
static GROBO_THREAD_FUNC listen(void *arg)
{
    listener *self = arg;
    grobo_socket socket = grobo_runner_event_socket(runner);
    int before = 0;
    while (self->ends < MOVES && self->wrong == 0) {
        grobo_runner_event event = {GROBO_RUNNER_EVENT_INIT};
        grobo_snapshot seen = {GROBO_SNAPSHOT_INIT};
        if (grobo_port_wait(socket, GROBO_PORT_READABLE, 5000000) == 0) {
            self->wrong = 1; /* nothing comes any more */
        }
        if (grobo_runner_snapshot(runner, &seen) != 20) {
            self->wrong = 2;
        }
        while (grobo_runner_next_event(runner, &event) == 1) {
            self->lost += event.lost;
            if (!event.of_line && event.event.kind == GROBO_EVENT_JOB &&
                event.event.u.job.kind == GROBO_JOB_MOVE) {
                self->ends++;
                self->wrong = event.event.u.job.number > before ? self->wrong : 3;
                before = event.event.u.job.number;
            }
        }
    }
    GROBO_THREAD_RETURN;
}

TEST_WITH(threaded, a_second_thread_hears_of_every_move)
{
    listener other = {.last = 0};
    runner_come_up();
    assert_int_equal(grobo_thread_start(&other.thread, listen, &other), GROBO_OK);
    for (int i = 0; i < MOVES; i++) {
        grobo_posture target = elbow_at(i % 2 == 0 ? 1 : 2);
        target.time_us = 10000;
        int job = grobo_robot_move(grobo_runner_robot(runner), &target);
        assert_int_equal(grobo_runner_wait_job(runner, job, 0), GROBO_OK);
    }
    assert_int_equal(grobo_thread_join(other.thread), GROBO_OK);
    assert_int_equal(other.wrong, 0);
    assert_int_equal(other.ends, MOVES);
}

TEST_WITH(alone, a_child_process_takes_nothing_away)
{
    int status = -1;
    runner_come_up();
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        /* As subprocess modules do: closes what it has, and is another program. */
        (void)close(grobo_runner_event_socket(runner));
        _exit(0);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    int job = grobo_robot_check(grobo_runner_robot(runner));
    assert_int_equal(grobo_runner_wait_job(runner, job, 0), GROBO_OK);
    assert_int_equal(next_end().event.u.job.number, job);
    char command[64];
    (void)snprintf(command, sizeof command, "! (: <&%d) 2>/dev/null",
                   (int)grobo_runner_event_socket(runner));
    assert_int_equal(system(command), 0); /* a program that is executed does not have it */
}

TEST_WITH(alone, events_outlive_the_close)
{
    runner_come_up();
    int job = grobo_robot_check(grobo_runner_robot(runner));
    assert_int_equal(grobo_runner_wait_job(runner, job, 0), GROBO_OK);
    assert_int_equal(grobo_runner_close(runner, 0), GROBO_OK);
    grobo_runner_event event;
    do {
        event = next_end();
    } while (event.event.u.job.number != job);
    assert_int_equal(event.event.u.job.result, GROBO_OK);
}

/* ---- the snapshot ------------------------------------------------------------------------- */

TEST_WITH(alone, a_snapshot_says_what_is_known)
{
    grobo_snapshot seen = {GROBO_SNAPSHOT_INIT};
    assert_int_equal(grobo_runner_snapshot(runner, &seen), 20);
    assert_false(seen.connected);
    assert_int_equal(seen.joints[ELBOW].angle_age_us, GROBO_NEVER_US);
    runner_come_up();
    grobo_posture target = elbow_at(10);
    int job = grobo_robot_move(grobo_runner_robot(runner), &target);
    assert_int_equal(grobo_runner_wait_job(runner, job, 0), GROBO_OK);
    assert_int_equal(grobo_runner_snapshot(runner, &seen), 20);
    assert_int_equal(seen.size, sizeof seen);
    assert_int_equal(seen.n_joints, 20);
    assert_true(seen.connected);
    assert_false(seen.latched);
    assert_false(seen.moving);
    assert_int_equal(seen.job, GROBO_JOB_NONE);
    const grobo_joint_info *elbow = &seen.joints[ELBOW];
    assert_true(elbow->has_target);
    assert_int_equal(grobo_ddeg_from_rad(elbow->target_rad), 100);
    assert_in_range((unsigned)grobo_ddeg_from_rad(elbow->state.angle_rad), 95, 105);
    assert_true(elbow->torque_known);
    assert_int_equal(elbow->state.torque, GROBO_TORQUE_ON);
    assert_true(elbow->angle_age_us >= 0 && elbow->angle_age_us < 5000000);
    assert_true(seen.counters.motion_frames > 0);
    assert_int_equal(grobo_runner_estop(runner), GROBO_OK);
    assert_int_equal(grobo_runner_snapshot(runner, &seen), 20);
    assert_true(seen.latched); /* before the loop has turned */
}

/* A callback that holds the loop until it is let go. */
typedef struct gate {
    grobo_mutex lock;
    grobo_cond changed;
    bool held, open;
} gate;

static int hold(void *arg, grobo_runner *from)
{
    gate *self = arg;
    (void)from;
    grobo_mutex_lock(&self->lock);
    self->held = true;
    grobo_cond_wake_all(&self->changed);
    while (!self->open) {
        grobo_cond_wait(&self->changed, &self->lock, GROBO_NEVER_US);
    }
    self->held = false;
    grobo_cond_wake_all(&self->changed);
    grobo_mutex_unlock(&self->lock);
    return GROBO_OK;
}

TEST_WITH(threaded, a_snapshot_does_not_wait_for_the_loop)
{
    gate one = {.held = false};
    grobo_snapshot seen = {GROBO_SNAPSHOT_INIT};
    grobo_runner_event event = {GROBO_RUNNER_EVENT_INIT};
    assert_int_equal(grobo_mutex_init(&one.lock), GROBO_OK);
    assert_int_equal(grobo_cond_init(&one.changed), GROBO_OK);
    runner_come_up();
    assert_int_equal(grobo_runner_post(runner, hold, &one), GROBO_OK);
    grobo_mutex_lock(&one.lock);
    while (!one.held) {
        grobo_cond_wait(&one.changed, &one.lock, GROBO_NEVER_US);
    }
    grobo_mutex_unlock(&one.lock);
    assert_int_equal(grobo_runner_snapshot(runner, &seen), 20); /* or it would be for ever */
    assert_true(seen.connected);
    assert_int_equal(grobo_runner_next_event(runner, &event), 1);
    grobo_mutex_lock(&one.lock);
    one.open = true;
    grobo_cond_wake_all(&one.changed);
    while (one.held) {
        grobo_cond_wait(&one.changed, &one.lock, GROBO_NEVER_US);
    }
    grobo_mutex_unlock(&one.lock);
    grobo_cond_deinit(&one.changed);
    grobo_mutex_deinit(&one.lock);
}

/* ---- refusals ----------------------------------------------------------------------------- */

TEST_WITH(alone, a_size_that_is_nonsense_is_refused)
{
    grobo_runner_event event = {GROBO_RUNNER_EVENT_INIT};
    grobo_snapshot seen = {.size = 0};
    runner_come_up();
    event.size = 0;
    assert_int_equal(grobo_runner_next_event(runner, &event), GROBO_ERR_ARG);
    event.size = sizeof event;
    assert_int_equal(grobo_runner_next_event(runner, &event), 1); /* nothing was lost by that */
    assert_int_equal(event.lost, 0);
    assert_int_equal(grobo_runner_snapshot(runner, &seen), GROBO_ERR_ARG);
}

/* A program of before `play` was added gets what it knows, and nothing is written behind it. */
TEST_WITH(alone, an_older_snapshot_gets_what_it_knows)
{
    grobo_snapshot seen = {.size = offsetof(grobo_snapshot, play), .n_joints = -7};
    runner_come_up();
    assert_int_equal(grobo_runner_snapshot(runner, &seen), 20);
    assert_true(seen.connected);
    assert_int_equal(seen.n_joints, -7);
    assert_int_equal(seen.size, offsetof(grobo_snapshot, play));
}

TEST(a_runner_without_a_ring_says_so)
{
    grobo_runner_config config = {
        GROBO_RUNNER_CONFIG_INIT,
        .session = &(grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM}};
    grobo_runner_event event = {GROBO_RUNNER_EVENT_INIT};
    grobo_runner *plain;
    assert_int_equal(grobo_runner_new(&config, &plain), GROBO_OK);
    assert_int_equal(grobo_runner_next_event(plain, &event), GROBO_ERR_STATE);
    assert_true(grobo_runner_event_socket(plain) == GROBO_SOCKET_NULL);
    assert_int_equal(grobo_runner_free(plain), GROBO_OK);
    config.events = GROBO_RUNNER_EVENTS_MAX + 1;
    assert_int_equal(grobo_runner_new(&config, &plain), GROBO_ERR_ARG);
}
