/* SPDX-License-Identifier: MIT */
/*
 * What each family of families.list has: the key of a robot's file with its driver (family.c), and
 * the simulated servo (sim.c). Both stand apart, so that firmware that names the first alone is
 * linked without the other.
 */
#ifndef GROBO_SERVO_FAMILIES_H
#define GROBO_SERVO_FAMILIES_H

#include <grobo/robot_file.h>

#define FAMILY(name, directory)                                                                    \
    extern const grobo_robot_family grobo_i_family_##name;                                         \
    extern const grobo_sim_family grobo_sim_##directory;
#include "src/servo/families.list"
#undef FAMILY

#endif
