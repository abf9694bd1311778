/* SPDX-License-Identifier: MIT */
/**
 * @file robot_plant.h
 * @brief A robot of a file whose body is a program's: its motors are here, its links are there.
 *
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_ROBOT_PLANT_H
#define GROBO_CORE_ROBOT_PLANT_H

#include <grobo/robot_file.h>

GROBO_BEGIN_DECLS

/**
 * As grobo_robot_def_physics(), but the plant moves the joints; the links of the file are not used.
 * @param plant copied; what it points to must live as long as the world
 * @return as grobo_sim_physics_new()
 */
GROBO_API int grobo_robot_def_plant(const grobo_robot_def *def, const grobo_sim_plant *plant,
                                    bool real_time, const grobo_mem *mem,
                                    grobo_sim_physics **physics);

GROBO_END_DECLS

#endif
