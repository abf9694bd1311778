/* SPDX-License-Identifier: MIT */
/* The robots that come with the library: tables made of their files by `make robots`. */
#include <string.h>

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

const grobo_robot_def *grobo_robot_def_find(const char *name)
{
    for (size_t i = 0; name != NULL && grobo_i_robot_defs[i] != NULL; i++) {
        if (strcmp(grobo_i_robot_defs[i]->name, name) == 0) {
            return grobo_i_robot_defs[i];
        }
    }
    return NULL;
}
