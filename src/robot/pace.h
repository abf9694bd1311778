/* SPDX-License-Identifier: MIT */
/* How often the line carries more of the trajectories of joints (pace.c). */
#ifndef GROBO_ROBOT_PACE_I_H
#define GROBO_ROBOT_PACE_I_H

#include <grobo/core/static.h>

#include "src/robot/budget.h"

/* grobo_budget.pace_us for these joints. */
uint32_t grobo_i_pace_of(const grobo_i_line *line, grobo_joint_mask joints);
/* True if the line can tell these joints their trajectories in segments in time, and read each
 * as often as it must; or if they are told whole trajectories. */
bool grobo_i_pace_fits(const grobo_robot *robot, grobo_joint_mask joints);
/* These are told their trajectories from now on: how often. @return false, and nothing has
 * changed, where the line is too slow for that. */
bool grobo_i_pace(grobo_robot *robot, grobo_joint_mask joints);

#endif
