/* SPDX-License-Identifier: MIT */
#include <grobo/lx16a.h>

#include "src/robots/bus_family.h"

GROBO_I_BUS_FAMILY(grobo_i_family_lx16a, "lx16a", grobo_lx16a_driver_init, 115200,
                   &grobo_lx16a_table);
