/* SPDX-License-Identifier: MIT */
/* The present values of a servo out of a block of its registers. */
#include <grobo/rs30x.h>

#include "core/bytes.h"

enum { VOLTAGE_UNIT_MV = 10 };

/* In the order of the bits GROBO_RS30X_HAS_... */
enum { TORQUE, POSITION, TIME, SPEED, CURRENT, TEMPERATURE, VOLTAGE, FIELDS };

static const struct {
    uint8_t address, bytes;
} fields[FIELDS] = {
    [TORQUE] = {GROBO_RS30X_TORQUE, 1},
    [POSITION] = {GROBO_RS30X_POSITION, 2},
    [TIME] = {GROBO_RS30X_TIME, 2},
    [SPEED] = {GROBO_RS30X_SPEED, 2},
    [CURRENT] = {GROBO_RS30X_CURRENT, 2},
    [VOLTAGE] = {GROBO_RS30X_VOLTAGE, 2},
    [TEMPERATURE] = {GROBO_RS30X_TEMPERATURE, 2},
};

int grobo_rs30x_state_decode(uint8_t address, const uint8_t *data, size_t n,
                             grobo_rs30x_state *state)
{
    static const uint8_t absent[2];
    const grobo_i_span block = {data, n};
    const uint8_t *at[FIELDS];
    int found = 0;
    unsigned has = 0;
    for (int i = 0; i < FIELDS; i++) {
        at[i] = absent;
        const uint8_t *field = NULL;
        if (fields[i].address >= address) {
            field = grobo_i_span_at(block, (size_t)(fields[i].address - address), fields[i].bytes);
        }
        if (field != NULL) {
            at[i] = field;
            has |= 1u << i;
            found++;
        }
    }
    state->torque = at[TORQUE][0];
    state->pos_ddeg = grobo_i_get_i16(at[POSITION]);
    state->time_cs = grobo_i_get_u16(at[TIME]);
    state->speed_dps = grobo_i_get_i16(at[SPEED]);
    state->current_ma = grobo_i_get_u16(at[CURRENT]);
    state->temperature_c = grobo_i_get_i16(at[TEMPERATURE]);
    state->voltage_mv = (uint32_t)grobo_i_get_u16(at[VOLTAGE]) * VOLTAGE_UNIT_MV;
    state->has = (uint8_t)has;
    return found;
}
