/* SPDX-License-Identifier: MIT */
/* Servos of the families, for files that name one. */
#ifndef GROBO_ROBOTS_FAMILIES_H
#define GROBO_ROBOTS_FAMILIES_H

#include "src/robots/robots.h"

/* The families that a file may name, NULL behind the last. */
extern const grobo_robot_family *const grobo_i_robot_families[];

/* Their simulated servos. */
extern const grobo_sim_family *const grobo_i_sim_families[];

/* Servo number index of a family, NULL behind the last. */
const grobo_servo_model *grobo_i_family_row(const grobo_robot_family *family, size_t index);

/* The servo of a joint, NULL: none. */
const grobo_servo_model *grobo_i_joint_servo(const grobo_robot_def *def, int joint);

#endif
