/* SPDX-License-Identifier: MIT */
/* A runner over a line that is lost, and how it leaves a robot: by a pty, served by a thread. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <event2/event.h>

#include "src/link/runner/runner.h"
#include "tests/support/far_robot.h"
#include "tests/support/folder.h"
#include "tests/support/runner_kit.h"
#include "tests/support/test.h"

/* On a busy machine a pseudo-terminal hands on what it was given 170 ms later. */
static const grobo_robot_config leave_off = {GROBO_ROBOT_CONFIG_INIT, .timeout_us = 300000,
                                             .on_exit = GROBO_EXIT_OFF};
static far_robot robot;
static char device[128];

static void choose_device(void)
{
    (void)folder_set_up();
    assert_true(snprintf(device, sizeof device, "%s", in_folder("robot")) < (int)sizeof device);
}

static int set_up(void)
{
    choose_device();
    far_robot_start(&robot, device);
    return 0;
}

static int tear_down(void)
{
    far_robot_end(&robot);
    folder_remove(NULL, 0);
    return 0;
}

static const test_fixture on_line[] = {{NULL, set_up, tear_down}};

static void make(grobo_runner_config config, bool threaded)
{
    grobo_session_config session = {GROBO_SESSION_CONFIG_INIT};

    if (config.session != NULL) {
        session = *config.session;
    }
    config.session = &session;
    session.device = device;
    session.baud_bps = FAR_ROBOT_BPS;
    if (session.robot == NULL) {
        session.robot = &leave_off;
    }
    assert_int_equal(grobo_runner_new(&config, &runner), GROBO_OK);
    if (threaded) {
        assert_int_equal(grobo_runner_start(runner), GROBO_OK);
    }
    runner_come_up();
}

static const grobo_play_options for_long = {GROBO_PLAY_OPTIONS_INIT, .repeat = 1000000};

/* Asked again where the machine was too busy for the far side to answer in time. */
static void have_torque(void)
{
    int result = GROBO_ERR_TIMEOUT;
    for (int i = 0; i < 5 && result == GROBO_ERR_TIMEOUT; i++) {
        result = runner_torque(runner, EVERY_JOINT, GROBO_TORQUE_ON, 20000000);
    }
    assert_int_equal(result, GROBO_OK);
    assert_int_equal(far_robot_torqued(&robot), 20);
}

/* ---- at the end of a program: the first, as it forks -------------------------------------- */

static void free_it(void)
{
    (void)grobo_runner_free(runner);
}

/* A program that ends without a word, but for its own atexit() handler. */
static void be_a_program(int until)
{
    grobo_runner_config config = {
        GROBO_RUNNER_CONFIG_INIT,
        .session = &(grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = device,
                                           .baud_bps = FAR_ROBOT_BPS, .robot = &leave_off}};
    char go;
    bool well = read(until, &go, 1) == 1 && atexit(free_it) == 0 &&
                grobo_runner_new(&config, &runner) >= 0 && grobo_runner_start(runner) >= 0 &&
                grobo_runner_connect(runner, 0) >= 0 &&
                runner_torque(runner, EVERY_JOINT, GROBO_TORQUE_ON, 0) >= 0;

    exit(well ? 0 : 1);
}

TEST(a_program_may_free_it_at_exit)
{
    int start[2];
    int status = -1;
    pid_t child;

    choose_device();
    assert_int_equal(pipe(start), 0);
    child = fork(); /* before there are threads */
    assert_true(child >= 0);
    if (child == 0) {
        be_a_program(start[0]);
    }
    far_robot_start(&robot, device);
    assert_int_equal(write(start[1], "", 1), 1);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    assert_int_equal(far_robot_torqued(&robot), 0);
    assert_int_equal(close(start[0]), 0);
    assert_int_equal(close(start[1]), 0);
    (void)tear_down();
}

/* ---- losing the line ---------------------------------------------------------------------- */

/* A thread that waits for the robot until it is told that it is gone. */
typedef struct waiter {
    grobo_thread thread;
    int number;
    int answers;
    int result;
} waiter;

static int wait_once(int number)
{
    grobo_posture posture;
    double angle_rad;

    switch (number) {
    case 0:
        return grobo_runner_wait(runner, GROBO_NEVER_US);
    case 1:
        return grobo_runner_read_posture(runner, &posture, GROBO_NEVER_US);
    case 2:
        return grobo_runner_read_angle(runner, ELBOW, &angle_rad, GROBO_NEVER_US);
    default:
        return runner_check(runner, GROBO_NEVER_US);
    }
}

static GROBO_THREAD_FUNC wait_for_loss(void *arg)
{
    waiter *self = arg;

    /* The adapter answers no more before it is found gone: that is a silent robot, not a loss. */
    do {
        self->result = wait_once(self->number);
        self->answers++;
    } while (self->result >= 0 || self->result == GROBO_ERR_TIMEOUT);
    GROBO_THREAD_RETURN;
}

TEST_WITH(on_line, nobody_waits_for_a_robot_that_is_gone)
{
    waiter waiters[4] = {0};
    int unplugged = 0;

    for (int threaded = 0; threaded < 2; threaded++) {
        int64_t begin_us;

        make((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = false}, threaded != 0);
        runner_have_motion(4);
        assert_int_equal(grobo_runner_play_motion(runner, &for_long), GROBO_OK);
        for (int i = 0; i < 4; i++) {
            waiters[i].number = i;
            assert_int_equal(grobo_thread_start(&waiters[i].thread, wait_for_loss, &waiters[i]),
                             GROBO_OK);
        }
        /* They are at it when a few readings of our own, in turn with theirs, are done. */
        for (int i = 0; i < 3; i++) {
            (void)wait_once(2);
        }
        begin_us = grobo_now_us();
        far_robot_plug(&robot, false);
        for (int i = 0; i < 4; i++) {
            assert_int_equal(grobo_thread_join(waiters[i].thread), GROBO_OK);
            /* Who asked when it was gone already has been told that it is closed. */
            assert_true(waiters[i].result == GROBO_ERR_UNPLUGGED ||
                        (i > 0 && waiters[i].result == GROBO_ERR_CLOSED));
            unplugged += waiters[i].result == GROBO_ERR_UNPLUGGED;
        }
        assert_true(grobo_now_us() - begin_us < 2000000);
        assert_false(grobo_runner_is_connected(runner));
        assert_false(runner_plays(runner));
        assert_int_equal(runner_go_to_zero(runner), GROBO_ERR_CLOSED);
        assert_int_equal(grobo_runner_wait(runner, 0), GROBO_ERR_UNPLUGGED);
        assert_int_equal(grobo_runner_free(runner), GROBO_OK);
        far_robot_plug(&robot, true);
    }
    assert_true(unplugged >= 2);
}

static GROBO_THREAD_FUNC connect_again(void *arg)
{
    waiter *self = arg;

    self->result = grobo_runner_connect(runner, GROBO_NEVER_US);
    GROBO_THREAD_RETURN;
}

TEST_WITH(on_line, who_waits_for_its_return_is_told)
{
    waiter self = {0};

    make((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT,
                               .session = &(grobo_session_config){GROBO_SESSION_CONFIG_INIT,
                                                                  .reconnect = true}},
         true);
    far_robot_plug(&robot, false);
    while (grobo_runner_is_connected(runner)) {
        (void)grobo_runner_svc(runner);
    }
    assert_int_equal(grobo_thread_start(&self.thread, connect_again, &self), GROBO_OK);
    far_robot_plug(&robot, true);
    assert_int_equal(grobo_thread_join(self.thread), GROBO_OK);
    assert_int_equal(self.result, GROBO_OK);
    assert_int_equal(runner_check(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
}

/* ---- leaving the robot -------------------------------------------------------------------- */

TEST_WITH(on_line, every_way_out_leaves_the_robot_well)
{
    make((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT}, true);
    have_torque();
    assert_int_equal(grobo_runner_stop(runner), GROBO_OK);
    assert_int_equal(far_robot_torqued(&robot), 0);
    assert_true(grobo_runner_is_connected(runner));
    have_torque();
    assert_int_equal(grobo_runner_close(runner, 0), GROBO_OK);
    assert_int_equal(far_robot_torqued(&robot), 0);
    runner_come_up();
    have_torque();
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    assert_int_equal(far_robot_torqued(&robot), 0);

    make((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT}, true);
    have_torque();
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    assert_int_equal(far_robot_torqued(&robot), 0);
}

TEST_WITH(on_line, a_robot_is_left_as_it_is_if_so_configured)
{
    make((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .skip_exit = true}, true);
    have_torque();
    assert_int_equal(grobo_runner_stop(runner), GROBO_OK);
    assert_int_equal(grobo_runner_close(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    assert_int_equal(far_robot_torqued(&robot), 20);
}

/* Tells a job's end to a test that must not call meanwhile. */
static void on_robot(void *ctx, const grobo_event *event)
{
    const int *to = ctx;

    if (event->kind == GROBO_EVENT_JOB && event->u.job.kind == GROBO_JOB_EXIT) {
        (void)!write(*to, "", 1);
    }
}

TEST_WITH(on_line, a_robot_whose_owner_is_gone_is_left_well)
{
    evutil_socket_t pair[2];
    char told;

    assert_int_equal(evutil_socketpair(AF_UNIX, SOCK_STREAM, 0, pair), 0);
    make(
        (grobo_runner_config){
            GROBO_RUNNER_CONFIG_INIT,
            .session = &(grobo_session_config){GROBO_SESSION_CONFIG_INIT, .on_robot = on_robot,
                                               .ctx = &pair[1]},
            .owner_timeout_us = 200000,
        },
        true);
    have_torque();
    /* Whoever waits is there. */
    runner_have_motion(1);
    assert_int_equal(grobo_runner_play_motion(runner, &for_long), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 600000), GROBO_ERR_PENDING);
    assert_int_equal(grobo_port_wait(pair[0], GROBO_PORT_READABLE, 0), 0);
    assert_true(runner_plays(runner));
    /* And now nobody. */
    assert_int_equal(grobo_port_wait(pair[0], GROBO_PORT_READABLE, 20000000), GROBO_PORT_READABLE);
    assert_int_equal(read(pair[0], &told, 1), 1);
    assert_int_equal(far_robot_torqued(&robot), 0);
    assert_false(runner_plays(runner));
    /* It comes back, and is gone again. */
    have_torque();
    assert_int_equal(grobo_port_wait(pair[0], GROBO_PORT_READABLE, 20000000), GROBO_PORT_READABLE);
    assert_int_equal(far_robot_torqued(&robot), 0);
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    assert_int_equal(close(pair[0]), 0);
    assert_int_equal(close(pair[1]), 0);
}

static int look_at_tick(void *arg, grobo_runner *its)
{
    *(int64_t *)arg = its->tick_us;
    return GROBO_OK;
}

static int on_svc(void *ctx, grobo_runner *its)
{
    (void)ctx;
    (void)its;
    return GROBO_OK;
}

TEST_WITH(on_line, a_runner_looks_each_period_for_its_service_alone)
{
    int64_t tick_us = 0;

    make((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT}, true);
    assert_int_equal(grobo_runner_call(runner, look_at_tick, &tick_us), GROBO_OK);
    assert_int_equal(tick_us, GROBO_NEVER_US);
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    make((grobo_runner_config){GROBO_RUNNER_CONFIG_INIT, .on_svc = on_svc}, true);
    assert_int_equal(grobo_runner_call(runner, look_at_tick, &tick_us), GROBO_OK);
    assert_int_not_equal(tick_us, GROBO_NEVER_US);
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
}
