/* SPDX-License-Identifier: MIT */
/**
 * @file robot_plant.h
 * @brief The weight of a robot of a file: whether it has any, and a body that is a program's, whose
 * motors are here and whose links are there.
 *
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_ROBOT_PLANT_H
#define GROBO_CORE_ROBOT_PLANT_H

#include <grobo/robot_file.h>

GROBO_BEGIN_DECLS

/** Whether a world of it has weight: links with masses, some of which a joint moves. */
GROBO_API bool grobo_robot_def_has_weight(const grobo_robot_def *def);

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
