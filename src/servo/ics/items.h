/* SPDX-License-Identifier: MIT */
/*
 * The table of registers gives each value of a servo a place: 0 to 31 are its EEPROM, whose nibbles
 * are put together, and what follows are items of the commands READ and WRITE.
 */
#ifndef GROBO_CORE_ICS_ITEMS_H
#define GROBO_CORE_ICS_ITEMS_H

#include <grobo/core/ics.h>

#include "src/servo/item.h"

enum {
    GROBO_I_ICS_EEPROM_BYTES = 32,
    GROBO_I_ICS_FIXED = 0x5A, /* its first byte */
    GROBO_I_ICS_AT_FLAGS = 7,
    GROBO_I_ICS_AT_MAX = 8,
    GROBO_I_ICS_AT_MIN = 10,
    GROBO_I_ICS_AT_ID = 28,
    GROBO_I_ICS_AT_POSITION = 50,
    /* Bits of the flags. */
    GROBO_I_ICS_REVERSE = 0x01,
    GROBO_I_ICS_FREE = GROBO_ICS_FLAG_FREE,
    GROBO_I_ICS_ROTATION = 0x10,
    GROBO_I_ICS_SLAVE = 0x80,
    /* Of a reply to a position: with the goal that was sent. */
    GROBO_I_ICS_AT_GOAL = 0x4000
};

/* Of an item. */
#define GROBO_I_ICS_CODE(command, item) ((uint16_t)((command) << 8 | (item)))
#define GROBO_I_ICS_READ(name) GROBO_I_ICS_CODE(GROBO_ICS_READ, GROBO_ICS_##name)
#define GROBO_I_ICS_WRITE(name) GROBO_I_ICS_CODE(GROBO_ICS_WRITE, GROBO_ICS_##name)
extern const grobo_i_item grobo_i_ics_items[];

/* Two values of 7 bits each are one. */
static inline uint16_t grobo_i_ics_value(const uint8_t *p)
{
    return (uint16_t)(p[0] << 7 | p[1]);
}

/* Degrees of a reading of the temperature, and back. */
double grobo_i_ics_celsius(int raw);
int grobo_i_ics_raw_heat(double celsius);

#endif
