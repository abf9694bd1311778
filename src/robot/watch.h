/* SPDX-License-Identifier: MIT */
/* Judges readings (watch.c). */
#ifndef GROBO_ROBOT_WATCH_I_H
#define GROBO_ROBOT_WATCH_I_H

#include <grobo/core/static.h>

/* Judges the reading of a joint just taken. */
void grobo_i_watch_reading(grobo_robot *robot, int joint, const grobo_joint_state *got);
/* Judges a reading that did not come. */
void grobo_i_watch_lost(grobo_robot *robot, int joint);

#endif
