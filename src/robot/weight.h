/* SPDX-License-Identifier: MIT */
/* The error that carries a joint, and goals that keep it (weight.c). */
#ifndef GROBO_ROBOT_WEIGHT_I_H
#define GROBO_ROBOT_WEIGHT_I_H

#include <grobo/core/static.h>

/* A reading of a joint: the load that it stands in, where it stands and its goal is known. */
void grobo_i_load_take(grobo_robot *robot, int joint, const grobo_joint_state *got);
/* A trajectory that begins where a joint is begins at the goal that its servo holds it by: one that
 * begins at the joint, and a load that was another one when it stood, would have it dip. */
void grobo_i_begin_at_goal(grobo_robot *robot, int joint);
/* What is kept of the error of a joint whose servo tells no speed, and of which no load is known:
 * it is behind its set point by its load, or its speed. */
double grobo_i_lag_kept(const grobo_robot *robot, int joint, double rest_rad);
/* The goal that has a joint rest where it can by then: it keeps the load. */
double grobo_i_goal_to_rest(const grobo_robot *robot, int joint, int64_t rest_us);
/* True of a joint that hangs in the goal of its trajectory, whether or not its load is known: it
 * was sent to no other place, or has come to rest. */
bool grobo_i_hangs_in_goal(const grobo_robot *robot, int joint);
/* This goal, drawn in so that its joint rests no further than that from here, and on this side: 1
 * above, -1 below, 0 on either. */
double grobo_i_goal_near(const grobo_robot_axis *axis, double goal_rad, double here_rad,
                         double most_rad, int side);

#endif
