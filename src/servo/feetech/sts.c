/* SPDX-License-Identifier: MIT */
/* STS and SMS: registers and models. Addresses and signs: LeRobot motors/feetech/tables.py;
 * defaults: a dump of six STS3215 (7.4 V) of an SO-101 arm; units: the maker's tables. The register
 * model holds two bytes that the maker calls version: 9 and 3 are 777. */
#include <grobo/feetech.h>

#include "src/servo/row.h"

/* Groups of models: for 7.4 V, for 12 V. */
enum { V7 = 1, V12 = 2, ALL = V7 | V12 };

static const grobo_servo_register rows[] = {
    ROW("firmware", 0, 1, 0, E, FIRMWARE, "", 0, 255, 0, ALL),
    ROW("firmware_minor", 1, 1, 0, E, NONE, "", 0, 255, 9, ALL),
    ROW("byte_order", 2, 1, 0, E, NONE, "", 0, 1, 0, ALL),
    ROW("model", 3, 2, 0, E, MODEL, "", 0, 65535, 0, ALL),
    ROW("id", 5, 1, 0, EW, ID, "", 0, 253, 1, ALL),
    ROW("baud", 6, 1, 0, EW, BAUD, "code", 0, 7, 0, ALL),
    ROW("return_delay", 7, 1, 0, EW, RETURN_DELAY, "2 us", 0, 254, 0, ALL),
    ROW("reply_level", 8, 1, 0, EW, REPLY_LEVEL, "", 0, 1, 1, ALL),
    ROW("min_position", 9, 2, 15, EW, MIN_POSITION, "0.088 deg", -32767, 32767, 0, ALL),
    ROW("max_position", 11, 2, 15, EW, MAX_POSITION, "0.088 deg", -32767, 32767, 4095, ALL),
    ROW("temperature_limit", 13, 1, 0, EW, TEMPERATURE_LIMIT, "deg C", 0, 100, 70, ALL),
    ROW("max_voltage", 14, 1, 0, EW, MAX_VOLTAGE, "0.1 V", 0, 254, 80, V7),
    ROW("max_voltage", 14, 1, 0, EW, MAX_VOLTAGE, "0.1 V", 0, 254, 140, V12),
    ROW("min_voltage", 15, 1, 0, EW, MIN_VOLTAGE, "0.1 V", 0, 254, 40, ALL),
    ROW("max_torque", 16, 2, 0, EW, MAX_TORQUE, "0.1 %", 0, 1000, 1000, ALL),
    ROW("phase", 18, 1, 0, EW, DIRECTION, "bits", 0, 255, 12, ALL),
    ROW("unload", 19, 1, 0, EW, SHUTDOWN, "bits", 0, 255, 44, ALL),
    ROW("led_alarm", 20, 1, 0, EW, NONE, "bits", 0, 255, 47, ALL),
    ROW("position_p", 21, 1, 0, EW, NONE, "", 0, 254, 32, ALL),
    ROW("position_d", 22, 1, 0, EW, NONE, "", 0, 254, 32, ALL),
    ROW("position_i", 23, 1, 0, EW, NONE, "", 0, 254, 0, ALL),
    ROW("startup_force", 24, 2, 0, EW, NONE, "0.1 %", 0, 1000, 16, ALL),
    ROW("cw_dead_zone", 26, 1, 0, EW, NONE, "0.088 deg", 0, 32, 1, ALL),
    ROW("ccw_dead_zone", 27, 1, 0, EW, NONE, "0.088 deg", 0, 32, 1, ALL),
    ROW("protection_current", 28, 2, 0, EW, CURRENT_LIMIT, "6.5 mA", 0, 511, 500, ALL),
    ROW("angular_resolution", 30, 1, 0, EW, NONE, "", 1, 100, 1, ALL),
    ROW("offset", 31, 2, 11, EW, OFFSET, "0.088 deg", -2047, 2047, 0, ALL),
    ROW("mode", 33, 1, 0, EW, MODE, "", 0, 3, 0, ALL),
    ROW("protective_torque", 34, 1, 0, EW, NONE, "1 %", 0, 100, 20, ALL),
    ROW("protection_time", 35, 1, 0, EW, NONE, "10 ms", 0, 254, 200, ALL),
    ROW("overload_torque", 36, 1, 0, EW, NONE, "1 %", 0, 100, 80, ALL),
    ROW("speed_p", 37, 1, 0, EW, NONE, "", 0, 100, 10, ALL),
    ROW("overcurrent_time", 38, 1, 0, EW, NONE, "10 ms", 0, 254, 200, ALL),
    ROW("speed_i", 39, 1, 0, EW, NONE, "", 0, 254, 200, ALL),
    ROW("torque", 40, 1, 0, W, TORQUE, "", 0, 128, 0, ALL),
    ROW("acceleration", 41, 1, 0, W, ACCELERATION, "8.79 deg/s2", 0, 254, 0, ALL),
    ROW("goal_position", 42, 2, 15, W, GOAL, "0.088 deg", -32767, 32767, 0, ALL),
    ROW("goal_pwm", 44, 2, 10, W, GOAL_PWM, "0.1 %", -1000, 1000, 0, ALL),
    ROW("goal_speed", 46, 2, 15, W, SPEED, "0.088 deg/s", -32767, 32767, 0, ALL),
    ROW("torque_limit", 48, 2, 0, W, TORQUE_LIMIT, "0.1 %", 0, 1000, 0, ALL),
    ROW("lock", 55, 1, 0, W, LOCK, "", 0, 1, 1, ALL),
    ROW("present_position", 56, 2, 15, R, POSITION, "0.088 deg", -32767, 32767, 0, ALL),
    ROW("present_speed", 58, 2, 15, R, PRESENT_SPEED, "0.088 deg/s", -32767, 32767, 0, ALL),
    ROW("present_load", 60, 2, 10, R, LOAD, "0.1 %", -1000, 1000, 0, ALL),
    ROW("voltage", 62, 1, 0, R, VOLTAGE, "0.1 V", 0, 255, 0, ALL),
    ROW("temperature", 63, 1, 0, R, TEMPERATURE, "deg C", 0, 255, 0, ALL),
    ROW("registered", 64, 1, 0, R, REGISTERED, "", 0, 1, 0, ALL),
    ROW("status", 65, 1, 0, R, ERROR, "bits", 0, 255, 0, ALL),
    ROW("moving", 66, 1, 0, R, MOVING, "", 0, 1, 0, ALL),
    ROW("current", 69, 2, 15, R, CURRENT, "6.5 mA", -32767, 32767, 0, ALL),
    ROW("goal_in_effect", 71, 2, 15, R, NONE, "0.088 deg", -32767, 32767, 0, ALL),
    ROW("moving_threshold", 80, 1, 0, W, NONE, "", 0, 255, 0, ALL),
    ROW("max_acceleration", 85, 1, 0, W, NONE, "8.79 deg/s2", 0, 254, 0, ALL),
    ROW("acceleration_factor", 86, 1, 0, W, NONE, "", 0, 254, 0, ALL),
};

#define MODEL(name, number, dps, mnm, ma, mv, group)                                               \
    {                                                                                              \
        name, number, 4096, 360, 2048, dps, mnm, ma, mv, group, 3, &grobo_sts_table                \
    }

/* Both versions of STS3215 have one number: their limits of voltage tell them apart. */
static const grobo_servo_model models[] = {
    MODEL("STS3215", 777, 300, 1910, 2400, 7400, V7),
    MODEL("STS3215-12V", 777, 272, 2940, 2700, 12000, V12),
    MODEL("STS3250", 2825, 450, 4900, 4500, 12000, V12),
    MODEL("SM8512BL", 11272, 270, 8300, 3900, 12000, V12),
};

#undef MODEL

static const grobo_servo_rate rates[] = {
    {0, ALL, 1000000}, {1, ALL, 500000}, {2, ALL, 250000}, {3, ALL, 128000},
    {4, ALL, 115200},  {5, ALL, 76800},  {6, ALL, 57600},  {7, ALL, 38400},
};

const grobo_servo_table grobo_sts_table = {
    .name = "Feetech STS",
    LIST(registers, register_count, rows),
    LIST(models, model_count, models),
    LIST(rates, rate_count, rates),
    .keeps = GROBO_KEEPS_LOCK,
};
