/* SPDX-License-Identifier: MIT */
#include <grobo/feetech.h>

#include "src/robots/bus_family.h"

GROBO_I_BUS_FAMILY(grobo_i_family_feetech, "feetech", grobo_feetech_driver_init, 1000000,
                   &grobo_sts_table, &grobo_scs_table);
