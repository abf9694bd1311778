/* SPDX-License-Identifier: MIT */
/* The present values of a servo out of a block of its registers. */
#include <string.h>

#include <grobo/core/rs30x.h>

#include "src/base/bytes.h"

enum { VOLTAGE_UNIT_MV = 10 };

/* In the order of the bits GROBO_RS30X_HAS_..., and of their addresses. */
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

/* The registers that matter, those that were not read being 0. */
enum { WINDOW_AT = GROBO_RS30X_TORQUE, WINDOW_BYTES = GROBO_RS30X_VOLTAGE + 2 - WINDOW_AT };

int grobo_rs30x_state_decode(uint8_t address, const uint8_t *data, size_t n,
                             grobo_rs30x_state *state)
{
    if ((data == NULL && n > 0) || state == NULL) {
        return GROBO_ERR_ARG;
    }
    uint8_t window[WINDOW_BYTES] = {0};
    int found = 0;
    unsigned has = 0;
    for (int i = 0; i < FIELDS; i++) {
        int at = fields[i].address - address;
        if (at < 0) {
            continue;
        }
        if ((size_t)at + fields[i].bytes > n) {
            break; /* and so are those behind it */
        }
        memcpy(&window[fields[i].address - WINDOW_AT], data + at, fields[i].bytes);
        has |= 1u << i;
        found++;
    }
    state->torque = window[GROBO_RS30X_TORQUE - WINDOW_AT];
    state->pos_ddeg = grobo_i_get_i16(&window[GROBO_RS30X_POSITION - WINDOW_AT]);
    state->time_cs = grobo_i_get_u16(&window[GROBO_RS30X_TIME - WINDOW_AT]);
    state->speed_dps = grobo_i_get_i16(&window[GROBO_RS30X_SPEED - WINDOW_AT]);
    state->current_ma = grobo_i_get_u16(&window[GROBO_RS30X_CURRENT - WINDOW_AT]);
    state->temperature_c = grobo_i_get_i16(&window[GROBO_RS30X_TEMPERATURE - WINDOW_AT]);
    state->voltage_mv =
        (uint32_t)grobo_i_get_u16(&window[GROBO_RS30X_VOLTAGE - WINDOW_AT]) * VOLTAGE_UNIT_MV;
    state->has = (uint8_t)has;
    return found;
}
