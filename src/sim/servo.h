/* SPDX-License-Identifier: MIT */
/* What packets do to a servo. */
#ifndef GROBO_SIM_SERVO_H
#define GROBO_SIM_SERVO_H

#include <grobo/sim.h>

/* Every servo that hears the packet carries it out and may reply; raw holds its bytes. */
void grobo_i_sim_packet(grobo_sim *sim, const grobo_rs30x_packet *packet,
                        const grobo_sim_event *raw);
/* Writes what is given and lets it take effect; the caller has checked it. */
void grobo_i_sim_store(grobo_sim *sim, int servo, int address, const uint8_t *bytes, size_t n);
/* Fills in the present values. */
void grobo_i_sim_refresh(grobo_sim *sim, int servo);
/* True while it neither hears nor speaks, whatever the rate. */
bool grobo_i_sim_deaf(const grobo_sim *sim, int servo);
/* The rate at which a servo listens and speaks; negative: none has this code. */
int32_t grobo_i_sim_bps(const grobo_sim *sim, int servo);

#endif
