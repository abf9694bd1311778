/* SPDX-License-Identifier: MIT */
/* Registers and models. */
#include "src/servo/acme/acme.h"
#include "src/servo/row.h"

static const grobo_servo_register rows[] = {
    ROW("model", 0, 2, 0, E, MODEL, "", 0, 65535, 0, 0),
    ROW("firmware", 2, 1, 0, E, FIRMWARE, "", 0, 255, 0, 0),
    ROW("id", 3, 1, 0, EW, ID, "", 0, ACME_ID_MAX, 1, 0),
    ROW("baud", 4, 1, 0, EW, BAUD, "code", 0, 1, 0, 0),
    ROW("return_delay", 5, 1, 0, EW, RETURN_DELAY, "2 us", 0, 254, 50, 0),
    ROW("min_position", 6, 2, 0, EW, MIN_POSITION, "0.1 deg", 0, 3000, 0, 0),
    ROW("max_position", 8, 2, 0, EW, MAX_POSITION, "0.1 deg", 0, 3000, 3000, 0),
    ROW("temperature_limit", 10, 1, 0, EW, TEMPERATURE_LIMIT, "deg C", 0, 100, 70, 0),
    ROW("min_voltage", 11, 1, 0, EW, MIN_VOLTAGE, "0.1 V", 0, 255, 60, 0),
    ROW("max_voltage", 12, 1, 0, EW, MAX_VOLTAGE, "0.1 V", 0, 255, 90, 0),
    ROW("torque", 16, 1, 0, W, TORQUE, "", 0, 1, 0, 0),
    ROW("goal_position", 18, 2, 0, W, GOAL, "0.1 deg", 0, 3000, 1500, 0),
    ROW("goal_time", 20, 2, 0, W, GOAL_TIME, "1 ms", 0, 30000, 0, 0),
    ROW("present_position", 24, 2, 0, R, POSITION, "0.1 deg", 0, 3000, 0, 0),
    ROW("present_speed", 26, 2, 1, R, PRESENT_SPEED, "0.1 deg/s", -32768, 32767, 0, 0),
    ROW("voltage", 28, 1, 0, R, VOLTAGE, "0.1 V", 0, 255, 0, 0),
    ROW("temperature", 29, 1, 0, R, TEMPERATURE, "deg C", 0, 255, 0, 0),
    ROW("error", 30, 1, 0, R, ERROR, "bits", 0, 255, 0, 0),
    ROW("moving", 31, 1, 0, R, MOVING, "", 0, 1, 0, 0),
};

static const grobo_servo_model models[] = {
    {"ACME-1", 11, 3000, 300, 1500, 360, 1500, 1000, 7400, 1, 0, &grobo_i_acme_table, NULL, 0, 0},
    {"ACME-2", 12, 3000, 300, 1500, 300, 3000, 2000, 7400, 1, 0, &grobo_i_acme_table, NULL, 0, 0},
};

static const grobo_servo_rate rates[] = {{0, 0, 250000}, {1, 0, 115200}};

static const uint64_t sets[] = {0x3};

const grobo_servo_table grobo_i_acme_table = {
    .name = "Acme",
    LIST(registers, register_count, rows),
    LIST(models, model_count, models),
    LIST(rates, rate_count, rates),
    .sets = sets,
    .keeps = GROBO_KEEPS_LIMP,
};
