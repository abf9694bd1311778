/* SPDX-License-Identifier: MIT */
/* Builders of servo packets, and what a command is answered by. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/rs30x.h>

#include "tests/support/tables.h"
#include "tests/support/test.h"
#include "tests/support/vectors.h"

enum { MAX = GROBO_RS30X_PACKET_MAX_BYTES };

TEST(reads_are_those_of_the_manual)
{
    uint8_t b[MAX];
    vector_expect(grobo_rs30x_read(1, 42, 2, b, MAX), b, "FA AF 01 0F 2A 02 00 26");
    vector_expect(grobo_rs30x_read(1, 42, 18, b, MAX), b, "FA AF 01 0F 2A 12 00 36");
    vector_expect(grobo_rs30x_read(1, 36, 18, b, MAX), b, "FA AF 01 0F 24 12 00 38");
    vector_expect(grobo_rs30x_read(1, 48, 2, b, MAX), b, "FA AF 01 0F 30 02 00 3C");
    vector_expect(grobo_rs30x_read_block(1, GROBO_RS30X_WANT_0_29, b, MAX), b,
                  "FA AF 01 03 00 00 01 03");
    vector_expect(grobo_rs30x_read_block(5, GROBO_RS30X_WANT_42_59, b, MAX), b,
                  "FA AF 05 09 00 00 01 0D");
    vector_expect(grobo_rs30x_read_block(1, GROBO_RS30X_WANT_30_41, b, MAX), b,
                  "FA AF 01 0B 00 00 01 0B");
}

TEST(writes_are_those_of_the_manual)
{
    uint8_t b[MAX];
    vector_expect(grobo_rs30x_write_u8(1, 0, GROBO_RS30X_ID, 5, b, MAX), b,
                  "FA AF 01 00 04 01 01 05 00");
    vector_expect(grobo_rs30x_write_u8(1, 0x60, GROBO_RS30X_BAUD, 4, b, MAX), b,
                  "FA AF 01 60 06 01 01 04 63");
    vector_expect(grobo_rs30x_write_u8(1, 0x60, GROBO_RS30X_DELAY, 18, b, MAX), b,
                  "FA AF 01 60 07 01 01 12 74");
    vector_expect(grobo_rs30x_write_u8(1, 9, GROBO_RS30X_TORQUE, 1, b, MAX), b,
                  "FA AF 01 09 24 01 01 01 2D");
    vector_expect(grobo_rs30x_write_u16(1, 0, GROBO_RS30X_CW_LIMIT, 1000, b, MAX), b,
                  "FA AF 01 00 08 02 01 E8 03 E1");
    vector_expect(grobo_rs30x_write_u16(1, 0, GROBO_RS30X_CCW_LIMIT, (uint16_t)-1000, b, MAX), b,
                  "FA AF 01 00 0A 02 01 18 FC EC");
    vector_expect(grobo_rs30x_write_u16(255, 0, GROBO_RS30X_GOAL, 0, b, MAX), b,
                  "FA AF FF 00 1E 02 01 00 00 E2");
    const grobo_rs30x_goal slow = {1, -1200, 1000};
    vector_expect(grobo_rs30x_write_goal(&slow, b, MAX), b, "FA AF 01 00 1E 04 01 50 FB E8 03 5A");
    const grobo_rs30x_goal goals[] = {{1, 100, 100}, {2, -100, 100}, {5, 500, 100}};
    vector_expect(grobo_rs30x_write_goals(goals, 3, b, MAX), b,
                  "FA AF 00 00 1E 05 03 01 64 00 64 00 02 9C FF 64 00 05 F4 01 64 00 88");
    const grobo_rs30x_byte torques[] = {{1, 1}, {2, 1}, {5, 1}};
    vector_expect(grobo_rs30x_write_bytes(GROBO_RS30X_TORQUE, torques, 3, b, MAX), b,
                  "FA AF 00 00 24 02 03 01 01 02 01 05 01 22");
}

TEST(special_commands_are_those_of_the_manuals)
{
    uint8_t b[MAX];
    vector_expect(grobo_rs30x_control(1, GROBO_RS30X_FLASH | GROBO_RS30X_REBOOT, b, MAX), b,
                  "FA AF 01 60 FF 00 00 9E");
    vector_expect(grobo_rs30x_control(2, GROBO_RS30X_FLASH, b, MAX), b, "FA AF 02 40 FF 00 00 BD");
    vector_expect(grobo_rs30x_control(1, GROBO_RS30X_REBOOT, b, MAX), b, "FA AF 01 20 FF 00 00 DE");
    vector_expect(grobo_rs30x_factory_reset(1, GROBO_RS30X_RESET_WITH_DATA, b, MAX), b,
                  "FA AF 01 10 FF FF 00 FF EE");
    vector_expect(grobo_rs30x_factory_reset(3, GROBO_RS30X_RESET_BARE, b, MAX), b,
                  "FA AF 03 10 FF FF 00 13");
    vector_expect(grobo_rs30x_ping(1, GROBO_RS30X_PING_FF_1_0, b, MAX), b,
                  "FA AF 01 01 FF 01 00 FE");
    vector_expect(grobo_rs30x_ping(1, GROBO_RS30X_PING_FF_0_0, b, MAX), b,
                  "FA AF 01 01 FF 00 00 FF");
    vector_expect(grobo_rs30x_ping(1, GROBO_RS30X_PING_0_0_0, b, MAX), b,
                  "FA AF 01 01 00 00 00 00");
}

TEST(returns_and_acks_are_built_for_the_other_end)
{
    static const uint8_t data[] = {0x28, 0xFF, 0x00, 0x00, 0x3E, 0x00, 0x0C, 0x00};
    uint8_t b[MAX];
    grobo_rs30x_packet p = {GROBO_RS30X_RETURN, 1, 0, 42, sizeof data, 1, data, sizeof data};
    vector_expect(grobo_rs30x_build(&p, b, MAX), b,
                  "FD DF 01 00 2A 08 01 28 FF 00 00 3E 00 0C 00 C7");
    p.kind = GROBO_RS30X_ACK_BYTE;
    vector_expect(grobo_rs30x_build(&p, b, MAX), b, "07");
    assert_int_equal(grobo_rs30x_build(&p, b, 0), GROBO_ERR_SPACE);
    p.kind = GROBO_RS30X_NACK_BYTE;
    vector_expect(grobo_rs30x_build(&p, b, MAX), b, "08");
}

TEST(builders_refuse_what_is_out_of_range)
{
    uint8_t b[MAX];
    const grobo_rs30x_goal far = {1, 1501, 0};
    const grobo_rs30x_goal slow = {1, 0, 16384};
    const grobo_rs30x_goal nobody[] = {{1, 0, 0}, {0, 0, 0}};
    const grobo_rs30x_byte all = {255, 1};
    const grobo_rs30x_goal many[29] = {{1, 0, 0}};
    assert_int_equal(grobo_rs30x_write_goal(&far, b, MAX), GROBO_ERR_LIMIT);
    assert_int_equal(grobo_rs30x_write_goal(&slow, b, MAX), GROBO_ERR_LIMIT);
    assert_int_equal(grobo_rs30x_write_goals(&far, 1, b, MAX), GROBO_ERR_LIMIT);
    assert_int_equal(grobo_rs30x_write_goals(nobody, 2, b, MAX), GROBO_ERR_ARG);
    assert_int_equal(grobo_rs30x_write_goals(nobody, 0, b, MAX), GROBO_ERR_ARG);
    assert_int_equal(grobo_rs30x_write_goals(many, 29, b, MAX), GROBO_ERR_CAP);
    assert_int_equal(grobo_rs30x_write_bytes(36, &all, 1, b, MAX), GROBO_ERR_ARG);
    assert_int_equal(grobo_rs30x_write_bytes(140, &all, 1, b, MAX), GROBO_ERR_ARG);
    assert_int_equal(grobo_rs30x_read(0, 42, 2, b, MAX), GROBO_ERR_ARG);
    assert_int_equal(grobo_rs30x_read(128, 42, 2, b, MAX), GROBO_ERR_ARG);
    assert_int_equal(grobo_rs30x_read(1, 42, 0, b, MAX), GROBO_ERR_ARG);
    assert_int_equal(grobo_rs30x_read(1, 139, 2, b, MAX), GROBO_ERR_ARG);
    assert_int_equal(grobo_rs30x_read_block(1, GROBO_RS30X_WANT_ACK, b, MAX), GROBO_ERR_ARG);
    assert_int_equal(grobo_rs30x_read_block(1, GROBO_RS30X_WANT_GIVEN, b, MAX), GROBO_ERR_ARG);
    assert_int_equal(grobo_rs30x_control(1, 0, b, MAX), GROBO_ERR_ARG);
    assert_int_equal(grobo_rs30x_control(1, 0x10, b, MAX), GROBO_ERR_ARG);
    assert_int_equal(grobo_rs30x_write_u8(1, 0, 140, 0, b, MAX), GROBO_ERR_ARG);
    assert_int_equal(grobo_rs30x_write_u16(1, 0, 139, 0, b, MAX), GROBO_ERR_ARG);
}

TEST(builders_refuse_fields_that_contradict_each_other)
{
    static const uint8_t data[MAX];
    uint8_t b[MAX];
    const grobo_rs30x_packet bad[] = {
        {GROBO_RS30X_SHORT, 0, 0, 30, 2, 1, data, 2},      /* id of a long packet */
        {GROBO_RS30X_LONG, 1, 0, 30, 2, 1, data, 2},       /* id of a short one */
        {GROBO_RS30X_LONG, 0, 1, 30, 2, 1, data, 2},       /* flags in a long packet */
        {GROBO_RS30X_LONG, 0, 0, 30, 3, 2, data, 5},       /* half an entry */
        {GROBO_RS30X_SHORT, 1, 0, 30, 2, 1, data, 3},      /* more data than announced */
        {GROBO_RS30X_SHORT, 1, 0, 30, 2, 0, data, 2},      /* count says there is none */
        {GROBO_RS30X_SHORT, 1, 0x10, 255, 255, 0, data, 1} /* a reset's data byte is FF */
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(grobo_rs30x_build(&bad[i], b, MAX), GROBO_ERR_ARG);
    }
    const grobo_rs30x_packet huge = {GROBO_RS30X_LONG, 0, 0, 30, 3, 47, data, 141};
    assert_int_equal(grobo_rs30x_build(&huge, b, MAX), GROBO_ERR_CAP);
}

/* The buffer ends where cap says: the byte behind it stays as it was. */
TEST(builders_never_write_past_the_capacity)
{
    const grobo_rs30x_goal goals[] = {{1, 100, 100}, {2, -100, 100}};
    for (size_t cap = 0; cap <= 20; cap++) {
        uint8_t b[MAX];
        memset(b, 0xEE, sizeof b);
        int n = grobo_rs30x_write_goals(goals, 2, b, cap);
        assert_int_equal(n, cap >= 18 ? 18 : GROBO_ERR_SPACE);
        assert_int_equal(b[cap >= 18 ? 18 : cap], 0xEE);
        memset(b, 0xEE, sizeof b);
        n = grobo_rs30x_read(1, 42, 2, b, cap);
        assert_int_equal(n, cap >= 8 ? 8 : GROBO_ERR_SPACE);
        assert_int_equal(b[cap >= 8 ? 8 : cap], 0xEE);
    }
}

TEST(every_want_has_the_reply_of_the_table)
{
    static const struct {
        uint8_t nibble, address, length;
        int bytes;
    } rows[] = {{0x3, 0, 30, 38},  {0x5, 30, 30, 38}, {0x7, 20, 10, 18},
                {0x9, 42, 18, 26}, {0xB, 30, 12, 20}, {0xD, 60, 68, 76}};
    uint8_t b[MAX];
    grobo_reply r;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        int n = grobo_rs30x_read_block(7, (grobo_rs30x_want)rows[i].nibble, b, MAX);
        assert_int_equal(grobo_rs30x_reply_to(b, (size_t)n, &r), rows[i].bytes);
        assert_int_equal(r.kind, GROBO_REPLY_RETURN);
        assert_int_equal(r.id, 7);
        assert_int_equal(r.address, rows[i].address);
        assert_int_equal(r.length, rows[i].length);
        assert_int_equal(r.bytes, rows[i].bytes);
    }
    int n = grobo_rs30x_write_u8(7, 1, 36, 1, b, MAX);
    assert_int_equal(grobo_rs30x_reply_to(b, (size_t)n, &r), 1);
    assert_int_equal(r.kind, GROBO_REPLY_ACK);
    n = grobo_rs30x_read(7, 36, 18, b, MAX);
    assert_int_equal(grobo_rs30x_reply_to(b, (size_t)n, &r), 26);
    n = grobo_rs30x_write_u8(7, 0, 36, 1, b, MAX);
    assert_int_equal(grobo_rs30x_reply_to(b, (size_t)n, &r), 0);
    n = grobo_rs30x_write_u8(255, 1, 36, 1, b, MAX);
    assert_int_equal(grobo_rs30x_reply_to(b, (size_t)n, &r), 0);
    assert_int_equal(r.kind, GROBO_REPLY_NONE);
}

TEST(no_reply_is_promised_for_broken_commands)
{
    uint8_t b[MAX];
    grobo_reply r = {.kind = GROBO_REPLY_ACK, .id = 9};
    size_t n = (size_t)grobo_rs30x_read(7, 36, 18, b, MAX);
    for (size_t cut = 0; cut < n; cut++) {
        assert_int_equal(grobo_rs30x_reply_to(b, cut, &r), GROBO_ERR_FRAME);
    }
    b[n] = 0;
    assert_int_equal(grobo_rs30x_reply_to(b, n + 1, &r), GROBO_ERR_FRAME);
    b[n - 1] ^= 1;
    assert_int_equal(grobo_rs30x_reply_to(b, n, &r), GROBO_ERR_CHECKSUM);
    n = (size_t)grobo_rs30x_write_u8(7, 2, 36, 1, b, MAX); /* flags 2 mean nothing */
    assert_int_equal(grobo_rs30x_reply_to(b, n, &r), GROBO_ERR_ARG);
    assert_int_equal(r.kind, GROBO_REPLY_ACK);
    assert_int_equal(r.id, 9);
}

/* The codec's addresses are those of the table. */
TEST(registers_stand_where_the_codec_has_them)
{
    static const struct {
        const char *name;
        int address;
    } rows[] = {{"model", GROBO_RS30X_MODEL},
                {"id", GROBO_RS30X_ID},
                {"baud", GROBO_RS30X_BAUD},
                {"cw_limit", GROBO_RS30X_CW_LIMIT},
                {"temperature_limit", GROBO_RS30X_TEMPERATURE_LIMIT},
                {"warm_up_time", GROBO_RS30X_WARM_UP_TIME},
                {"ccw_slope", GROBO_RS30X_CCW_SLOPE},
                {"goal", GROBO_RS30X_GOAL},
                {"goal_time", GROBO_RS30X_GOAL_TIME},
                {"max_torque", GROBO_RS30X_MAX_TORQUE},
                {"torque", GROBO_RS30X_TORQUE},
                {"position", GROBO_RS30X_POSITION},
                {"voltage", GROBO_RS30X_VOLTAGE}};
    const grobo_servo_model *early = grobo_servo_model_named(&grobo_i_rs30x_table, "RS301CR");
    const grobo_servo_model *late = grobo_servo_model_numbered(&grobo_i_rs30x_table, 0x3040);
    assert_string_equal(late->name, "RS304MD");
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        assert_int_equal(grobo_servo_register_named(late, rows[i].name)->address, rows[i].address);
    }
    assert_null(grobo_servo_register_named(early, "warm_up_time"));
    assert_null(grobo_servo_register_at(late, 3));
    assert_null(grobo_servo_register_at(late, 139));
    assert_null(grobo_servo_model_numbered(&grobo_i_rs30x_table, 0x3011));
    assert_int_equal(grobo_servo_register_named(early, "punch")->factory, 180);
    assert_int_equal(grobo_servo_register_named(late, "punch")->factory, 200);
    assert_int_equal(grobo_servo_baud_bps(late, GROBO_RS30X_BAUD_CODE_DEFAULT), 115200);
    assert_int_equal(GROBO_RS30X_DELAY_US(18), 1000);
}

TEST(states_are_taken_out_of_any_block)
{
    uint8_t b[MAX];
    grobo_rs30x_state s;
    /* The manual's return packet: -16.4 deg, 5.67 s, 7 mA; here with more of it filled in. */
    int n = vector_from_hex("5C FF 37 02 C4 FF 07 00 2D 00 E4 02 00 00 00 00 00 00", b, MAX);
    assert_int_equal(grobo_rs30x_state_decode(42, b, (size_t)n, &s), 6);
    assert_int_equal(s.has, 0x7E);
    assert_int_equal(s.pos_ddeg, -164);
    assert_int_equal(s.time_cs, 567);
    assert_int_equal(s.speed_dps, -60);
    assert_int_equal(s.current_ma, 7);
    assert_int_equal(s.temperature_c, 45);
    assert_int_equal(s.voltage_mv, 7400);
    assert_int_equal(s.torque, 0);
    static const uint8_t block36[18] = {2, 0, 0, 0, 0, 0, 0x84, 0x03, 0, 0, 0, 0, 0, 0, 0xF6, 0xFF};
    assert_int_equal(grobo_rs30x_state_decode(36, block36, 18, &s), 7);
    assert_int_equal(s.torque, GROBO_TORQUE_BRAKE);
    assert_int_equal(s.pos_ddeg, 900);
    assert_int_equal(s.temperature_c, -10);
    assert_int_equal(grobo_rs30x_state_decode(36, block36, 7, &s), 1); /* half a position */
    assert_int_equal(s.has, GROBO_RS30X_HAS_TORQUE);
    assert_int_equal(s.pos_ddeg, 0);
    assert_int_equal(grobo_rs30x_state_decode(43, block36, 2, &s), 0);
    assert_int_equal(grobo_rs30x_state_decode(44, block36, 2, &s), 1);
    assert_int_equal(s.has, GROBO_RS30X_HAS_TIME);
    assert_int_equal(grobo_rs30x_state_decode(42, block36, 0, &s), 0);
}
