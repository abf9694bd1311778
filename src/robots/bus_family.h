/* SPDX-License-Identifier: MIT */
/* A family of servos on a bus. Each is a file of its own, and linked where a robot names it. */
#ifndef GROBO_ROBOTS_BUS_FAMILY_H
#define GROBO_ROBOTS_BUS_FAMILY_H

#include "src/robots/robots.h"

/* of: the family; fill: grobo_..._driver_init(); and its tables. */
#define GROBO_I_BUS_FAMILY(of, text, fill, bps, ...)                                               \
    static int init(grobo_driver *driver, const grobo_model *model, grobo_wiring wiring)           \
    {                                                                                              \
        return wiring == GROBO_WIRING_BUS ? fill(driver, model) : GROBO_ERR_UNSUPPORTED;           \
    }                                                                                              \
    static const grobo_servo_table *const tables[] = {__VA_ARGS__, NULL};                          \
    const grobo_robot_family of = {.name = (text),                                                 \
                                   .tables = tables,                                               \
                                   .baud_bps = (bps),                                              \
                                   .wiring = GROBO_WIRING_BUS,                                     \
                                   .init = init}

#endif
