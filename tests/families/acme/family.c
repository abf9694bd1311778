/* SPDX-License-Identifier: MIT */
/* What a robot's file names. */
#include "src/servo/acme/acme.h"
#include "src/servo/families.h"

const grobo_robot_family grobo_i_family_acme = {
    .name = "acme",
    .tables = {&grobo_i_acme_table},
    .baud_bps = 250000,
    .wiring = GROBO_WIRING_BUS,
    .init = {[GROBO_WIRING_BUS] = grobo_i_acme_driver_init}};
