/* SPDX-License-Identifier: MIT */
#include <grobo/dxl2.h>

#include "src/robots/robots.h"

static int init(grobo_driver *driver, const grobo_model *model, grobo_wiring wiring)
{
    return wiring == GROBO_WIRING_BUS ? grobo_dxl2_driver_init(driver, model)
                                      : GROBO_ERR_UNSUPPORTED;
}

static const grobo_servo_table *const tables[] = {&grobo_dxl2_table, NULL};

const grobo_robot_family grobo_i_family_dynamixel2 = {.name = "dynamixel2",
                                                      .tables = tables,
                                                      .baud_bps = 57600,
                                                      .wiring = GROBO_WIRING_BUS,
                                                      .init = init};
