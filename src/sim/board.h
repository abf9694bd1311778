/* SPDX-License-Identifier: MIT */
/* The controller board. */
#ifndef GROBO_SIM_BOARD_H
#define GROBO_SIM_BOARD_H

#include <grobo/core/sim_static.h>

/* A byte of the host has arrived. */
void grobo_i_sim_board_hear(grobo_sim *sim, uint8_t byte, int64_t t_ns);
/* A whole frame of the host's has arrived, at a board that listens and has heard nothing else. */
void grobo_i_sim_board_hear_frame(grobo_sim *sim, const uint8_t *bytes, size_t n, int64_t t_ns);
/* True where it does. */
bool grobo_i_sim_board_listens(const grobo_sim *sim);
/* Bytes of a servo have arrived, the last one at t_ns: one, or some that the board waits for. */
void grobo_i_sim_board_got(grobo_sim *sim, const uint8_t *bytes, size_t n, int64_t t_ns);
/* When the board does something on its own, or GROBO_NEVER_US; and doing it. */
int64_t grobo_i_sim_board_next(const grobo_sim *sim);
void grobo_i_sim_board_act(grobo_sim *sim, int64_t t_ns);

#endif
