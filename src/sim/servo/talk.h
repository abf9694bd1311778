/* SPDX-License-Identifier: MIT */
/* What servos say on their half-duplex line, and whom it meets there. */
#ifndef GROBO_SIM_TALK_H
#define GROBO_SIM_TALK_H

#include <grobo/core/sim_static.h>

/* Servos begin to say bytes at start_ns. */
void grobo_i_sim_talk(grobo_sim *sim, const uint8_t *bytes, size_t n, int64_t start_ns);
/* A byte of the master is over at t_ns: what servos say at that time is in it, and it in that.
 * False where nobody takes it, as its parity is wrong then. */
bool grobo_i_sim_talk_into(grobo_sim *sim, uint8_t *byte, int64_t t_ns);
/* When the next byte of a servo is over, or GROBO_NEVER_US; and that byte. False as above.
 */
int64_t grobo_i_sim_talk_next(const grobo_sim *sim);
bool grobo_i_sim_talk_take(grobo_sim *sim, int64_t t_ns, uint8_t *taken);
/* The next n bytes of the only talk, which nobody disturbs. */
void grobo_i_sim_talk_take_run(grobo_sim *sim, size_t n, uint8_t *taken);
/* When the first of the talks is over, or GROBO_NEVER_US. */
int64_t grobo_i_sim_talks_end(const grobo_sim *sim);

#endif
