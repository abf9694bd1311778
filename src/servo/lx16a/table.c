/* SPDX-License-Identifier: MIT */
/* Made from src/servo/models/lx16a by `make servos`: registers and models. */
#include <grobo/core/lx16a.h>

#include "src/servo/row.h"
#include "src/servo/tables.h"

static const grobo_servo_register rows[] = {
    ROW("id", 0, 1, 0, EW, ID, "", 0, 253, 1, 0),
    ROW("offset", 1, 1, 1, EW, OFFSET, "0.24 deg", -125, 125, 0, 0),
    ROW("min_position", 2, 2, 0, EW, MIN_POSITION, "0.24 deg", 0, 1000, 0, 0),
    ROW("max_position", 4, 2, 0, EW, MAX_POSITION, "0.24 deg", 0, 1000, 1000, 0),
    ROW("min_voltage", 6, 2, 0, EW, MIN_VOLTAGE, "0.001 V", 4500, 12000, 4500, 0),
    ROW("max_voltage", 8, 2, 0, EW, MAX_VOLTAGE, "0.001 V", 4500, 12000, 12000, 0),
    ROW("temperature_limit", 10, 1, 0, EW, TEMPERATURE_LIMIT, "deg C", 50, 100, 85, 0),
    ROW("led_alarm", 11, 1, 0, EW, NONE, "bits", 0, 7, 7, 0),
    ROW("led_off", 12, 1, 0, EW, NONE, "", 0, 1, 0, 0),
    ROW("torque", 16, 1, 0, W, TORQUE, "", 0, 1, 0, 0),
    ROW("mode", 17, 1, 0, W, MODE, "", 0, 1, 0, 0),
    ROW("mode_speed", 19, 2, 1, W, GOAL_SPEED, "0.1 %", -1000, 1000, 0, 0),
    ROW("goal_position", 21, 2, 0, W, GOAL, "0.24 deg", 0, 1000, 0, 0),
    ROW("goal_time", 23, 2, 0, W, GOAL_TIME, "1 ms", 0, 30000, 0, 0),
    ROW("next_position", 25, 2, 0, W, NONE, "0.24 deg", 0, 1000, 0, 0),
    ROW("next_time", 27, 2, 0, W, NONE, "1 ms", 0, 30000, 0, 0),
    ROW("temperature", 29, 1, 0, R, TEMPERATURE, "deg C", 0, 255, 0, 0),
    ROW("voltage", 30, 2, 0, R, VOLTAGE, "0.001 V", 0, 65535, 0, 0),
    ROW("present_position", 32, 2, 1, R, POSITION, "0.24 deg", -32768, 32767, 0, 0),
};

static const grobo_servo_model models[] = {
    {"LX-16A", 16, 1000, 240, 500, 375, 1670, 1000, 7400, 0, 0, &grobo_i_lx16a_table, NULL, 0, 0},
    {"LX-15D", 15, 1000, 240, 500, 375, 1670, 1000, 7400, 0, 0, &grobo_i_lx16a_table, NULL, 0, 0},
    {"LX-224", 224, 1000, 240, 500, 300, 1960, 1000, 7400, 0, 0, &grobo_i_lx16a_table, NULL, 0, 0},
    {"HTS-35H", 35, 1000, 240, 500, 333, 3430, 3000, 11100, 0, 0, &grobo_i_lx16a_table, NULL, 0, 0},
};

static const uint64_t sets[] = {
    0xF,
};

const grobo_servo_table grobo_i_lx16a_table = {
    .name = "Hiwonder LX",
    LIST(registers, register_count, rows),
    LIST(models, model_count, models),
    .sets = sets,
    .keeps = GROBO_KEEPS_LIMP,
};

const grobo_servo_table *grobo_lx16a_table(void)
{
    return &grobo_i_lx16a_table;
}
