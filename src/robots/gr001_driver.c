/* SPDX-License-Identifier: MIT */
#include "src/robots/robots.h"

const grobo_driver *grobo_gr001_driver(grobo_wiring wiring)
{
    return wiring == GROBO_WIRING_BOARD || wiring == GROBO_WIRING_BUS
               ? &grobo_i_gr001_drivers[wiring]
               : NULL;
}
