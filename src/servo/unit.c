/* SPDX-License-Identifier: MIT */
/* Reads the unit of a register, a text of its table, as a number. */
#include "src/servo/unit.h"

/* The number, and what it is of: of "0.229 rpm" 6 * 0.229 deg/s, of "0.1 V" 100 mV. */
double grobo_i_register_unit(const grobo_servo_register *reg)
{
    double value = 0;
    double place = 0;
    const char *at = reg->unit;
    for (; (*at >= '0' && *at <= '9') || *at == '.'; at++) {
        if (*at == '.') {
            place = 1;
        } else {
            place /= 10;
            value = place > 0 ? value + place * (*at - '0') : value * 10 + (*at - '0');
        }
    }
    if (at[0] != ' ') {
        return value;
    }
    return value * (at[1] == 'r' ? 6 : at[1] == 'V' ? 1000 : 1);
}

int32_t grobo_i_first_tick(const grobo_servo_model *servo)
{
    return servo->span_deg >= 360 ? servo->middle - (int32_t)servo->span_ticks / 2 : 0;
}
