/* SPDX-License-Identifier: MIT */
/* AX and MX with Protocol 1.0: registers and models. Rows and defaults: the maker's pages of
 * AX-12A, AX-18A, MX-28, MX-64 and MX-106. Speeds, torques and currents are those of the data
 * sheets at the nominal supply. */
#include <grobo/dxl1.h>

#include "src/servo/row.h"

/* Groups of models: one each where defaults differ. */
enum { AX12 = 1, AX18 = 2, MX28 = 4, MX64 = 8, MX106 = 16 };
enum { AX = AX12 | AX18, CURRENT = MX64 | MX106, MX = MX28 | CURRENT, ALL = AX | MX };

static const grobo_servo_register rows[] = {
    ROW("model", 0, 2, 0, E, MODEL, "", 0, 65535, 0, ALL),
    ROW("firmware", 2, 1, 0, E, FIRMWARE, "", 0, 255, 0, ALL),
    ROW("id", 3, 1, 0, EW, ID, "", 0, 253, 1, ALL),
    ROW("baud", 4, 1, 0, EW, BAUD, "code", 0, 254, 1, AX),
    ROW("baud", 4, 1, 0, EW, BAUD, "code", 0, 254, 34, MX),
    ROW("return_delay", 5, 1, 0, EW, RETURN_DELAY, "2 us", 0, 254, 250, ALL),
    ROW("min_position", 6, 2, 0, EW, MIN_POSITION, "0.29 deg", 0, 1023, 0, AX),
    ROW("min_position", 6, 2, 0, EW, MIN_POSITION, "0.088 deg", 0, 4095, 0, MX),
    ROW("max_position", 8, 2, 0, EW, MAX_POSITION, "0.29 deg", 0, 1023, 1023, AX),
    ROW("max_position", 8, 2, 0, EW, MAX_POSITION, "0.088 deg", 0, 4095, 4095, MX),
    ROW("drive_mode", 10, 1, 0, EW, DIRECTION, "bits", 0, 3, 0, MX106),
    ROW("temperature_limit", 11, 1, 0, EW, TEMPERATURE_LIMIT, "deg C", 0, 99, 70, AX12),
    ROW("temperature_limit", 11, 1, 0, EW, TEMPERATURE_LIMIT, "deg C", 0, 99, 75, AX18),
    ROW("temperature_limit", 11, 1, 0, EW, TEMPERATURE_LIMIT, "deg C", 0, 99, 80, MX),
    ROW("min_voltage", 12, 1, 0, EW, MIN_VOLTAGE, "0.1 V", 50, 250, 60, ALL),
    ROW("max_voltage", 13, 1, 0, EW, MAX_VOLTAGE, "0.1 V", 50, 250, 140, AX),
    ROW("max_voltage", 13, 1, 0, EW, MAX_VOLTAGE, "0.1 V", 50, 250, 160, MX28 | MX106),
    ROW("max_voltage", 13, 1, 0, EW, MAX_VOLTAGE, "0.1 V", 50, 250, 240, MX64),
    ROW("max_torque", 14, 2, 0, EW, MAX_TORQUE, "0.1 %", 0, 1023, 1023, AX12 | MX),
    ROW("max_torque", 14, 2, 0, EW, MAX_TORQUE, "0.1 %", 0, 1023, 983, AX18),
    ROW("reply_level", 16, 1, 0, EW, REPLY_LEVEL, "", 0, 2, 2, ALL),
    ROW("alarm_led", 17, 1, 0, EW, NONE, "bits", 0, 127, 36, ALL),
    ROW("shutdown", 18, 1, 0, EW, SHUTDOWN, "bits", 0, 127, 36, ALL),
    ROW("offset", 20, 2, 1, EW, OFFSET, "0.088 deg", -24576, 24576, 0, MX),
    ROW("resolution_divider", 22, 1, 0, EW, NONE, "", 1, 4, 1, MX),
    ROW("torque", 24, 1, 0, W, TORQUE, "", 0, 1, 0, ALL),
    ROW("led", 25, 1, 0, W, NONE, "", 0, 1, 0, ALL),
    ROW("cw_margin", 26, 1, 0, W, NONE, "0.29 deg", 0, 255, 1, AX),
    ROW("position_d", 26, 1, 0, W, NONE, "", 0, 254, 0, MX),
    ROW("ccw_margin", 27, 1, 0, W, NONE, "0.29 deg", 0, 255, 1, AX),
    ROW("position_i", 27, 1, 0, W, NONE, "", 0, 254, 0, MX),
    ROW("cw_slope", 28, 1, 0, W, NONE, "", 0, 254, 32, AX),
    ROW("position_p", 28, 1, 0, W, NONE, "", 0, 254, 32, MX),
    ROW("ccw_slope", 29, 1, 0, W, NONE, "", 0, 254, 32, AX),
    ROW("goal_position", 30, 2, 0, W, GOAL, "0.29 deg", 0, 1023, 0, AX),
    ROW("goal_position", 30, 2, 1, W, GOAL, "0.088 deg", -28672, 28672, 0, MX),
    ROW("moving_speed", 32, 2, 0, W, SPEED, "0.111 rpm", 0, 2047, 0, AX),
    ROW("moving_speed", 32, 2, 0, W, SPEED, "0.114 rpm", 0, 2047, 0, MX),
    ROW("torque_limit", 34, 2, 0, W, TORQUE_LIMIT, "0.1 %", 0, 1023, 0, ALL),
    ROW("present_position", 36, 2, 0, R, POSITION, "0.29 deg", 0, 1023, 0, AX),
    ROW("present_position", 36, 2, 1, R, POSITION, "0.088 deg", -32768, 32767, 0, MX),
    ROW("present_speed", 38, 2, 10, R, PRESENT_SPEED, "0.111 rpm", -1023, 1023, 0, AX),
    ROW("present_speed", 38, 2, 10, R, PRESENT_SPEED, "0.114 rpm", -1023, 1023, 0, MX),
    ROW("present_load", 40, 2, 10, R, LOAD, "0.1 %", -1023, 1023, 0, ALL),
    ROW("voltage", 42, 1, 0, R, VOLTAGE, "0.1 V", 0, 255, 0, ALL),
    ROW("temperature", 43, 1, 0, R, TEMPERATURE, "deg C", 0, 255, 0, ALL),
    ROW("registered", 44, 1, 0, R, REGISTERED, "", 0, 1, 0, ALL),
    ROW("moving", 46, 1, 0, R, MOVING, "", 0, 1, 0, ALL),
    ROW("lock", 47, 1, 0, W, LOCK, "", 0, 1, 0, ALL),
    ROW("punch", 48, 2, 0, W, NONE, "0.1 %", 0, 1023, 32, AX),
    ROW("punch", 48, 2, 0, W, NONE, "0.1 %", 0, 1023, 0, MX),
    ROW("tick", 50, 2, 0, R, NONE, "1 ms", 0, 32767, 0, MX),
    ROW("current", 68, 2, 0, R, CURRENT, "4.5 mA", 0, 4095, 2048, CURRENT),
    ROW("torque_control", 70, 1, 0, W, MODE, "", 0, 1, 0, CURRENT),
    ROW("goal_torque", 71, 2, 10, W, GOAL_CURRENT, "4.5 mA", -1023, 1023, 0, CURRENT),
    ROW("goal_acceleration", 73, 1, 0, W, ACCELERATION, "8.583 deg/s2", 0, 254, 0, MX),
};

#define MODEL(name, number, ticks, deg, middle, dps, mnm, ma, group)                               \
    {                                                                                              \
        name, number, ticks, deg, middle, dps, mnm, ma, 12000, group, 24, &grobo_dxl1_table        \
    }

static const grobo_servo_model models[] = {
    MODEL("AX-12A", 12, 1023, 300, 512, 354, 1500, 1500, AX12),
    MODEL("AX-18A", 18, 1023, 300, 512, 582, 1800, 2200, AX18),
    MODEL("MX-28", 29, 4096, 360, 2048, 330, 2500, 1400, MX28),
    MODEL("MX-64", 310, 4096, 360, 2048, 378, 6000, 4100, MX64),
    MODEL("MX-106", 320, 4096, 360, 2048, 270, 8400, 5200, MX106),
};

#undef MODEL

/* What hosts call 115200 and 57600 is 117647 and 57143. Other codes are 2000000 / (code + 1). */
static const grobo_servo_rate rates[] = {
    {1, ALL, 1000000}, {3, ALL, 500000},   {4, ALL, 400000},   {7, ALL, 250000},
    {9, ALL, 200000},  {16, ALL, 115200},  {34, ALL, 57600},   {103, ALL, 19200},
    {207, ALL, 9600},  {250, MX, 2250000}, {251, MX, 2500000}, {252, MX, 3000000},
};

const grobo_servo_table grobo_dxl1_table = {
    .name = "DYNAMIXEL AX, MX",
    LIST(registers, register_count, rows),
    LIST(models, model_count, models),
    LIST(rates, rate_count, rates),
    .keeps = GROBO_KEEPS_LIMP,
};
