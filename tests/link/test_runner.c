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

TEST_WITH(with_and_without_thread, settings_are_kept)
{
    char dir[sizeof folder];
    char longer[GROBO_PATH_MAX_BYTES + 1];

    assert_int_equal(grobo_runner_get_motion_dir(runner, dir, sizeof dir), (int)strlen(folder));
    assert_string_equal(dir, folder);
    assert_int_equal(grobo_runner_get_motion_dir(runner, dir, strlen(folder)), GROBO_ERR_SPACE);
    memset(longer, 'x', sizeof longer - 1);
    longer[sizeof longer - 1] = '\0';
    assert_int_equal(grobo_runner_set_motion_dir(runner, longer), GROBO_ERR_CAP);
    assert_int_equal(grobo_runner_set_motion_dir(runner, NULL), GROBO_ERR_ARG);

    assert_int_equal(grobo_runner_get_default_time_us(runner), 100000);
    assert_int_equal(grobo_runner_set_default_time_us(runner, 250000), GROBO_OK);
    assert_int_equal(grobo_runner_get_default_time_us(runner), 250000);
    assert_int_equal(grobo_runner_set_default_time_us(runner, 0), GROBO_ERR_ARG);

    assert_int_equal(grobo_runner_get_sense_interval_us(runner), 1000000);
    assert_int_equal(grobo_runner_set_sense_interval_us(runner, 50000), GROBO_OK);
    assert_int_equal(grobo_runner_get_sense_interval_us(runner), 50000);
    assert_int_equal(grobo_runner_get_default_time_us(runner), 250000);
    assert_int_equal(grobo_runner_set_sense_interval_us(runner, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_runner_set_sense_interval_us(runner, GROBO_SENSE_NEVER), GROBO_OK);

    assert_int_equal(grobo_runner_get_period_us(runner), GROBO_RUNNER_PERIOD_US);
    assert_int_equal(grobo_runner_set_period_us(runner, 20000), GROBO_OK);
    assert_int_equal(grobo_runner_get_period_us(runner), 20000);
    assert_int_equal(grobo_runner_set_period_us(runner, 500000), GROBO_OK);
    assert_int_equal(grobo_runner_get_period_us(runner), 500000);
    assert_int_equal(grobo_runner_set_period_us(runner, 999), GROBO_ERR_ARG);

    assert_int_equal(grobo_runner_set_motion_count(runner, 3), GROBO_OK);
    assert_false(grobo_runner_is_reverse(runner));
    assert_int_equal(grobo_runner_set_motion_count(runner, -3), GROBO_OK);
    assert_true(grobo_runner_is_reverse(runner));
    assert_int_equal(grobo_runner_set_motion_count(runner, 1), GROBO_OK);
    grobo_runner_set_reverse(runner, true);
    assert_true(grobo_runner_is_reverse(runner));
    grobo_runner_set_reverse(runner, false);
    assert_false(grobo_runner_is_reverse(runner));
}

static int rx_bytes(void *arg, grobo_runner *from)
{
    uint64_t tx;
    uint64_t rx;

    (void)arg;
    grobo_session_bytes(grobo_runner_session(from), &tx, &rx);
    return (int)rx;
}

static int goal_time_cs(void *arg, grobo_runner *from)
{
    int32_t value = -1;

    (void)arg;
    (void)grobo_sim_get_register(grobo_session_sim(grobo_runner_session(from)), ELBOW,
                                 GROBO_RS30X_GOAL_TIME, &value);
    return (int)value;
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

TEST_WITH(with_and_without_thread, settings_take_effect)
{
    grobo_posture posture;

    runner_come_up();
    assert_int_equal(grobo_runner_set_sense_interval_us(runner, GROBO_SENSE_NEVER), GROBO_OK);
    assert_int_equal(grobo_runner_read_posture(runner, &posture, 0), 20); /* what was under way */
    assert_int_equal(bytes_in(100000), 0);
    assert_int_equal(grobo_runner_set_sense_interval_us(runner, 20000), GROBO_OK);
    assert_true(bytes_in(100000) >= 26);

    assert_int_equal(grobo_runner_set_default_time_us(runner, 340000), GROBO_OK);
    assert_int_equal(grobo_runner_set_motion_time_us(runner, 0), GROBO_OK);
    for (int i = 1; i <= 2; i++) { /* the way to the first is longer */
        assert_int_equal(grobo_runner_set_joint(runner, ELBOW, grobo_rad_from_deg(2 * i)),
                         GROBO_OK);
        assert_int_equal(grobo_runner_start_motion(runner), GROBO_OK);
        assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    }
    assert_int_equal(grobo_runner_call(runner, goal_time_cs, NULL), 34);
}

TEST_WITH(with_and_without_thread, postures_are_kept)
{
    grobo_posture posture;
    grobo_posture got;

    grobo_runner_get_init_posture(runner, &got);
    assert_int_equal(got.n_joints, 20);
    assert_true(got.set == EVERY_JOINT);
    for (int j = 0; j < 20; j++) {
        assert_true(got.angle_rad[j] == 0);
    }
    grobo_posture_init_pose(&got, &grobo_i_gr001_model);
    assert_true(got.set == EVERY_JOINT);
    for (int j = 0; j < 20; j++) {
        assert_true(got.angle_rad[j] == grobo_i_gr001_model.joints[j].init_rad);
    }
    assert_int_equal(grobo_runner_set_init_posture(runner, &got), GROBO_OK);
    grobo_runner_get_init_posture(runner, &posture);
    assert_true(grobo_posture_equal(&posture, &got));
    assert_int_equal(grobo_posture_set_deg(&got, 0, 0), GROBO_OK);
    assert_int_equal(grobo_posture_set_deg(&got, ELBOW, 1000), GROBO_OK);
    assert_int_equal(grobo_runner_set_init_posture(runner, &got), GROBO_ERR_LIMIT);
    assert_int_equal(grobo_posture_set_deg(&got, ELBOW, 7), GROBO_OK);
    assert_int_equal(grobo_runner_set_init_posture(runner, &got), GROBO_OK);
    grobo_runner_get_init_posture(runner, &posture);
    assert_true(grobo_posture_equal(&posture, &got));

    grobo_runner_get_target_posture(runner, &posture);
    assert_true(posture.set == 0);
    assert_int_equal(grobo_runner_set_joint(runner, ELBOW, grobo_rad_from_deg(8)), GROBO_OK);
    assert_int_equal(grobo_runner_set_joint(runner, 20, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_runner_set_joint(runner, -1, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_runner_set_joint(runner, ELBOW, 99), GROBO_ERR_LIMIT);
    assert_int_equal(grobo_runner_set_joint(runner, ELBOW, 0.0 / (double)(runner == NULL)),
                     GROBO_ERR_NAN);
    assert_int_equal(grobo_runner_set_motion_time_us(runner, 300000), GROBO_OK);
    assert_int_equal(grobo_runner_set_motion_time_us(runner, -1), GROBO_ERR_ARG);
    grobo_runner_get_target_posture(runner, &posture);
    assert_true(posture.set == GROBO_JOINT_BIT(ELBOW));
    assert_true(posture.angle_rad[ELBOW] == grobo_rad_from_deg(8));
    assert_int_equal(posture.time_us, 300000);
    got.time_us = 650000;
    assert_int_equal(grobo_posture_set_deg(&got, 0, 3), GROBO_OK);
    assert_int_equal(grobo_runner_set_target_posture(runner, &got), GROBO_OK);
    grobo_posture kept = got;
    got.n_joints = 3;
    assert_int_equal(grobo_runner_set_target_posture(runner, &got), GROBO_ERR_ARG);
    grobo_runner_get_target_posture(runner, &posture);
    assert_true(grobo_posture_equal(&posture, &kept));
    assert_int_equal(posture.time_us, 650000);
    grobo_runner_get_init_posture(runner, &posture); /* is another one */
    assert_true(posture.angle_rad[0] == 0 && posture.angle_rad[ELBOW] == kept.angle_rad[ELBOW]);
}

/* ---- the line ----------------------------------------------------------------------------- */

/* Asserts nothing itself: it may run on another thread than the test. */
static int serial_is_closed(void *arg, grobo_runner *from)
{
    grobo_serial *serial = grobo_runner_serial(from);

    return from == runner && arg == NULL &&
                   serial == grobo_session_serial(grobo_runner_session(from)) &&
                   !grobo_serial_is_open(serial)
               ? 77
               : 0;
}

TEST_WITH(with_and_without_thread, the_line_opens_and_closes)
{
    char device[GROBO_DEVICE_MAX_BYTES];
    char longer[GROBO_DEVICE_MAX_BYTES + 1];
    grobo_os_cause cause;

    assert_false(grobo_runner_is_connected(runner));
    assert_int_equal(grobo_runner_check_connection(runner, 0), GROBO_ERR_CLOSED);
    assert_int_equal(grobo_runner_start_motion(runner), GROBO_ERR_CLOSED);

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
    assert_int_equal(grobo_runner_check_connection(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_call(runner, serial_is_closed, NULL), 77);

    assert_int_equal(grobo_runner_close(runner, 0), GROBO_OK);
    assert_false(grobo_runner_is_connected(runner));
    assert_int_equal(grobo_runner_close(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_check_connection(runner, 0), GROBO_ERR_CLOSED);
    runner_come_up();
}

/* ---- servos, postures --------------------------------------------------------------------- */

TEST_WITH(with_and_without_thread, servo_states)
{
    int states[20];

    assert_int_equal(grobo_runner_set_servo_state(runner, ELBOW, GROBO_TORQUE_ON, 0),
                     GROBO_ERR_CLOSED);
    runner_come_up();
    assert_int_equal(grobo_runner_get_servo_states(runner, states, 19), GROBO_ERR_SPACE);
    assert_int_equal(grobo_runner_set_servo_states(runner, EVERY_JOINT, GROBO_TORQUE_BRAKE, 0),
                     GROBO_OK);
    assert_int_equal(grobo_runner_set_servo_state(runner, ELBOW, GROBO_TORQUE_ON, 0),
                     GROBO_TORQUE_ON);
    assert_int_equal(grobo_runner_get_servo_state(runner, ELBOW), GROBO_TORQUE_ON);
    assert_int_equal(grobo_runner_get_servo_states(runner, states, 20), 20);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(states[j], j == ELBOW ? GROBO_TORQUE_ON : GROBO_TORQUE_BRAKE);
    }
    assert_int_equal(grobo_runner_set_servo_state(runner, ELBOW, GROBO_TORQUE_OFF, 0),
                     GROBO_TORQUE_OFF);
    assert_int_equal(grobo_runner_get_servo_state(runner, ELBOW), GROBO_TORQUE_OFF);
    assert_int_equal(grobo_runner_set_servo_state(runner, 20, GROBO_TORQUE_ON, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_runner_get_servo_state(runner, 20), GROBO_ERR_ARG);
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
    assert_int_equal(grobo_runner_get_current_posture(runner, &posture), 0);
    runner_come_up();
    assert_int_equal(grobo_runner_call(runner, turn_elbow, &angle_mdeg), GROBO_OK);
    assert_int_equal(grobo_runner_read_posture(runner, &posture, 0), 20);
    assert_true(grobo_deg_from_rad(posture.angle_rad[ELBOW]) > 11.9);
    assert_int_equal(grobo_runner_get_current_posture(runner, &current), 20);
    assert_true(grobo_posture_near(&current, &posture, grobo_rad_from_deg(0.2)));
    assert_true(grobo_deg_from_rad(current.angle_rad[ELBOW]) > 11.9);
    runner_assert_elbow_at(12);
    assert_int_equal(grobo_runner_read_angle(runner, 20, &angle_rad, 0), GROBO_ERR_ARG);

    /* A servo that does not answer: nobody takes anything for its angle, the others are read. */
    assert_int_equal(grobo_runner_call(runner, cut_elbow, NULL), GROBO_OK);
    assert_int_equal(grobo_runner_read_angle(runner, ELBOW, &angle_rad, 0), GROBO_ERR_TIMEOUT);
    assert_true(angle_rad == -99);
    assert_int_equal(grobo_runner_read_posture(runner, &posture, 0), 19);
    assert_true(posture.set == (EVERY_JOINT & ~GROBO_JOINT_BIT(ELBOW)));
}

/* ---- raw commands ------------------------------------------------------------------------- */

TEST_WITH(with_and_without_thread, raw_commands)
{
    static const uint8_t check[] = {0x41, 0x00};
    uint8_t longer[GROBO_RUNNER_COMMAND_BYTES + 1] = {0};
    uint8_t got[GROBO_RUNNER_RECEIVE_BYTES + 1];

    assert_int_equal(grobo_runner_get_command(runner, NULL, 0), 0);
    assert_int_equal(grobo_runner_set_command(runner, NULL, 0), 0);
    assert_int_equal(grobo_runner_send_command(runner, NULL, 0, 0), GROBO_ERR_EMPTY);
    assert_int_equal(grobo_runner_set_command(runner, check, sizeof check), 2);
    assert_int_equal(grobo_runner_set_command(runner, longer, sizeof longer), GROBO_ERR_CAP);
    assert_int_equal(grobo_runner_get_command(runner, got, 1), GROBO_ERR_SPACE);
    assert_int_equal(grobo_runner_get_command(runner, got, sizeof got), 2);
    assert_memory_equal(got, check, 2);
    for (size_t i = 0; i < sizeof longer; i++) {
        longer[i] = (uint8_t)(i + 1);
    }
    assert_int_equal(grobo_runner_set_command(runner, longer, 256), 256);
    assert_int_equal(grobo_runner_get_command(runner, got, sizeof got), 256);
    assert_memory_equal(got, longer, 256);
    assert_int_equal(grobo_runner_set_command(runner, check, sizeof check), 2);

    /* The port is opened where it is not; the answer of the board is 07. */
    assert_int_equal(grobo_runner_send_command(runner, NULL, 0, 0), 2);
    assert_true(grobo_runner_is_connected(runner));
    assert_int_equal(grobo_runner_receive(runner, got, 1), 1);
    assert_int_equal(got[0], 0x07);
    assert_int_equal(grobo_runner_send_command(runner, check, 2, 0), 2);
    assert_int_equal(grobo_runner_receive(runner, got, 2), GROBO_ERR_SHORT);
    assert_int_equal(grobo_runner_receive(runner, got, 2), GROBO_ERR_TIMEOUT);
    assert_int_equal(grobo_runner_receive(runner, got, sizeof got), GROBO_ERR_CAP);
    assert_int_equal(grobo_runner_send_command(runner, longer, sizeof longer, 0), GROBO_ERR_CAP);
    assert_true(grobo_runner_send_command(runner, "rubbish", 7, 0) < 0);
}

/* Of what was only sent nobody waits for the end, but it can be stopped. */
TEST_WITH(with_and_without_thread, a_raw_move_is_stopped_like_any_other)
{
    /* Motor 5 to -90.0 degrees in 60 s. */
    static const uint8_t slow[] = {0x53, 0x0C, 0xFA, 0xAF, 0x05, 0x00, 0x1E,
                                   0x04, 0x01, 0x7C, 0xFC, 0x70, 0x17, 0xF9};
    double stood_rad;
    double angle_rad;

    runner_come_up();
    assert_int_equal(grobo_runner_set_servo_states(runner, EVERY_JOINT, GROBO_TORQUE_ON, 0), 0);
    assert_int_equal(grobo_robot_stop(grobo_runner_robot(runner), false), GROBO_ERR_STATE);
    assert_int_equal(grobo_runner_send_command(runner, slow, sizeof slow, 0), sizeof slow);
    assert_int_equal(grobo_runner_is_moving(runner), 1);
    assert_int_equal(grobo_robot_stop(grobo_runner_robot(runner), false), GROBO_OK);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    assert_int_equal(grobo_runner_is_moving(runner), 0);
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
    assert_int_equal(grobo_runner_set_servo_states(runner, EVERY_JOINT, GROBO_TORQUE_ON, 0),
                     GROBO_OK);
    assert_int_equal(grobo_runner_estop(runner), GROBO_OK);
    (void)grobo_runner_wait(runner, 0);
    assert_int_equal(grobo_runner_get_servo_state(runner, ELBOW), GROBO_TORQUE_BRAKE);
    assert_int_equal(grobo_runner_set_servo_state(runner, ELBOW, GROBO_TORQUE_ON, 0),
                     GROBO_ERR_LATCHED);
    assert_int_equal(grobo_runner_init_position(runner), GROBO_ERR_LATCHED);
    assert_int_equal(grobo_runner_reset(runner), GROBO_OK);
    assert_int_equal(grobo_runner_set_servo_state(runner, ELBOW, GROBO_TORQUE_ON, 0),
                     GROBO_TORQUE_ON);
    assert_int_equal(grobo_runner_exit(runner, GROBO_EXIT_OFF, 0), GROBO_OK);
    assert_int_equal(grobo_runner_get_servo_state(runner, ELBOW), GROBO_TORQUE_OFF);
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
    assert_int_equal(grobo_runner_get_period_us(made), 3000);
    assert_int_equal(grobo_runner_get_device(made, longer, sizeof longer), 3);
    assert_string_equal(longer, GROBO_DEVICE_SIM);
    assert_int_equal(grobo_runner_free(made), GROBO_OK);
    assert_int_equal(counter.bytes, 0);
    assert_int_equal(grobo_runner_free(NULL), GROBO_OK);
    event_base_free(base);
}
