/* SPDX-License-Identifier: MIT */
/* LX-16A servos: what the simulated ones answer, byte by byte, and what the engine refuses. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/lx16a.h>
#include <grobo/core/robot.h>

#include "tests/support/chain_kit.h"
#include "tests/support/family_kit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"
#include "tests/support/vectors.h"

enum { MS = 1000, S = 1000000 };

static chain_kit chain;
static family_kit kit;
static const grobo_robot_config watched = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 50 * MS};

static void start_chain(int n)
{
    const grobo_servo_model *lx16a = grobo_servo_model_named(&grobo_i_lx16a_table, "LX-16A");
    chain_start(&chain, lx16a, n, &(grobo_sim_config){GROBO_SIM_CONFIG_INIT, .no_stops = true});
}

static void start(void)
{
    family_start(&kit, family_named("lx16a"), &watched, NULL);
}

static int32_t value(int servo, grobo_register_role role)
{
    return chain_register(&chain, servo, role);
}

/* Frames of pylx16a 1.1.1 and lewansoul-lx16a 0.1. */
TEST(writes_are_silent_and_reads_are_answered)
{
    start_chain(2);
    int64_t asked_us = chain.kit.now_us;
    simkit_ask(&chain.kit, "55 55 01 03 1C DF", 50000);
    simkit_expect(&chain.kit, "55 55 01 05 1C F4 01 E8"); /* 500 */
    int64_t us = chain.kit.got_us[chain.kit.n_got - 1] - asked_us;
    assert_true(us >= 14 * 10 * 1000000LL / 115200 && us < 3000);
    simkit_ask(&chain.kit, "55 55 01 07 01 20 03 E8 03 E8", 5000); /* 800 in 1 s */
    simkit_expect(&chain.kit, "");
    assert_int_equal(value(0, GROBO_ROLE_TORQUE), 1);
    simkit_run(&chain.kit, 495000);
    assert_true(abs(value(0, GROBO_ROLE_POSITION) - 650) <= 2); /* at even speed */
    simkit_run(&chain.kit, 600000);
    assert_int_equal(value(0, GROBO_ROLE_POSITION), 800);
    simkit_ask(&chain.kit, "55 55 01 03 02 F9", 50000);
    simkit_expect(&chain.kit, "55 55 01 07 02 20 03 E8 03 E7");
    assert_int_equal(value(1, GROBO_ROLE_POSITION), 500);
}

TEST(to_all_only_ids_are_answered)
{
    start_chain(1);
    simkit_ask(&chain.kit, "55 55 FE 03 0E F0", 50000);
    simkit_expect(&chain.kit, "55 55 01 04 0E 01 EB");
    simkit_ask(&chain.kit, "55 55 FE 03 1C E2", 50000);
    simkit_expect(&chain.kit, "");
    start_chain(2); /* two that wait start together */
    simkit_ask(&chain.kit, "55 55 01 07 07 58 02 64 00 32", 5000);
    simkit_ask(&chain.kit, "55 55 02 07 07 90 01 64 00 FA", 5000);
    assert_int_equal(value(0, GROBO_ROLE_TORQUE), 0);
    simkit_ask(&chain.kit, "55 55 FE 03 0B F3", 5000);
    simkit_run(&chain.kit, 200000);
    assert_int_equal(value(0, GROBO_ROLE_POSITION), 600);
    assert_int_equal(value(1, GROBO_ROLE_POSITION), 400);
}

TEST(what_a_servo_cannot_take_is_refused)
{
    start_chain(1);
    simkit_ask(&chain.kit, "55 55 01 05 01 20 03 D5", 5000); /* lx16a 0.0.2: without a time */
    assert_int_equal(simkit_events(&chain.kit, GROBO_SIM_REFUSED, NULL), 1);
    simkit_ask(&chain.kit, "55 55 01 07 14 BC 02 2C 01 F8", 5000); /* limits 700 to 300 */
    assert_int_equal(simkit_events(&chain.kit, GROBO_SIM_REFUSED, NULL), 2);
    simkit_ask(&chain.kit, "55 55 01 07 14 2C 01 BC 02 F8", 5000); /* 300 to 700 */
    simkit_ask(&chain.kit, "55 55 01 07 01 E8 03 64 00 A7", 5000); /* 1000 in 100 ms */
    assert_int_equal(value(0, GROBO_ROLE_GOAL), 700);
    simkit_ask(&chain.kit, "55 55 01 07 1D 01 00 F4 01 E4", 5000); /* a wheel */
    simkit_ask(&chain.kit, "55 55 01 07 01 F4 01 64 00 9D", 5000);
    assert_int_equal(simkit_events(&chain.kit, GROBO_SIM_REFUSED, NULL), 3);
    assert_int_equal(value(0, GROBO_ROLE_GOAL), 700);
}

/* The offset is kept by a command of its own; mode and torque never. */
TEST(power_off_forgets_what_is_not_kept)
{
    start_chain(1);
    simkit_ask(&chain.kit, "55 55 01 04 11 0A DF", 5000);          /* offset 10 */
    simkit_ask(&chain.kit, "55 55 01 07 1D 01 00 F4 01 E4", 5000); /* a wheel */
    simkit_ask(&chain.kit, "55 55 01 04 18 3C A6", 5000);          /* 60 deg C */
    assert_int_equal(value(0, GROBO_ROLE_POSITION), 490);
    for (int kept = 0; kept < 2; kept++) {
        grobo_sim_set_supply(&chain.kit.sim, 3000);
        grobo_sim_set_supply(&chain.kit.sim, 7400);
        simkit_run(&chain.kit, S);
        assert_int_equal(value(0, GROBO_ROLE_OFFSET), kept * 10);
        assert_int_equal(value(0, GROBO_ROLE_MODE), 0);
        assert_int_equal(value(0, GROBO_ROLE_TEMPERATURE_LIMIT), 60);
        simkit_ask(&chain.kit, "55 55 01 04 11 0A DF", 5000);
        simkit_ask(&chain.kit, "55 55 01 03 12 E9", 5000); /* saved */
    }
}

/* ---- the engine ------------------------------------------------------------------------------ */

TEST(a_servo_that_is_set_up_otherwise_never_moves)
{
    static const struct {
        grobo_register_role role;
        int32_t value;
    } rows[] = {
        {GROBO_ROLE_MODE, 1}, {GROBO_ROLE_MIN_POSITION, 300}, {GROBO_ROLE_MAX_POSITION, 600}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        start();
        family_set_up(&kit, 2, rows[i].role, rows[i].value);
        assert_int_equal(family_move(&kit, 20, 1000), GROBO_ERR_SETUP);
        for (int j = 0; j < FAMILY_JOINTS; j++) {
            assert_true(fabs(family_angle_deg(&kit, j)) < 0.2);
        }
    }
}

/* Whatever a frame or a value would move behind the gate. */
TEST(what_moves_is_guarded)
{
    static const struct {
        uint16_t address, length;
        const char *data;
        int result;
    } rows[] = {
        {21, 4, "\x20\x03\x00\x00", GROBO_ERR_UNSUPPORTED},
        {16, 1, "\x01", GROBO_ERR_UNSUPPORTED},
        {17, 4, "\x01\x00\xF4\x01", GROBO_ERR_UNSUPPORTED},
        {25, 4, "\x20\x03\x00\x00", GROBO_ERR_UNSUPPORTED},
        {2, 4, "\x64\x00\xE8\x03", GROBO_ERR_STATE}, /* while it holds */
        {0, 1, "\x09", GROBO_ERR_STATE},
        {1, 1, "\x09", GROBO_ERR_STATE},
        {2, 2, "\x64\x00", GROBO_ERR_UNSUPPORTED}, /* half of an item */
        {12, 1, "\x01", GROBO_OK},
    };
    static const struct {
        const char *hex;
        int result;
    } frames[] = {
        {"55 55 01 07 01 E8 03 00 00 0B", GROBO_ERR_LIMIT}, /* 120 deg */
        {"55 55 01 07 01 20 03 01 00 D2", GROBO_ERR_SPEED},
        {"55 55 01 07 07 20 03 E8 03 E2", GROBO_ERR_UNSUPPORTED},
        {"55 55 FE 03 0B F3", GROBO_ERR_UNSUPPORTED},
        {"55 55 FE 04 0D 00 F0", GROBO_ERR_UNSUPPORTED}, /* id of all, as lx16a-servo sends it */
        {"55 55 01 07 1D 01 00 F4 01 E4", GROBO_ERR_UNSUPPORTED},
        {"55 55 01 03 1C DF", GROBO_OK},
    };
    start();
    assert_int_equal(family_move(&kit, 10, 1000), GROBO_OK);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const grobo_register_io io = {1, rows[i].address, rows[i].length,
                                      (const uint8_t *)rows[i].data};
        int result = grobo_robot_registers(&kit.robot, &io);
        result = result > 0 ? family_wait(&kit, result) : result;
        if (result != rows[i].result) {
            fail_msg("row %zu: %d instead of %d", i, result, rows[i].result);
        }
    }
    for (size_t i = 0; i < sizeof frames / sizeof frames[0]; i++) {
        uint8_t frame[GROBO_LX16A_FRAME_MAX_BYTES];
        int n = vector_from_hex(frames[i].hex, frame, sizeof frame);
        int result = grobo_robot_raw(&kit.robot, frame, (size_t)n);
        result = result > 0 ? family_wait(&kit, result) : result;
        if (result != frames[i].result) {
            fail_msg("frame %zu: %d instead of %d", i, result, frames[i].result);
        }
    }
    family_at(&kit, 10);
}

/* A servo that lets go by itself is seen to have lost its torque. */
TEST(a_supply_outside_of_the_limits_trips)
{
    start();
    assert_int_equal(family_move(&kit, 10, 1000), GROBO_OK);
    family_set_up(&kit, 1, GROBO_ROLE_MIN_VOLTAGE, 9000);
    family_run(&kit, 500 * MS);
    assert_int_equal(kit.n_trips, 1);
    assert_int_equal(kit.trips[0], GROBO_TRIP_TORQUE_LOST);
}
