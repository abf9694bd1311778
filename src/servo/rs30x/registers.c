/* SPDX-License-Identifier: MIT */
/* Made from src/servo/models/rs30x by `make servos`: registers and models. */
#include <grobo/core/rs30x.h>

#include "src/servo/row.h"
#include "src/servo/tables.h"

static const grobo_servo_register rows[] = {
    ROW("model", 0, 2, 0, E, MODEL, "", 0, 65535, 0, 0),
    ROW("firmware", 2, 1, 0, E, FIRMWARE, "", 0, 255, 0, 0),
    ROW("id", 4, 1, 0, EW, ID, "", 1, 127, 1, 0),
    ROW("reverse", 5, 1, 0, EW, DIRECTION, "", 0, 1, 0, 0),
    ROW("baud", 6, 1, 0, EW, BAUD, "code", 0, 10, 7, 0),
    ROW("delay", 7, 1, 0, EW, RETURN_DELAY, "50 us", 0, 127, 0, 0),
    ROW("cw_limit", 8, 2, 1, EW, MAX_POSITION, "0.1 deg", -1500, 1500, 1500, 0),
    ROW("ccw_limit", 10, 2, 1, EW, MIN_POSITION, "0.1 deg", -1500, 1500, -1500, 0),
    ROW("temperature_limit", 14, 2, 1, E, TEMPERATURE_LIMIT, "deg C", -32768, 32767, 80, 0),
    ROW("silence_torque", 22, 1, 0, EW, NONE, "", 0, 255, 0, 1),
    ROW("warm_up_time", 23, 1, 0, EW, NONE, "", 0, 255, 0, 1),
    ROW("cw_margin", 24, 1, 0, EW, NONE, "0.1 deg", 0, 255, 2, 2),
    ROW("cw_margin", 24, 1, 0, EW, NONE, "0.1 deg", 0, 255, 1, 3),
    ROW("ccw_margin", 25, 1, 0, EW, NONE, "0.1 deg", 0, 255, 2, 2),
    ROW("ccw_margin", 25, 1, 0, EW, NONE, "0.1 deg", 0, 255, 1, 3),
    ROW("cw_slope", 26, 1, 0, EW, NONE, "1 deg", 0, 255, 10, 4),
    ROW("cw_slope", 26, 1, 0, EW, NONE, "1 deg", 0, 255, 15, 5),
    ROW("cw_slope", 26, 1, 0, EW, NONE, "1 deg", 0, 255, 4, 3),
    ROW("ccw_slope", 27, 1, 0, EW, NONE, "1 deg", 0, 255, 10, 4),
    ROW("ccw_slope", 27, 1, 0, EW, NONE, "1 deg", 0, 255, 15, 5),
    ROW("ccw_slope", 27, 1, 0, EW, NONE, "1 deg", 0, 255, 4, 3),
    ROW("punch", 28, 2, 0, EW, NONE, "0.01 %", 0, 10000, 180, 4),
    ROW("punch", 28, 2, 0, EW, NONE, "0.01 %", 0, 10000, 200, 5),
    ROW("punch", 28, 2, 0, EW, NONE, "0.01 %", 0, 10000, 1300, 3),
    ROW("goal", 30, 2, 1, W, GOAL, "0.1 deg", -1500, 1500, 0, 0),
    ROW("goal_time", 32, 2, 0, W, GOAL_TIME, "10 ms", 0, 16383, 0, 0),
    ROW("max_torque", 35, 1, 0, W, TORQUE_LIMIT, "1 %", 0, 100, 100, 6),
    ROW("max_torque", 35, 1, 0, W, TORQUE_LIMIT, "1 %", 0, 100, 77, 5),
    ROW("torque", 36, 1, 0, W, TORQUE, "", 0, 2, 0, 0),
    ROW("position", 42, 2, 1, R, POSITION, "0.1 deg", -32768, 32767, 0, 0),
    ROW("time", 44, 2, 0, R, NONE, "10 ms", 0, 65535, 0, 0),
    ROW("speed", 46, 2, 1, R, PRESENT_SPEED, "deg/s", -32768, 32767, 0, 0),
    ROW("current", 48, 2, 0, R, CURRENT, "mA", 0, 65535, 0, 0),
    ROW("temperature", 50, 2, 1, R, TEMPERATURE, "deg C", -32768, 32767, 0, 0),
    ROW("voltage", 52, 2, 0, R, VOLTAGE, "10 mV", 0, 65535, 0, 0),
};

static const grobo_servo_model models[] = {
    {"RS301CR", 12304, 3000, 300, 0, 545, 0, 1200, 7400, 1, 0, &grobo_i_rs30x_table, NULL, 0, 0},
    {"RS302CD", 12320, 3000, 300, 0, 375, 0, 900, 7400, 1, 0, &grobo_i_rs30x_table, NULL, 0, 0},
    {"RS303MR", 12336, 3000, 300, 0, 545, 0, 1200, 7400, 1, 0, &grobo_i_rs30x_table, NULL, 0, 0},
    {"RS304MD", 12352, 3000, 300, 0, 375, 0, 900, 7400, 1, 0, &grobo_i_rs30x_table, NULL, 0, 0},
    {"RS405CB", 16464, 3000, 300, 0, 273, 4710, 3600, 11100, 1, GROBO_MODEL_UNVERIFIED,
     &grobo_i_rs30x_table, NULL, 0, 0},
    {"RS406CB", 16480, 3000, 300, 0, 545, 2750, 1900, 11100, 1, 0, &grobo_i_rs30x_table, NULL, 0,
     0},
};

static const grobo_servo_rate rates[] = {
    {0, 0, 9600},  {1, 0, 14400},  {2, 0, 19200},  {3, 0, 28800},  {4, 0, 38400},   {5, 0, 57600},
    {6, 0, 76800}, {7, 0, 115200}, {8, 0, 153600}, {9, 0, 230400}, {10, 0, 460800},
};

static const uint64_t sets[] = {
    0x3F, 0xC, 0xF, 0x30, 0x5, 0xA, 0x35,
};

const grobo_servo_table grobo_i_rs30x_table = {
    .name = "Futaba RS30x",
    LIST(registers, register_count, rows),
    LIST(models, model_count, models),
    LIST(rates, rate_count, rates),
    .sets = sets,
    .keeps = GROBO_KEEPS_COMMAND,
};

const grobo_servo_table *grobo_rs30x_table(void)
{
    return &grobo_i_rs30x_table;
}
