/* SPDX-License-Identifier: MIT */
/* When the background reads which joint (sense.c). */
#ifndef GROBO_ROBOT_SENSE_I_H
#define GROBO_ROBOT_SENSE_I_H

#include <grobo/core/static.h>

/* Starts a background reading if one is due. */
void grobo_i_sense_step(grobo_robot *robot);
/* When the background reads next. */
int64_t grobo_i_sense_deadline(const grobo_robot *robot);

/* A background reading is over, and taken. */
void grobo_i_sense_done(const grobo_robot_slot *slot, int result);

#endif
