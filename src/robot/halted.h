/* SPDX-License-Identifier: MIT */
/* Reads back what was halted, and repeats what was lost (halted.c). */
#ifndef GROBO_ROBOT_HALTED_I_H
#define GROBO_ROBOT_HALTED_I_H

#include <grobo/core/static.h>

/* A joint, just read, moves though it was not sent there: it stops where it is. */
void grobo_i_astray(grobo_robot *robot, int joint);
/* A joint was just read: what is known by that of its halt. */
void grobo_i_halted_look(grobo_robot *robot, int joint);
/* True if halted joints are to be read now. When they are; GROBO_NEVER_US: there are none. */
bool grobo_i_halted_due(const grobo_robot *robot);
int64_t grobo_i_halted_at(const grobo_robot *robot);
/* Which of them is read next, one by one; or all of them. */
int grobo_i_halted_next(grobo_robot *robot);
grobo_joint_mask grobo_i_halted_ask(grobo_robot *robot);
/* Tells what was read back when that is all, and what was not when it takes too long; when. */
void grobo_i_halted_step(grobo_robot *robot);
int64_t grobo_i_halted_deadline(const grobo_robot *robot);

#endif
