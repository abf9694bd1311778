/* SPDX-License-Identifier: MIT */
/* Values of Kondo KRS servos, by addresses of this library, and models. EEPROM: the ICS3.5 Software
 * Manual; speeds, torques and currents: from the maker's shop, by memory. */
#include "src/servo/ics/items.h"
#include "src/servo/row.h"

enum { ICS35 = 1, ICS36 = 2, ALL = ICS35 | ICS36 };
static const grobo_servo_register rows[] = {
    ROW("fixed", 0, 1, 0, E, NONE, "", 0, 255, GROBO_I_ICS_FIXED, ALL),
    ROW("stretch", 1, 1, 0, EW, NONE, "", 2, 254, 60, ALL),
    ROW("speed", 2, 1, 0, EW, NONE, "", 1, 127, 127, ALL),
    ROW("punch", 3, 1, 0, EW, NONE, "", 0, 10, 1, ALL),
    ROW("dead_band", 4, 1, 0, EW, NONE, "", 0, 10, 2, ALL),
    ROW("damping", 5, 1, 0, EW, NONE, "", 1, 255, 40, ALL),
    ROW("safe_timer", 6, 1, 0, EW, NONE, "0.056 s", 10, 255, 250, ALL),
    ROW("flags", 7, 1, 0, EW, DIRECTION, "bits", 0, 255, 4, ALL),
    ROW("max_position", 8, 2, 0, EW, MAX_POSITION, "0.03375 deg", 3500, 11500, 11500, ALL),
    ROW("min_position", 10, 2, 0, EW, MIN_POSITION, "0.03375 deg", 3500, 11500, 3500, ALL),
    ROW("baud", 13, 1, 0, EW, BAUD, "code", 0, 10, 10, ALL),
    ROW("temperature_limit", 14, 1, 0, EW, TEMPERATURE_LIMIT, "", 1, 127, 80, ALL),
    ROW("current_limit", 15, 1, 0, EW, CURRENT_LIMIT, "100 mA", 1, 63, 63, ALL),
    ROW("response", 25, 1, 0, EW, NONE, "", 1, 5, 3, ALL),
    ROW("offset", 26, 1, 1, EW, OFFSET, "", -127, 127, 0, ALL),
    ROW("id", 28, 1, 0, EW, ID, "", 0, 31, 0, ALL),
    ROW("stretch_1", 29, 1, 0, EW, NONE, "", 2, 254, 120, ALL),
    ROW("stretch_2", 30, 1, 0, EW, NONE, "", 2, 254, 60, ALL),
    ROW("stretch_3", 31, 1, 0, EW, NONE, "", 2, 254, 254, ALL),
    ROW("torque", 40, 1, 0, W, TORQUE, "", 0, 1, 0, ALL),
    ROW("stretch_now", 41, 1, 0, W, NONE, "", 1, 127, 30, ALL),
    ROW("speed_now", 42, 1, 0, W, SPEED, "", 1, 127, 127, ALL),
    ROW("current_limit_now", 43, 1, 0, W, TORQUE_LIMIT, "100 mA", 1, 63, 63, ALL),
    ROW("temperature_limit_now", 44, 1, 0, W, NONE, "", 1, 127, 80, ALL),
    ROW("goal_position", 46, 2, 0, W, GOAL, "0.03375 deg", 3500, 11500, 7500, ALL),
    ROW("current", 48, 1, 6, R, CURRENT, "100 mA", -63, 63, 0, ALL),
    ROW("temperature", 49, 1, 0, R, TEMPERATURE, "", 0, 127, 0, ALL),
    ROW("present_position", 50, 2, 0, R, POSITION, "0.03375 deg", 0, 16383, 0, ALL),
};

/* The servos do not tell which they are: these numbers are the library's. */
#define MODEL(name, number, dps, mnm, ma, mv, version)                                             \
    {                                                                                              \
        name, number, 8000, 270, GROBO_ICS_POSITION_MIDDLE, dps, mnm, ma, mv, version, 0,          \
            &grobo_ics_table                                                                       \
    }

static const grobo_servo_model models[] = {
    MODEL("KRS-3301", 3301, 500, 600, 1200, 7400, ICS36),
    MODEL("KRS-6003R2HV", 6003, 273, 6500, 5000, 11100, ICS36),
    MODEL("KRS-2552RHV", 2552, 429, 1370, 2000, 11100, ICS35),
    MODEL("KRS-2572HV", 2572, 462, 2450, 2500, 11100, ICS35),
    MODEL("KRS-3304", 3304, 462, 1370, 1800, 7400, ICS35),
    MODEL("KRS-4034HV", 4034, 353, 4090, 4000, 11100, ICS35),
};

#undef MODEL

static const grobo_servo_rate rates[] = {{0, ALL, 1250000}, {1, ALL, 625000}, {10, ALL, 115200}};

const grobo_servo_table grobo_ics_table = {
    .name = "Kondo KRS",
    LIST(registers, register_count, rows),
    LIST(models, model_count, models),
    LIST(rates, rate_count, rates),
    .big_endian = true,
};

bool grobo_ics_tells_position(const grobo_servo_model *servo)
{
    return servo != NULL && servo->table == &grobo_ics_table && servo->group == ICS36;
}

const grobo_i_item grobo_i_ics_items[] = {
    {0, GROBO_I_ICS_EEPROM_BYTES, GROBO_I_ICS_WRITE(EEPROM), GROBO_I_ICS_READ(EEPROM)},
    {41, 1, GROBO_I_ICS_WRITE(STRETCH), GROBO_I_ICS_READ(STRETCH)},
    {42, 1, GROBO_I_ICS_WRITE(SPEED), GROBO_I_ICS_READ(SPEED)},
    {43, 1, GROBO_I_ICS_WRITE(CURRENT), 0},
    {44, 1, GROBO_I_ICS_WRITE(TEMPERATURE), 0},
    {48, 1, 0, GROBO_I_ICS_READ(CURRENT)},
    {49, 1, 0, GROBO_I_ICS_READ(TEMPERATURE)},
    {50, 2, 0, GROBO_I_ICS_READ(POSITION_ITEM)},
    {0, 0, 0, 0},
};

/* Small is hot. Between 30 and 87 as the manual prints it (another table of the maker's is some
 * degrees off), to the ends as rcb4 goes on. */
static const struct {
    int raw;
    double celsius;
} heat[] = {{0, 118}, {30, 100}, {47, 90}, {60, 80}, {75, 70}, {87, 60}, {127, 26.7}};
enum { HEATS = sizeof heat / sizeof heat[0] };

double grobo_i_ics_celsius(int raw)
{
    int i = 1;
    while (i < HEATS - 1 && heat[i].raw < raw) {
        i++;
    }
    return heat[i - 1].celsius + (raw - heat[i - 1].raw) * (heat[i].celsius - heat[i - 1].celsius) /
                                     (heat[i].raw - heat[i - 1].raw);
}

int grobo_i_ics_raw_heat(double celsius)
{
    int raw = 0;
    while (raw < 127 && grobo_i_ics_celsius(raw) > celsius) {
        raw++;
    }
    return raw;
}
