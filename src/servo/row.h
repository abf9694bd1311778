/* SPDX-License-Identifier: MIT */
/* A row of a register table, in the order in which people read it. */
#ifndef GROBO_CORE_SERVO_ROW_H
#define GROBO_CORE_SERVO_ROW_H

#include <grobo/registers.h>

#define ROW(name, address, bytes, sign, flags, role, unit, min, max, factory, groups)              \
    {                                                                                              \
        name, unit, (min), (max), (factory), (address), (bytes), (sign), (flags),                  \
            GROBO_ROLE_##role, (groups)                                                            \
    }

#endif
