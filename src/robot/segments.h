/* SPDX-License-Identifier: MIT */
/* Long moves told in parts, in time (segments.c). */
#ifndef GROBO_ROBOT_SEGMENTS_I_H
#define GROBO_ROBOT_SEGMENTS_I_H

#include <grobo/core/static.h>

/* Tells more of their trajectories when it is time for that, and ends what the host has left
 * standing. */
void grobo_i_segments_step(grobo_robot *robot);
/* When that is to be looked at next. */
int64_t grobo_i_segments_deadline(const grobo_robot *robot);

#endif
