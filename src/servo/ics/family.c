/* SPDX-License-Identifier: MIT */
#include <grobo/core/ics.h>

#include "src/servo/families.h"
#include "src/servo/tables.h"

const grobo_robot_family grobo_i_family_ics = {
    .name = "ics",
    .tables = {&grobo_i_ics_table},
    .baud_bps = 115200,
    .wiring = GROBO_WIRING_BUS,
    .fixed = true,
    .init = {[GROBO_WIRING_BUS] = grobo_ics_driver_init}};
