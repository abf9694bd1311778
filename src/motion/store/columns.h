/* SPDX-License-Identifier: MIT */
/* The columns of a .m file: which joint each is, and whether a motion fits into them. */
#ifndef GROBO_MOTION_COLUMNS_H
#define GROBO_MOTION_COLUMNS_H

#include "src/motion/store/container.h"

/*
 * Column c of a .m file is joint joints[c]: the model's joints in the order of their motors, or,
 * where it has not so many joints (or there is no model), joint c. Of at most GROBO_JOINTS_MAX
 * columns. @return true for motor order.
 */
bool grobo_i_motor_order(const grobo_model *model, int columns, uint8_t *joints);
/*
 * How many columns a motion takes in a .m file, and whose they are: as many of the first motors as
 * every posture sets, or 0 where postures set others.
 */
int grobo_i_m_columns(const grobo_motion *motion, const grobo_model *model, uint8_t *joints);

#endif
