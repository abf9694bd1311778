/* SPDX-License-Identifier: MIT */
#include <grobo/core/dxl1.h>

#include "src/servo/families.h"
#include "src/servo/tables.h"

const grobo_robot_family grobo_i_family_dynamixel1 = {
    .name = "dynamixel1",
    .tables = {&grobo_i_dxl1_table},
    .baud_bps = 1000000,
    .wiring = GROBO_WIRING_BUS,
    .init = {[GROBO_WIRING_BUS] = grobo_dxl1_driver_init}};
