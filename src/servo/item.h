/* SPDX-License-Identifier: MIT */
/*
 * Servos without registers: a command writes a value, another reads it. The table of registers
 * gives each value a place in the order of its command's parameters, so that a run of registers is
 * one item, and its bytes are the parameters.
 */
#ifndef GROBO_CORE_SERVO_ITEM_H
#define GROBO_CORE_SERVO_ITEM_H

#include <stdint.h>

/* What goes in one frame. A list ends with one without bytes. */
typedef struct grobo_i_item {
    uint8_t address, bytes; /* of the table of registers */
    uint16_t write, read;   /* the family's codes; 0: none */
} grobo_i_item;

/* The item that a code writes or reads; NULL: none. */
const grobo_i_item *grobo_i_item_of(const grobo_i_item *items, uint16_t code);
/* The item that is these registers; NULL: they are none, or not all of one. */
const grobo_i_item *grobo_i_item_at(const grobo_i_item *items, unsigned address, unsigned bytes);

#endif
