/* SPDX-License-Identifier: MIT */
/* The simulator of a robot. */
#include <string.h>

#include "src/robots/file/families.h"

int grobo_robot_def_sim(const grobo_robot_def *def, grobo_wiring wiring, grobo_robot_sim *sim)
{
    if (def == NULL || sim == NULL) {
        return GROBO_ERR_ARG;
    }
    memset(sim, 0, sizeof *sim);
    sim->config.size = sizeof sim->config;
    sim->config.model = def->model;
    sim->config.wiring = wiring;
    sim->config.baud_bps = def->baud_bps;
    for (int j = 0; j < def->model->n_joints; j++) {
        sim->servos[j] = grobo_i_joint_servo(def, j);
    }
    sim->config.servos = sim->servos;
    sim->config.families = grobo_i_sim_families;
    sim->config.supply_mv = sim->servos[0]->voltage_mv;
    sim->config.mounted = true;
    return GROBO_OK;
}
