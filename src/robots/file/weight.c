/* SPDX-License-Identifier: MIT */
/* A world in which a robot has weight: its links, as the dynamics want them. */
#include <math.h>
#include <string.h>

#include <grobo/robot_file.h>

bool grobo_robot_def_has_weight(const grobo_robot_def *def)
{
    for (int i = 0; def != NULL && i < def->n_links; i++) {
        if (def->links[i].mass_kg > 0 && def->links[i].parent >= 0) {
            return true;
        }
    }
    return false;
}

/* Roll, pitch, yaw about fixed axes. */
static void rotation(double r[9], const double rpy[3])
{
    double cr = cos(rpy[0]), sr = sin(rpy[0]), cp = cos(rpy[1]), sp = sin(rpy[1]);
    double cy = cos(rpy[2]), sy = sin(rpy[2]);
    const double made[9] = {cy * cp,
                            cy * sp * sr - sy * cr,
                            cy * sp * cr + sy * sr,
                            sy * cp,
                            sy * sp * sr + cy * cr,
                            sy * sp * cr - cy * sr,
                            -sp,
                            cp * sr,
                            cp * cr};
    memcpy(r, made, sizeof made);
}

int grobo_robot_def_physics(const grobo_robot_def *def, bool real_time, const grobo_mem *mem,
                            grobo_sim_physics **physics)
{
    grobo_sim_link links[GROBO_ROBOT_LINKS_MAX];
    if (def == NULL || physics == NULL || def->n_links > GROBO_ROBOT_LINKS_MAX) {
        return GROBO_ERR_ARG;
    }
    for (int i = 0; i < def->n_links; i++) {
        const grobo_robot_link *from = &def->links[i];
        grobo_sim_link *to = &links[i];
        *to = (grobo_sim_link){.name = from->name,
                               .parent = from->parent,
                               .joint = from->joint,
                               .mass_kg = from->mass_kg};
        memcpy(to->origin_m, from->origin_m, sizeof to->origin_m);
        memcpy(to->axis, from->axis, sizeof to->axis);
        memcpy(to->com_m, from->com_m, sizeof to->com_m);
        memcpy(to->inertia_kgm2, from->inertia_kgm2, sizeof to->inertia_kgm2);
        rotation(to->r, from->origin_rad);
    }
    const grobo_sim_physics_config config = {GROBO_SIM_PHYSICS_CONFIG_INIT, .model = def->model,
                                             .links = links, .n_links = def->n_links,
                                             .real_time = real_time};
    return grobo_sim_physics_new(&config, mem, physics);
}
