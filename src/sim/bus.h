/* SPDX-License-Identifier: MIT */
/* What servos hear on their line. */
#ifndef GROBO_SIM_BUS_H
#define GROBO_SIM_BUS_H

#include <grobo/sim_static.h>

/* A byte of the board or host is over on the bus. */
void grobo_i_sim_bus_hear(grobo_sim *sim, uint8_t byte, int64_t t_ns);
/* A whole frame or packet has come: what may befall the robot then. */
void grobo_i_sim_frame_faults(grobo_sim *sim);

#endif
