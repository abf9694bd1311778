/* SPDX-License-Identifier: MIT */
#include <grobo/feetech.h>

#include "src/robots/robots.h"

static int init(grobo_driver *driver, const grobo_model *model, grobo_wiring wiring)
{
    return wiring == GROBO_WIRING_BUS ? grobo_feetech_driver_init(driver, model)
                                      : GROBO_ERR_UNSUPPORTED;
}

static const grobo_servo_table *const tables[] = {&grobo_sts_table, &grobo_scs_table, NULL};

const grobo_robot_family grobo_i_family_feetech = {.name = "feetech",
                                                   .tables = tables,
                                                   .baud_bps = 1000000,
                                                   .wiring = GROBO_WIRING_BUS,
                                                   .init = init};
