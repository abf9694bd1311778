/* SPDX-License-Identifier: MIT */
#include <grobo/ics.h>

#include "src/robots/robots.h"

static int init(grobo_driver *driver, const grobo_model *model, grobo_wiring wiring)
{
    return wiring == GROBO_WIRING_BUS ? grobo_ics_driver_init(driver, model)
                                      : GROBO_ERR_UNSUPPORTED;
}

static const grobo_servo_table *const tables[] = {&grobo_ics_table, NULL};

const grobo_robot_family grobo_i_family_ics = {
    .name = "ics", .tables = tables, .baud_bps = 115200, .wiring = GROBO_WIRING_BUS, .init = init};
