/* SPDX-License-Identifier: MIT */
/*
 * These servos have no registers: a command writes a value, another reads it. The table of
 * registers gives each value a place in the order of its command's parameters, so that a run of
 * registers is one item, and its bytes are the parameters.
 */
#ifndef GROBO_CORE_LX16A_ITEMS_H
#define GROBO_CORE_LX16A_ITEMS_H

#include <grobo/lx16a.h>

/* What goes in one frame. */
typedef struct grobo_i_lx16a_item {
    uint8_t address, bytes; /* of grobo_lx16a_table */
    uint8_t write, read;    /* grobo_lx16a_code; 0: none */
} grobo_i_lx16a_item;

/* The item number k, NULL behind the last. */
const grobo_i_lx16a_item *grobo_i_lx16a_item_row(unsigned k);
/* The item that a command writes or reads; NULL: none. */
const grobo_i_lx16a_item *grobo_i_lx16a_item_of(uint8_t command);
/* The item that is these registers; NULL: they are none, or not all of one. */
const grobo_i_lx16a_item *grobo_i_lx16a_item_at(unsigned address, unsigned bytes);

#endif
