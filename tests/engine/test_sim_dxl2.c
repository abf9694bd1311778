/* SPDX-License-Identifier: MIT */
/* Simulated DYNAMIXEL of the X series: answers, times, registers, modes, shutdowns. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/dxl2.h>
#include <grobo/core/sim.h>

#include "tests/support/chain_kit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { BYTE_US = 10, DELAY_US = 500 };

static chain_kit chain;

static const grobo_servo_model *model(const char *name)
{
    return grobo_servo_model_named(&grobo_i_dxl2_table, name);
}

static const uint8_t six[] = {1, 2, 3, 4, 5, 6};

/* Fields of the status that came at an offset. */
static uint8_t id_at(size_t at)
{
    return chain.kit.got[at + 4];
}

static int32_t value_at(size_t at)
{
    const uint8_t *p = &chain.kit.got[at + 9];
    return (int32_t)((uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 |
                     (uint32_t)p[3] << 24);
}

/* The bytes are those of clients' recordings (vectors of dynamixel-sdk 4.1.0). */
TEST(answers_are_those_of_a_servo)
{
    chain_start(&chain, model("XL330-M288"), 3, NULL);
    int64_t asked_us = chain.kit.now_us;
    simkit_ask(&chain.kit, "FF FF FD 00 01 03 00 01 19 4E", 50000);
    assert_int_equal(chain.kit.n_got, 14);
    assert_memory_equal(chain.kit.got, "\xFF\xFF\xFD\x00\x01\x07\x00\x55\x00\xB0\x04\x34", 12);
    assert_int_equal(chain.kit.got_us[13] - asked_us, 10 * BYTE_US + DELAY_US + 14 * BYTE_US);
    /* Position of id 3: 2048. */
    simkit_ask(&chain.kit, "FF FF FD 00 03 07 00 02 84 00 04 00 11 35", 50000);
    simkit_expect(&chain.kit, "FF FF FD 00 03 08 00 55 00 00 08 00 00 DF B4");
    /* A bad CRC, another id, a status: nothing. */
    simkit_ask(&chain.kit, "FF FF FD 00 03 07 00 02 84 00 04 00 11 36", 50000);
    simkit_expect(&chain.kit, "");
    simkit_ask(&chain.kit, "FF FF FD 00 06 07 00 02 92 00 01 00 09 43", 50000);
    simkit_expect(&chain.kit, "");
    simkit_ask(&chain.kit, "FF FF FD 00 01 04 00 55 00 A1 0C", 50000);
    simkit_expect(&chain.kit, "");
    /* Torque on keeps the EEPROM; a goal outside the limits; a register that is read only. */
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1), GROBO_DXL2_DONE);
    simkit_ask(&chain.kit, "FF FF FD 00 01 06 00 03 07 00 09 84 E3", 50000);
    assert_int_equal(chain.kit.n_got, 11);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_NO_ACCESS);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_GOAL, 5000), GROBO_DXL2_BAD_LIMIT);
    simkit_ask(&chain.kit, "FF FF FD 00 03 09 00 03 84 00 01 00 00 00 36 DD", 50000);
    simkit_expect(&chain.kit, "FF FF FD 00 03 04 00 55 07 43 0C");
    simkit_ask(&chain.kit, "FF FF FD 00 03 07 00 03 74 00 01 00 42 6B", 50000);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_BAD_LENGTH);
    chain_send(&chain, 2, 0x77, 0, 0, NULL, 0);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_BAD_INSTRUCTION);
    chain_send(&chain, 2, GROBO_DXL2_READ, 140, 20, NULL, 0);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_NO_ACCESS);
    chain_send(&chain, 2, GROBO_DXL2_READ, 132, 0, NULL, 0);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_BAD_LENGTH);
}

/* Host budget of the reference: (14 + n) x 10 us + n x (d + (11 + len) x 10 us). */
TEST(servos_of_a_list_answer_in_turn)
{
    chain_start(&chain, model("XL330-M288"), 6, NULL);
    int64_t asked_us = chain.kit.now_us;
    chain_send(&chain, GROBO_DXL2_ID_ALL, GROBO_DXL2_SYNC_READ, 132, 4, six, sizeof six);
    assert_int_equal(chain.kit.n_got, 6 * 15);
    for (size_t i = 0; i < 6; i++) {
        assert_int_equal(id_at(15 * i), i + 1);
        assert_int_equal(value_at(15 * i), 2048);
        int64_t end_us = 20 * BYTE_US + (int64_t)(i + 1) * (DELAY_US + 15 * BYTE_US);
        assert_int_equal(chain.kit.got_us[15 * i + 14] - asked_us, end_us);
    }
    /* One is silent: its time goes by, the others answer. */
    assert_int_equal(grobo_sim_set_cable(&chain.kit.sim, 1, GROBO_SIM_CABLE_MUTE), 0);
    chain_send(&chain, GROBO_DXL2_ID_ALL, GROBO_DXL2_SYNC_READ, 132, 4, six, 3);
    assert_int_equal(chain.kit.n_got, 2 * 15);
    assert_int_equal(id_at(15), 3);
    assert_int_equal(chain.kit.got_us[15] - chain.kit.got_us[14], DELAY_US + 16 * BYTE_US);
}

TEST(a_fast_read_is_one_status)
{
    chain_start(&chain, model("XL430-W250"), 6, NULL);
    int64_t asked_us = chain.kit.now_us;
    chain_send(&chain, GROBO_DXL2_ID_ALL, GROBO_DXL2_FAST_SYNC_READ, 132, 4, six, sizeof six);
    assert_int_equal(chain.kit.n_got, 8 + 6 * 8);
    assert_int_equal(grobo_dxl2_measure(chain.kit.got, chain.kit.n_got, 2), chain.kit.n_got);
    assert_int_equal(chain.kit.got_us[55] - asked_us, 20 * BYTE_US + DELAY_US + 56 * BYTE_US);
    int at = 8;
    for (int i = 0; i < 6; i++) {
        grobo_dxl2_packet block;
        at = grobo_dxl2_block(chain.kit.got, chain.kit.n_got, (size_t)at, 4, &block);
        assert_true(at > 0);
        assert_int_equal(block.id, i + 1);
    }
    /* After one that is silent nobody can go on. */
    assert_int_equal(grobo_sim_set_cable(&chain.kit.sim, 2, GROBO_SIM_CABLE_MUTE), 0);
    chain_send(&chain, GROBO_DXL2_ID_ALL, GROBO_DXL2_FAST_SYNC_READ, 132, 4, six, sizeof six);
    assert_int_equal(chain.kit.n_got, 8 + 2 * 8);
}

static void write_block(uint8_t id, int address, const uint8_t *bytes, size_t n)
{
    chain_send(&chain, id, GROBO_DXL2_WRITE, (uint16_t)address, 0, bytes, n);
    assert_int_equal(chain.kit.n_got, 11);
}

/* Reads a block and returns its first four bytes. */
static int32_t read_block(uint8_t id, int address, int n)
{
    chain_send(&chain, id, GROBO_DXL2_READ, (uint16_t)address, (uint16_t)n, NULL, 0);
    assert_int_equal(chain.kit.n_got, 11 + n);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_DONE);
    return value_at(0);
}

/* A run of indirect addresses; where its data are. */
static const struct {
    const char *model;
    int address, data, last,
        most; /* of the run: first address, first data, the last ones; RAM's end */
} runs[] = {{"XL330-M288", 168, 208, 206, 227},
            {"XC430-W150", 168, 224, 222, 661},
            {"XM540-W270", 578, 634, 632, 661},
            {"MX-64-2", 168, 224, 222, 661}};

/* The e-manual of each model: what an indirect address holds at power-on, and that its data are the
 * bytes that it names. */
TEST(indirect_data_stand_for_other_registers)
{
    for (size_t r = 0; r < sizeof runs / sizeof runs[0]; r++) {
        chain_start(&chain, model(runs[r].model), 2, NULL);
        assert_int_equal(read_block(1, runs[r].address, 4) & 0xFFFF, runs[r].data);
        /* Data of its own. */
        write_block(1, runs[r].data, (const uint8_t[]){7, 8, 9}, 3);
        assert_int_equal(chain.kit.got[8], GROBO_DXL2_DONE);
        assert_int_equal(read_block(1, runs[r].data, 4), 0x090807);
        /* Goal position, whose bytes come together in one write; then the present one. */
        const uint8_t goal[] = {116, 0, 117, 0, 118, 0, 119, 0};
        write_block(1, runs[r].address, goal, sizeof goal);
        assert_int_equal(chain.kit.got[8], GROBO_DXL2_DONE);
        assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1), GROBO_DXL2_DONE);
        write_block(1, runs[r].data, (const uint8_t[]){0xC4, 0x09, 0, 0}, 4);
        assert_int_equal(chain.kit.got[8], GROBO_DXL2_DONE);
        assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_GOAL), 2500);
        simkit_run(&chain.kit, 2000000);
        const uint8_t present[] = {132, 0, 133, 0, 134, 0, 135, 0};
        write_block(1, runs[r].address, present, sizeof present);
        assert_int_equal(read_block(1, runs[r].data, 4), 2500);
        /* What a goal may not be, it may not be here; the servo that was not asked is as it was. */
        write_block(1, runs[r].address, goal, sizeof goal);
        write_block(1, runs[r].data, (const uint8_t[]){0x88, 0x13, 0, 0}, 4);
        assert_int_equal(chain.kit.got[8], GROBO_DXL2_BAD_LIMIT);
        assert_int_equal(read_block(2, runs[r].address, 4) & 0xFFFF, runs[r].data);
        /* No register below RAM or behind it; half an address. */
        write_block(1, runs[r].last, (const uint8_t[]){7, 0}, 2);
        assert_int_equal(chain.kit.got[8], GROBO_DXL2_BAD_RANGE);
        const uint8_t beyond[] = {(uint8_t)((runs[r].most + 1) & 0xFF),
                                  (uint8_t)((runs[r].most + 1) >> 8)};
        write_block(1, runs[r].last, beyond, sizeof beyond);
        assert_int_equal(chain.kit.got[8], GROBO_DXL2_BAD_RANGE);
        write_block(1, runs[r].last, (const uint8_t[]){116}, 1);
        assert_int_equal(chain.kit.got[8], GROBO_DXL2_BAD_RANGE);
        /* A reboot forgets them. */
        chain_send(&chain, 1, GROBO_DXL2_REBOOT, 0, 0, NULL, 0);
        simkit_run(&chain.kit, 3000000);
        assert_int_equal(read_block(1, runs[r].address, 4) & 0xFFFF, runs[r].data);
    }
}

/* Those of P and PRO are in the EEPROM (emanual, PH54-200-S500-R, M54-60-S250-RA, M54-60-S250-R):
 * locked by torque, and there after a reboot; new from the factory. */
TEST(indirect_addresses_of_the_eeprom_last)
{
    static const struct {
        const char *name;
        int first, position;
    } rows[] = {
        {"PH54-200-S500-R", 168, 580}, {"M54-60-S250-RA", 168, 580}, {"M54-60-S250-R", 49, 611}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const int first = rows[i].first, position = rows[i].position;
        uint8_t present[8];
        for (int k = 0; k < 4; k++) {
            present[2 * k] = (uint8_t)(position + k);
            present[2 * k + 1] = (uint8_t)((position + k) >> 8);
        }
        chain_start(&chain, model(rows[i].name), 1, NULL);
        assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1), GROBO_DXL2_DONE);
        write_block(1, first, present, sizeof present);
        assert_int_equal(chain.kit.got[8], GROBO_DXL2_NO_ACCESS);
        assert_int_equal(read_block(1, first, 4), 634 | 635 << 16);
        assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_GOAL, 5000), GROBO_DXL2_DONE);
        simkit_run(&chain.kit, 2000000);
        assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 0), GROBO_DXL2_DONE);
        write_block(1, first, present, sizeof present);
        assert_int_equal(chain.kit.got[8], GROBO_DXL2_DONE);
        write_block(1, 640, (const uint8_t[]){7}, 1);
        chain_send(&chain, 1, GROBO_DXL2_REBOOT, 0, 0, NULL, 0);
        simkit_run(&chain.kit, 3000000);
        assert_int_equal(read_block(1, first, 4), position | (position + 1) << 16);
        assert_true(abs(read_block(1, 634, 4) - 5000) <= 3);
        assert_int_equal(read_block(1, 640, 4), 0); /* data are RAM */
        chain_send(&chain, 1, GROBO_DXL2_FACTORY_RESET, 0, 0, (const uint8_t[]){2}, 1);
        simkit_run(&chain.kit, 3000000);
        assert_int_equal(read_block(1, first, 4), 634 | 635 << 16);
    }
}

/* A servo says why it does not answer with so much: silence would be a broken cable to its host. */
TEST(a_read_of_too_much_is_refused)
{
    static const int lengths[] = {0, 241, 255, 256, 300, 512, 65535};
    chain_start(&chain, model("PH54-200-S500-R"), 1, NULL);
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        chain_send(&chain, 1, GROBO_DXL2_READ, 168, (uint16_t)lengths[i], NULL, 0);
        assert_int_equal(chain.kit.n_got, 11);
        assert_int_equal(chain.kit.got[8], GROBO_DXL2_BAD_LENGTH);
    }
    /* Stuffed, FF FF FD of each three bytes would be longer than a packet may be. */
    uint8_t pattern[90];
    for (size_t i = 0; i < sizeof pattern; i++) {
        pattern[i] = i % 3 == 2 ? 0xFD : 0xFF;
    }
    write_block(1, 634, pattern, sizeof pattern);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_DONE);
    chain_send(&chain, 1, GROBO_DXL2_READ, 634, sizeof pattern, NULL, 0);
    assert_int_equal(chain.kit.n_got, 11 + sizeof pattern / 3 * 4);
    chain_send(&chain, 1, GROBO_DXL2_READ, 168, 240, NULL, 0);
    assert_int_equal(chain.kit.n_got, 11 + 240);
}

/* Position, speed and current in one reading of each, as the maker's ROS driver asks. */
TEST(indirect_data_are_read_together)
{
    chain_start(&chain, model("XM430-W350"), 3, NULL);
    const uint8_t places[] = {132, 0, 133, 0, 134, 0, 135, 0, 144, 0, 145, 0};
    for (uint8_t id = 1; id <= 3; id++) {
        write_block(id, 578, places, sizeof places);
        assert_int_equal(chain.kit.got[8], GROBO_DXL2_DONE);
    }
    chain_send(&chain, GROBO_DXL2_ID_ALL, GROBO_DXL2_SYNC_READ, 634, 6, six, 3);
    assert_int_equal(chain.kit.n_got, 3 * 17);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(id_at(17 * i), i + 1);
        assert_int_equal(value_at(17 * i), 2048);
        assert_int_equal(chain.kit.got[17 * i + 13], 120);
    }
    chain_send(&chain, GROBO_DXL2_ID_ALL, GROBO_DXL2_FAST_SYNC_READ, 634, 6, six, 3);
    assert_int_equal(chain.kit.n_got, 8 + 3 * 10);
    assert_int_equal(chain.kit.got[8 + 1 + 1], 2048 & 0xFF);
    assert_int_equal(chain.kit.got[8 + 1 + 2], 2048 >> 8);
}

TEST(all_are_found_by_one_ping)
{
    chain_start(&chain, model("XM430-W350"), 20, NULL);
    simkit_ask(&chain.kit, "FF FF FD 00 FE 03 00 01 31 42", 100000);
    assert_int_equal(chain.kit.n_got, 20 * 14);
    for (size_t i = 0; i < 20; i++) {
        assert_int_equal(id_at(14 * i), i + 1);
    }
}

/* New servos have one id: what is for it is for all of them, and their answers collide. */
TEST(servos_with_one_id_act_together)
{
    static const uint8_t leds[] = {1, 1}, bulk[] = {1, 65, 0, 1, 0, 0}, both[] = {1, 3};
    static const uint8_t instructions[] = {GROBO_DXL2_SYNC_READ, GROBO_DXL2_FAST_SYNC_READ};
    chain_start(&chain, model("XL330-M288"), 3, NULL);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_GOAL, 0x500), 0);
    assert_int_equal(chain_write(&chain, 2, GROBO_ROLE_ID, 1), 0);
    simkit_run(&chain.kit, 1000000);
    chain_send(&chain, GROBO_DXL2_ID_ALL, GROBO_DXL2_SYNC_WRITE, 65, 1, leds, sizeof leds);
    assert_int_equal(simkit_register(&chain.kit, 0, 65), 1);
    assert_int_equal(simkit_register(&chain.kit, 1, 65), 1);
    chain_send(&chain, GROBO_DXL2_ID_ALL, GROBO_DXL2_BULK_WRITE, 0, 0, bulk, sizeof bulk);
    assert_int_equal(simkit_register(&chain.kit, 0, 65), 0);
    assert_int_equal(simkit_register(&chain.kit, 1, 65), 0);
    chain_send(&chain, GROBO_DXL2_ID_ALL, GROBO_DXL2_SYNC_READ, 132, 4, both, sizeof both);
    assert_int_equal(chain.kit.n_got, 2 * 15);
    assert_int_equal(value_at(0), 0x500 & 0x800);
    assert_int_equal(id_at(15), 3);
    assert_int_equal(chain.kit.got_us[15] - chain.kit.got_us[14], DELAY_US + BYTE_US);
    for (size_t i = 0; i < sizeof instructions; i++) {
        uint32_t before = chain.kit.sim.stats.collisions;
        chain_send(&chain, GROBO_DXL2_ID_ALL, instructions[i], 132, 4, both, sizeof both);
        assert_int_equal(chain.kit.sim.stats.collisions, before + 1);
    }
    uint32_t before = chain.kit.sim.stats.collisions;
    chain_send(&chain, GROBO_DXL2_ID_ALL, GROBO_DXL2_PING, 0, 0, NULL, 0);
    assert_int_equal(chain.kit.n_got, 2 * 14);
    assert_int_equal(chain.kit.sim.stats.collisions, before + 1);
}

/* By its drive mode, where no error forbids it; the goal has its time. */
TEST(a_goal_may_wake_a_servo)
{
    chain_start(&chain, model("XL330-M288"), 1, NULL);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_DIRECTION, GROBO_DXL2_DRIVE_TIME), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_GOAL, 1024), 0);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_TORQUE), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_DIRECTION,
                                 GROBO_DXL2_DRIVE_TIME | GROBO_DXL2_DRIVE_WAKES),
                     0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_SPEED, 1000), 0);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_TORQUE), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_GOAL, 2148), 0);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_TORQUE), 1);
    simkit_run(&chain.kit, 400000);
    assert_in_range(chain_register(&chain, 0, GROBO_ROLE_POSITION), 2080, 2110);
    assert_int_equal(grobo_sim_set_temperature(&chain.kit.sim, 0, 90), 0);
    simkit_run(&chain.kit, 1000);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_TORQUE), 0);
    (void)chain_write(&chain, 1, GROBO_ROLE_GOAL, 1024);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_TORQUE), 0);
}

TEST(moves_follow_their_profile)
{
    chain_start(&chain, model("XL330-M288"), 1, NULL);
    /* By time: 500 ms for 1000 counts, 200 ms of it to get up to speed. */
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_DIRECTION, 4), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_ACCELERATION, 200), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_SPEED, 500), 0);
    int64_t begun_us = chain.kit.now_us;
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_GOAL, 3048), 0);
    begun_us = begun_us + 16 * BYTE_US;
    static const int16_t way[] = {2048, 2131, 2381, 2715, 2965, 3048, 3048};
    for (size_t i = 0; i < sizeof way / sizeof *way; i++) {
        simkit_run(&chain.kit, begun_us + (int64_t)i * 100000 - chain.kit.now_us);
        assert_in_range(chain_register(&chain, 0, GROBO_ROLE_POSITION), way[i] - 2, way[i] + 2);
    }
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_MOVING), 0);
    /* By velocity: 100 x 0.229 rpm are 137.4 degrees a second, at once. */
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 0), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_DIRECTION, 0), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_ACCELERATION, 0), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_SPEED, 100), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_GOAL, 0), 0);
    int32_t from = chain_register(&chain, 0, GROBO_ROLE_POSITION);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_PRESENT_SPEED), -100);
    simkit_run(&chain.kit, 500000);
    assert_in_range(from - chain_register(&chain, 0, GROBO_ROLE_POSITION), 780, 783);
}

/* A goal in the middle of a move goes on at the speed that there is. */
TEST(a_stream_of_goals_flows)
{
    chain_start(&chain, model("XL330-M288"), 1, NULL);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_ACCELERATION, 40), 0);
    for (int i = 1; i <= 50; i++) {
        assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_GOAL, 2048 + 20 * i), 0);
        simkit_run(&chain.kit, 9000);
    }
    assert_in_range(chain_register(&chain, 0, GROBO_ROLE_POSITION), 2780, 3048); /* it lags */
    assert_in_range(chain_register(&chain, 0, GROBO_ROLE_PRESENT_SPEED), 90, 180);
    simkit_run(&chain.kit, 1000000);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_POSITION), 3048);
}

/* PRO before (A): registers from 562 on, a goal with a speed, a torque of 0 that does not bound
 * (emanual H54-100-S500-R, goal_velocity, goal_torque). */
TEST(pro_moves_at_the_speed_of_its_goal)
{
    enum { GOAL = 596, VELOCITY = 600, TORQUE = 604 };
    chain_start(&chain, model("H54-100-S500-R"), 1, NULL);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1), 0);
    /* 10000 of 1/501.923 rpm are 119.54 degrees a second: 166667 counts, while torque is 0. */
    const uint8_t goal[] = {0x20, 0xA1, 0x07, 0, 0x10, 0x27, 0, 0}; /* 500000, beyond its limit */
    write_block(1, GOAL, goal, sizeof goal);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_BAD_LIMIT);
    const uint8_t inside[] = {0x40, 0x0D, 0x03, 0, 0x10, 0x27, 0, 0}; /* 200000 */
    write_block(1, GOAL, inside, sizeof inside);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_DONE);
    simkit_run(&chain.kit, 1000000);
    assert_in_range(chain_register(&chain, 0, GROBO_ROLE_POSITION), 166000, 167400);
    assert_in_range(chain_register(&chain, 0, GROBO_ROLE_PRESENT_SPEED), 9995, 10005);
    simkit_run(&chain.kit, 1000000);
    assert_in_range(chain_register(&chain, 0, GROBO_ROLE_POSITION), 199998, 200002);
    assert_int_equal(read_block(1, TORQUE, 4) & 0xFFFF, 0);
    /* Faster than its limit, either way round. */
    write_block(1, VELOCITY, (const uint8_t[]){0x69, 0x42, 0, 0}, 4); /* 17001 */
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_BAD_LIMIT);
    write_block(1, VELOCITY, (const uint8_t[]){0x97, 0xBD, 0xFF, 0xFF}, 4);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_BAD_LIMIT);
    /* As a wheel it turns at this speed, and backwards. */
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 0), 0);
    write_block(1, 11, (const uint8_t[]){16}, 1);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_BAD_RANGE);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_MODE, 1), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1), 0);
    write_block(1, VELOCITY, (const uint8_t[]){0x18, 0xFC, 0xFF, 0xFF}, 4); /* -1000 */
    simkit_run(&chain.kit, 100000);
    assert_in_range(chain_register(&chain, 0, GROBO_ROLE_PRESENT_SPEED), -1002, -998);
}

TEST(modes_have_their_own_goals)
{
    chain_start(&chain, model("XL330-M288"), 1,
                &(grobo_sim_config){GROBO_SIM_CONFIG_INIT, .no_stops = true});
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_MODE, 1), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_MODE, 3), GROBO_DXL2_NO_ACCESS);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_GOAL_SPEED, 446), GROBO_DXL2_BAD_LIMIT);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_GOAL_SPEED, -100), 0);
    simkit_run(&chain.kit, 10000000);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_PRESENT_SPEED), -100);
    assert_in_range(chain_register(&chain, 0, GROBO_ROLE_POSITION), 2048 - 15700, 2048 - 15600);
    /* A mode that counts turns begins within one. */
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 0), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_MODE, 4), 0);
    assert_in_range(chain_register(&chain, 0, GROBO_ROLE_POSITION), 0, 4095);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_GOAL, -8000), 0);
    simkit_run(&chain.kit, 5000000);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_POSITION), -8000);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_MODE, 2), GROBO_DXL2_NO_ACCESS);
    chain_start(&chain, model("XL430-W250"), 1, NULL);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_MODE, 5), GROBO_DXL2_BAD_RANGE);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_MODE, 2), GROBO_DXL2_BAD_RANGE);
}

TEST(the_watchdog_stops_a_servo)
{
    chain_start(&chain, model("XL330-M288"), 2, NULL);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_SPEED, 20), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_WATCHDOG, 5), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_GOAL, 4095), 0);
    /* What is for others does not count. */
    for (int i = 0; i < 4; i++) {
        chain_send(&chain, 2, GROBO_DXL2_PING, 0, 0, NULL, 0);
        simkit_run(&chain.kit, 40000);
    }
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_WATCHDOG), -1);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_SPEED), 0);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_TORQUE), 1);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_MOVING), 0);
    int32_t here = chain_register(&chain, 0, GROBO_ROLE_POSITION);
    assert_in_range(here, 2048 + 25, 2048 + 35); /* 100 ms at 27.5 degrees a second */
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_GOAL, 2048), GROBO_DXL2_BAD_RANGE);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_WATCHDOG, 0), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_GOAL, 2048), 0);
}

TEST(a_shutdown_lasts_until_the_restart)
{
    chain_start(&chain, model("XL330-M288"), 1, NULL);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1), 0);
    assert_int_equal(grobo_sim_set_blocked(&chain.kit.sim, 0, true), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_GOAL, 3000), 0);
    simkit_run(&chain.kit, 900000);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_ERROR), 0);
    simkit_run(&chain.kit, 200000);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_ERROR), GROBO_DXL2_OVERLOAD);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_TORQUE), 0);
    chain_send(&chain, 1, GROBO_DXL2_READ, 132, 4, NULL, 0);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_ALERT);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1),
                     GROBO_DXL2_FAILED | GROBO_DXL2_ALERT);
    chain_send(&chain, 1, GROBO_DXL2_REBOOT, 0, 0, NULL, 0);
    assert_int_equal(chain.kit.n_got, 11);
    chain_send(&chain, 1, GROBO_DXL2_PING, 0, 0, NULL, 0);
    assert_int_equal(chain.kit.n_got, 0);
    simkit_run(&chain.kit, 600000);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1), 0);
    /* The voltage of XL330 is in its shutdown, that of XL430 is not. */
    grobo_sim_set_supply(&chain.kit.sim, 7400 * 75 / 50);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_ERROR), GROBO_DXL2_VOLTAGE);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_TORQUE), 0);
    chain_start(&chain, model("XL430-W250"), 1, NULL);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_VOLTAGE), 120);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1), 0);
    grobo_sim_set_supply(&chain.kit.sim, 7400 * 150 / 120);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_ERROR), GROBO_DXL2_VOLTAGE);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_TORQUE), 1);
    assert_int_equal(grobo_sim_set_temperature(&chain.kit.sim, 0, 80), 0);
    simkit_run(&chain.kit, 1000);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_TORQUE), 0);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_ERROR),
                     GROBO_DXL2_VOLTAGE | GROBO_DXL2_OVERHEATED);
}

TEST(writes_wait_level_and_names_hold)
{
    chain_start(&chain, model("XL330-M288"), 2, NULL);
    static const uint8_t goal[] = {0x00, 0x0A, 0x00, 0x00};
    chain_send(&chain, 1, GROBO_DXL2_ACTION, 0, 0, NULL, 0);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_BAD_INSTRUCTION);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1), 0);
    chain_send(&chain, 1, GROBO_DXL2_REG_WRITE, 116, 0, goal, sizeof goal);
    assert_int_equal(chain.kit.got[8], 0);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_REGISTERED), 1);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_GOAL), 2048);
    chain_send(&chain, GROBO_DXL2_ID_ALL, GROBO_DXL2_ACTION, 0, 0, NULL, 0);
    assert_int_equal(chain.kit.n_got, 0);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_REGISTERED), 0);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_GOAL), 2560);
    /* Level 1: reads only; 0: pings only. */
    assert_int_equal(chain_write(&chain, 2, GROBO_ROLE_REPLY_LEVEL, 1), -1);
    assert_int_equal(chain_write(&chain, 2, GROBO_ROLE_TORQUE, 1), -1);
    chain_send(&chain, 2, GROBO_DXL2_READ, 64, 1, NULL, 0);
    assert_int_equal(chain.kit.got[9], 1);
    assert_int_equal(chain_write(&chain, 2, GROBO_ROLE_REPLY_LEVEL, 0), -1);
    chain_send(&chain, 2, GROBO_DXL2_READ, 64, 1, NULL, 0);
    assert_int_equal(chain.kit.n_got, 0);
    chain_send(&chain, 2, GROBO_DXL2_PING, 0, 0, NULL, 0);
    assert_int_equal(chain.kit.n_got, 14);
    /* The answer to a new id, and to a new rate, comes the old way. */
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 0), 0);
    chain_send(&chain, 1, GROBO_DXL2_WRITE, 12, 0, (const uint8_t *)"\x32", 1);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_ID, 9), 0);
    assert_int_equal(chain.kit.got[4], 1);
    chain_send(&chain, 9, GROBO_DXL2_PING, 0, 0, NULL, 0);
    assert_int_equal(chain.kit.got[4], 9);
    /* To its second id it says nothing, and keeps its EEPROM as it is. */
    chain_send(&chain, 50, GROBO_DXL2_WRITE, 65, 0, (const uint8_t *)"\x01", 1);
    assert_int_equal(chain.kit.n_got, 0);
    assert_int_equal(simkit_register(&chain.kit, 0, 65), 1);
    chain_send(&chain, 50, GROBO_DXL2_WRITE, 9, 0, (const uint8_t *)"\x07", 1);
    assert_int_equal(chain.kit.n_got, 0);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_RETURN_DELAY), 250);
    chain_send(&chain, 50, GROBO_DXL2_PING, 0, 0, NULL, 0);
    assert_int_equal(chain.kit.n_got, 0);
    chain_send(&chain, 50, GROBO_DXL2_FACTORY_RESET, 0, 0, (const uint8_t *)"\xFF", 1);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_ID), 9);
    assert_int_equal(chain_write(&chain, 9, GROBO_ROLE_BAUD, 1), 0);
    chain_send(&chain, 9, GROBO_DXL2_PING, 0, 0, NULL, 0);
    assert_int_equal(chain.kit.n_got, 0);
    assert_int_equal(grobo_sim_set_line_bps(&chain.kit.sim, 57600), 0);
    chain_send(&chain, 9, GROBO_DXL2_PING, 0, 0, NULL, 0);
    assert_int_equal(chain.kit.n_got, 14);
}

TEST(it_is_as_from_the_factory)
{
    chain_start(&chain, model("XL330-M288"), 1, NULL);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_ID, 9), 0);
    /* All but id and rate from the factory; no such reset is none. */
    assert_int_equal(chain_write(&chain, 9, GROBO_ROLE_RETURN_DELAY, 3), 0);
    chain_send(&chain, 9, GROBO_DXL2_FACTORY_RESET, 0, 0, (const uint8_t *)"\x03", 1);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_BAD_RANGE);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_RETURN_DELAY), 3);
    static const uint8_t but_both = GROBO_DXL2_RESET_BUT_ID_BAUD, all = GROBO_DXL2_RESET_ALL;
    chain_send(&chain, 9, GROBO_DXL2_FACTORY_RESET, 0, 0, &but_both, 1);
    simkit_run(&chain.kit, 600000);
    chain_send(&chain, 9, GROBO_DXL2_PING, 0, 0, NULL, 0);
    assert_int_equal(chain.kit.n_got, 14);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_RETURN_DELAY), 250);
    chain_send(&chain, 9, GROBO_DXL2_FACTORY_RESET, 0, 0, &all, 1);
    simkit_run(&chain.kit, 600000);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_ID), 1);
}

/* The requests are the examples of emanual protocol2, which prints a wrong CRC of the second. */
TEST(its_control_table_is_backed_up)
{
    static const char store[] = "FF FF FD 00 01 08 00 20 01 43 54 52 4C 16 F5";
    static const char restore[] = "FF FF FD 00 01 08 00 20 02 43 54 52 4C 9E F5";
    static const char done[] = "FF FF FD 00 01 04 00 55 00 A1 0C";
    enum { STARTUP = 60, POSITION_P = 84, PROFILE = 108, READY = 147, INDIRECT = 168 };
    chain_start(&chain, model("XC330-T288"), 2, NULL);
    /* Nothing to restore; not while torque is on. */
    simkit_ask(&chain.kit, restore, 50000);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_FAILED);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 1), 0);
    simkit_ask(&chain.kit, store, 50000);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_FAILED);
    assert_int_equal(simkit_register(&chain.kit, 0, READY), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_TORQUE, 0), 0);
    /* EEPROM and gains are stored, and the EEPROM comes back with a restart. */
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_RETURN_DELAY, 7), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_ACCELERATION, 11), 0);
    chain_send(&chain, 1, GROBO_DXL2_WRITE, POSITION_P, 0, (const uint8_t *)"\x09\x01", 2);
    chain_send(&chain, 1, GROBO_DXL2_WRITE, INDIRECT, 0, (const uint8_t *)"\x54\x00", 2);
    simkit_ask(&chain.kit, store, 50000);
    simkit_expect(&chain.kit, done);
    assert_int_equal(simkit_register(&chain.kit, 0, READY), 1);
    assert_int_equal(simkit_register(&chain.kit, 1, READY), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_RETURN_DELAY, 8), 0);
    assert_int_equal(chain_write(&chain, 1, GROBO_ROLE_ACCELERATION, 12), 0);
    simkit_ask(&chain.kit, restore, 50000);
    simkit_expect(&chain.kit, done);
    simkit_run(&chain.kit, 600000);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_RETURN_DELAY), 7);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_ACCELERATION), 0);
    assert_int_equal(simkit_register(&chain.kit, 0, READY), 1);
    /* Registers in RAM come back, and torque is on, where startup says so. */
    chain_send(&chain, 1, GROBO_DXL2_WRITE, STARTUP, 0, (const uint8_t *)"\x03", 1);
    assert_int_equal(chain.kit.got[8], 0);
    chain_send(&chain, 1, GROBO_DXL2_REBOOT, 0, 0, NULL, 0);
    simkit_run(&chain.kit, 600000);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_ACCELERATION), 11);
    assert_int_equal(simkit_register(&chain.kit, 0, POSITION_P), 0x109);
    chain_send(&chain, 1, GROBO_DXL2_READ, INDIRECT, 2, NULL, 0);
    assert_int_equal(chain.kit.got[9], POSITION_P);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_TORQUE), 1);
    assert_int_equal(chain_register(&chain, 0, GROBO_ROLE_GOAL), 2048);
    /* Another code, another key, no such instruction. */
    chain_send(&chain, 2, GROBO_DXL2_BACKUP, 0, 0, (const uint8_t *)"\x03\x43\x54\x52\x4C", 5);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_BAD_RANGE);
    chain_send(&chain, 2, GROBO_DXL2_BACKUP, 0, 0, (const uint8_t *)"\x01\x43\x54\x52\x4D", 5);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_BAD_RANGE);
    chain_start(&chain, model("2XL430-W250"), 1, NULL);
    simkit_ask(&chain.kit, store, 50000);
    assert_int_equal(chain.kit.got[8], GROBO_DXL2_BAD_INSTRUCTION);
}

TEST(a_backup_of_p_has_its_indirect_addresses)
{
    static const uint8_t store[] = {1, 0x43, 0x54, 0x52, 0x4C};
    static const uint8_t restore[] = {2, 0x43, 0x54, 0x52, 0x4C};
    enum { READY = 878, INDIRECT = 168 };
    chain_start(&chain, model("PH54-200-S500-R"), 1, NULL);
    chain_send(&chain, 1, GROBO_DXL2_WRITE, INDIRECT, 0, (const uint8_t *)"\x34\x02", 2);
    chain_send(&chain, 1, GROBO_DXL2_BACKUP, 0, 0, store, sizeof store);
    assert_int_equal(chain.kit.got[8], 0);
    chain_send(&chain, 1, GROBO_DXL2_READ, READY, 1, NULL, 0);
    assert_int_equal(chain.kit.got[9], 1);
    chain_send(&chain, 1, GROBO_DXL2_WRITE, INDIRECT, 0, (const uint8_t *)"\x35\x02", 2);
    assert_int_equal(chain.kit.got[8], 0);
    chain_send(&chain, 1, GROBO_DXL2_BACKUP, 0, 0, restore, sizeof restore);
    simkit_run(&chain.kit, 600000);
    chain_send(&chain, 1, GROBO_DXL2_READ, INDIRECT, 2, NULL, 0);
    assert_int_equal(chain.kit.got[9], 0x34);
}
