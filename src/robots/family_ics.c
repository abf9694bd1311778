/* SPDX-License-Identifier: MIT */
#include <grobo/ics.h>

#include "src/robots/bus_family.h"

GROBO_I_BUS_FAMILY(grobo_i_family_ics, "ics", grobo_ics_driver_init, 115200, &grobo_ics_table);
