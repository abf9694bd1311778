/* SPDX-License-Identifier: MIT */
#include "src/sim/servo/note.h"

void grobo_i_sim_note(grobo_sim *sim, grobo_sim_event_kind kind, int servo, int32_t value)
{
    grobo_i_sim_tell(
        sim,
        &(grobo_sim_event){.kind = kind, .time_us = sim->now_us, .servo = servo, .value = value});
}
