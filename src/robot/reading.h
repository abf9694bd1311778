/* SPDX-License-Identifier: MIT */
/* What a reading tells of a joint (reading.c). */
#ifndef GROBO_ROBOT_READING_I_H
#define GROBO_ROBOT_READING_I_H

#include <grobo/core/static.h>

/* A joint slower than this does not move: in free mode it holds again (protocol 5). */
#define GROBO_I_SLOW_DPS 8

/* Takes what a slot has read of its joint, or the reason why there is nothing. *got: what was read,
 * corrected. @return result, or the error of the driver's parse. */
int grobo_i_reading_take(const grobo_robot_slot *slot, int result, const grobo_packet *reply,
                         grobo_joint_state *got);
/* True for a result that says that no reading came. */
bool grobo_i_is_loss(int result);
/* The goal that holds a joint where its servo says that it is, drawn in to its limits; NaN where it
 * stands too far outside. */
double grobo_i_hold_rad(const grobo_robot *robot, int joint);

#endif
