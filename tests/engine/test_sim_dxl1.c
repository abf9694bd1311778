/* SPDX-License-Identifier: MIT */
/* Simulated AX, MX, STS and SCS: answers, times, registers, modes, protection. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/dxl2.h>
#include <grobo/core/feetech.h>
#include <grobo/core/sim.h>
#include <grobo/core/sim_static.h>

#include "tests/support/chain_kit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { BYTE_US = 10 };

static chain_kit chain;
static const uint8_t six[] = {1, 2, 3, 4, 5, 6};

static void start(const char *name, int n)
{
    const grobo_servo_table *const tables[] = {&grobo_i_dxl1_table, &grobo_i_sts_table,
                                               &grobo_i_scs_table};
    const grobo_servo_model *model = NULL;
    for (int i = 0; i < 3 && model == NULL; i++) {
        model = grobo_servo_model_named(tables[i], name);
    }
    chain_start(&chain, model, n, &(grobo_sim_config){GROBO_SIM_CONFIG_INIT, .no_stops = true});
}

static int32_t value(int servo, grobo_register_role role)
{
    return chain_register(&chain, servo, role);
}

static int put(int id, grobo_register_role role, int32_t to)
{
    return chain_write(&chain, id, role, to);
}

/* The bytes are those of clients' recordings (vectors of feetech-servo-sdk 1.0.0). */
TEST(sts_answers_at_once)
{
    start("STS3215", 6);
    int64_t asked_us = chain.kit.now_us;
    simkit_ask(&chain.kit, "FF FF 01 02 01 FB", 50000);
    simkit_expect(&chain.kit, "FF FF 01 02 00 FC");
    assert_int_equal(chain.kit.got_us[5] - asked_us, 12 * BYTE_US);
    simkit_ask(&chain.kit, "FF FF 01 04 02 03 02 F3", 50000);
    simkit_expect(&chain.kit, "FF FF 01 04 00 09 03 EE"); /* 777 */
    simkit_ask(&chain.kit, "FF FF 02 04 02 38 02 BD", 50000);
    simkit_expect(&chain.kit, "FF FF 02 04 00 00 08 F1");
    /* Six positions: 14 bytes, then 8 from each without a pause. */
    asked_us = chain.kit.now_us;
    simkit_ask(&chain.kit, "FF FF FE 0A 82 38 02 01 02 03 04 05 06 26", 50000);
    assert_int_equal(chain.kit.n_got, 6 * 8);
    for (size_t i = 0; i < 6; i++) {
        assert_int_equal(chain.kit.got[8 * i + 2], i + 1);
        assert_int_equal(chain.kit.got_us[8 * i + 7] - asked_us,
                         (14 + 8 * ((int64_t)i + 1)) * BYTE_US);
    }
    /* A wrong sum, an unknown instruction, something to all: nothing. */
    simkit_ask(&chain.kit, "FF FF 01 02 01 FC", 50000);
    simkit_expect(&chain.kit, "");
    simkit_ask(&chain.kit, "FF FF 01 02 77 85", 50000);
    simkit_expect(&chain.kit, "");
    simkit_ask(&chain.kit, "FF FF FE 04 03 28 00 D2", 50000);
    simkit_expect(&chain.kit, "");
    /* Level 0: reads only. */
    assert_int_equal(put(6, GROBO_ROLE_REPLY_LEVEL, 0), -1);
    assert_int_equal(put(6, GROBO_ROLE_TORQUE, 1), -1);
    simkit_ask(&chain.kit, "FF FF 06 02 01 F6", 50000);
    simkit_expect(&chain.kit, "FF FF 06 02 00 F7");
}

TEST(scs_has_the_high_byte_first_and_no_sync_read)
{
    start("SCS0009", 2);
    simkit_ask(&chain.kit, "FF FF 01 04 02 03 02 F3", 50000);
    simkit_expect(&chain.kit, "FF FF 01 04 00 05 04 F1"); /* 1284 */
    simkit_ask(&chain.kit, "FF FF FE 06 82 38 02 01 02 3C", 50000);
    simkit_expect(&chain.kit, "");
    /* Goal 600 in 500 ms, by one write as its SDK does. */
    assert_int_equal(put(1, GROBO_ROLE_TORQUE, 1), 0);
    static const uint8_t block[] = {0x02, 0x58, 0x01, 0xF4, 0x00, 0x00};
    chain_send(&chain, 1, GROBO_DXL1_WRITE, 42, 0, block, sizeof block);
    simkit_run(&chain.kit, 250000);
    assert_in_range(value(0, GROBO_ROLE_POSITION), 555, 557);
    simkit_run(&chain.kit, 250000);
    assert_int_equal(value(0, GROBO_ROLE_POSITION), 600);
    /* The low byte first is 8, below the limit: the servo runs to its lowest position. */
    simkit_ask(&chain.kit, "FF FF 01 05 03 2A 00 08 C4", 50000);
    simkit_run(&chain.kit, 2000000);
    assert_int_equal(value(0, GROBO_ROLE_POSITION), 20);
}

TEST(sts_moves_by_speed_and_acceleration)
{
    start("STS3215", 1);
    assert_int_equal(put(1, GROBO_ROLE_TORQUE, 1), 0);
    /* WritePosEx 3000 speed 1500 acc 50: v/a = 0.3 s, d/v + v/a = 0.935 s. */
    simkit_ask(&chain.kit, "FF FF 01 0A 03 29 32 B8 0B 00 00 DC 05 F2", 50000);
    simkit_run(&chain.kit, 300000);
    assert_in_range(value(0, GROBO_ROLE_POSITION), 2272, 2276);
    assert_int_equal(value(0, GROBO_ROLE_PRESENT_SPEED), 1500);
    simkit_run(&chain.kit, 620000);
    assert_int_equal(value(0, GROBO_ROLE_MOVING), 1);
    simkit_run(&chain.kit, 20000);
    assert_int_equal(value(0, GROBO_ROLE_MOVING), 0);
    assert_int_equal(value(0, GROBO_ROLE_POSITION), 3000);
    /* A goal beyond the limits is taken to them in silence. */
    assert_int_equal(put(1, GROBO_ROLE_MAX_POSITION, 3500), 0);
    assert_int_equal(put(1, GROBO_ROLE_GOAL, 4000), 0);
    simkit_run(&chain.kit, 2000000);
    assert_int_equal(value(0, GROBO_ROLE_POSITION), 3500);
    /* A wheel: 1000 steps a second backwards. */
    assert_int_equal(put(1, GROBO_ROLE_MODE, GROBO_STS_MODE_SPEED), 0);
    assert_int_equal(put(1, GROBO_ROLE_SPEED, -1000), 0);
    simkit_run(&chain.kit, 5000000);
    assert_int_equal(value(0, GROBO_ROLE_PRESENT_SPEED), -1000);
    assert_in_range(value(0, GROBO_ROLE_POSITION), 3500 - 5000 + 4096 - 5, 3500 - 5000 + 4096 + 5);
}

TEST(sts_is_calibrated)
{
    start("STS3215", 1);
    assert_int_equal(grobo_sim_set_angle(&chain.kit.sim, 0, 45000, 0), 0);
    assert_int_equal(value(0, GROBO_ROLE_POSITION), 2560);
    assert_int_equal(put(1, GROBO_ROLE_OFFSET, 513), 0);
    assert_int_equal(value(0, GROBO_ROLE_POSITION), 2047);
    assert_int_equal(put(1, GROBO_ROLE_OFFSET, -195), 0);
    assert_int_equal(value(0, GROBO_ROLE_POSITION), 2755);
    assert_int_equal(put(1, GROBO_ROLE_TORQUE, GROBO_STS_TORQUE_CALIBRATE), 0);
    assert_int_equal(value(0, GROBO_ROLE_POSITION), 2048);
    assert_int_equal(value(0, GROBO_ROLE_OFFSET), 512);
    assert_int_equal(value(0, GROBO_ROLE_TORQUE), 0);
    /* Locked, an id lasts until the restart; open, for good. The answer has the new one. */
    assert_int_equal(put(1, GROBO_ROLE_ID, 7), 0);
    assert_int_equal(chain.kit.got[2], 7);
    chain_send(&chain, 7, GROBO_DXL1_REBOOT, 0, 0, NULL, 0);
    simkit_run(&chain.kit, 600000);
    assert_int_equal(value(0, GROBO_ROLE_ID), 1);
    assert_int_equal(put(1, GROBO_ROLE_LOCK, 0), 0);
    assert_int_equal(put(1, GROBO_ROLE_ID, 7), 0);
    chain_send(&chain, 7, GROBO_DXL1_REBOOT, 0, 0, NULL, 0);
    simkit_run(&chain.kit, 600000);
    assert_int_equal(value(0, GROBO_ROLE_ID), 7);
    assert_int_equal(value(0, GROBO_ROLE_OFFSET), 512);
}

TEST(sts_protects_itself)
{
    start("STS3215", 1);
    assert_int_equal(put(1, GROBO_ROLE_TORQUE, 1), 0);
    assert_int_equal(grobo_sim_set_blocked(&chain.kit.sim, 0, true), 0);
    assert_int_equal(put(1, GROBO_ROLE_GOAL, 3000), 0);
    simkit_run(&chain.kit, 1900000);
    assert_int_equal(value(0, GROBO_ROLE_ERROR), 0);
    assert_int_equal(value(0, GROBO_ROLE_LOAD), 1000);
    simkit_run(&chain.kit, 200000);
    assert_int_equal(value(0, GROBO_ROLE_ERROR), GROBO_FEETECH_OVERLOAD);
    assert_int_equal(value(0, GROBO_ROLE_LOAD), 200); /* the protective torque */
    chain_send(&chain, 1, GROBO_DXL1_READ, 56, 2, NULL, 0);
    assert_int_equal(chain.kit.got[4], GROBO_FEETECH_OVERLOAD);
    assert_int_equal(chain.kit.n_got, 8);
    assert_int_equal(put(1, GROBO_ROLE_TORQUE, 0), 0);
    assert_int_equal(value(0, GROBO_ROLE_ERROR), 0);
    /* LeRobot's gripper: 250 x 6.5 mA for 2 s take the torque. */
    assert_int_equal(put(1, GROBO_ROLE_CURRENT_LIMIT, 250), 0);
    assert_int_equal(put(1, GROBO_ROLE_TORQUE, 1), 0);
    simkit_run(&chain.kit, 2100000);
    assert_int_equal(value(0, GROBO_ROLE_ERROR), GROBO_FEETECH_OVERCURRENT);
    assert_int_equal(value(0, GROBO_ROLE_TORQUE), 0);
    grobo_sim_set_supply(&chain.kit.sim, 7400 * 9 / 8 + 300);
    assert_int_equal(value(0, GROBO_ROLE_ERROR) & (int)GROBO_FEETECH_VOLTAGE, 1);
}

/* The requests are printed in the manual of Protocol 1.0, or dynamixel-sdk's. */
TEST(ax_judges_what_it_is_told)
{
    start("AX-12A", 2);
    int64_t asked_us = chain.kit.now_us;
    simkit_ask(&chain.kit, "FF FF 01 04 02 2B 01 CC", 50000);
    simkit_expect(&chain.kit, "FF FF 01 03 00 19 E2"); /* 25 deg C */
    assert_int_equal(chain.kit.got_us[6] - asked_us, 15 * BYTE_US + 500);
    simkit_ask(&chain.kit, "FF FF 01 05 03 1E 00 04 D4", 50000);
    simkit_expect(&chain.kit, "FF FF 01 02 08 F4"); /* 1024 is no position */
    assert_int_equal(put(1, GROBO_ROLE_MAX_POSITION, 800), 0);
    assert_int_equal(put(1, GROBO_ROLE_GOAL, 900), GROBO_DXL1_ANGLE_LIMIT);
    simkit_ask(&chain.kit, "FF FF 01 02 77 85", 50000);
    simkit_expect(&chain.kit, "FF FF 01 02 40 BC");
    simkit_ask(&chain.kit, "FF FF 01 02 01 FC", 50000);
    simkit_expect(&chain.kit, "FF FF 01 02 10 EC");
    simkit_ask(&chain.kit, "FF FF FE 06 82 24 02 01 02 50", 50000);
    simkit_expect(&chain.kit, "");
    chain_send(&chain, 1, GROBO_DXL1_ACTION, 0, 0, NULL, 0);
    assert_int_equal(chain.kit.got[4], GROBO_DXL1_BAD_INSTRUCTION);
    /* A goal brings the torque; 200 x 0.111 rpm. */
    assert_int_equal(put(1, GROBO_ROLE_SPEED, 200), 0);
    assert_int_equal(put(1, GROBO_ROLE_GOAL, 700), 0);
    assert_int_equal(value(0, GROBO_ROLE_TORQUE), 1);
    assert_int_equal(value(0, GROBO_ROLE_PRESENT_SPEED), 200);
    simkit_run(&chain.kit, 500000);
    assert_int_equal(value(0, GROBO_ROLE_POSITION), 700);
    /* A closed lock keeps the EEPROM until power-off. */
    assert_int_equal(put(1, GROBO_ROLE_LOCK, 1), 0);
    assert_int_equal(put(1, GROBO_ROLE_ID, 5), GROBO_DXL1_BAD_RANGE);
    assert_int_equal(put(1, GROBO_ROLE_LOCK, 0), GROBO_DXL1_BAD_RANGE);
    assert_int_equal(put(1, GROBO_ROLE_LOCK, 1), 0);
    assert_int_equal(put(1, GROBO_ROLE_ID, 5), GROBO_DXL1_BAD_RANGE);
}

TEST(ax_loses_its_force)
{
    start("AX-12A", 1);
    assert_int_equal(put(1, GROBO_ROLE_GOAL, 512), 0);
    assert_int_equal(grobo_sim_set_blocked(&chain.kit.sim, 0, true), 0);
    assert_int_equal(put(1, GROBO_ROLE_GOAL, 900), 0);
    simkit_run(&chain.kit, 1100000);
    assert_int_equal(value(0, GROBO_ROLE_TORQUE), 1);
    assert_int_equal(value(0, GROBO_ROLE_TORQUE_LIMIT), 0);
    assert_int_equal(simkit_look(&chain.kit, 0).torque, GROBO_TORQUE_OFF);
    chain_send(&chain, 1, GROBO_DXL1_READ, 36, 2, NULL, 0);
    assert_int_equal(chain.kit.got[4], GROBO_DXL1_OVERLOAD);
    assert_int_equal(grobo_sim_set_blocked(&chain.kit.sim, 0, false), 0);
    assert_int_equal(put(1, GROBO_ROLE_TORQUE_LIMIT, 1023), 0);
    simkit_run(&chain.kit, 2000000);
    assert_int_equal(value(0, GROBO_ROLE_POSITION), 900);
    assert_int_equal(grobo_sim_set_temperature(&chain.kit.sim, 0, 75), 0);
    simkit_run(&chain.kit, 1000);
    assert_int_equal(value(0, GROBO_ROLE_TORQUE_LIMIT), 0);
    chain_send(&chain, 1, GROBO_DXL1_PING, 0, 0, NULL, 0);
    assert_int_equal(chain.kit.got[4], GROBO_DXL1_OVERHEATED);
}

TEST(mx_is_read_in_bulk)
{
    start("MX-28", 6);
    simkit_ask(&chain.kit, "FF FF FE 0C 92 00 08 04 24 02 05 24 02 06 24 DC", 50000);
    assert_int_equal(chain.kit.n_got, 14 + 8 + 8);
    assert_int_equal(chain.kit.got[2], 4);
    assert_int_equal(chain.kit.got[14 + 2], 5);
    assert_int_equal(chain.kit.got[14 + 8 + 2], 6);
    chain_send(&chain, GROBO_DXL1_ID_ALL, GROBO_DXL1_SYNC_READ, 36, 2, six, sizeof six);
    assert_int_equal(chain.kit.n_got, 0);
    /* An id that comes twice counts once (emanual, Protocol 1.0). */
    simkit_ask(&chain.kit, "FF FF FE 0C 92 00 02 04 24 02 05 24 01 04 2B DE", 50000);
    assert_int_equal(chain.kit.n_got, 8 + 8);
    /* Multi-turn, where alone its offset counts, and its wheel. */
    assert_int_equal(put(3, GROBO_ROLE_OFFSET, 1024), 0);
    assert_int_equal(value(2, GROBO_ROLE_POSITION), 2048);
    assert_int_equal(put(3, GROBO_ROLE_MIN_POSITION, 4095), 0);
    assert_int_equal(value(2, GROBO_ROLE_POSITION), 3072);
    assert_int_equal(put(1, GROBO_ROLE_MIN_POSITION, 4095), 0);
    assert_int_equal(put(1, GROBO_ROLE_GOAL, -2048), 0);
    simkit_run(&chain.kit, 3000000);
    assert_int_equal(value(0, GROBO_ROLE_POSITION), -2048);
    assert_int_equal(put(2, GROBO_ROLE_MAX_POSITION, 0), 0);
    assert_int_equal(put(2, GROBO_ROLE_SPEED, 1124), 0);
    assert_int_equal(put(2, GROBO_ROLE_TORQUE, 1), 0);
    assert_int_equal(value(1, GROBO_ROLE_PRESENT_SPEED), -100);
}

/* New servos have one id: what is for it is for all of them, and their answers collide. */
TEST(servos_with_one_id_act_together)
{
    static const uint8_t goal[] = {1, 0x00, 0x05}, both[] = {1, 3};
    start("STS3215", 3);
    assert_int_equal(put(1, GROBO_ROLE_TORQUE, 1), 0);
    assert_int_equal(put(2, GROBO_ROLE_TORQUE_LIMIT, 0), 0); /* it stays: their answers differ */
    (void)put(2, GROBO_ROLE_ID, 1);
    chain_send(&chain, GROBO_DXL1_ID_ALL, GROBO_DXL1_SYNC_WRITE, 42, 2, goal, sizeof goal);
    simkit_run(&chain.kit, 1000000);
    assert_int_equal(value(0, GROBO_ROLE_POSITION), 0x500);
    assert_int_equal(value(1, GROBO_ROLE_GOAL), 0x500);
    chain_send(&chain, GROBO_DXL1_ID_ALL, GROBO_DXL1_SYNC_READ, 56, 2, both, sizeof both);
    simkit_expect(&chain.kit, "FF FF 01 04 00 00 00 F0 FF FF 03 04 00 00 08 F0");
    uint32_t before = chain.kit.sim.stats.collisions;
    chain_send(&chain, GROBO_DXL1_ID_ALL, GROBO_DXL1_PING, 0, 0, NULL, 0);
    assert_int_equal(chain.kit.n_got, 2 * 6);
    assert_int_equal(chain.kit.sim.stats.collisions, before + 1);
    start("MX-28", 2);
    assert_int_equal(put(2, GROBO_ROLE_ID, 1), 0);
    before = chain.kit.sim.stats.collisions;
    simkit_ask(&chain.kit, "FF FF 01 02 01 FC", 50000); /* a wrong sum */
    assert_int_equal(chain.kit.sim.stats.collisions, before + 1);
}

/* A goal alone, without torque before: in its own write, in the maker's block, by a sync write.
 * What is written beside it wakes nobody. */
TEST(a_goal_switches_torque_on)
{
    static const char *const servos[] = {"STS3215", "SCS0009", "AX-12A"};
    for (size_t i = 0; i < sizeof servos / sizeof *servos; i++) {
        start(servos[i], 1);
        assert_int_equal(put(1, GROBO_ROLE_SPEED, 100), 0);
        assert_int_equal(value(0, GROBO_ROLE_TORQUE), 0);
        assert_int_equal(put(1, GROBO_ROLE_GOAL, value(0, GROBO_ROLE_POSITION)), 0);
        assert_int_equal(value(0, GROBO_ROLE_TORQUE), 1);
        assert_int_equal(put(1, GROBO_ROLE_TORQUE, 0), 0);
        assert_int_equal(value(0, GROBO_ROLE_TORQUE), 0);
    }
    static const uint8_t goal[] = {1, 0x00, 0x05};
    static const uint8_t block[] = {0, 0x00, 0x04, 0, 0, 0x64, 0};
    start("STS3215", 1);
    chain_send(&chain, GROBO_DXL1_ID_ALL, GROBO_DXL1_SYNC_WRITE, 42, 2, goal, sizeof goal);
    simkit_run(&chain.kit, 1000000);
    assert_int_equal(value(0, GROBO_ROLE_POSITION), 0x500);
    assert_int_equal(put(1, GROBO_ROLE_TORQUE, 0), 0);
    chain_send(&chain, 1, GROBO_DXL1_WRITE, 41, 0, block, sizeof block);
    assert_int_equal(value(0, GROBO_ROLE_TORQUE), 1);
}

/* Two families on one line: each hears its own packets and no other. */
TEST(families_share_a_line)
{
    start("STS3215", 2);
    chain.servos[0] = grobo_servo_model_named(&grobo_i_dxl2_table, "XL330-M288");
    grobo_sim_config config = chain.kit.sim.config;
    config.baud_bps = 1000000;
    simkit_start(&chain.kit, &config);
    simkit_ask(&chain.kit, "FF FF FD 00 01 03 00 01 19 4E", 50000);
    assert_int_equal(chain.kit.n_got, 14);
    simkit_ask(&chain.kit, "FF FF 02 02 01 FA", 50000);
    simkit_expect(&chain.kit, "FF FF 02 02 00 FB");
    simkit_ask(&chain.kit, "FF FF 01 02 01 FB", 50000);
    simkit_expect(&chain.kit, "");
    assert_int_equal(grobo_sim_set_id(&chain.kit.sim, 0, 9), 0);
    assert_int_equal(grobo_sim_find(&chain.kit.sim, 9), 0);
    assert_int_equal(grobo_sim_set_id(&chain.kit.sim, 0, 253), GROBO_ERR_LIMIT);
    uint8_t flash[GROBO_SIM_FLASH_BYTES];
    assert_int_equal(grobo_sim_get_flash(&chain.kit.sim, 0, flash), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(grobo_sim_set_flash(&chain.kit.sim, 0, flash), GROBO_ERR_UNSUPPORTED);
    /* What cannot be simulated. */
    static const grobo_sim_family *const none[] = {&grobo_i_sim_dxl2, NULL};
    grobo_sim *sim = &chain.kit.sim;
    config.families = none;
    assert_int_equal(grobo_sim_init(sim, &config, 0), GROBO_ERR_UNSUPPORTED);
    config.families = NULL;
    assert_int_equal(grobo_sim_init(sim, &config, 0), GROBO_ERR_UNSUPPORTED);
    config = chain.kit.sim.config;
    config.wiring = GROBO_WIRING_BOARD;
    assert_int_equal(grobo_sim_init(sim, &config, 0), GROBO_ERR_ARG);
}
