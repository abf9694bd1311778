/* SPDX-License-Identifier: MIT */
/* A servo at its line, whatever its family. */
#ifndef GROBO_SIM_SERVO_H
#define GROBO_SIM_SERVO_H

#include <grobo/core/sim_static.h>

/* Bytes of a simulator with no more servos than this model has joints, NULL: a GR001. What lies
 * behind them of a grobo_sim is not there. */
size_t grobo_i_sim_bytes(const grobo_model *model);
/* Whether a servo that a packet is for hears it now; tells of those that miss it. */
bool grobo_i_sim_hears(grobo_sim *sim, int servo, const grobo_sim_event *raw);
/* A servo answers after_ns from now. Its own replies go straight to the bus; on its way to the host
 * a reply may suffer, and the bytes with it. */
void grobo_i_sim_speak(grobo_sim *sim, int servo, uint8_t *bytes, size_t n, int64_t after_ns);
/* The supply as it is under the present load. */
int32_t grobo_i_sim_supply_mv(const grobo_sim *sim);
/* True while it neither hears nor speaks, whatever the rate. */
bool grobo_i_sim_deaf(const grobo_sim *sim, int servo);
/* The rate at which a servo listens and speaks; negative: none has this code. */
int32_t grobo_i_sim_bps(const grobo_sim *sim, int servo);

#endif
