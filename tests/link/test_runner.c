/* SPDX-License-Identifier: MIT */
/*
 * Every function of a runner, over the simulator, from a thread that is not the loop's: once
 * while a runner's thread runs the loop, and once without, where the calls run it themselves.
 */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <event2/event.h>

#include <grobo/core/robot.h>
#include <grobo/core/sim.h>

#include "tests/support/counted_mem.h"
#include "tests/support/folder.h"
#include "tests/support/runner_kit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

/* ---- facts and settings ------------------------------------------------------------------- */

TEST_WITH(with_and_without_thread, name_and_joints)
{
    assert_string_equal(grobo_runner_name(runner), "GR001");
    assert_int_equal(grobo_runner_joints(runner), 20);

    /* Of a robot of three joints. */
    grobo_joint joints[3];
    grobo_model model =
        GROBO_TABLE(grobo_model, .name = "leg", GROBO_MODEL_JOINTS(joints), .n_joints = 3);
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    grobo_runner *leg = NULL;
    for (int j = 0; j < 3; j++) {
        joints[j] = grobo_i_gr001_model.joints[j];
        joints[j].mirror = (uint8_t)j;
    }
    assert_int_equal(grobo_rs30x_driver_init(&driver, &model, &grobo_i_rs30x_protocol), GROBO_OK);
    const grobo_runner_config config = {
        GROBO_RUNNER_CONFIG_INIT, .name = "Robin",
        .session = &(grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM,
                                           .driver = &driver}};
    assert_int_equal(grobo_runner_new(&config, &leg), GROBO_OK);
    assert_string_equal(grobo_runner_name(leg), "Robin");
    assert_int_equal(grobo_runner_joints(leg), 3);
    assert_int_equal(grobo_runner_free(leg), GROBO_OK);
}

static int rx_bytes(void *arg, grobo_runner *from)
{
    uint64_t tx;
    uint64_t rx;

    (void)arg;
    grobo_session_bytes(grobo_runner_session(from), &tx, &rx);
    return (int)rx;
}

/* Lets the loop run for a while, whoever runs it; the bytes that came. */
static int bytes_in(int64_t span_us)
{
    int before = grobo_runner_call(runner, rx_bytes, NULL);
    int64_t end_us = grobo_now_us() + span_us;

    while (grobo_now_us() < end_us) {
        assert_true(grobo_runner_svc(runner) >= 0);
    }
    return grobo_runner_call(runner, rx_bytes, NULL) - before;
}

/* ---- the line ----------------------------------------------------------------------------- */

TEST_WITH(with_and_without_thread, the_line_opens_and_closes)
{
    char device[GROBO_DEVICE_MAX_BYTES];
    char longer[GROBO_DEVICE_MAX_BYTES + 1];
    grobo_os_cause cause;

    assert_false(grobo_runner_is_connected(runner));
    assert_int_equal(runner_check(runner, 0), GROBO_ERR_CLOSED);
    assert_int_equal(runner_go_to_zero(runner), GROBO_ERR_CLOSED);

    assert_int_equal(grobo_runner_set_device(runner, "/nowhere/tty"), GROBO_OK);
    assert_int_equal(grobo_runner_get_device(runner, device, sizeof device), 12);
    assert_string_equal(device, "/nowhere/tty");
    assert_int_equal(grobo_runner_get_device(runner, device, 12), GROBO_ERR_SPACE);
    memset(longer, 'x', sizeof longer - 1);
    longer[sizeof longer - 1] = '\0';
    assert_int_equal(grobo_runner_set_device(runner, longer), GROBO_ERR_CAP);
    assert_int_equal(grobo_runner_set_device(runner, NULL), GROBO_ERR_ARG);
    assert_int_equal(grobo_runner_open(runner), GROBO_ERR_NOENT);
    assert_int_equal(grobo_runner_connect(runner, 0), GROBO_ERR_NOENT);
    assert_int_equal(grobo_runner_get_cause(runner, &cause), GROBO_OK);
    assert_true(strlen(cause.text) > 0);

    assert_int_equal(grobo_runner_set_device(runner, GROBO_DEVICE_SIM), GROBO_OK);
    assert_int_equal(grobo_runner_open(runner), GROBO_OK);
    assert_int_equal(grobo_runner_open(runner), GROBO_ERR_STATE);
    assert_int_equal(grobo_runner_connect(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_connect(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_set_device(runner, "/nowhere/tty"), GROBO_ERR_STATE);
    assert_int_equal(runner_check(runner, 0), GROBO_OK);

    assert_int_equal(grobo_runner_close(runner, 0), GROBO_OK);
    assert_false(grobo_runner_is_connected(runner));
    assert_int_equal(grobo_runner_close(runner, 0), GROBO_OK);
    assert_int_equal(runner_check(runner, 0), GROBO_ERR_CLOSED);
    runner_come_up();
}

/* ---- torque, readings --------------------------------------------------------------------- */

TEST_WITH(with_and_without_thread, torque_is_switched)
{
    grobo_joint_mask elbow = GROBO_JOINT_BIT(ELBOW);

    assert_int_equal(runner_torque(runner, elbow, GROBO_TORQUE_ON, 0), GROBO_ERR_CLOSED);
    assert_int_equal(runner_torque_of(runner, ELBOW), GROBO_ERR_EMPTY);
    runner_come_up();
    assert_int_equal(runner_torque(runner, EVERY_JOINT, GROBO_TORQUE_BRAKE, 0), GROBO_OK);
    assert_int_equal(runner_torque(runner, elbow, GROBO_TORQUE_ON, 0), GROBO_OK);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(runner_torque_of(runner, j),
                         j == ELBOW ? GROBO_TORQUE_ON : GROBO_TORQUE_BRAKE);
    }
    assert_int_equal(runner_torque(runner, elbow, GROBO_TORQUE_OFF, 0), GROBO_OK);
    assert_int_equal(runner_torque_of(runner, ELBOW), GROBO_TORQUE_OFF);
    assert_int_equal(runner_torque(runner, GROBO_JOINT_BIT(20), GROBO_TORQUE_ON, 0), GROBO_ERR_ARG);
}

static int turn_elbow(void *arg, grobo_runner *from)
{
    const int32_t *angle_mdeg = arg;

    return grobo_sim_set_angle(grobo_session_sim(grobo_runner_session(from)), ELBOW, *angle_mdeg,
                               0);
}

static int cut_elbow(void *arg, grobo_runner *from)
{
    (void)arg;
    return grobo_sim_set_cable(grobo_session_sim(grobo_runner_session(from)), ELBOW,
                               GROBO_SIM_CABLE_MUTE);
}

TEST_WITH(with_and_without_thread, readings)
{
    grobo_posture posture;
    grobo_posture current;
    double angle_rad = -99;
    int32_t angle_mdeg = 12000;

    assert_int_equal(grobo_runner_read_posture(runner, &posture, 0), GROBO_ERR_CLOSED);
    runner_come_up();
    assert_int_equal(grobo_runner_call(runner, turn_elbow, &angle_mdeg), GROBO_OK);
    assert_int_equal(grobo_runner_read_posture(runner, &posture, 0), 20);
    assert_true(grobo_deg_from_rad(posture.angle_rad[ELBOW]) > 11.9);
    assert_int_equal(grobo_robot_posture(grobo_runner_robot(runner), GROBO_NEVER_US, &current), 20);
    assert_true(grobo_posture_near(&current, &posture, grobo_rad_from_deg(0.2)));
    assert_true(grobo_deg_from_rad(current.angle_rad[ELBOW]) > 11.9);
    runner_assert_elbow_at(12);
    assert_int_equal(grobo_runner_read_angle(runner, 20, &angle_rad, 0), GROBO_ERR_ARG);

    /* A servo that does not answer: nobody takes anything for its angle, the others are read. */
    assert_int_equal(grobo_runner_call(runner, cut_elbow, NULL), GROBO_OK);
    int result = GROBO_OK; /* a reading that was on its way may have been answered yet */
    for (int i = 0; i < 3 && result == GROBO_OK; i++) {
        angle_rad = -99;
        result = grobo_runner_read_angle(runner, ELBOW, &angle_rad, 0);
    }
    assert_int_equal(result, GROBO_ERR_TIMEOUT);
    assert_true(angle_rad == -99);
    assert_int_equal(grobo_runner_read_posture(runner, &posture, 0), 19);
    assert_true(posture.set == (EVERY_JOINT & ~GROBO_JOINT_BIT(ELBOW)));
}

/* ---- raw frames --------------------------------------------------------------------------- */

/* The job of a raw frame ends when it was sent, but what it moves can be stopped. */
TEST_WITH(with_and_without_thread, a_raw_move_is_stopped_like_any_other)
{
    /* Motor 5 to -90.0 degrees in 60 s. */
    static const uint8_t slow[] = {0x53, 0x0C, 0xFA, 0xAF, 0x05, 0x00, 0x1E,
                                   0x04, 0x01, 0x7C, 0xFC, 0x70, 0x17, 0xF9};
    double stood_rad;
    double angle_rad;

    runner_come_up();
    assert_int_equal(runner_torque(runner, EVERY_JOINT, GROBO_TORQUE_ON, 0), 0);
    assert_int_equal(grobo_robot_stop(grobo_runner_robot(runner), false), GROBO_ERR_STATE);
    assert_int_equal(grobo_runner_wait_job(
                         runner, grobo_robot_raw(grobo_runner_robot(runner), slow, sizeof slow), 0),
                     GROBO_OK);
    assert_true(runner_moves(runner));
    assert_int_equal(grobo_robot_stop(grobo_runner_robot(runner), false), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_false(runner_moves(runner));
    assert_int_equal(grobo_runner_read_angle(runner, ELBOW, &stood_rad, 0), GROBO_OK);
    assert_true(bytes_in(300000) >= 0);
    assert_int_equal(grobo_runner_read_angle(runner, ELBOW, &angle_rad, 0), GROBO_OK);
    assert_true(angle_rad == stood_rad);
}

/* ---- safety ------------------------------------------------------------------------------- */

TEST_WITH(with_and_without_thread, stops_are_latched_until_reset)
{
    assert_int_equal(grobo_runner_exit(runner, GROBO_EXIT_OFF, 0), GROBO_ERR_CLOSED);
    runner_come_up();
    assert_int_equal(runner_torque(runner, EVERY_JOINT, GROBO_TORQUE_ON, 0), GROBO_OK);
    assert_int_equal(grobo_runner_estop(runner), GROBO_OK);
    (void)grobo_runner_wait(runner, 0);
    assert_int_equal(runner_torque_of(runner, ELBOW), GROBO_TORQUE_BRAKE);
    assert_int_equal(runner_torque(runner, GROBO_JOINT_BIT(ELBOW), GROBO_TORQUE_ON, 0),
                     GROBO_ERR_LATCHED);
    assert_int_equal(runner_go_to_zero(runner), GROBO_ERR_LATCHED);
    assert_int_equal(grobo_runner_reset(runner), GROBO_OK);
    assert_int_equal(runner_torque(runner, GROBO_JOINT_BIT(ELBOW), GROBO_TORQUE_ON, 0), GROBO_OK);
    assert_int_equal(grobo_runner_exit(runner, GROBO_EXIT_OFF, 0), GROBO_OK);
    assert_int_equal(runner_torque_of(runner, ELBOW), GROBO_TORQUE_OFF);
}

/* ---- making ------------------------------------------------------------------------------- */

TEST(bad_configurations_and_lack_of_memory)
{
    struct event_base *base = grobo_loop_new();
    grobo_session_config session = {GROBO_SESSION_CONFIG_INIT};
    grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session};
    grobo_runner *made = NULL;
    char longer[GROBO_NAME_MAX_BYTES + 1];
    counted_mem counter;
    const grobo_mem mem = counted_mem_of(&counter);
    int r = GROBO_ERR_NOMEM;

    assert_int_equal(grobo_runner_new(NULL, &made), GROBO_ERR_ARG);
    assert_int_equal(grobo_runner_new(&config, &made), GROBO_ERR_ARG);
    session.device = GROBO_DEVICE_SIM;
    assert_int_equal(grobo_runner_new(&config, NULL), GROBO_ERR_ARG);
    session.base = base;
    assert_int_equal(grobo_runner_new(&config, &made), GROBO_ERR_ARG);
    session.base = NULL;
    config.period_us = 999;
    assert_int_equal(grobo_runner_new(&config, &made), GROBO_ERR_ARG);
    config.period_us = 0;
    memset(longer, 'x', sizeof longer - 1);
    longer[sizeof longer - 1] = '\0';
    config.name = longer;
    assert_int_equal(grobo_runner_new(&config, &made), GROBO_ERR_CAP);
    assert_null(made);
    config.name = "Robin";
    config.period_us = 3000;
    session.mem = &mem;
    for (size_t n = 1; r == GROBO_ERR_NOMEM; n++) {
        assert_true(n <= 20);
        counter = (counted_mem){.fail_at = n};
        r = grobo_runner_new(&config, &made);
        if (r < 0) {
            assert_null(made);
            assert_int_equal(counter.bytes, 0);
        }
    }
    assert_int_equal(r, GROBO_OK);
    assert_string_equal(grobo_runner_name(made), "Robin");
    assert_int_equal(grobo_runner_joints(made), 20);
    assert_int_equal(grobo_runner_get_device(made, longer, sizeof longer), 3);
    assert_string_equal(longer, GROBO_DEVICE_SIM);
    assert_int_equal(grobo_runner_free(made), GROBO_OK);
    assert_int_equal(counter.bytes, 0);
    assert_int_equal(grobo_runner_free(NULL), GROBO_OK);
    event_base_free(base);
}
