/* SPDX-License-Identifier: MIT */
/* Joints that something holds up, or that are loaded with more than they carry (blocked.c). A build
 * for plain drivers has none of it. */
#ifndef GROBO_ROBOT_BLOCKED_H
#define GROBO_ROBOT_BLOCKED_H

#include <grobo/core/static.h>

#if GROBO_DRIVERS_PLAIN
static inline void grobo_i_blocked_forget(grobo_robot *robot, int joint)
{
    (void)robot;
    (void)joint;
}
static inline void grobo_i_blocked_look(grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    grobo_i_blocked_forget(robot, joint);
    (void)got;
}
static inline bool grobo_i_blocked_wants_goal(const grobo_robot *robot, int joint)
{
    (void)robot;
    (void)joint;
    return false;
}
#else
/* What was known of a joint is void. */
void grobo_i_blocked_forget(grobo_robot *robot, int joint);
/* Judges the angle of a joint just read. */
void grobo_i_blocked_look(grobo_robot *robot, int joint, const grobo_joint_state *got);
/* True of a joint whose next reading must contain its goal, to show whether it is blocked. */
bool grobo_i_blocked_wants_goal(const grobo_robot *robot, int joint);
#endif

#endif
