/* SPDX-License-Identifier: MIT */
/* Whether a joint that was told to stand goes on all the same (astray.c). */
#ifndef GROBO_ROBOT_ASTRAY_I_H
#define GROBO_ROBOT_ASTRAY_I_H

#include <grobo/core/static.h>

/* True of a joint that turns yet near the end of its trajectory: it is let go on, and is to be
 * looked at once more. */
bool grobo_i_arrives(grobo_robot *robot, int joint);
/* True of one that is far from the goal that its servo told of, and turns there, however slowly. */
bool grobo_i_creeps_to_its_goal(const grobo_robot *robot, int joint);
/* True if the servo, just read, says that it is on a trajectory; notes that trajectory. */
bool grobo_i_goes_on(grobo_robot *robot, int joint);

#endif
