/* SPDX-License-Identifier: MIT */
/* What ends the work of the engine and stops joints that move (stop.c). */
#ifndef GROBO_ROBOT_STOP_I_H
#define GROBO_ROBOT_STOP_I_H

#include <grobo/core/static.h>

/* What the engine does by itself after a motion makes way for any request. */
void grobo_i_make_way(grobo_robot *robot);
/* Cancels targets that wait, and halts what moves; while a motion is played, which ends by itself,
 * only what was sent beside it. */
void grobo_i_stop_moves(grobo_robot *robot);
/* A motion cannot go on: halts all that moves, and ends what moves or waits to move beside it. */
void grobo_i_stop_broken(grobo_robot *robot);
/* True if a job moves joints, or would: a stop ends it. */
bool grobo_i_job_moves(const grobo_robot_task *job);

#endif
