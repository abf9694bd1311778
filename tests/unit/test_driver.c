/* SPDX-License-Identifier: MIT */
/* Driver tables: the frames they build, what they read, what is wrong with a table. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/driver.h>
#include <grobo/core/dxl2.h>
#include <grobo/core/feetech.h>
#include <grobo/core/sequencer.h>

#include "tests/support/tables.h"
#include "tests/support/test.h"

static grobo_exchange exchange;

static const grobo_driver *fresh(grobo_wiring wiring)
{
    memset(&exchange, 0, sizeof exchange);
    return grobo_gr001_driver(wiring);
}

static void expect_frame(const char *bytes, size_t size)
{
    assert_int_equal(exchange.frame_bytes, size);
    assert_memory_equal(exchange.frame, bytes, size);
}

static grobo_target zero_target(int64_t time_us)
{
    grobo_target target;
    memset(&target, 0, sizeof target);
    assert_int_equal(grobo_posture_init(&target.posture, 20), 0);
    target.posture.set = GROBO_JOINTS_ALL(20);
    for (int j = 0; j < 20; j++) {
        target.joint_time_us[j] = time_us;
    }
    return target;
}

TEST(check_asks_the_board_or_the_servos)
{
    const grobo_driver *board = fresh(GROBO_WIRING_BOARD);
    assert_int_equal(board->check(board, NULL, 0, &exchange), 1);
    expect_frame("\x41\x00", 2);
    assert_int_equal(exchange.reply.kind, GROBO_REPLY_ACK);
    assert_int_equal(board->check(board, NULL, 1, &exchange), 0);
    const grobo_driver *bus = fresh(GROBO_WIRING_BUS);
    assert_int_equal(bus->check(bus, NULL, 19, &exchange), 1);
    assert_int_equal(exchange.reply.kind, GROBO_REPLY_RETURN);
    assert_int_equal(exchange.reply.id, 8); /* joint 19 is motor 8 */
    assert_int_equal(bus->check(bus, NULL, 20, &exchange), 0);
}

TEST(all_joints_go_in_motor_order)
{
    const grobo_driver *driver = fresh(GROBO_WIRING_BOARD);
    grobo_target target = zero_target(1000000);
    assert_int_equal(driver->posture(driver, NULL, &target, 0, &exchange), 1);
    assert_int_equal(exchange.frame_bytes, 110);
    assert_int_equal(exchange.frame[109], 0x1B); /* protocol 5 */
    assert_int_equal(exchange.reply.kind, GROBO_REPLY_NONE);
    for (int motor = 1; motor <= 20; motor++) {
        assert_int_equal(exchange.frame[5 * (motor - 1) + 9], motor);
    }
    assert_int_equal(driver->posture(driver, NULL, &target, 1, &exchange), 0);
}

TEST(one_joint_goes_in_a_short_packet)
{
    const grobo_driver *driver = fresh(GROBO_WIRING_BOARD);
    grobo_target target = zero_target(100000);
    int joint = grobo_model_joint_of_motor(driver->model, 3);
    target.posture.set = GROBO_JOINT_BIT(joint);
    target.posture.angle_rad[joint] = grobo_rad_from_deg(90);
    assert_int_equal(driver->posture(driver, NULL, &target, 0, &exchange), 1);
    expect_frame("\x53\x0C\xFA\xAF\x03\x00\x1E\x04\x01\x84\x03\x0A\x00\x95", 14);
}

TEST(angles_are_rounded_to_nearest)
{
    const grobo_driver *driver = fresh(GROBO_WIRING_BUS);
    grobo_target target = zero_target(14000);
    target.posture.set = GROBO_JOINT_BIT(2);
    target.posture.angle_rad[2] = 0.34906585; /* 200, not 199 */
    assert_int_equal(driver->posture(driver, NULL, &target, 0, &exchange), 1);
    assert_int_equal(exchange.frame[7] | exchange.frame[8] << 8, 200);
    assert_int_equal(exchange.frame[9] | exchange.frame[10] << 8, 1);
}

TEST(torque_frames_are_those_of_the_board)
{
    const grobo_driver *driver = fresh(GROBO_WIRING_BOARD);
    grobo_joint_mask first = GROBO_JOINT_BIT(grobo_model_joint_of_motor(driver->model, 1));
    assert_int_equal(driver->torque(driver, NULL, first, GROBO_TORQUE_BRAKE, 0, &exchange), 1);
    expect_frame("\x53\x09\xFA\xAF\x01\x00\x24\x01\x01\x02\x27", 11);
    fresh(GROBO_WIRING_BOARD);
    assert_int_equal(
        driver->torque(driver, NULL, GROBO_JOINTS_ALL(20), GROBO_TORQUE_ON, 0, &exchange), 1);
    assert_int_equal(exchange.frame_bytes, 50);
    assert_int_equal(exchange.frame[49], 0x26);
}

TEST(more_joints_than_a_frame_holds_make_more_frames)
{
    static grobo_joint joints[40];
    static const char names[40][4] = {"a0", "a1", "a2", "a3", "a4", "a5", "a6", "a7", "a8", "a9",
                                      "b0", "b1", "b2", "b3", "b4", "b5", "b6", "b7", "b8", "b9",
                                      "c0", "c1", "c2", "c3", "c4", "c5", "c6", "c7", "c8", "c9",
                                      "d0", "d1", "d2", "d3", "d4", "d5", "d6", "d7", "d8", "d9"};
    grobo_model model =
        GROBO_TABLE(grobo_model, .name = "many", GROBO_MODEL_JOINTS(joints), .n_joints = 40);
    static const int frames[2][2] = {{23, 17}, {28, 12}}; /* 127 and 148 bytes of packet */
    for (int j = 0; j < 40; j++) {
        joints[j] = (grobo_joint){.name = names[j],
                                  .min_rad = -1,
                                  .max_rad = 1,
                                  .max_speed_rad_s = 5,
                                  .motor = (uint8_t)(40 - j),
                                  .mirror = (uint8_t)j,
                                  .mirror_sign = 1};
    }
    for (int w = 0; w < 2; w++) {
        grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
        assert_int_equal(
            grobo_rs30x_driver_init(&driver, &model, grobo_wiring_protocol((grobo_wiring)w)), 0);
        assert_int_equal(grobo_driver_check(&driver), 0);
        grobo_target target = zero_target(100000);
        target.posture.set = GROBO_JOINTS_ALL(40);
        for (int part = 0; part < 2; part++) {
            memset(&exchange, 0, sizeof exchange);
            assert_int_equal(driver.posture(&driver, NULL, &target, part, &exchange), 1);
            int head = w == GROBO_WIRING_BOARD ? 2 : 0;
            assert_int_equal(exchange.frame[head + 6], frames[w][part]);
            assert_int_equal(exchange.frame[head + 7], part == 0 ? 1 : frames[w][0] + 1);
        }
        assert_int_equal(driver.posture(&driver, NULL, &target, 2, &exchange), 0);
        assert_true((driver.stored == NULL) == (w == GROBO_WIRING_BUS));
    }
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    assert_int_equal(
        grobo_rs30x_driver_init(&driver, &model, grobo_wiring_protocol((grobo_wiring)2)),
        GROBO_ERR_ARG);
    assert_int_equal(grobo_rs30x_driver_init(&driver, NULL, &grobo_i_rs30x_protocol),
                     GROBO_ERR_ARG);
    assert_null(grobo_gr001_driver((grobo_wiring)2));
}

TEST(senses_ask_for_what_they_say)
{
    static const uint8_t blocks[][2] = {{36, 18}, {42, 2}, {30, 18}, {30, 24}};
    for (int kind = 0; kind < 4; kind++) {
        const grobo_driver *driver = fresh(GROBO_WIRING_BOARD);
        assert_int_equal(driver->sense(driver, NULL, 12, (grobo_sense_kind)kind, &exchange), 0);
        assert_int_equal(exchange.reply.id, 1);
        assert_int_equal(exchange.reply.address, blocks[kind][0]);
        assert_int_equal(exchange.reply.length, blocks[kind][1]);
    }
}

static int parse(const uint8_t *data, size_t n, uint8_t address, grobo_joint_state *got)
{
    const grobo_driver *driver = grobo_gr001_driver(GROBO_WIRING_BOARD);
    const grobo_packet reply = {.kind = GROBO_PACKET_RETURN,
                                .id = 1,
                                .flags = GROBO_RS30X_STATUS_HOT,
                                .address = address,
                                .data = data,
                                .data_bytes = n};
    memset(got, 0, sizeof *got);
    return driver->parse(driver, NULL, 12, &reply, got);
}

TEST(replies_become_readings)
{
    grobo_joint_state got;
    /* No.30-53: goal -1.5, time, torque 1, position 20.0, 0.10 s, -30 deg/s, 120 mA, 41 C, 7.4 V */
    uint8_t all[24] = {0xF1, 0xFF, 0,  0, 0,    77,   1,   0, 0,  0, 0,    0,
                       200,  0,    10, 0, 0xE2, 0xFF, 120, 0, 41, 0, 0xE4, 0x02};
    assert_int_equal(parse(all, 24, 30, &got), 0);
    assert_true(fabs(grobo_deg_from_rad(got.goal_rad) + 1.5) < 1e-9);
    assert_true(fabs(grobo_deg_from_rad(got.angle_rad) - 20) < 1e-9);
    assert_int_equal(got.time_us, 100000);
    assert_int_equal(got.speed_dps, -30);
    assert_int_equal(got.current_ma, 120);
    assert_int_equal(got.temperature_c, 41);
    assert_int_equal(got.voltage_mv, 7400);
    assert_int_equal(got.torque, GROBO_TORQUE_ON);
    assert_int_equal(got.flags, GROBO_RS30X_STATUS_HOT);
    assert_int_equal(got.valid, 0xFF);
    assert_int_equal(parse(all + 12, 2, 42, &got), 0);
    assert_int_equal(got.valid, GROBO_FIELD_ANGLE);
    assert_int_equal(parse(all + 6, 18, 36, &got), 0);
    assert_int_equal(got.valid, 0x7F);
}

TEST(what_no_servo_says_is_not_believed)
{
    grobo_joint_state got;
    static const struct {
        int at;
        uint8_t low, high;
    } wrong[] = {{6, 3, 0}, {12, 0x09, 0x07}, {18, 0x11, 0x27}, {20, 0x97, 0}, {22, 0xD1, 0x07}};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        uint8_t all[24] = {0};
        all[wrong[i].at] = wrong[i].low;
        all[wrong[i].at + 1] = wrong[i].high;
        assert_int_equal(parse(all, 24, 30, &got), GROBO_ERR_MISMATCH);
    }
}

/* A joint of servos that are registers. */
typedef struct table_row {
    int (*init)(grobo_driver *driver, const grobo_model *model);
    uint16_t servo;
    grobo_register_role role;
    int32_t good, bad; /* the values next to each other that are believed, and not */
} table_row;

static int read_as(const table_row *row, int32_t value)
{
    const grobo_joint joint = {.name = "a",
                               .min_rad = -1,
                               .max_rad = 1,
                               .max_speed_rad_s = 2,
                               .servo_model = row->servo,
                               .motor = 1,
                               .mirror_sign = 1};
    const grobo_model model =
        GROBO_TABLE(grobo_model, .name = "t", GROBO_MODEL_JOINTS(&joint), .n_joints = 1);
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    grobo_joint_state got = {0};
    uint8_t bytes[256] = {0};
    assert_int_equal(row->init(&driver, &model), GROBO_OK);
    assert_true(driver.sense(&driver, NULL, 0, GROBO_SENSE_FULL, &exchange) >= 0);
    const grobo_servo_model *servo =
        row->init == grobo_dxl2_driver_init
            ? grobo_servo_model_numbered(&grobo_i_dxl2_table, row->servo)
            : grobo_servo_model_numbered(&grobo_i_sts_table, row->servo);
    const grobo_servo_register *reg = grobo_servo_register_of(servo, row->role);
    const grobo_servo_register *position = grobo_servo_register_of(servo, GROBO_ROLE_POSITION);
    const grobo_reply *asked = &exchange.reply;
    bytes[position->address + 1] = 8; /* the middle */
    for (int i = 0; i < reg->bytes; i++) {
        bytes[reg->address + i] = (uint8_t)((uint32_t)value >> 8 * i);
    }
    const grobo_packet reply = {.kind = GROBO_PACKET_RETURN,
                                .id = 1,
                                .address = asked->address,
                                .data = bytes + asked->address,
                                .data_bytes = asked->length};
    return driver.parse(&driver, NULL, 0, &reply, &got);
}

TEST(nor_what_no_servo_of_registers_says)
{
    static const table_row rows[] = {
        {grobo_dxl2_driver_init, 1200, GROBO_ROLE_PRESENT_SPEED, 32767, 32768},
        {grobo_dxl2_driver_init, 1200, GROBO_ROLE_PRESENT_SPEED, -32767, -32768},
        {grobo_dxl2_driver_init, 1200, GROBO_ROLE_PRESENT_SPEED, 0, INT32_MIN},
        {grobo_dxl2_driver_init, 1200, GROBO_ROLE_POSITION, 4351, 4352},
        {grobo_dxl2_driver_init, 1200, GROBO_ROLE_POSITION, -256, -257},
        {grobo_dxl2_driver_init, 1200, GROBO_ROLE_VOLTAGE, 300, 301},
        {grobo_dxl2_driver_init, 1200, GROBO_ROLE_TEMPERATURE, 120, 121},
        {grobo_dxl2_driver_init, 1200, GROBO_ROLE_TORQUE, 1, 3},
        {grobo_feetech_driver_init, 777, GROBO_ROLE_TEMPERATURE, 120, 121},
        {grobo_feetech_driver_init, 777, GROBO_ROLE_TORQUE, 2, 128},
        {grobo_feetech_driver_init, 777, GROBO_ROLE_ERROR, 0, 32}, /* the status told of none */
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        assert_int_equal(read_as(&rows[i], rows[i].good), GROBO_OK);
        assert_int_equal(read_as(&rows[i], rows[i].bad), GROBO_ERR_MISMATCH);
    }
}

TEST(bad_tables_are_refused)
{
    static const grobo_readback nowhere[] = {{0.1, 20}};
    static const double rest_outside[20] = {[3] = 1.0};
    static grobo_protocol others;
    grobo_driver bad[13];
    for (int i = 0; i < 13; i++) {
        bad[i] = *grobo_gr001_driver(GROBO_WIRING_BOARD);
        assert_int_equal(grobo_driver_check(&bad[i]), 0);
    }
    bad[0].name = NULL;
    bad[1].posture = NULL;
    bad[2].time_step_us = 0;
    bad[3].limits.approach_rad_s = 0;
    bad[4].on_exit = GROBO_EXIT_DEFAULT;
    bad[5].readback = nowhere;
    bad[5].n_readback = 1;
    bad[6].rest_rad = rest_outside;
    bad[7].protocol = NULL;
    bad[8].model = NULL;
    others = grobo_i_rs30x_protocol; /* whose ids end at 19: one is outside */
    others.id_max = 19;
    bad[9].protocol = &others;
    bad[10].time_max_us = GROBO_PLAY_TIME_MAX_US + 1;
    bad[11].accel_rad_s2 = INFINITY;
    bad[12].accel_rad_s2 = -1;
    for (int i = 0; i < 13; i++) {
        assert_int_equal(grobo_driver_check(&bad[i]), GROBO_ERR_ARG);
    }
    assert_int_equal(grobo_driver_check(NULL), GROBO_ERR_ARG);
}

TEST(raw_frames_are_read)
{
    const grobo_driver *driver = fresh(GROBO_WIRING_BOARD);
    grobo_target target = zero_target(0);
    grobo_joint_mask torqued[3] = {0};
    grobo_target moved = zero_target(500000);
    moved.posture.angle_rad[5] = grobo_rad_from_deg(12.3);
    assert_int_equal(driver->posture(driver, NULL, &moved, 0, &exchange), 1);
    target.posture.set = 0;
    assert_int_equal(
        driver->inspect(driver, NULL, exchange.frame, exchange.frame_bytes, &target, torqued), 0);
    assert_true(target.posture.set == GROBO_JOINTS_ALL(20) && torqued[1] == 0);
    assert_true(fabs(grobo_deg_from_rad(target.posture.angle_rad[5]) - 12.3) < 1e-9);
    assert_int_equal(target.joint_time_us[5], 500000);
    /* Torque of all by the address of all. */
    target.posture.set = 0;
    assert_int_equal(
        driver->inspect(driver, NULL,
                        (const uint8_t *)"\x53\x09\xFA\xAF\xFF\x00\x24\x01\x01\x01\xDA", 11,
                        &target, torqued),
        0);
    assert_true(torqued[1] == GROBO_JOINTS_ALL(20) && target.posture.set == 0);
}
