/* SPDX-License-Identifier: MIT */
#include "src/robots/robots.h"

const grobo_robot_def *const grobo_robot_defs[] = {
    &grobo_i_robot_gr001,        &grobo_i_robot_so101,
    &grobo_i_robot_so101_leader, &grobo_i_robot_koch,
    &grobo_i_robot_koch_leader,  &grobo_i_robot_openmanipulator_x,
    &grobo_i_robot_pan_tilt,     NULL,
};
