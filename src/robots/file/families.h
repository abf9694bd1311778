/* SPDX-License-Identifier: MIT */
/* Servos of the families, for files that name one. */
#ifndef GROBO_ROBOTS_FAMILIES_H
#define GROBO_ROBOTS_FAMILIES_H

#include "src/robots/robots.h"

/* A servo as a file names it. */
typedef struct grobo_i_servo {
    const char *name;
    uint16_t model;
    double speed_deg_s; /* without load */
} grobo_i_servo;

/* Servo number index of a family; false behind the last. */
bool grobo_i_family_row(const grobo_robot_family *family, size_t index, grobo_i_servo *servo);

/* The servo of this model, of a family that has tables; NULL: none. */
const grobo_servo_model *grobo_i_family_servo(const grobo_robot_family *family, uint16_t model);

#endif
