/* SPDX-License-Identifier: MIT */
/* A row of a register table, in the order in which people read it. */
#ifndef GROBO_CORE_SERVO_ROW_H
#define GROBO_CORE_SERVO_ROW_H

#include <grobo/core/registers.h>

/* Flags of a row: what is measured, what may be written, what is kept, both. */
enum { R = 0, W = GROBO_REGISTER_W, E = GROBO_REGISTER_KEPT, EW = W | E };

#define ROW(name, address, bytes, sign, flags, role, unit, min, max, factory, set)                 \
    {                                                                                              \
        name, unit, (min), (max), (factory), (address), (bytes), (sign), (flags),                  \
            GROBO_ROLE_##role, (set)                                                               \
    }

/* A list of a table, and how long it is. */
#define LIST(field, count, list) .field = (list), .count = sizeof(list) / sizeof(list)[0]

#endif
