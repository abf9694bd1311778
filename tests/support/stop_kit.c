/* SPDX-License-Identifier: MIT */
#include <stdint.h>
#include <string.h>

#include "src/link/runner/runner.h"
#include "tests/support/stop_kit.h"
#include "tests/support/test.h"

struct saw saw, told;
hold gate;
int (*in_callback)(grobo_runner *from);
int callback_result;
grobo_mutex users;

static int on_svc(void *ctx, grobo_runner *from)
{
    int (*asked)(grobo_runner *);

    (void)ctx;
    hold_here(&gate);
    grobo_mutex_lock(&users);
    grobo_mutex_unlock(&users);
    asked = in_callback;
    in_callback = NULL;
    if (asked != NULL) {
        callback_result = asked(from);
    }
    return 0;
}

static void on_robot(void *ctx, const grobo_event *event)
{
    (void)ctx;
    saw.trips += event->kind == GROBO_EVENT_TRIP;
    if (event->kind == GROBO_EVENT_PLAY && event->u.play.to == GROBO_SEQUENCER_STOPPING) {
        saw.stop_us = -event->now_us;
    }
    if (event->kind == GROBO_EVENT_PLAY && event->u.play.from == GROBO_SEQUENCER_STOPPING) {
        saw.stop_us += event->now_us;
    }
    if (event->kind == GROBO_EVENT_JOB && event->u.job.kind == GROBO_JOB_ESTOP) {
        saw.estops++;
        saw.estop_result = event->u.job.result;
    }
    if (event->kind == GROBO_EVENT_JOB && event->u.job.kind == GROBO_JOB_EXIT) {
        saw.exits++;
        saw.exit_result = event->u.job.result;
    }
}

/* A packet for the servos is behind two bytes of the board: its address is the seventh byte, and
 * the ninth how many servos it writes to, 0 for a reading. */
static void on_tap(void *ctx, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                   size_t size)
{
    (void)now_us;
    (void)ctx;
    if (direction == GROBO_DIR_TX) {
        bool writes = size > 8 && bytes[2] == 0xFA && bytes[3] == 0xAF && bytes[8] > 0;
        int address = writes ? bytes[6] : -1;

        saw.goals += address == GOAL;
        if (saw.listen && saw.first == 0) {
            saw.first = address;
        }
    }
}

void stop_kit_make(grobo_runner_config config)
{
    grobo_session_config session = {GROBO_SESSION_CONFIG_INIT};

    if (config.session != NULL) {
        session = *config.session;
    }
    config.session = &session;
    session.device = GROBO_DEVICE_SIM;
    session.baud_bps = 1000000;
    session.on_robot = on_robot;
    session.on_tap = on_tap;
    config.period_us = config.period_us > 0 ? config.period_us : 1000;
    config.on_svc = on_svc;
    memset(&saw, 0, sizeof saw);
    in_callback = NULL;
    callback_result = 0;
    hold_init(&gate);
    assert_int_equal(grobo_mutex_init(&users), GROBO_OK);
    assert_int_equal(grobo_runner_new(&config, &runner), GROBO_OK);
}

void stop_kit_end(void)
{
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    hold_deinit(&gate);
    grobo_mutex_deinit(&users);
}

void stop_kit_start(grobo_runner_config config)
{
    stop_kit_make(config);
    assert_int_equal(grobo_runner_start(runner), GROBO_OK);
    assert_int_equal(grobo_runner_connect(runner, LONG_US), GROBO_OK);
    assert_int_equal(runner_torque(runner, EVERY_JOINT, GROBO_TORQUE_ON, LONG_US), GROBO_OK);
}

void move_for_long(void)
{
    assert_true(runner_move_elbow(runner, 45, LONG_US) > 0);
    assert_int_equal(grobo_runner_wait(runner, 300000), GROBO_ERR_PENDING);
    assert_true(runner_moves(runner));
}

int copy_seen(void *arg, grobo_runner *from)
{
    (void)from;
    memcpy(arg, &saw, sizeof saw);
    return 0;
}

int tripped(void *arg, grobo_runner *from)
{
    grobo_trip_info trip;

    (void)arg;
    grobo_robot_tripped(grobo_session_robot(grobo_runner_session(from)), &trip);
    return trip.latched;
}

int begin_to_listen(void *arg, grobo_runner *from)
{
    (void)from;
    (void)arg;
    saw.listen = true;
    saw.first = 0;
    return 0;
}

void assert_stopped(int estops)
{
    (void)grobo_runner_wait(runner, 0);
    assert_int_equal(grobo_runner_call(runner, tripped, NULL), 1);
    assert_true(grobo_runner_is_latched(runner));
    assert_false(runner_moves(runner));
    assert_int_equal(grobo_runner_call(runner, copy_seen, &told), 0);
    assert_int_equal(told.estops, estops);
    assert_int_equal(told.estop_result, GROBO_OK);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(runner_torque_of(runner, j), GROBO_TORQUE_BRAKE);
    }
}

void play_for_long(void)
{
    const grobo_play_options fast = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                     .rate_hz = 100,          .unwatched = true,
                                     .stop_us = STOP_US,      .repeat = 1000000};
    int64_t end_us = grobo_now_us() + LONG_US / 2;
    int before;

    assert_int_equal(grobo_runner_call(runner, copy_seen, &told), 0);
    before = told.goals;
    runner_have_motion(4);
    assert_int_equal(grobo_runner_play_motion(runner, &fast), GROBO_OK);
    do {
        assert_int_equal(grobo_runner_call(runner, copy_seen, &told), 0);
        assert_true(grobo_now_us() < end_us);
    } while (told.goals < before + 20);
}

static GROBO_THREAD_FUNC run_call(void *arg)
{
    caller *self = arg;

    self->result = self->call(runner);
    GROBO_THREAD_RETURN;
}

void begin_call(caller *c, int (*call)(grobo_runner *from), int slots)
{
    int64_t end_us = grobo_now_us() + 10000000;
    int n;

    c->call = call;
    assert_int_equal(grobo_thread_start(&c->thread, run_call, c), GROBO_OK);
    do {
        n = 0;
        grobo_i_runner_lock(runner);
        for (int i = 0; i < RUNNER_SLOTS; i++) {
            n += runner->slot[i].state != CALL_FREE;
        }
        grobo_i_runner_unlock(runner);
        assert_true(grobo_now_us() < end_us);
    } while (n < slots);
}

int end_call(caller *c)
{
    assert_int_equal(grobo_thread_join(c->thread), GROBO_OK);
    return c->result;
}
