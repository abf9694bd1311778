/* SPDX-License-Identifier: MIT */
/* Made from src/servo/models/dxl1 by `make servos`: registers and models. */
#include <grobo/core/dxl1.h>

#include "src/servo/row.h"
#include "src/servo/tables.h"

static const grobo_servo_register rows[] = {
    ROW("model", 0, 2, 0, E, MODEL, "", 0, 65535, 0, 0),
    ROW("firmware", 2, 1, 0, E, FIRMWARE, "", 0, 255, 0, 0),
    ROW("id", 3, 1, 0, EW, ID, "", 0, 253, 1, 0),
    ROW("baud", 4, 1, 0, EW, BAUD, "code", 0, 254, 1, 1),
    ROW("baud", 4, 1, 0, EW, BAUD, "code", 0, 254, 34, 2),
    ROW("return_delay", 5, 1, 0, EW, RETURN_DELAY, "2 us", 0, 254, 250, 0),
    ROW("min_position", 6, 2, 0, EW, MIN_POSITION, "0.29 deg", 0, 1023, 0, 3),
    ROW("min_position", 6, 2, 0, EW, MIN_POSITION, "0.088 deg", 0, 4095, 0, 4),
    ROW("min_position", 6, 2, 0, EW, MIN_POSITION, "", 0, 4095, 0, 5),
    ROW("max_position", 8, 2, 0, EW, MAX_POSITION, "0.29 deg", 0, 1023, 1023, 3),
    ROW("max_position", 8, 2, 0, EW, MAX_POSITION, "0.088 deg", 0, 4095, 4095, 4),
    ROW("max_position", 8, 2, 0, EW, MAX_POSITION, "", 0, 4095, 4095, 5),
    ROW("drive_mode", 10, 1, 0, EW, DIRECTION, "bits", 0, 3, 0, 6),
    ROW("temperature_limit", 11, 1, 0, EW, TEMPERATURE_LIMIT, "deg C", 0, 99, 70, 7),
    ROW("temperature_limit", 11, 1, 0, EW, TEMPERATURE_LIMIT, "deg C", 0, 99, 75, 8),
    ROW("temperature_limit", 11, 1, 0, EW, TEMPERATURE_LIMIT, "deg C", 0, 99, 80, 9),
    ROW("min_voltage", 12, 1, 0, EW, MIN_VOLTAGE, "0.1 V", 50, 250, 60, 0),
    ROW("max_voltage", 13, 1, 0, EW, MAX_VOLTAGE, "0.1 V", 50, 250, 140, 10),
    ROW("max_voltage", 13, 1, 0, EW, MAX_VOLTAGE, "0.1 V", 50, 250, 160, 11),
    ROW("max_voltage", 13, 1, 0, EW, MAX_VOLTAGE, "0.1 V", 50, 250, 240, 12),
    ROW("max_voltage", 13, 1, 0, EW, MAX_VOLTAGE, "0.1 V", 50, 250, 190, 13),
    ROW("max_torque", 14, 2, 0, EW, MAX_TORQUE, "0.1 %", 0, 1023, 1023, 14),
    ROW("max_torque", 14, 2, 0, EW, MAX_TORQUE, "0.1 %", 0, 1023, 983, 8),
    ROW("reply_level", 16, 1, 0, EW, REPLY_LEVEL, "", 0, 2, 2, 0),
    ROW("alarm_led", 17, 1, 0, EW, NONE, "bits", 0, 127, 36, 0),
    ROW("shutdown", 18, 1, 0, EW, SHUTDOWN, "bits", 0, 127, 36, 0),
    ROW("offset", 20, 2, 1, EW, OFFSET, "0.088 deg", -24576, 24576, 0, 4),
    ROW("resolution_divider", 22, 1, 0, EW, NONE, "", 1, 4, 1, 4),
    ROW("torque", 24, 1, 0, W, TORQUE, "", 0, 1, 0, 0),
    ROW("led", 25, 1, 0, W, NONE, "", 0, 1, 0, 0),
    ROW("cw_margin", 26, 1, 0, W, NONE, "0.29 deg", 0, 255, 1, 15),
    ROW("position_d", 26, 1, 0, W, NONE, "", 0, 254, 0, 16),
    ROW("cw_margin", 26, 1, 0, W, NONE, "0.29 deg", 0, 255, 4, 17),
    ROW("position_d", 26, 1, 0, W, NONE, "", 0, 254, 8, 18),
    ROW("ccw_margin", 27, 1, 0, W, NONE, "0.29 deg", 0, 255, 1, 15),
    ROW("position_i", 27, 1, 0, W, NONE, "", 0, 254, 0, 4),
    ROW("ccw_margin", 27, 1, 0, W, NONE, "0.29 deg", 0, 255, 4, 17),
    ROW("cw_slope", 28, 1, 0, W, NONE, "", 0, 254, 32, 15),
    ROW("position_p", 28, 1, 0, W, NONE, "", 0, 254, 32, 16),
    ROW("cw_slope", 28, 1, 0, W, NONE, "", 0, 254, 64, 17),
    ROW("position_p", 28, 1, 0, W, NONE, "", 0, 254, 8, 18),
    ROW("ccw_slope", 29, 1, 0, W, NONE, "", 0, 254, 32, 15),
    ROW("ccw_slope", 29, 1, 0, W, NONE, "", 0, 254, 64, 17),
    ROW("goal_position", 30, 2, 0, W, GOAL, "0.29 deg", 0, 1023, 0, 3),
    ROW("goal_position", 30, 2, 1, W, GOAL, "0.088 deg", -28672, 28672, 0, 4),
    ROW("goal_position", 30, 2, 1, W, GOAL, "", -28672, 28672, 0, 5),
    ROW("moving_speed", 32, 2, 0, W, SPEED, "0.111 rpm", 0, 2047, 0, 3),
    ROW("moving_speed", 32, 2, 0, W, SPEED, "0.114 rpm", 0, 2047, 0, 16),
    ROW("moving_speed", 32, 2, 0, W, SPEED, "0.916 rpm", 0, 2047, 0, 18),
    ROW("moving_speed", 32, 2, 0, W, SPEED, "", 0, 2047, 0, 5),
    ROW("torque_limit", 34, 2, 0, W, TORQUE_LIMIT, "0.1 %", 0, 1023, 0, 0),
    ROW("present_position", 36, 2, 0, R, POSITION, "0.29 deg", 0, 1023, 0, 3),
    ROW("present_position", 36, 2, 1, R, POSITION, "0.088 deg", -32768, 32767, 0, 4),
    ROW("present_position", 36, 2, 1, R, POSITION, "", -32768, 32767, 0, 5),
    ROW("present_speed", 38, 2, 10, R, PRESENT_SPEED, "0.111 rpm", -1023, 1023, 0, 3),
    ROW("present_speed", 38, 2, 10, R, PRESENT_SPEED, "0.114 rpm", -1023, 1023, 0, 16),
    ROW("present_speed", 38, 2, 10, R, PRESENT_SPEED, "0.916 rpm", -1023, 1023, 0, 18),
    ROW("present_speed", 38, 2, 10, R, PRESENT_SPEED, "", -1023, 1023, 0, 5),
    ROW("present_load", 40, 2, 10, R, LOAD, "0.1 %", -1023, 1023, 0, 0),
    ROW("voltage", 42, 1, 0, R, VOLTAGE, "0.1 V", 0, 255, 0, 0),
    ROW("temperature", 43, 1, 0, R, TEMPERATURE, "deg C", 0, 255, 0, 0),
    ROW("registered", 44, 1, 0, R, REGISTERED, "", 0, 1, 0, 0),
    ROW("moving", 46, 1, 0, R, MOVING, "", 0, 1, 0, 0),
    ROW("lock", 47, 1, 0, W, LOCK, "", 0, 1, 0, 0),
    ROW("punch", 48, 2, 0, W, NONE, "0.1 %", 0, 1023, 32, 19),
    ROW("punch", 48, 2, 0, W, NONE, "0.1 %", 0, 1023, 0, 20),
    ROW("tick", 50, 2, 0, R, NONE, "1 ms", 0, 32767, 0, 4),
    ROW("current", 68, 2, 0, R, CURRENT, "4.5 mA", 0, 4095, 2048, 21),
    ROW("torque_control", 70, 1, 0, W, MODE, "", 0, 1, 0, 21),
    ROW("goal_torque", 71, 2, 10, W, GOAL_CURRENT, "4.5 mA", -1023, 1023, 0, 21),
    ROW("goal_acceleration", 73, 1, 0, W, ACCELERATION, "8.583 deg/s2", 0, 254, 0, 4),
};

static const grobo_servo_model models[] = {
    {"AX-12A", 12, 1023, 300, 512, 354, 1500, 1500, 12000, 24, 0, &grobo_i_dxl1_table, NULL, 0, 0},
    {"AX-18A", 18, 1023, 300, 512, 582, 1800, 2200, 12000, 24, 0, &grobo_i_dxl1_table, NULL, 0, 0},
    {"MX-28", 29, 4096, 360, 2048, 330, 2500, 1400, 12000, 24, 0, &grobo_i_dxl1_table, NULL, 0, 0},
    {"MX-64", 310, 4096, 360, 2048, 378, 6000, 4100, 12000, 24, 0, &grobo_i_dxl1_table, NULL, 0, 0},
    {"MX-106", 320, 4096, 360, 2048, 270, 8400, 5200, 12000, 24, 0, &grobo_i_dxl1_table, NULL, 0,
     0},
    {"AX-12W", 300, 1023, 300, 512, 324, 200, 1400, 12000, 24, GROBO_MODEL_UNVERIFIED,
     &grobo_i_dxl1_table, NULL, 0, 0},
    {"RX-24F", 24, 1023, 300, 512, 756, 2600, 2400, 12000, 24, 0, &grobo_i_dxl1_table, NULL, 0, 0},
    {"RX-28", 28, 1023, 300, 512, 510, 3700, 1900, 18500, 24, 0, &grobo_i_dxl1_table, NULL, 0, 0},
    {"RX-64", 64, 1023, 300, 512, 384, 5300, 2600, 18500, 24, 0, &grobo_i_dxl1_table, NULL, 0, 0},
    {"MX-12W", 104, 4096, 360, 2048, 2820, 200, 1400, 12000, 24, GROBO_MODEL_UNVERIFIED,
     &grobo_i_dxl1_table, NULL, 0, 0},
    {"AX-MX-ANY", 0, 4096, 360, 2048, 1, 1, 1, 12000, 24, GROBO_MODEL_NO_JOINT, &grobo_i_dxl1_table,
     NULL, 0, 0},
};

static const grobo_servo_rate rates[] = {
    {1, 0, 1000000}, {3, 0, 500000},     {4, 0, 400000},     {7, 0, 250000},
    {9, 0, 200000},  {16, 0, 115200},    {34, 0, 57600},     {103, 0, 19200},
    {207, 0, 9600},  {250, 22, 2250000}, {251, 22, 2500000}, {252, 22, 3000000},
};

static const uint64_t sets[] = {
    0x7FF, 0x223, 0x5DC, 0x1E3, 0x21C, 0x400, 0x10,  0x21,  0x2,   0x7DC, 0x423, 0x214,
    0x8,   0x1C0, 0x7FD, 0x1C3, 0x1C,  0x20,  0x200, 0x3E3, 0x41C, 0x18,  0x61C,
};

const grobo_servo_table grobo_i_dxl1_table = {
    .name = "DYNAMIXEL AX, MX",
    LIST(registers, register_count, rows),
    LIST(models, model_count, models),
    LIST(rates, rate_count, rates),
    .sets = sets,
    .keeps = GROBO_KEEPS_LIMP,
};

const grobo_servo_table *grobo_dxl1_table(void)
{
    return &grobo_i_dxl1_table;
}
