/* SPDX-License-Identifier: MIT */
/*
 * What every file of the simulator may use: telling what happens, and its times. Those of wires are
 * nanoseconds (a byte at 115200 bps is no whole number of microseconds), those of servos
 * microseconds.
 */
#ifndef GROBO_SIM_NOTE_H
#define GROBO_SIM_NOTE_H

#include <grobo/core/sim_static.h>

static inline void grobo_i_sim_tell(grobo_sim *sim, const grobo_sim_event *event)
{
    if (sim->config.hook != NULL) {
        sim->config.hook(sim->config.hook_ctx, event);
    }
}

/* Tells an event without bytes, now. */
void grobo_i_sim_note(grobo_sim *sim, grobo_sim_event_kind kind, int servo, int32_t value);

/* The first microsecond at which something at t_ns is over. */
static inline int64_t grobo_i_sim_us(int64_t t_ns)
{
    int64_t us = t_ns / 1000;
    return us * 1000 < t_ns ? us + 1 : us;
}

#endif
