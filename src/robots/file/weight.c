/* SPDX-License-Identifier: MIT */
/* A world in which a robot has weight: its links, as the dynamics want them. */
#include <string.h>

#include <grobo/core/robot_plant.h>

#include "src/body/body.h"
#include "src/robots/file/families.h"
#include "src/robots/robots.h"

bool grobo_robot_def_has_weight(const grobo_robot_def *def)
{
    for (int i = 0; def != NULL && i < def->n_links; i++) {
        if (def->links[i].mass_kg > 0 && def->links[i].parent >= 0) {
            return true;
        }
    }
    return false;
}

/* The servo's own, with what the file says instead. False: the file says nothing. */
static bool given(const grobo_robot_def *def, int j, grobo_sim_motor *motor)
{
    static const grobo_robot_motor nothing;
    const grobo_robot_motor *said = def->motors != NULL ? &def->motors[j] : &nothing;
    const grobo_servo_model *servo = grobo_i_joint_servo(def, j);
    if (memcmp(said, &nothing, sizeof nothing) == 0 || grobo_sim_motor_of(servo, motor) < 0) {
        return false;
    }
    motor->from = GROBO_SIM_MOTOR_GIVEN;
    motor->source = "the robot's file";
    motor->kt_nm_a = said->kt_nm_a > 0 ? said->kt_nm_a : motor->kt_nm_a;
    motor->resistance_ohm = said->resistance_ohm > 0 ? said->resistance_ohm : motor->resistance_ohm;
    motor->armature_kgm2 = said->armature_kgm2 > 0 ? said->armature_kgm2 : motor->armature_kgm2;
    motor->torque_max_nm = said->torque_max_nm > 0 ? said->torque_max_nm : motor->torque_max_nm;
    motor->backlash_rad = said->backlash_rad > 0 ? said->backlash_rad : motor->backlash_rad;
    if (said->friction_nm > 0 || said->viscous_nms > 0) {
        motor->friction =
            (grobo_sim_friction){.base_nm = said->friction_nm, .viscous_nms = said->viscous_nms};
    }
    return true;
}

/* The world of a configuration that has its links or its plant: the robot's motors are added. */
static int make_world(const grobo_robot_def *def, grobo_sim_physics_config config,
                      const grobo_mem *mem, grobo_sim_physics **physics)
{
    grobo_sim_motor motor[GROBO_JOINTS_MAX];
    const grobo_sim_motor *motors[GROBO_JOINTS_MAX] = {NULL};
    for (int j = 0; j < def->model->n_joints; j++) {
        motors[j] = given(def, j, &motor[j]) ? &motor[j] : NULL;
    }
    config.model = def->model;
    config.motors = motors;
    return grobo_sim_physics_new(&config, mem, physics);
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
        grobo_i_rotation_of_rpy(to->r, from->origin_rad);
    }
    const grobo_sim_physics_config config = {GROBO_SIM_PHYSICS_CONFIG_INIT, .links = links,
                                             .n_links = def->n_links, .real_time = real_time};
    return make_world(def, config, mem, physics);
}

int grobo_robot_def_plant(const grobo_robot_def *def, const grobo_sim_plant *plant, bool real_time,
                          const grobo_mem *mem, grobo_sim_physics **physics)
{
    if (def == NULL || plant == NULL || plant->step == NULL || physics == NULL) {
        return GROBO_ERR_ARG;
    }
    const grobo_sim_physics_config config = {GROBO_SIM_PHYSICS_CONFIG_INIT, .plant = plant,
                                             .real_time = real_time};
    return make_world(def, config, mem, physics);
}
