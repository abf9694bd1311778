/* SPDX-License-Identifier: MIT */
/* Whether a joint stands (stand.c). */
#ifndef GROBO_ROBOT_STAND_I_H
#define GROBO_ROBOT_STAND_I_H

#include <grobo/core/static.h>

/* Two positions show that a joint stands where they are so far apart: 0.5 s and more. */
int64_t grobo_i_stand_us(const grobo_robot *robot, int joint);

/* A frame tells the joint something: what was read before shows nothing of it. */
void grobo_i_stand_forget(grobo_robot_axis *axis);
/* Where it is, by a reading that was asked for since then. */
void grobo_i_stand_seen(grobo_robot *robot, int joint, int64_t asked_us, double angle_rad);
/* True if the last reading found the joint elsewhere than the one before. */
bool grobo_i_stand_left(const grobo_robot_axis *axis);
/* True of a joint whose trajectory is over, and which by the last reading is at its end, or
 * hangs beside it, and is slow; or has not moved between two of them. Less than what follows. */
bool grobo_i_rests(const grobo_robot *robot, int joint);
/* True if it was read to stand since then. */
bool grobo_i_stands(const grobo_robot *robot, int joint);
/* True if the goal read is the one that it was sent to, or of a trajectory told in segments lies
 * ahead of where it was by then. */
bool grobo_i_goal_is_taken(const grobo_robot *robot, int joint);

/* A frame that tells these joints something has left: to stop, or anything else. */
void grobo_i_halt_left(grobo_robot *robot, grobo_joint_mask joints, bool halts);
/* These are halted once they were read. */
void grobo_i_halt_owe(grobo_robot *robot, grobo_joint_mask joints);

/* A joint that carries a weight swings about the place where it hangs, and its load need not be
 * known: two positions show that it does not. */
bool grobo_i_is_calm(const grobo_robot_axis *axis);
/* Joints that have arrived and swing about the place where they hang: a stop sends them nowhere,
 * and is over when they were read to rest. */
grobo_joint_mask grobo_i_swinging(const grobo_robot *robot);

#endif
