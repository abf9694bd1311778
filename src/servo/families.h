/* SPDX-License-Identifier: MIT */
/*
 * What each family of families.list has: the key of a robot's file with its driver (family.c), the
 * simulated servo (sim.c), and what its frames say (words.c; an array, NULL behind the last). They
 * stand apart, so that firmware that names the first alone is linked without the others.
 */
#ifndef GROBO_SERVO_FAMILIES_H
#define GROBO_SERVO_FAMILIES_H

#include <grobo/core/words.h>
#include <grobo/robot_file.h>

#define FAMILY(name, directory)                                                                    \
    extern const grobo_robot_family grobo_i_family_##name;                                         \
    extern const grobo_sim_family grobo_i_sim_##directory;                                         \
    extern const grobo_words *const grobo_i_words_##directory[];
#include "src/servo/families.list"
#undef FAMILY

#endif
