/* SPDX-License-Identifier: MIT */
#include <grobo/core/lx16a.h>

#include "src/servo/families.h"
#include "src/servo/tables.h"

const grobo_robot_family grobo_i_family_lx16a = {
    .name = "lx16a",
    .tables = {&grobo_i_lx16a_table},
    .baud_bps = 115200,
    .wiring = GROBO_WIRING_BUS,
    .fixed = true,
    .init = {[GROBO_WIRING_BUS] = grobo_lx16a_driver_init}};
