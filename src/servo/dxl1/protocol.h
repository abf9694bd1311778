/* SPDX-License-Identifier: MIT */
/* DYNAMIXEL Protocol 1.0 for the bus, for Feetech's servos too. */
#ifndef GROBO_CORE_DXL1_PROTOCOL_H
#define GROBO_CORE_DXL1_PROTOCOL_H

#include <grobo/core/dxl1.h>

/* Of grobo_protocol. */
int grobo_i_dxl1_measure(const uint8_t *bytes, size_t n, unsigned accept);
int grobo_i_dxl1_reply_to(const uint8_t *frame, size_t n, grobo_reply *reply);
void grobo_i_dxl1_reply_at(const uint8_t *frame, size_t n, unsigned k, grobo_reply *reply);
/* unpack, whose errors of these bits say that the request was not done. */
void grobo_i_dxl1_unpack(uint8_t *bytes, size_t n, uint8_t refusals, grobo_packet *packet);

#endif
