/* SPDX-License-Identifier: MIT */
/* Values of Kondo KRS servos, by addresses of this library: what carries them on the wire, and the
 * scale of temperatures. Registers and models are in table.c. */
#include "src/servo/ics/items.h"
#include "src/servo/tables.h"

enum { ICS36 = 36 };

bool grobo_ics_tells_position(const grobo_servo_model *servo)
{
    return grobo_servo_series(servo) == &grobo_i_ics_table && servo->firmware == ICS36;
}

const grobo_i_item grobo_i_ics_items[] = {
    {0, GROBO_I_ICS_EEPROM_BYTES, GROBO_I_ICS_WRITE(EEPROM), GROBO_I_ICS_READ(EEPROM)},
    {41, 1, GROBO_I_ICS_WRITE(STRETCH), GROBO_I_ICS_READ(STRETCH)},
    {42, 1, GROBO_I_ICS_WRITE(SPEED), GROBO_I_ICS_READ(SPEED)},
    {43, 1, GROBO_I_ICS_WRITE(CURRENT), 0},
    {44, 1, GROBO_I_ICS_WRITE(TEMPERATURE), 0},
    {48, 1, 0, GROBO_I_ICS_READ(CURRENT)},
    {49, 1, 0, GROBO_I_ICS_READ(TEMPERATURE)},
    {GROBO_I_ICS_AT_POSITION, 2, 0, GROBO_I_ICS_READ(POSITION_ITEM)},
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
