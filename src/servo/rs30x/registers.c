/* SPDX-License-Identifier: MIT */
/*
 * RS30x: registers and models. Rows and defaults: RS301CR/RS302CD manual, memory map; where it
 * gives no range it is that of the register's width. Speeds (0.11 and 0.16 s for 60 degrees at
 * 7.4 V) and stall currents: the same. That RS303MR and RS304MD are made as these two is an
 * assumption, and so is the factory's limit of the temperature. A file of its own: firmware need
 * not link it.
 */
#include <grobo/rs30x.h>

#include "src/servo/row.h"

/* Groups of models. */
enum { RS301 = 1, RS302 = 2, RS303 = 4, RS304 = 8 };
enum { FAST = RS301 | RS303, SLOW = RS302 | RS304, LATER = RS303 | RS304, ALL = FAST | SLOW };

static const grobo_servo_register rows[] = {
    ROW("model", 0, 2, 0, E, MODEL, "", 0, 65535, 0, ALL),
    ROW("firmware", 2, 1, 0, E, FIRMWARE, "", 0, 255, 0, ALL),
    ROW("id", 4, 1, 0, EW, ID, "", 1, 127, 1, ALL),
    ROW("reverse", 5, 1, 0, EW, DIRECTION, "", 0, 1, 0, ALL),
    ROW("baud", 6, 1, 0, EW, BAUD, "code", 0, 10, 7, ALL),
    ROW("delay", 7, 1, 0, EW, RETURN_DELAY, "50 us", 0, 127, 0, ALL),
    ROW("cw_limit", 8, 2, 1, EW, MAX_POSITION, "0.1 deg", -1500, 1500, 1500, ALL),
    ROW("ccw_limit", 10, 2, 1, EW, MIN_POSITION, "0.1 deg", -1500, 1500, -1500, ALL),
    ROW("temperature_limit", 14, 2, 1, E, TEMPERATURE_LIMIT, "deg C", -32768, 32767, 80, ALL),
    ROW("silence_torque", 22, 1, 0, EW, NONE, "", 0, 255, 0, LATER),
    ROW("warm_up_time", 23, 1, 0, EW, NONE, "", 0, 255, 0, LATER),
    ROW("cw_margin", 24, 1, 0, EW, NONE, "0.1 deg", 0, 255, 2, ALL),
    ROW("ccw_margin", 25, 1, 0, EW, NONE, "0.1 deg", 0, 255, 2, ALL),
    ROW("cw_slope", 26, 1, 0, EW, NONE, "1 deg", 0, 255, 10, FAST),
    ROW("cw_slope", 26, 1, 0, EW, NONE, "1 deg", 0, 255, 15, SLOW),
    ROW("ccw_slope", 27, 1, 0, EW, NONE, "1 deg", 0, 255, 10, FAST),
    ROW("ccw_slope", 27, 1, 0, EW, NONE, "1 deg", 0, 255, 15, SLOW),
    ROW("punch", 28, 2, 0, EW, NONE, "0.01 %", 0, 10000, 180, FAST),
    ROW("punch", 28, 2, 0, EW, NONE, "0.01 %", 0, 10000, 200, SLOW),
    ROW("goal", 30, 2, 1, W, GOAL, "0.1 deg", -1500, 1500, 0, ALL),
    ROW("goal_time", 32, 2, 0, W, GOAL_TIME, "10 ms", 0, 16383, 0, ALL),
    ROW("max_torque", 35, 1, 0, W, TORQUE_LIMIT, "1 %", 0, 100, 100, FAST),
    ROW("max_torque", 35, 1, 0, W, TORQUE_LIMIT, "1 %", 0, 100, 77, SLOW),
    ROW("torque", 36, 1, 0, W, TORQUE, "", 0, 2, 0, ALL),
    ROW("position", 42, 2, 1, R, POSITION, "0.1 deg", -32768, 32767, 0, ALL),
    ROW("time", 44, 2, 0, R, NONE, "10 ms", 0, 65535, 0, ALL),
    ROW("speed", 46, 2, 1, R, PRESENT_SPEED, "deg/s", -32768, 32767, 0, ALL),
    ROW("current", 48, 2, 0, R, CURRENT, "mA", 0, 65535, 0, ALL),
    ROW("temperature", 50, 2, 1, R, TEMPERATURE, "deg C", -32768, 32767, 0, ALL),
    ROW("voltage", 52, 2, 0, R, VOLTAGE, "10 mV", 0, 65535, 0, ALL),
};

#define MODEL(name, number, dps, ma, group)                                                        \
    {                                                                                              \
        name, number, 3000, 300, 0, dps, 0, ma, 7400, group, 1, &grobo_rs30x_table                 \
    }

static const grobo_servo_model models[] = {
    MODEL("RS301CR", GROBO_RS30X_RS301CR, 545, 1200, RS301),
    MODEL("RS302CD", GROBO_RS30X_RS302CD, 375, 900, RS302),
    MODEL("RS303MR", GROBO_RS30X_RS303MR, 545, 1200, RS303),
    MODEL("RS304MD", GROBO_RS30X_RS304MD, 375, 900, RS304),
};

#undef MODEL

static const grobo_servo_rate rates[] = {
    {0, ALL, 9600},   {1, ALL, 14400},  {2, ALL, 19200},   {3, ALL, 28800},
    {4, ALL, 38400},  {5, ALL, 57600},  {6, ALL, 76800},   {7, ALL, 115200},
    {8, ALL, 153600}, {9, ALL, 230400}, {10, ALL, 460800},
};

const grobo_servo_table grobo_rs30x_table = {
    .name = "Futaba RS30x",
    LIST(registers, register_count, rows),
    LIST(models, model_count, models),
    LIST(rates, rate_count, rates),
    .keeps = GROBO_KEEPS_COMMAND,
};
