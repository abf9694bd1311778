/* SPDX-License-Identifier: MIT */
#include <grobo/dxl1.h>

#include "src/robots/bus_family.h"

GROBO_I_BUS_FAMILY(grobo_i_family_dynamixel1, "dynamixel1", grobo_dxl1_driver_init, 1000000,
                   &grobo_dxl1_table);
