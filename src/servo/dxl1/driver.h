/* SPDX-License-Identifier: MIT */
/* Frames of Protocol 1.0 by the packets of 2.0, for Feetech's driver too. */
#ifndef GROBO_CORE_DXL1_DRIVER_H
#define GROBO_CORE_DXL1_DRIVER_H

#include <grobo/core/dxl1.h>

#include "src/servo/table/family.h"

/* Of grobo_i_family. */
int grobo_i_dxl1_build_as(const grobo_dxl2_packet *packet, uint8_t *buf, size_t cap);
int grobo_i_dxl1_parse_as(const uint8_t *frame, size_t n, uint8_t *data, size_t cap,
                          grobo_dxl2_packet *packet);

#endif
