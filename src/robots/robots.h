/* SPDX-License-Identifier: MIT */
/* The families that a robot's file may name, and the tables that are made of the files here. */
#ifndef GROBO_ROBOTS_H
#define GROBO_ROBOTS_H

#include <grobo/robot_file.h>

extern const grobo_robot_family grobo_i_family_rs30x;
extern const grobo_robot_family grobo_i_family_dynamixel2;
extern const grobo_robot_family grobo_i_family_dynamixel1;
extern const grobo_robot_family grobo_i_family_feetech;
extern const grobo_robot_family grobo_i_family_lx16a;
extern const grobo_robot_family grobo_i_family_ics;

/* By wiring. */
extern const grobo_driver grobo_i_gr001_drivers[];

extern const grobo_robot_def grobo_i_robot_gr001;
extern const grobo_robot_def grobo_i_robot_so101;
extern const grobo_robot_def grobo_i_robot_so101_leader;
extern const grobo_robot_def grobo_i_robot_koch;
extern const grobo_robot_def grobo_i_robot_koch_leader;
extern const grobo_robot_def grobo_i_robot_openmanipulator_x;
extern const grobo_robot_def grobo_i_robot_pan_tilt;

#endif
