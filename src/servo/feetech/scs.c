/* SPDX-License-Identifier: MIT */
/* Made from src/servo/models/scs by `make servos`: registers and models. */
#include <grobo/core/feetech.h>

#include "src/servo/row.h"
#include "src/servo/tables.h"

static const grobo_servo_register rows[] = {
    ROW("firmware", 0, 1, 0, E, FIRMWARE, "", 0, 255, 0, 0),
    ROW("firmware_minor", 1, 1, 0, E, NONE, "", 0, 255, 0, 0),
    ROW("byte_order", 2, 1, 0, E, NONE, "", 0, 1, 1, 0),
    ROW("model", 3, 2, 0, E, MODEL, "", 0, 65535, 0, 0),
    ROW("id", 5, 1, 0, EW, ID, "", 0, 253, 1, 0),
    ROW("baud", 6, 1, 0, EW, BAUD, "code", 0, 7, 0, 0),
    ROW("return_delay", 7, 1, 0, EW, RETURN_DELAY, "2 us", 0, 254, 0, 0),
    ROW("reply_level", 8, 1, 0, EW, REPLY_LEVEL, "", 0, 1, 1, 0),
    ROW("min_position", 9, 2, 0, EW, MIN_POSITION, "0.293 deg", 0, 1023, 20, 1),
    ROW("min_position", 9, 2, 0, EW, MIN_POSITION, "", 0, 1023, 20, 2),
    ROW("max_position", 11, 2, 0, EW, MAX_POSITION, "0.293 deg", 0, 1023, 1003, 1),
    ROW("max_position", 11, 2, 0, EW, MAX_POSITION, "", 0, 1023, 1003, 2),
    ROW("temperature_limit", 13, 1, 0, EW, TEMPERATURE_LIMIT, "deg C", 0, 100, 80, 0),
    ROW("max_voltage", 14, 1, 0, EW, MAX_VOLTAGE, "0.1 V", 0, 254, 90, 0),
    ROW("min_voltage", 15, 1, 0, EW, MIN_VOLTAGE, "0.1 V", 0, 254, 45, 0),
    ROW("max_torque", 16, 2, 0, EW, MAX_TORQUE, "0.1 %", 0, 1000, 1000, 0),
    ROW("phase", 18, 1, 0, EW, DIRECTION, "bits", 0, 255, 0, 0),
    ROW("unload", 19, 1, 0, EW, SHUTDOWN, "bits", 0, 255, 37, 0),
    ROW("led_alarm", 20, 1, 0, EW, NONE, "bits", 0, 255, 37, 0),
    ROW("position_p", 21, 1, 0, EW, NONE, "", 0, 254, 15, 0),
    ROW("position_d", 22, 1, 0, EW, NONE, "", 0, 254, 15, 0),
    ROW("position_i", 23, 1, 0, EW, NONE, "", 0, 254, 0, 0),
    ROW("startup_force", 24, 2, 0, EW, NONE, "0.1 %", 0, 1000, 30, 0),
    ROW("cw_dead_zone", 26, 1, 0, EW, NONE, "0.293 deg", 0, 32, 1, 1),
    ROW("cw_dead_zone", 26, 1, 0, EW, NONE, "", 0, 32, 1, 2),
    ROW("ccw_dead_zone", 27, 1, 0, EW, NONE, "0.293 deg", 0, 32, 1, 1),
    ROW("ccw_dead_zone", 27, 1, 0, EW, NONE, "", 0, 32, 1, 2),
    ROW("hysteresis", 28, 1, 0, EW, NONE, "0.293 deg", 0, 32, 1, 1),
    ROW("hysteresis", 28, 1, 0, EW, NONE, "", 0, 32, 1, 2),
    ROW("protective_torque", 37, 1, 0, EW, NONE, "1 %", 0, 100, 20, 0),
    ROW("protection_time", 38, 1, 0, EW, NONE, "40 ms", 0, 254, 100, 0),
    ROW("overload_torque", 39, 1, 0, EW, NONE, "1 %", 0, 100, 80, 0),
    ROW("torque", 40, 1, 0, W, TORQUE, "", 0, 2, 0, 0),
    ROW("goal_position", 42, 2, 0, W, GOAL, "0.293 deg", 0, 1023, 0, 1),
    ROW("goal_position", 42, 2, 0, W, GOAL, "", 0, 1023, 0, 2),
    ROW("goal_time", 44, 2, 0, W, GOAL_TIME, "1 ms", 0, 32767, 0, 0),
    ROW("goal_speed", 46, 2, 0, W, SPEED, "0.293 deg/s", 0, 32767, 0, 0),
    ROW("lock", 48, 1, 0, W, LOCK, "", 0, 1, 1, 0),
    ROW("present_position", 56, 2, 0, R, POSITION, "0.293 deg", 0, 1023, 0, 1),
    ROW("present_position", 56, 2, 0, R, POSITION, "", 0, 1023, 0, 2),
    ROW("present_speed", 58, 2, 15, R, PRESENT_SPEED, "0.293 deg/s", -32767, 32767, 0, 0),
    ROW("present_load", 60, 2, 10, R, LOAD, "0.1 %", -1023, 1023, 0, 0),
    ROW("voltage", 62, 1, 0, R, VOLTAGE, "0.1 V", 0, 255, 0, 0),
    ROW("temperature", 63, 1, 0, R, TEMPERATURE, "deg C", 0, 255, 0, 0),
    ROW("registered", 64, 1, 0, R, REGISTERED, "", 0, 1, 0, 0),
    ROW("status", 65, 1, 0, R, ERROR, "bits", 0, 255, 0, 0),
    ROW("moving", 66, 1, 0, R, MOVING, "", 0, 1, 0, 0),
};

static const grobo_servo_model models[] = {
    {"SCS0009", 1284, 1024, 300, 512, 600, 230, 1000, 6000, 3, 0, &grobo_i_scs_table, NULL, 0, 0},
    {"SCS15", 3845, 1024, 300, 512, 330, 1470, 1500, 7400, 3,
     GROBO_MODEL_NO_JOINT | GROBO_MODEL_UNVERIFIED, &grobo_i_scs_table, NULL, 0, 0},
    {"SCS115", 6405, 1024, 300, 512, 330, 1470, 1500, 7400, 3,
     GROBO_MODEL_NO_JOINT | GROBO_MODEL_UNVERIFIED, &grobo_i_scs_table, NULL, 0, 0},
    {"SCS215", 8965, 1024, 300, 512, 330, 1860, 2000, 7400, 3, GROBO_MODEL_UNVERIFIED,
     &grobo_i_scs_table, NULL, 0, 0},
    {"SCS225", 8969, 1024, 300, 512, 330, 2450, 2400, 7400, 3, GROBO_MODEL_UNVERIFIED,
     &grobo_i_scs_table, NULL, 0, 0},
};

static const grobo_servo_rate rates[] = {
    {0, 0, 1000000}, {1, 0, 500000}, {2, 0, 250000}, {3, 0, 128000},
    {4, 0, 115200},  {5, 0, 76800},  {6, 0, 57600},  {7, 0, 38400},
};

static const uint64_t sets[] = {
    0x1F,
    0x19,
    0x6,
};

const grobo_servo_table grobo_i_scs_table = {
    .name = "Feetech SCS",
    LIST(registers, register_count, rows),
    LIST(models, model_count, models),
    LIST(rates, rate_count, rates),
    .sets = sets,
    .keeps = GROBO_KEEPS_LOCK,
    .big_endian = true,
};

const grobo_servo_table *grobo_scs_table(void)
{
    return &grobo_i_scs_table;
}
