/* SPDX-License-Identifier: MIT */
#include "src/robots/robots.h"

const grobo_robot_def *const grobo_i_robot_defs[] = {
    &grobo_i_robot_gr001,        &grobo_i_robot_so101,
    &grobo_i_robot_so101_leader, &grobo_i_robot_koch,
    &grobo_i_robot_koch_leader,  &grobo_i_robot_openmanipulator_x,
    &grobo_i_robot_pan_tilt,     NULL,
};

const grobo_robot_def *grobo_robot_def_at(size_t i)
{
    size_t n = sizeof grobo_i_robot_defs / sizeof *grobo_i_robot_defs;
    return i < n ? grobo_i_robot_defs[i] : NULL;
}
