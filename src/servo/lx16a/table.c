/* SPDX-License-Identifier: MIT */
/* Values of LewanSoul and Hiwonder servos, by addresses of this library, and models. Ranges and
 * defaults: the maker's protocol; speeds, torques and currents: from shops, nothing measured. */
#include "src/servo/lx16a/items.h"
#include "src/servo/row.h"

enum { ALL = 1 };

static const grobo_servo_register rows[] = {
    ROW("id", 0, 1, 0, EW, ID, "", 0, 253, 1, ALL),
    ROW("offset", 1, 1, 1, EW, OFFSET, "0.24 deg", -125, 125, 0, ALL),
    ROW("min_position", 2, 2, 0, EW, MIN_POSITION, "0.24 deg", 0, 1000, 0, ALL),
    ROW("max_position", 4, 2, 0, EW, MAX_POSITION, "0.24 deg", 0, 1000, 1000, ALL),
    ROW("min_voltage", 6, 2, 0, EW, MIN_VOLTAGE, "0.001 V", 4500, 12000, 4500, ALL),
    ROW("max_voltage", 8, 2, 0, EW, MAX_VOLTAGE, "0.001 V", 4500, 12000, 12000, ALL),
    ROW("temperature_limit", 10, 1, 0, EW, TEMPERATURE_LIMIT, "deg C", 50, 100, 85, ALL),
    ROW("led_alarm", 11, 1, 0, EW, NONE, "bits", 0, 7, 7, ALL),
    ROW("led_off", 12, 1, 0, EW, NONE, "", 0, 1, 0, ALL),
    ROW("torque", 16, 1, 0, W, TORQUE, "", 0, 1, 0, ALL),
    ROW("mode", 17, 1, 0, W, MODE, "", 0, 1, 0, ALL),
    ROW("mode_speed", 19, 2, 1, W, GOAL_SPEED, "0.1 %", -1000, 1000, 0, ALL),
    ROW("goal_position", 21, 2, 0, W, GOAL, "0.24 deg", 0, 1000, 0, ALL),
    ROW("goal_time", 23, 2, 0, W, GOAL_TIME, "1 ms", 0, 30000, 0, ALL),
    ROW("next_position", 25, 2, 0, W, NONE, "0.24 deg", 0, 1000, 0, ALL),
    ROW("next_time", 27, 2, 0, W, NONE, "1 ms", 0, 30000, 0, ALL),
    ROW("temperature", 29, 1, 0, R, TEMPERATURE, "deg C", 0, 255, 0, ALL),
    ROW("voltage", 30, 2, 0, R, VOLTAGE, "0.001 V", 0, 65535, 0, ALL),
    ROW("present_position", 32, 2, 1, R, POSITION, "0.24 deg", -32768, 32767, 0, ALL),
};

/* The servos do not tell which they are: these numbers are the library's. */
#define MODEL(name, number, dps, mnm, ma, mv)                                                      \
    {                                                                                              \
        name, number, 1000, 240, 500, dps, mnm, ma, mv, ALL, 0, &grobo_lx16a_table                 \
    }

static const grobo_servo_model models[] = {
    MODEL("LX-16A", 16, 375, 1670, 1000, 7400),
    MODEL("LX-15D", 15, 375, 1670, 1000, 7400),
    MODEL("LX-224", 224, 300, 1960, 1000, 7400),
    MODEL("HTS-35H", 35, 333, 3430, 3000, 11100),
};

#undef MODEL

const grobo_servo_table grobo_lx16a_table = {
    .name = "Hiwonder LX",
    LIST(registers, register_count, rows),
    LIST(models, model_count, models),
};

const grobo_i_item grobo_i_lx16a_items[] = {
    {0, 1, GROBO_LX16A_ID, GROBO_LX16A_ID_READ},
    {1, 1, GROBO_LX16A_OFFSET, GROBO_LX16A_OFFSET_READ},
    {2, 4, GROBO_LX16A_LIMITS, GROBO_LX16A_LIMITS_READ},
    {6, 4, GROBO_LX16A_VOLTAGES, GROBO_LX16A_VOLTAGES_READ},
    {10, 1, GROBO_LX16A_HEAT, GROBO_LX16A_HEAT_READ},
    {11, 1, GROBO_LX16A_ALARM, GROBO_LX16A_ALARM_READ},
    {12, 1, GROBO_LX16A_LED, GROBO_LX16A_LED_READ},
    {16, 1, GROBO_LX16A_LOAD, GROBO_LX16A_LOAD_READ},
    {17, 4, GROBO_LX16A_MODE, GROBO_LX16A_MODE_READ},
    {21, 4, GROBO_LX16A_MOVE, GROBO_LX16A_MOVE_READ},
    {25, 4, GROBO_LX16A_WAIT, GROBO_LX16A_WAIT_READ},
    {29, 1, 0, GROBO_LX16A_TEMPERATURE_READ},
    {30, 2, 0, GROBO_LX16A_VOLTAGE_READ},
    {32, 2, 0, GROBO_LX16A_POSITION_READ},
    {0, 0, 0, 0},
};
