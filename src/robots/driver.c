/* SPDX-License-Identifier: MIT */
#include <grobo/core/lines.h>

#include "src/robots/robots.h"

static int init(const grobo_robot_def *def, grobo_wiring wiring, grobo_driver *made)
{
#if GROBO_LINES_MAX > 1
    if (def->on_lines != NULL) {
        return wiring == def->wiring ? grobo_lines_driver_init(made, def->on_lines, def->model)
                                     : GROBO_ERR_UNSUPPORTED;
    }
#endif
    return def->family->init[wiring] == NULL ? GROBO_ERR_UNSUPPORTED
                                             : def->family->init[wiring](made, def->model);
}

int grobo_robot_def_driver(const grobo_robot_def *def, grobo_wiring wiring, grobo_driver *driver)
{
    grobo_driver made = GROBO_TABLE_INIT(grobo_driver);
    if (def == NULL || driver == NULL || (unsigned)wiring > GROBO_WIRING_BUS) {
        return GROBO_ERR_ARG;
    }
    int result = init(def, wiring, &made);
    if (result < 0) {
        return result;
    }
    made.limits = def->limits;
    made.on_exit = def->on_exit;
    made.arm = def->arm;
    made.rest_rad = def->rest_rad;
    made.readback = def->readback;
    made.n_readback = def->n_readback;
    result = grobo_driver_check(&made);
    return result < 0 ? result : grobo_driver_copy(driver, &made);
}
