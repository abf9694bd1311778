/* SPDX-License-Identifier: MIT */
#include <grobo/core/dxl2.h>

#include "src/servo/families.h"
#include "src/servo/tables.h"

const grobo_robot_family grobo_i_family_dynamixel2 = {
    .name = "dynamixel2",
    .tables = {&grobo_i_dxl2_table},
    .baud_bps = 57600,
    .wiring = GROBO_WIRING_BUS,
    .init = {[GROBO_WIRING_BUS] = grobo_dxl2_driver_init}};
