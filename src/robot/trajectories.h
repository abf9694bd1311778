/* SPDX-License-Identifier: MIT */
/* Trajectories that are told in segments (trajectories.c). */
#ifndef GROBO_ROBOT_TRAJECTORIES_I_H
#define GROBO_ROBOT_TRAJECTORIES_I_H

#include <grobo/core/static.h>

/* True if this order's joints are told their trajectories in parts, those that get so much time. */
bool grobo_i_goes_in_parts(const grobo_robot *robot, const grobo_robot_order *order);
bool grobo_i_segments_wanted(const grobo_robot *robot, int joint, int64_t time_us);
/* The part of a target that its frame asks for. @return false, and nothing in *part, where that is
 * all of it. */
bool grobo_i_segments_cut(const grobo_robot *robot, const grobo_robot_order *order,
                          const grobo_target *whole, grobo_target *part);
/* A joint begins the trajectory just noted, which is told in parts. */
void grobo_i_segments_begin(grobo_robot *robot, int joint);
/* Where these of the joints that are told more go next; and that they were told. */
void grobo_i_segments_aim(const grobo_robot *robot, grobo_joint_mask joints, grobo_target *target);
void grobo_i_segments_told(grobo_robot *robot, const grobo_target *target);
/* When joints are told more; GROBO_NEVER_US: none is. */
int64_t grobo_i_segments_due(const grobo_robot *robot);
/* The joints of which that is true now. */
grobo_joint_mask grobo_i_joints_that(const grobo_robot *robot,
                                     bool (*is)(const grobo_robot_axis *axis, int64_t now_us));
/* Joints that are told more of their trajectories. */
grobo_joint_mask grobo_i_trajectories_renewed(const grobo_robot *robot);

#endif
