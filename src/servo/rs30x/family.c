/* SPDX-License-Identifier: MIT */
#include <grobo/core/board.h>

#include "src/servo/families.h"
#include "src/servo/tables.h"

static int init_board(grobo_driver *driver, const grobo_model *model)
{
    return grobo_rs30x_driver_init(driver, model, &grobo_i_board_protocol);
}

static int init_bus(grobo_driver *driver, const grobo_model *model)
{
    return grobo_rs30x_driver_init(driver, model, &grobo_i_rs30x_protocol);
}

const grobo_robot_family grobo_i_family_rs30x = {
    .name = "rs30x",
    .tables = {&grobo_i_rs30x_table},
    .baud_bps = 115200,
    .wiring = GROBO_WIRING_BUS,
    .fixed = true,
    .init = {[GROBO_WIRING_BOARD] = init_board, [GROBO_WIRING_BUS] = init_bus}};
