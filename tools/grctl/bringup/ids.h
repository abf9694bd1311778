/* SPDX-License-Identifier: MIT */
/* New servos all have the id of the factory: each is plugged in alone, and gets its joint's. */
#ifndef GRCTL_SETUP_IDS_H
#define GRCTL_SETUP_IDS_H

#include "tools/grctl/bringup/found.h"

/*
 * Asks for the servo of each joint of a robot, the last one first, and writes what it lacks: id,
 * the robot's rate, a closed lock. What was begun before and not finished is found and finished:
 * only what differs is written. Then all of them are plugged in and looked for; *all is who
 * answers. Returns 0, or the exit status with the reason said. Nothing moves: a servo that holds is
 * refused.
 */
int ids_give(app *a, const grobo_robot_def *def, found_servos *all);

#endif
