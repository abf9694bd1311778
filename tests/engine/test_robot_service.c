/* SPDX-License-Identifier: MIT */
/* Registers, flash and reboot, raw frames, stored motions, free mode, configuration. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/rig.h"
#include "tests/support/test.h"

static grobo_test_rig rig;

static uint8_t reply[GROBO_REGISTERS];
static size_t reply_bytes;

static void keep_reply(grobo_test_rig *r, const grobo_event *event)
{
    (void)r;
    if (event->kind == GROBO_EVENT_JOB) {
        reply_bytes = event->u.job.size;
        memcpy(reply, event->u.job.data, reply_bytes);
    }
}

/* ---- registers -------------------------------------------------------------- */

static int io(uint8_t id, uint8_t address, uint8_t length, const uint8_t *data)
{
    grobo_register_io request = {id, address, length, data};
    return grobo_robot_registers(&rig.robot, &request);
}

TEST_WITH(rig_wirings, registers_are_read_and_written)
{
    static const grobo_wiring wirings[] = {GROBO_WIRING_BOARD, GROBO_WIRING_BUS};
    for (int w = 0; w < 2; w++) {
        rig_start_driver(&rig, grobo_gr001_driver(wirings[w]), &quiet, NULL);
        rig.on_event = keep_reply;
        rig_expect(&rig, io(NECK_ID, GROBO_RS30X_MODEL, 2, NULL), GROBO_OK);
        assert_int_equal(reply_bytes, 2);
        assert_int_equal(reply[0] | reply[1] << 8, GROBO_RS30X_RS302CD);
        uint8_t delay = 5;
        rig_expect(&rig, io(NECK_ID, GROBO_RS30X_DELAY, 1, &delay), GROBO_OK);
        int32_t value = 0;
        assert_int_equal(grobo_sim_get_register(&rig.sim, NECK, GROBO_RS30X_DELAY, &value), 0);
        assert_int_equal(value, 5);
    }
}

TEST_WITH(rig_wirings, motor_registers_are_not_written_this_way)
{
    const uint8_t data[10] = {0};
    rig_start(&rig, &quiet, NULL);
    assert_int_equal(io(NECK_ID, GROBO_RS30X_GOAL, 2, data), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(io(NECK_ID, GROBO_RS30X_TORQUE, 1, data), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(io(NECK_ID, 28, 4, data), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(io(0, 4, 1, data), GROBO_ERR_ARG);
    assert_int_equal(io(NECK_ID, 139, 2, NULL), GROBO_ERR_ARG);
    assert_int_equal(rig.n_sent, 0);
}

TEST_WITH(rig_wirings, flash_and_reboot_wait)
{
    rig_start(&rig, &quiet, NULL);
    uint8_t margin = 7;
    rig_expect(&rig, io(NECK_ID, GROBO_RS30X_CW_MARGIN, 1, &margin), GROBO_OK);
    int64_t begun_us = rig.now_us;
    rig_expect(&rig, grobo_robot_command(&rig.robot, NECK_ID, GROBO_SERVO_FLASH), 0);
    assert_true(rig.now_us - begun_us >= 1000000);
    begun_us = rig.now_us;
    rig_expect(&rig, grobo_robot_command(&rig.robot, NECK_ID, GROBO_SERVO_REBOOT), 0);
    assert_true(rig.now_us - begun_us >= 2000000);
    rig.on_event = keep_reply;
    rig_expect(&rig, io(NECK_ID, GROBO_RS30X_CW_MARGIN, 1, NULL), GROBO_OK);
    assert_int_equal(reply[0], 7);
}

TEST_WITH(rig_wirings, a_reboot_that_was_asked_for_is_no_loss_of_torque)
{
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 200000};
    rig_start(&rig, &config, NULL);
    rig_power(&rig);
    rig_expect(&rig, grobo_robot_command(&rig.robot, NECK_ID, GROBO_SERVO_REBOOT), 0);
    rig_run(&rig, 1000000);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_OFF);
    assert_null(rig_last(&rig, GROBO_EVENT_TRIP));
}

/* ---- raw frames ------------------------------------------------------------- */

static int raw(const char *bytes, size_t size)
{
    return grobo_robot_raw(&rig.robot, (const uint8_t *)bytes, size);
}

TEST(raw_reads_bring_their_reply)
{
    rig_start(&rig, &quiet, NULL);
    rig.on_event = keep_reply;
    rig_expect(&rig, raw("\x54\x09\xFA\xAF\x01\x0F\x24\x12\x00\x38\x1A", 11), GROBO_OK);
    assert_int_equal(reply_bytes, 18);
    rig_expect(&rig, raw("\x41\x00", 2), GROBO_OK);
}

TEST(raw_targets_pass_the_same_gate)
{
    rig_start(&rig, &quiet, NULL);
    /* Motor 2 to 10.0 degrees in 1 s, to 60.0, to 10.0 at full speed; torque of it on. */
    const char *soft = "\x53\x0C\xFA\xAF\x02\x00\x1E\x04\x01\x64\x00\x64\x00\x19";
    const char *far = "\x53\x0C\xFA\xAF\x02\x00\x1E\x04\x01\x58\x02\x64\x00\x27";
    const char *hard = "\x53\x0C\xFA\xAF\x02\x00\x1E\x04\x01\x64\x00\x00\x00\x7D";
    const char *on = "\x53\x09\xFA\xAF\x02\x00\x24\x01\x01\x01\x27";
    assert_int_equal(raw(soft, 14), GROBO_ERR_STALE);
    rig_expect(&rig, grobo_robot_sense(&rig.robot, rig_all(&rig), 0), GROBO_OK);
    assert_int_equal(raw(far, 14), GROBO_ERR_LIMIT);
    assert_int_equal(raw(hard, 14), GROBO_ERR_SPEED);
    assert_int_equal(raw(on, 11), GROBO_ERR_STATE);
    rig_power(&rig);
    rig_expect(&rig, raw(soft, 14), GROBO_OK);
    rig_run(&rig, 1100000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 10) < 0.1);
    rig_expect(&rig, raw(on, 11), GROBO_OK);
    rig_expect(&rig, grobo_robot_estop(&rig.robot), GROBO_OK);
    assert_int_equal(raw(soft, 14), GROBO_ERR_LATCHED);
}

TEST(raw_bytes_without_meaning_are_refused_unless_told)
{
    grobo_robot_config config = quiet;
    rig_start(&rig, &quiet, NULL);
    assert_int_equal(raw("\x50\x4D\x01", 3), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(raw("hello", 5), GROBO_ERR_UNSUPPORTED);
    /* A sum that is wrong, a goal of which only one byte is written. */
    assert_int_equal(raw("\x53\x0C\xFA\xAF\x02\x00\x1E\x04\x01\x64\x00\x64\x00\x18", 14),
                     GROBO_ERR_UNSUPPORTED);
    assert_int_equal(raw("\x53\x09\xFA\xAF\x02\x00\x1E\x01\x01\x05\x19", 11),
                     GROBO_ERR_UNSUPPORTED);
    assert_int_equal(rig.n_sent, 0);
    config.accept_unknown_raw = true;
    assert_int_equal(grobo_robot_configure(&rig.robot, &config), GROBO_OK);
    rig_expect(&rig, raw("\x50\x4D\x01", 3), GROBO_OK);
    assert_int_equal(rig.sim.stats.last_slot, 1);
}

TEST(stored_motions_are_started)
{
    rig_start(&rig, &quiet, NULL);
    rig_expect(&rig, grobo_robot_stored(&rig.robot, GROBO_STORED_SLOT, 3), GROBO_OK);
    rig_expect(&rig, grobo_robot_stored(&rig.robot, GROBO_STORED_SCENARIO, 4), 0);
    rig_run(&rig, 10000);
    assert_int_equal(rig.sim.stats.slots, 1);
    assert_int_equal(rig.sim.stats.last_slot, 3);
    assert_int_equal(rig.sim.stats.last_scenario, 4);
    assert_int_equal(grobo_robot_stored(&rig.robot, GROBO_STORED_SLOT, 256), GROBO_ERR_ARG);
    rig_start_driver(&rig, grobo_gr001_driver(GROBO_WIRING_BUS), &quiet, NULL);
    assert_int_equal(grobo_robot_stored(&rig.robot, GROBO_STORED_SLOT, 3), GROBO_ERR_UNSUPPORTED);
}

/* ---- free mode -------------------------------------------------------------- */

TEST_WITH(rig_wirings, free_mode_gives_way_and_holds)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    assert_int_equal(grobo_robot_free(&rig.robot, rig_all(&rig), true), GROBO_OK);
    rig_run(&rig, 500000);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_ON);
    assert_int_equal(grobo_sim_set_load(&rig.sim, NECK, 200), 0); /* a hand pushes */
    rig_run(&rig, 400000);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_BRAKE);
    assert_int_equal(rig_torque(&rig, R_KNEE), GROBO_TORQUE_ON);
    assert_int_equal(grobo_sim_set_angle(&rig.sim, NECK, 25000, 500000), 0);
    rig_run(&rig, 450000);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_BRAKE); /* still turning */
    assert_int_equal(grobo_sim_set_load(&rig.sim, NECK, 0), 0);
    rig_run(&rig, 1000000);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_ON);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 25) < 1);
    rig_expect(&rig, grobo_robot_free(&rig.robot, rig_all(&rig), false), GROBO_OK);
    rig_forget(&rig);
    rig_run(&rig, 500000);
    assert_int_equal(rig.n_sent, 0);
}

/* However often it is read: a hand needs a moment to get a joint going, and to turn it back. */
TEST_WITH(rig_wirings, a_joint_that_gave_way_is_not_gripped_at_once)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    assert_int_equal(grobo_robot_free(&rig.robot, GROBO_JOINT_BIT(NECK), true), 0);
    rig_run(&rig, 500000);
    assert_int_equal(grobo_sim_set_load(&rig.sim, NECK, 200), 0);
    rig_run(&rig, 50000);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_BRAKE);
    assert_int_equal(grobo_sim_set_load(&rig.sim, NECK, 0), 0);
    rig_run(&rig, 50000);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_BRAKE);
    for (int deg = 20; deg >= -20; deg -= 20) {
        assert_int_equal(grobo_sim_set_angle(&rig.sim, NECK, deg * 1000, 500000), 0);
        rig_run(&rig, 550000);
        assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_BRAKE);
    }
    rig_run(&rig, 200000);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_ON);
    assert_true(fabs(rig_angle_deg(&rig, NECK) + 20) < 0.1);
}

TEST_WITH(rig_wirings, limp_joints_hold_in_free_mode_where_they_are)
{
    grobo_sim_config limp = {GROBO_SIM_CONFIG_INIT, .start = GROBO_SIM_START_LIMP, .seed = 9,
                             .jump_on_torque = true};
    rig_start(&rig, &quiet, &limp);
    assert_int_equal(grobo_robot_free(&rig.robot, rig_all(&rig), true), GROBO_OK);
    rig_run(&rig, 1500000);
    assert_int_equal(rig.torque_on, 20); /* and the rig saw that each was at its goal */
}

TEST_WITH(rig_wirings, free_mode_believes_no_goal_read_before)
{
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 1};
    grobo_sim_config jumpy = {GROBO_SIM_CONFIG_INIT, .jump_on_torque = true};
    for (int i = 0; i < 20; i++) { /* whatever reading is under way when it begins */
        rig_start(&rig, &config, &jumpy);
        rig_power(&rig);
        grobo_sim_set_supply(&rig.sim, 3000); /* the servos forget their goals */
        rig_run(&rig, 100000);
        grobo_sim_set_supply(&rig.sim, 7400);
        rig_run(&rig, 4000000 + 6300 * i);
        assert_int_equal(grobo_robot_reset(&rig.robot), GROBO_OK);
        assert_int_equal(grobo_robot_free(&rig.robot, rig_all(&rig), true), 0);
        rig_run(&rig, 1000000);
        assert_int_equal(rig_torque(&rig, R_KNEE), GROBO_TORQUE_ON);
        assert_true(fabs(rig_angle_deg(&rig, R_KNEE) + 40) < 1);
    }
}

/* ---- configuration ---------------------------------------------------------- */

TEST_WITH(rig_wirings, configurations_are_checked)
{
    static const grobo_robot_config bad[] = {
        {GROBO_ROBOT_CONFIG_INIT, .speed_limit_pct = 101},
        {GROBO_ROBOT_CONFIG_INIT, .speed_limit_pct = -1},
        {GROBO_ROBOT_CONFIG_INIT, .approach_dps = -1},
        {GROBO_ROBOT_CONFIG_INIT, .retries = -2},
        {GROBO_ROBOT_CONFIG_INIT, .stall_us = -1},
        {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = -2},
        {GROBO_ROBOT_CONFIG_INIT, .retries = 256},
        {GROBO_ROBOT_CONFIG_INIT, .on_exit = (grobo_exit_policy)9},
        {GROBO_ROBOT_CONFIG_INIT, .default_time_us = -1},
        {GROBO_ROBOT_CONFIG_INIT, .exit_bound_us = -1},
        {GROBO_ROBOT_CONFIG_INIT, .approach_dps = INFINITY},
    };
    const grobo_driver *driver = grobo_gr001_driver(GROBO_WIRING_BOARD);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(grobo_robot_init(&rig.robot, driver, NULL, &bad[i], 0), GROBO_ERR_ARG);
    }
    grobo_driver none = *driver;
    none.sense = NULL;
    assert_int_equal(grobo_robot_init(&rig.robot, &none, NULL, NULL, 0), GROBO_ERR_ARG);
    rig_start(&rig, NULL, NULL);
    assert_int_equal(grobo_robot_configure(&rig.robot, &bad[0]), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_configure(&rig.robot, NULL), 0);
}

TEST_WITH(rig_wirings, limits_may_be_switched_off)
{
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 200000,
                                 .temperature_c = -1};
    rig_start(&rig, &config, NULL);
    rig_power(&rig);
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, NECK, 68), 0);
    rig_run(&rig, 1000000);
    assert_null(rig_last(&rig, GROBO_EVENT_TRIP));
}

TEST_WITH(rig_wirings, read_back_correction_is_an_option)
{
    grobo_robot_config config = quiet;
    grobo_joint_info info;
    rig_start(&rig, &quiet, NULL);
    rig_expect(&rig, grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(R_KNEE), 0), 0);
    assert_int_equal(grobo_robot_joint(&rig.robot, R_KNEE, &info), 0);
    assert_true(fabs(grobo_deg_from_rad(info.state.angle_rad) + 40) < 0.06);
    config.readback_correction = true;
    assert_int_equal(grobo_robot_configure(&rig.robot, &config), GROBO_OK);
    rig_expect(&rig, grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(R_KNEE), 0), 0);
    assert_int_equal(grobo_robot_joint(&rig.robot, R_KNEE, &info), 0);
    assert_true(fabs(grobo_deg_from_rad(info.state.angle_rad) + 38) < 0.06);
}

/* The correction is of what is read, not of where a joint is to be held. */
TEST_WITH(rig_wirings, a_corrected_joint_is_held_where_its_servo_says)
{
    grobo_robot_config config = quiet;
    grobo_sim_config jumpy = {GROBO_SIM_CONFIG_INIT, .jump_on_torque = true};
    config.readback_correction = true;
    rig_start(&rig, &config, &jumpy);
    for (int i = 0; i < 5; i++) {
        rig_power(&rig);
        rig_run(&rig, 500000);
        assert_true(fabs(rig_angle_deg(&rig, R_KNEE) + 40) < 0.1);
        rig_expect(&rig, grobo_robot_torque(&rig.robot, rig_all(&rig), GROBO_TORQUE_OFF), GROBO_OK);
    }
    assert_int_equal(grobo_robot_free(&rig.robot, rig_all(&rig), true), GROBO_OK);
    rig_run(&rig, 2000000);
    assert_int_equal(rig_torque(&rig, R_KNEE), GROBO_TORQUE_ON);
    assert_true(fabs(rig_angle_deg(&rig, R_KNEE) + 40) < 0.1);
}

TEST_WITH(rig_wirings, cancel_stops_a_move_where_it_is)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_ERR_STATE);
    grobo_posture target = rig_posture(&rig, NECK, 40, 2000);
    int number = grobo_robot_move(&rig.robot, &target);
    rig_run(&rig, 1000000);
    assert_true(grobo_robot_moving(&rig.robot));
    assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_OK);
    rig_expect(&rig, number, GROBO_ERR_CANCELED);
    rig_run(&rig, 200000);
    assert_false(grobo_robot_moving(&rig.robot));
    double here_deg = rig_angle_deg(&rig, NECK);
    assert_true(here_deg > 5 && here_deg < 25);
    rig_run(&rig, 1000000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - here_deg) < 0.01);
}
