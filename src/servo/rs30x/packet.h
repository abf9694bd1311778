/* SPDX-License-Identifier: MIT */
/* The form of a packet, as builders and parser see it. */
#ifndef GROBO_CORE_RS30X_PACKET_H
#define GROBO_CORE_RS30X_PACKET_H

#include <grobo/core/rs30x.h>

enum {
    GROBO_I_AT_ID = 2,
    GROBO_I_AT_FLAGS = 3,
    GROBO_I_AT_ADDRESS = 4,
    GROBO_I_AT_LENGTH = 5,
    GROBO_I_AT_COUNT = 6,
    GROBO_I_AT_DATA = 7
};

/*
 * Data bytes that the header (up to and with the count) announces, or GROBO_ERR_FRAME when it is
 * not one of a packet. A factory reset announces none and may have one all the same.
 */
int grobo_i_rs30x_announced(const uint8_t *header);

/* True for the header of a factory reset, which comes with a data byte FF or without. */
bool grobo_i_rs30x_is_reset(const uint8_t *header);

/* Of grobo_protocol. */
int grobo_i_rs30x_measure(const uint8_t *bytes, size_t n, unsigned accept);
void grobo_i_rs30x_unpack(uint8_t *bytes, size_t n, grobo_packet *packet);

#endif
