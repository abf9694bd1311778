/* SPDX-License-Identifier: MIT */
#include <grobo/core/feetech.h>

#include "src/servo/families.h"
#include "src/servo/tables.h"

const grobo_robot_family grobo_i_family_feetech = {
    .name = "feetech",
    .tables = {&grobo_i_sts_table, &grobo_i_scs_table},
    .baud_bps = 1000000,
    .wiring = GROBO_WIRING_BUS,
    .init = {[GROBO_WIRING_BUS] = grobo_feetech_driver_init}};
