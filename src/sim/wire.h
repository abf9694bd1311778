/* SPDX-License-Identifier: MIT */
/* The host's line: the bytes under way to and from it. */
#ifndef GROBO_SIM_WIRE_H
#define GROBO_SIM_WIRE_H

#include <grobo/core/sim_static.h>

/* Bytes that there is room for, byte_ns each, the first from at_ns on. */
void grobo_i_sim_wire_write(grobo_sim_wire *wire, const uint8_t *bytes, size_t n, int64_t at_ns,
                            int64_t byte_ns);
/* Takes those that are over by now. */
size_t grobo_i_sim_wire_read(grobo_sim_wire *wire, uint8_t *buf, size_t cap, int64_t now_ns);
/* When the next byte is over, or GROBO_NEVER_US. */
int64_t grobo_i_sim_wire_next(const grobo_sim_wire *wire);
/* The next byte of the host as it arrives; false when it is lost. */
bool grobo_i_sim_from_host(grobo_sim *sim, uint8_t *byte);
/* The bytes on the host's line, where each arrives as it was sent and they stand in one piece; NULL
 * else. They are taken with grobo_i_sim_wire_drop(). */
const uint8_t *grobo_i_sim_sound(const grobo_sim *sim);
void grobo_i_sim_wire_drop(grobo_sim_wire *wire, size_t n);
/* Bytes for the host, one behind the other: the first is over at at_ns. */
void grobo_i_sim_to_host(grobo_sim *sim, const uint8_t *bytes, size_t n, int64_t at_ns);
/* The host's cable is out: what is on the line is lost. */
void grobo_i_sim_cut(grobo_sim *sim);

#endif
