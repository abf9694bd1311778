/* SPDX-License-Identifier: MIT */
#include <grobo/board.h>

#include "src/robots/robots.h"

static int init(grobo_driver *driver, const grobo_model *model, grobo_wiring wiring)
{
    switch (wiring) {
    case GROBO_WIRING_BOARD:
        return grobo_rs30x_driver_init(driver, model, &grobo_board_protocol);
    case GROBO_WIRING_BUS:
        return grobo_rs30x_driver_init(driver, model, &grobo_rs30x_protocol);
    }
    return GROBO_ERR_ARG;
}

const grobo_robot_family grobo_i_family_rs30x = {
    .name = "rs30x", .baud_bps = 115200, .wiring = GROBO_WIRING_BUS, .init = init};
