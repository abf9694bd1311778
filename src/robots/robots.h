/* SPDX-License-Identifier: MIT */
/* The tables that are made of the files here. */
#ifndef GROBO_ROBOTS_H
#define GROBO_ROBOTS_H

#include "src/servo/families.h"

extern const grobo_model grobo_i_gr001_model;

/* By wiring. */
extern const grobo_driver grobo_i_gr001_drivers[];

extern const grobo_robot_def grobo_i_robot_gr001;
extern const grobo_robot_def grobo_i_robot_so101;
extern const grobo_robot_def grobo_i_robot_so101_leader;
extern const grobo_robot_def grobo_i_robot_koch;
extern const grobo_robot_def grobo_i_robot_koch_leader;
extern const grobo_robot_def grobo_i_robot_openmanipulator_x;
extern const grobo_robot_def grobo_i_robot_pan_tilt;

/* The robots that come with the library, NULL behind the last. */
extern const grobo_robot_def *const grobo_i_robot_defs[];

#endif
