/* SPDX-License-Identifier: MIT */
/* Made from src/servo/models/sts by `make servos`: registers and models. */
#include <grobo/core/feetech.h>

#include "src/servo/row.h"
#include "src/servo/tables.h"

static const grobo_servo_register rows[] = {
    ROW("firmware", 0, 1, 0, E, FIRMWARE, "", 0, 255, 0, 0),
    ROW("firmware_minor", 1, 1, 0, E, NONE, "", 0, 255, 9, 0),
    ROW("byte_order", 2, 1, 0, E, NONE, "", 0, 1, 0, 0),
    ROW("model", 3, 2, 0, E, MODEL, "", 0, 65535, 0, 0),
    ROW("id", 5, 1, 0, EW, ID, "", 0, 253, 1, 0),
    ROW("baud", 6, 1, 0, EW, BAUD, "code", 0, 7, 0, 0),
    ROW("return_delay", 7, 1, 0, EW, RETURN_DELAY, "2 us", 0, 254, 0, 0),
    ROW("reply_level", 8, 1, 0, EW, REPLY_LEVEL, "", 0, 1, 1, 0),
    ROW("min_position", 9, 2, 15, EW, MIN_POSITION, "0.088 deg", -32767, 32767, 0, 1),
    ROW("min_position", 9, 2, 15, EW, MIN_POSITION, "", -32767, 32767, 0, 2),
    ROW("max_position", 11, 2, 15, EW, MAX_POSITION, "0.088 deg", -32767, 32767, 4095, 1),
    ROW("max_position", 11, 2, 15, EW, MAX_POSITION, "", -32767, 32767, 4095, 2),
    ROW("temperature_limit", 13, 1, 0, EW, TEMPERATURE_LIMIT, "deg C", 0, 100, 70, 0),
    ROW("max_voltage", 14, 1, 0, EW, MAX_VOLTAGE, "0.1 V", 0, 254, 80, 3),
    ROW("max_voltage", 14, 1, 0, EW, MAX_VOLTAGE, "0.1 V", 0, 254, 140, 4),
    ROW("min_voltage", 15, 1, 0, EW, MIN_VOLTAGE, "0.1 V", 0, 254, 40, 0),
    ROW("max_torque", 16, 2, 0, EW, MAX_TORQUE, "0.1 %", 0, 1000, 1000, 0),
    ROW("phase", 18, 1, 0, EW, DIRECTION, "bits", 0, 255, 12, 0),
    ROW("unload", 19, 1, 0, EW, SHUTDOWN, "bits", 0, 255, 44, 0),
    ROW("led_alarm", 20, 1, 0, EW, NONE, "bits", 0, 255, 47, 0),
    ROW("position_p", 21, 1, 0, EW, NONE, "", 0, 254, 32, 0),
    ROW("position_d", 22, 1, 0, EW, NONE, "", 0, 254, 32, 0),
    ROW("position_i", 23, 1, 0, EW, NONE, "", 0, 254, 0, 0),
    ROW("startup_force", 24, 2, 0, EW, NONE, "0.1 %", 0, 1000, 16, 0),
    ROW("cw_dead_zone", 26, 1, 0, EW, NONE, "0.088 deg", 0, 32, 1, 1),
    ROW("cw_dead_zone", 26, 1, 0, EW, NONE, "", 0, 32, 1, 2),
    ROW("ccw_dead_zone", 27, 1, 0, EW, NONE, "0.088 deg", 0, 32, 1, 1),
    ROW("ccw_dead_zone", 27, 1, 0, EW, NONE, "", 0, 32, 1, 2),
    ROW("protection_current", 28, 2, 0, EW, CURRENT_LIMIT, "6.5 mA", 0, 511, 500, 1),
    ROW("protection_current", 28, 2, 0, EW, CURRENT_LIMIT, "", 0, 511, 500, 2),
    ROW("angular_resolution", 30, 1, 0, EW, NONE, "", 1, 100, 1, 0),
    ROW("offset", 31, 2, 11, EW, OFFSET, "0.088 deg", -2047, 2047, 0, 1),
    ROW("offset", 31, 2, 11, EW, OFFSET, "", -2047, 2047, 0, 2),
    ROW("mode", 33, 1, 0, EW, MODE, "", 0, 3, 0, 0),
    ROW("protective_torque", 34, 1, 0, EW, NONE, "1 %", 0, 100, 20, 0),
    ROW("protection_time", 35, 1, 0, EW, NONE, "10 ms", 0, 254, 200, 0),
    ROW("overload_torque", 36, 1, 0, EW, NONE, "1 %", 0, 100, 80, 0),
    ROW("speed_p", 37, 1, 0, EW, NONE, "", 0, 100, 10, 0),
    ROW("overcurrent_time", 38, 1, 0, EW, NONE, "10 ms", 0, 254, 200, 0),
    ROW("speed_i", 39, 1, 0, EW, NONE, "", 0, 254, 200, 0),
    ROW("torque", 40, 1, 0, W, TORQUE, "", 0, 128, 0, 0),
    ROW("acceleration", 41, 1, 0, W, ACCELERATION, "8.79 deg/s2", 0, 254, 0, 0),
    ROW("goal_position", 42, 2, 15, W, GOAL, "0.088 deg", -32767, 32767, 0, 1),
    ROW("goal_position", 42, 2, 15, W, GOAL, "", -32767, 32767, 0, 2),
    ROW("goal_pwm", 44, 2, 10, W, GOAL_PWM, "0.1 %", -1000, 1000, 0, 0),
    ROW("goal_speed", 46, 2, 15, W, SPEED, "0.088 deg/s", -32767, 32767, 0, 0),
    ROW("torque_limit", 48, 2, 0, W, TORQUE_LIMIT, "0.1 %", 0, 1000, 0, 0),
    ROW("lock", 55, 1, 0, W, LOCK, "", 0, 1, 1, 0),
    ROW("present_position", 56, 2, 15, R, POSITION, "0.088 deg", -32767, 32767, 0, 1),
    ROW("present_position", 56, 2, 15, R, POSITION, "", -32767, 32767, 0, 2),
    ROW("present_speed", 58, 2, 15, R, PRESENT_SPEED, "0.088 deg/s", -32767, 32767, 0, 0),
    ROW("present_load", 60, 2, 10, R, LOAD, "0.1 %", -1000, 1000, 0, 0),
    ROW("voltage", 62, 1, 0, R, VOLTAGE, "0.1 V", 0, 255, 0, 0),
    ROW("temperature", 63, 1, 0, R, TEMPERATURE, "deg C", 0, 255, 0, 0),
    ROW("registered", 64, 1, 0, R, REGISTERED, "", 0, 1, 0, 0),
    ROW("status", 65, 1, 0, R, ERROR, "bits", 0, 255, 0, 0),
    ROW("moving", 66, 1, 0, R, MOVING, "", 0, 1, 0, 0),
    ROW("current", 69, 2, 15, R, CURRENT, "6.5 mA", -32767, 32767, 0, 1),
    ROW("current", 69, 2, 15, R, CURRENT, "", -32767, 32767, 0, 2),
    ROW("goal_in_effect", 71, 2, 15, R, NONE, "0.088 deg", -32767, 32767, 0, 1),
    ROW("goal_in_effect", 71, 2, 15, R, NONE, "", -32767, 32767, 0, 2),
    ROW("moving_threshold", 80, 1, 0, W, NONE, "", 0, 255, 0, 0),
    ROW("max_acceleration", 85, 1, 0, W, NONE, "8.79 deg/s2", 0, 254, 0, 0),
    ROW("acceleration_factor", 86, 1, 0, W, NONE, "", 0, 254, 0, 0),
};

static const grobo_servo_model models[] = {
    {"STS3215", 777, 4096, 360, 2048, 300, 1910, 2400, 7400, 3, 0, &grobo_i_sts_table, NULL, 0, 0},
    {"STS3215-12V", 777, 4096, 360, 2048, 272, 2940, 2700, 12000, 3, 0, &grobo_i_sts_table, NULL, 0,
     0},
    {"STS3250", 2825, 4096, 360, 2048, 450, 4900, 4500, 12000, 3, 0, &grobo_i_sts_table, NULL, 0,
     0},
    {"SM8512BL", 11272, 4096, 360, 2048, 270, 8300, 3900, 12000, 3, 0, &grobo_i_sts_table, NULL, 0,
     0},
    {"STS-ANY", 0, 4096, 360, 2048, 1, 1, 1, 12000, 3, GROBO_MODEL_NO_JOINT, &grobo_i_sts_table,
     NULL, 0, 0},
};

static const grobo_servo_rate rates[] = {
    {0, 0, 1000000}, {1, 0, 500000}, {2, 0, 250000}, {3, 0, 128000},
    {4, 0, 115200},  {5, 0, 76800},  {6, 0, 57600},  {7, 0, 38400},
};

static const uint64_t sets[] = {
    0x1F, 0xF, 0x10, 0x1, 0x1E,
};

const grobo_servo_table grobo_i_sts_table = {
    .name = "Feetech STS",
    LIST(registers, register_count, rows),
    LIST(models, model_count, models),
    LIST(rates, rate_count, rates),
    .sets = sets,
    .keeps = GROBO_KEEPS_LOCK,
};

const grobo_servo_table *grobo_sts_table(void)
{
    return &grobo_i_sts_table;
}
