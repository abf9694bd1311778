/* SPDX-License-Identifier: MIT */
#include <grobo/lx16a.h>

#include "src/robots/robots.h"

static int init(grobo_driver *driver, const grobo_model *model, grobo_wiring wiring)
{
    return wiring == GROBO_WIRING_BUS ? grobo_lx16a_driver_init(driver, model)
                                      : GROBO_ERR_UNSUPPORTED;
}

static const grobo_servo_table *const tables[] = {&grobo_lx16a_table, NULL};

const grobo_robot_family grobo_i_family_lx16a = {.name = "lx16a",
                                                 .tables = tables,
                                                 .baud_bps = 115200,
                                                 .wiring = GROBO_WIRING_BUS,
                                                 .init = init};
