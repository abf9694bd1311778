/* SPDX-License-Identifier: MIT */
/* Chance: what strikes when, and what becomes of bytes and replies then. */
#ifndef GROBO_SIM_FAULT_H
#define GROBO_SIM_FAULT_H

#include <grobo/core/sim_static.h>

/* The generator of what is no fault: start posture, bytes at a wrong rate. */
#define GROBO_I_SIM_CHANCE GROBO_SIM_FAULTS

void grobo_i_sim_seed(grobo_sim *sim);
/* 0 .. below - 1 */
uint32_t grobo_i_sim_random(grobo_sim *sim, int generator, uint32_t below);
/* True if the fault strikes now; counts and tells it. */
bool grobo_i_sim_strikes(grobo_sim *sim, grobo_sim_fault fault, int servo);
/* A byte that crosses the host's line: lost (false), damaged, or as it was. */
bool grobo_i_sim_crosses(grobo_sim *sim, uint8_t *byte);

/* Where the parts of a reply go: bytes from start_ns on without a pause. */
typedef void (*grobo_i_sim_emit)(grobo_sim *sim, const uint8_t *bytes, size_t n, int64_t start_ns);
/* Sends a reply to the host by emit, with the faults that replies have. */
void grobo_i_sim_reply(grobo_sim *sim, const grobo_sim_event *reply, int64_t start_ns,
                       grobo_i_sim_emit emit);

#endif
