/* SPDX-License-Identifier: MIT */
/* A driver for servos without registers: one frame for one servo, one item a frame. */
#ifndef GROBO_CORE_TABLE_ITEMS_H
#define GROBO_CORE_TABLE_ITEMS_H

#include "src/servo/item.h"
#include "src/servo/table/family.h"

typedef struct grobo_i_items {
    grobo_i_family family; /* the first: what `family` of a driver points to */
    const grobo_i_item *items;
    /* What each grobo_sense_kind reads, one after the other, 0 behind the last. The setup comes
     * before the angle, so that a joint whose servo is set up otherwise is never sensed. */
    const uint16_t *senses[GROBO_SENSE_ALL + 1];
    const uint16_t *wheel_goal; /* of a wheel, in place of GROBO_SENSE_GOAL */
    uint16_t check;             /* what every servo answers */
    /* Fill a whole exchange. */
    int (*read)(const grobo_driver *self, uint8_t id, uint16_t code, grobo_exchange *exchange);
    int (*write)(const grobo_driver *self, const grobo_register_io *io, uint16_t code,
                 grobo_exchange *exchange);
    int (*torque)(const grobo_driver *self, int joint, bool on, grobo_exchange *exchange);
    /* Of writing an item; data NULL: whatever the value. */
    grobo_write_kind (*kind)(uint16_t code, const uint8_t *data);
} grobo_i_items;

/* Completes a driver that has posture, parse and inspect. As grobo_i_table_make(). */
int grobo_i_items_make(grobo_driver *made, const grobo_model *model, const grobo_protocol *protocol,
                       const grobo_i_items *items);

#endif
