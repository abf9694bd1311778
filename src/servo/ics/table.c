/* SPDX-License-Identifier: MIT */
/* Made from src/servo/models/ics by `make servos`: registers and models. */
#include <grobo/core/ics.h>

#include "src/servo/row.h"
#include "src/servo/tables.h"

static const grobo_servo_register rows[] = {
    ROW("fixed", 0, 1, 0, E, NONE, "", 0, 255, 90, 0),
    ROW("stretch", 1, 1, 0, EW, NONE, "", 2, 254, 60, 0),
    ROW("speed", 2, 1, 0, EW, NONE, "", 1, 127, 127, 0),
    ROW("punch", 3, 1, 0, EW, NONE, "", 0, 10, 1, 0),
    ROW("dead_band", 4, 1, 0, EW, NONE, "", 0, 10, 2, 0),
    ROW("damping", 5, 1, 0, EW, NONE, "", 1, 255, 40, 0),
    ROW("safe_timer", 6, 1, 0, EW, NONE, "0.056 s", 10, 255, 250, 0),
    ROW("flags", 7, 1, 0, EW, DIRECTION, "bits", 0, 255, 4, 0),
    ROW("max_position", 8, 2, 0, EW, MAX_POSITION, "0.03375 deg", 3500, 11500, 11500, 0),
    ROW("min_position", 10, 2, 0, EW, MIN_POSITION, "0.03375 deg", 3500, 11500, 3500, 0),
    ROW("baud", 13, 1, 0, EW, BAUD, "code", 0, 10, 10, 0),
    ROW("temperature_limit", 14, 1, 0, EW, TEMPERATURE_LIMIT, "", 1, 127, 80, 0),
    ROW("current_limit", 15, 1, 0, EW, CURRENT_LIMIT, "100 mA", 1, 63, 63, 0),
    ROW("response", 25, 1, 0, EW, NONE, "", 1, 5, 3, 0),
    ROW("offset", 26, 1, 1, EW, OFFSET, "", -127, 127, 0, 0),
    ROW("id", 28, 1, 0, EW, ID, "", 0, 31, 0, 0),
    ROW("stretch_1", 29, 1, 0, EW, NONE, "", 2, 254, 120, 0),
    ROW("stretch_2", 30, 1, 0, EW, NONE, "", 2, 254, 60, 0),
    ROW("stretch_3", 31, 1, 0, EW, NONE, "", 2, 254, 254, 0),
    ROW("torque", 40, 1, 0, W, TORQUE, "", 0, 1, 0, 0),
    ROW("stretch_now", 41, 1, 0, W, NONE, "", 1, 127, 30, 0),
    ROW("speed_now", 42, 1, 0, W, SPEED, "", 1, 127, 127, 0),
    ROW("current_limit_now", 43, 1, 0, W, TORQUE_LIMIT, "100 mA", 1, 63, 63, 0),
    ROW("temperature_limit_now", 44, 1, 0, W, NONE, "", 1, 127, 80, 0),
    ROW("goal_position", 46, 2, 0, W, GOAL, "0.03375 deg", 3500, 11500, 7500, 0),
    ROW("current", 48, 1, 6, R, CURRENT, "100 mA", -63, 63, 0, 0),
    ROW("temperature", 49, 1, 0, R, TEMPERATURE, "", 0, 127, 0, 0),
    ROW("present_position", 50, 2, 0, R, POSITION, "0.03375 deg", 0, 16383, 0, 1),
};

static const grobo_servo_model models[] = {
    {"KRS-3301", 3301, 8000, 270, 7500, 500, 600, 1200, 7400, 36, GROBO_MODEL_UNVERIFIED,
     &grobo_i_ics_table, NULL, 0, 0},
    {"KRS-6003R2HV", 6003, 8000, 270, 7500, 273, 6500, 5000, 11100, 36, GROBO_MODEL_UNVERIFIED,
     &grobo_i_ics_table, NULL, 0, 0},
    {"KRS-2552RHV", 2552, 8000, 270, 7500, 429, 1370, 2000, 11100, 35,
     GROBO_MODEL_NO_JOINT | GROBO_MODEL_UNVERIFIED, &grobo_i_ics_table, NULL, 0, 0},
    {"KRS-2572HV", 2572, 8000, 270, 7500, 462, 2450, 2500, 11100, 35,
     GROBO_MODEL_NO_JOINT | GROBO_MODEL_UNVERIFIED, &grobo_i_ics_table, NULL, 0, 0},
    {"KRS-3304", 3304, 8000, 270, 7500, 462, 1370, 1800, 7400, 35,
     GROBO_MODEL_NO_JOINT | GROBO_MODEL_UNVERIFIED, &grobo_i_ics_table, NULL, 0, 0},
    {"KRS-4034HV", 4034, 8000, 270, 7500, 353, 4090, 4000, 11100, 35,
     GROBO_MODEL_NO_JOINT | GROBO_MODEL_UNVERIFIED, &grobo_i_ics_table, NULL, 0, 0},
    {"KRS-3304R2", 3305, 8000, 270, 7500, 462, 1360, 2000, 7400, 36, GROBO_MODEL_UNVERIFIED,
     &grobo_i_ics_table, NULL, 0, 0},
    {"KRS-2552R2HV", 2553, 8000, 270, 7500, 429, 1370, 2000, 11100, 36, GROBO_MODEL_UNVERIFIED,
     &grobo_i_ics_table, NULL, 0, 0},
    {"KRS-4034R2HV", 4035, 8000, 270, 7500, 353, 4090, 4000, 11100, 36, GROBO_MODEL_UNVERIFIED,
     &grobo_i_ics_table, NULL, 0, 0},
    {"KRS-ANY", 0, 8000, 270, 7500, 1, 1, 1, 11100, 35,
     GROBO_MODEL_NO_JOINT | GROBO_MODEL_UNVERIFIED, &grobo_i_ics_table, NULL, 0, 0},
};

static const grobo_servo_rate rates[] = {
    {0, 0, 1250000},
    {1, 0, 625000},
    {10, 0, 115200},
};

static const uint64_t sets[] = {
    0x3FF,
    0x1C3,
};

const grobo_servo_table grobo_i_ics_table = {
    .name = "Kondo KRS",
    LIST(registers, register_count, rows),
    LIST(models, model_count, models),
    LIST(rates, rate_count, rates),
    .sets = sets,
    .keeps = GROBO_KEEPS_LIMP,
    .big_endian = true,
};

const grobo_servo_table *grobo_ics_table(void)
{
    return &grobo_i_ics_table;
}
