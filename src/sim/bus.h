/* SPDX-License-Identifier: MIT */
/* What servos hear on their line. */
#ifndef GROBO_SIM_BUS_H
#define GROBO_SIM_BUS_H

#include <grobo/core/sim_static.h>

/* A byte of the board or host is over on the bus. */
void grobo_i_sim_bus_hear(grobo_sim *sim, uint8_t byte, int64_t t_ns);
/* The size of the packet that bytes begin with, where servos hear it as it is: nobody talks, none
 * waits for the end of another one. Its end is all that matters then. 0: byte by byte. */
size_t grobo_i_sim_bus_packet(const grobo_sim *sim, const uint8_t *bytes, size_t n);
/* Such a packet is over. */
void grobo_i_sim_bus_hear_packet(grobo_sim *sim, const uint8_t *bytes, size_t n, int64_t t_ns);
/* A whole frame or packet has come: what may befall the robot then. */
void grobo_i_sim_frame_faults(grobo_sim *sim);

#endif
