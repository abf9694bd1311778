/* SPDX-License-Identifier: MIT */
/* A command that nobody waits for any more does not leave. */
#include <stdint.h>
#include <string.h>

#include <grobo/core/runner.h>

#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { ELBOW = 13, PATIENCE_US = 1500000 };

/* Motor 2 to 1.0 degree in 20 s. */
static const uint8_t goal[] = {0x53, 0x0C, 0xFA, 0xAF, 0x02, 0x00, 0x1E,
                               0x04, 0x01, 0x0A, 0x00, 0xD0, 0x07, 0xC4};

/* Filled by the loop, looked at when it is over. */
static struct {
    uint8_t bytes[1 << 20];
    size_t size;
} sent;

static void on_tap(void *ctx, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                   size_t size)
{
    (void)now_us;
    (void)ctx;
    if (direction == GROBO_DIR_TX && sent.size + size <= sizeof sent.bytes) {
        memcpy(sent.bytes + sent.size, bytes, size);
        sent.size += size;
    }
}

static int times_sent(void)
{
    int n = 0;

    for (size_t i = 0; i + sizeof goal <= sent.size; i++) {
        n += memcmp(sent.bytes + i, goal, sizeof goal) == 0;
    }
    return n;
}

/* 4 s in which the frames of a motion leave no room for anything else. */
static void fill_line(grobo_runner *runner)
{
    const grobo_play_options full = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                     .rate_hz = 53, .unwatched = true};
    grobo_motion *motion;
    grobo_posture posture;

    assert_int_equal(grobo_motion_new(GROBO_MOTION_POSTURES, 20, NULL, &motion), GROBO_OK);
    grobo_posture_init_pose(&posture, &grobo_i_gr001_model);
    for (int i = 0; i < 2; i++) {
        posture.time_us = 4000000 * i;
        assert_int_equal(grobo_posture_set_deg(&posture, ELBOW, 5.0 * i), GROBO_OK);
        assert_int_equal(grobo_motion_append(motion, &posture), GROBO_OK);
    }
    assert_int_equal(grobo_runner_set_motion(runner, motion), 2);
    grobo_motion_free(motion);
    assert_int_equal(grobo_runner_play_motion(runner, &full), GROBO_OK);
}

TEST(a_command_that_took_too_long_does_not_leave)
{
    grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT,
                                  .session = &(grobo_session_config){GROBO_SESSION_CONFIG_INIT,
                                                                     .device = GROBO_DEVICE_SIM,
                                                                     .on_tap = on_tap},
                                  .skip_exit = true};
    grobo_runner *runner;

    assert_int_equal(grobo_runner_new(&config, &runner), GROBO_OK);
    assert_int_equal(grobo_runner_start(runner), GROBO_OK);
    assert_int_equal(grobo_runner_connect(runner, 0), GROBO_OK);
    assert_int_equal(
        grobo_runner_set_servo_states(runner, GROBO_JOINTS_ALL(20), GROBO_TORQUE_ON, 0), 0);
    fill_line(runner);
    /* It is begun when the robot is known to be where the motion begins, and finds no room. */
    assert_int_equal(grobo_runner_send_command(runner, goal, sizeof goal, PATIENCE_US),
                     GROBO_ERR_TIMEOUT);
    assert_int_equal(grobo_runner_wait(runner, 10000000), GROBO_OK);
    /* The next one has the line to itself. */
    assert_int_equal(grobo_runner_send_command(runner, goal, sizeof goal, 0), sizeof goal);
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    assert_int_equal(times_sent(), 1);
}
