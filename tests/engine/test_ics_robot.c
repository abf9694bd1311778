/* SPDX-License-Identifier: MIT */
/* KRS servos: what the simulated ones answer, byte by byte, and what the engine refuses. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/ics.h>
#include <grobo/core/robot.h>
#include <grobo/core/sim.h>

#include "tests/support/chain_kit.h"
#include "tests/support/family_kit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"
#include "tests/support/vectors.h"

enum { MS = 1000, S = 1000000 };

static chain_kit chain;
static family_kit kit;
static const grobo_robot_config watched = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 50 * MS};

static void start_chain(const char *name, int n)
{
    chain_start(&chain, grobo_servo_model_named(&grobo_i_ics_table, name), n,
                &(grobo_sim_config){GROBO_SIM_CONFIG_INIT, .no_stops = true});
}

static void start(void)
{
    family_start(&kit, family_named("ics"), &watched, NULL);
}

static int32_t value(int servo, grobo_register_role role)
{
    return chain_register(&chain, servo, role);
}

/* The manual's own examples: 81 3A 4C, A1 01. */
TEST(commands_are_answered)
{
    start_chain("KRS-3301", 2);
    int64_t asked_us = chain.kit.now_us;
    simkit_ask(&chain.kit, "81 3A 4C", 50000);
    simkit_expect(&chain.kit, "01 3A 4C");
    int64_t us = chain.kit.got_us[2] - asked_us;
    assert_true(us >= 6 * 11 * 1000000LL / 115200 && us < 1500); /* 11 bits a byte */
    simkit_ask(&chain.kit, "A1 01", 50000);
    simkit_expect(&chain.kit, "21 01 1E");
    simkit_ask(&chain.kit, "C1 02 40", 50000);
    simkit_expect(&chain.kit, "41 02 40");
    simkit_ask(&chain.kit, "81 46 50", 50000); /* 9040: the answer is where it is */
    simkit_expect(&chain.kit, "01 3A 4C");
    simkit_run(&chain.kit, S);
    assert_true(abs(value(0, GROBO_ROLE_POSITION) - 9040) <= 1);
    simkit_ask(&chain.kit, "A1 05", 50000);
    simkit_expect(&chain.kit, "21 05 46 50");
    simkit_ask(&chain.kit, "81 00 00", 50000); /* lets go */
    simkit_expect(&chain.kit, "01 46 50");
    assert_int_equal(value(0, GROBO_ROLE_TORQUE), 0);
    assert_int_equal(value(1, GROBO_ROLE_POSITION), 7500);
}

TEST(versions_and_id_0_differ)
{
    start_chain("KRS-2552RHV", 1);
    simkit_ask(&chain.kit, "A1 05", 20000);
    simkit_expect(&chain.kit, "");
    simkit_ask(&chain.kit, "81 3A 4C", 20000);
    simkit_expect(&chain.kit, "01 3A 4C");
    simkit_ask(&chain.kit, "E0 01 01 01", 20000); /* becomes 0, and listens again later */
    simkit_expect(&chain.kit, "E0");
    simkit_run(&chain.kit, S);
    simkit_ask(&chain.kit, "80 3A 4C", 20000);
    simkit_expect(&chain.kit, "80 3A 4C");
}

TEST(the_eeprom_is_kept_and_items_are_not)
{
    start_chain("KRS-3301", 1);
    simkit_ask(&chain.kit, "A1 00", 50000);
    assert_int_equal(chain.kit.n_got, 66);
    uint8_t eeprom[66];
    memcpy(eeprom, chain.kit.got, sizeof eeprom);
    assert_int_equal(eeprom[2] << 4 | eeprom[3], 0x5A);
    assert_int_equal(eeprom[16] << 4 | eeprom[17], 6); /* fixed, free */
    char hex[66 * 3 + 1];
    eeprom[0] = 0xC1;
    eeprom[12] = 0; /* damping 40 becomes 8 */
    for (size_t i = 0; i < sizeof eeprom; i++) {
        (void)snprintf(hex + 3 * i, 4, "%02X ", eeprom[i]);
    }
    hex[sizeof hex - 2] = '\0';
    simkit_ask(&chain.kit, hex, 50000);
    simkit_expect(&chain.kit, "41 00");
    simkit_ask(&chain.kit, "C1 02 40", 50000);
    simkit_expect(&chain.kit, ""); /* it is busy */
    simkit_run(&chain.kit, S);
    simkit_ask(&chain.kit, "C1 02 40", 50000);
    simkit_expect(&chain.kit, "41 02 40");
    grobo_sim_set_supply(&chain.kit.sim, 3000);
    grobo_sim_set_supply(&chain.kit.sim, 7400);
    simkit_run(&chain.kit, S);
    assert_int_equal(value(0, GROBO_ROLE_SPEED), 127);
    assert_int_equal(simkit_register(&chain.kit, 0, 5), 8);
}

/* ---- the engine ------------------------------------------------------------------------------ */

TEST(a_servo_that_is_set_up_otherwise_never_moves)
{
    static const struct {
        grobo_register_role role;
        int32_t value;
    } rows[] = {{GROBO_ROLE_DIRECTION, 1},
                {GROBO_ROLE_DIRECTION, 0x10},
                {GROBO_ROLE_MIN_POSITION, 7000},
                {GROBO_ROLE_MAX_POSITION, 8000}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        start();
        family_set_up(&kit, 2, rows[i].role, rows[i].value);
        assert_int_equal(family_move(&kit, 20, 1000), GROBO_ERR_SETUP);
        for (int j = 0; j < FAMILY_JOINTS; j++) {
            assert_true(fabs(family_angle_deg(&kit, j)) < 0.2);
        }
    }
    start(); /* with ICS 3.5 nobody knows where a servo is */
    kit.joints[1].servo_model = 2552;
    assert_int_equal(grobo_ics_driver_init(&kit.driver, &kit.model), GROBO_ERR_UNSUPPORTED);
}

TEST(what_moves_is_guarded)
{
    static const struct {
        const char *hex;
        int result;
    } frames[] = {
        {"81 46 50", GROBO_ERR_SPEED},       /* at whatever speed is set */
        {"81 59 6C", GROBO_ERR_LIMIT},       /* 135 deg */
        {"87 3A 4C", GROBO_ERR_UNSUPPORTED}, /* no joint */
        {"C1 02 7F", GROBO_ERR_UNSUPPORTED}, /* the speed */
        {"C1 03 01", GROBO_ERR_UNSUPPORTED}, {"C1 01 20", GROBO_OK}, {"A1 02", GROBO_OK},
    };
    static const struct {
        uint16_t address;
        int result;
    } rows[] = {{42, GROBO_ERR_UNSUPPORTED},
                {46, GROBO_ERR_UNSUPPORTED},
                {7, GROBO_ERR_UNSUPPORTED},
                {43, GROBO_ERR_STATE},
                {41, GROBO_OK}};
    start();
    assert_int_equal(family_move(&kit, 10, 1000), GROBO_OK);
    for (size_t i = 0; i < sizeof frames / sizeof frames[0]; i++) {
        uint8_t frame[8];
        int n = vector_from_hex(frames[i].hex, frame, sizeof frame);
        int result = grobo_robot_raw(&kit.robot, frame, (size_t)n);
        result = result > 0 ? family_wait(&kit, result) : result;
        if (result != frames[i].result) {
            fail_msg("%s: %d instead of %d", frames[i].hex, result, frames[i].result);
        }
    }
    uint8_t raw_id[] = {0xFF, 0, 0, 0};
    assert_true(grobo_robot_raw(&kit.robot, raw_id, sizeof raw_id) < 0);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const grobo_register_io io = {1, rows[i].address, 1, (const uint8_t *)"\x20"};
        int result = grobo_robot_registers(&kit.robot, &io);
        result = result > 0 ? family_wait(&kit, result) : result;
        if (result != rows[i].result) {
            fail_msg("address %u: %d instead of %d", rows[i].address, result, rows[i].result);
        }
    }
    family_at(&kit, 10);
}

/* Each goal leaves when the speed for it was answered: where that is lost nothing goes. */
TEST(no_goal_goes_without_its_speed)
{
    start();
    assert_int_equal(family_move(&kit, 0, 1000), GROBO_OK);
    kit.most_dps = 0;
    assert_int_equal(grobo_sim_set_fault(&kit.sim, GROBO_SIM_FAULT_SILENT, 0.3), GROBO_OK);
    for (int k = 0; k < 40; k++) {
        grobo_posture p = family_posture(&kit, k % 2 == 0 ? 30 : -30, 1000);
        (void)grobo_robot_reset(&kit.robot); /* lost replies trip it now and then */
        (void)grobo_robot_move(&kit.robot, &p);
        family_run(&kit, 2500 * MS);
        for (int j = 0; j < FAMILY_JOINTS; j++) { /* what a goal alone would go at */
            family_set_up(&kit, j, GROBO_ROLE_SPEED, 127);
        }
    }
    assert_true(kit.most_dps > 5 && kit.most_dps < 1.3 * 60);
}

TEST(a_joint_that_lost_its_power_trips)
{
    start();
    assert_int_equal(family_move(&kit, 10, 1000), GROBO_OK);
    assert_int_equal(grobo_sim_set_cable(&kit.sim, 1, GROBO_SIM_CABLE_OUT), GROBO_OK);
    assert_int_equal(grobo_sim_set_cable(&kit.sim, 1, GROBO_SIM_CABLE_IN), GROBO_OK);
    family_run(&kit, 2 * S);
    assert_true(kit.n_trips > 0);
    assert_int_equal(kit.trips[0], GROBO_TRIP_TORQUE_LOST);
}
