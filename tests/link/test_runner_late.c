/* SPDX-License-Identifier: MIT */
/* A runner that is held up does not take what waits on the line for silence. */
#include <poll.h>
#include <stdint.h>

#include <grobo/core/runner.h>

#include "tests/support/line.h"
#include "tests/support/test.h"

enum { PATIENCE_US = 300000, HELD_UP_US = GROBO_SILENCE_DEFAULT_MS * 1000 + 1000 };

static const uint8_t CHECK[] = {0x41, 0x00};
static const uint8_t ACK = 0x07; /* of the board, to a check */

static test_line line;

/*
 * Runs in the round in which grobo_runner_receive() asks, before it: the answer comes, but the
 * loop does not get to read it before the silence has lasted too long.
 */
static int hold_up(void *arg, grobo_runner *runner)
{
    struct pollfd near = {.fd = grobo_serial_handle(grobo_runner_serial(runner)), .events = POLLIN};
    int64_t until_us = grobo_now_us() + HELD_UP_US;

    (void)arg;
    test_line_write(&line, &ACK, sizeof ACK);
    assert_int_equal(poll(&near, 1, 5000), 1);
    while (grobo_now_us() <= until_us) {
    }
    return GROBO_OK;
}

/* A runner that has sent a check, and takes what comes for its answer. */
static grobo_runner *ask(grobo_runner_fn on_svc)
{
    /* Nobody but the test asks, and nobody stops waiting for the answer. */
    const grobo_robot_config robot = {GROBO_ROBOT_CONFIG_INIT, .bus.margin_us = 60000000,
                                      .retries = -1, .sense_interval_us = GROBO_SENSE_NEVER};
    grobo_session_config session = {GROBO_SESSION_CONFIG_INIT, .robot = &robot, .skip_check = true};
    grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session, .on_svc = on_svc,
                                  .skip_exit = true};
    grobo_runner *runner;
    uint8_t got[2] = {0, 0};

    test_line_open(&line);
    session.device = line.device;
    assert_int_equal(grobo_runner_new(&config, &runner), GROBO_OK);
    assert_int_equal(grobo_runner_connect(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_send_command(runner, CHECK, sizeof CHECK, PATIENCE_US),
                     GROBO_ERR_TIMEOUT);
    test_line_read(&line, got, sizeof got);
    assert_memory_equal(got, CHECK, sizeof CHECK);
    return runner;
}

TEST(what_has_come_is_read_before_there_is_silence)
{
    grobo_runner *runner = ask(NULL);
    uint8_t got[2] = {0, 0};

    assert_int_equal(grobo_runner_post(runner, hold_up, NULL), GROBO_OK);
    assert_int_equal(grobo_runner_receive(runner, got, 1), 1);
    assert_int_equal(got[0], ACK);
    assert_int_equal(grobo_runner_receive(runner, got, 1), GROBO_ERR_TIMEOUT);
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    test_line_close(&line);
}

/* Its caller has been told that it did not leave in time, and may send another. */
TEST(a_command_whose_time_is_over_does_not_leave)
{
    /* The line is never free: what is read is not answered, and waited for. */
    const grobo_robot_config robot = {GROBO_ROBOT_CONFIG_INIT, .bus.margin_us = 60000000,
                                      .retries = -1, .sense_interval_us = 10000};
    grobo_session_config session = {GROBO_SESSION_CONFIG_INIT, .robot = &robot, .skip_check = true};
    grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session, .skip_exit = true};
    int64_t end_us = grobo_now_us() + 5000000;
    grobo_runner *runner;
    uint8_t got[64];

    test_line_open(&line);
    session.device = line.device;
    assert_int_equal(grobo_runner_new(&config, &runner), GROBO_OK);
    assert_int_equal(grobo_runner_connect(runner, 0), GROBO_OK);
    while (test_line_read_some(&line, got, sizeof got) == 0) {
        assert_true(grobo_now_us() < end_us);
        assert_int_equal(grobo_runner_svc(runner), 1);
    }
    assert_int_equal(grobo_runner_send_command(runner, CHECK, sizeof CHECK, PATIENCE_US / 10),
                     GROBO_ERR_TIMEOUT);
    assert_int_equal(grobo_runner_svc(runner), 1);
    assert_int_equal(grobo_robot_job(grobo_runner_robot(runner)), GROBO_JOB_NONE);
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    test_line_close(&line);
}

static bool trickles;

/* The beginning of a reply, which is no answer yet: the command continues to wait. */
static int send_a_byte(void *arg, grobo_runner *runner)
{
    const uint8_t noise = 0xFD;

    (void)runner;
    (void)arg;
    if (trickles) {
        test_line_write(&line, &noise, sizeof noise);
    }
    return GROBO_OK;
}

TEST(a_trickle_does_not_stretch_a_receive)
{
    grobo_runner *runner = ask(send_a_byte);
    uint8_t got[400];
    int64_t start_us = grobo_now_us();

    trickles = true;
    /* A byte in each round of 10 ms: 400 would take 4 s. */
    assert_int_equal(grobo_runner_receive(runner, got, sizeof got), GROBO_ERR_SHORT);
    assert_in_range(grobo_now_us() - start_us, 1000 * GROBO_SILENCE_DEFAULT_MS, 2000000);
    trickles = false;
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    test_line_close(&line);
}
