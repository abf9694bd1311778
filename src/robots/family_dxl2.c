/* SPDX-License-Identifier: MIT */
#include <grobo/dxl2.h>

#include "src/robots/bus_family.h"

GROBO_I_BUS_FAMILY(grobo_i_family_dynamixel2, "dynamixel2", grobo_dxl2_driver_init, 57600,
                   &grobo_dxl2_table);
