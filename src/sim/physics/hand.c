/* SPDX-License-Identifier: MIT */
/* What a person does to a world, and sees of it. */
#include <math.h>

#include "src/sim/physics/physics.h"

#define PUSH_MAX_NM 100
#define PAYLOAD_MAX_KG 100
#define SUPPLY_MAX_MOHM 100000

static int joint_at(const grobo_sim *sim, int servo, grobo_i_joint_world **joint)
{
    grobo_i_world *w = grobo_i_world_of(sim);
    if (sim == NULL || servo < 0 || servo >= sim->n_servos) {
        return GROBO_ERR_ARG;
    }
    if (w == NULL) {
        return GROBO_ERR_UNSUPPORTED;
    }
    *joint = &w->joint[servo];
    grobo_i_world_wake(sim);
    return GROBO_OK;
}

int grobo_sim_push(grobo_sim *sim, int servo, double torque_nm)
{
    grobo_i_joint_world *joint;
    int result = fabs(torque_nm) <= PUSH_MAX_NM ? joint_at(sim, servo, &joint) : GROBO_ERR_ARG;
    if (result == GROBO_OK) {
        joint->push_nm = torque_nm;
    }
    return result;
}

int grobo_sim_set_wall(grobo_sim *sim, int servo, int32_t min_mdeg, int32_t max_mdeg)
{
    grobo_i_joint_world *joint;
    int result = min_mdeg <= max_mdeg ? joint_at(sim, servo, &joint) : GROBO_ERR_ARG;
    if (result == GROBO_OK) {
        joint->wall_mdeg[0] = min_mdeg;
        joint->wall_mdeg[1] = max_mdeg;
    }
    return result;
}

static int find_link(const grobo_i_world *w, const char *name)
{
    if (name == NULL) {
        return w->tree.n_links - 1;
    }
    for (int i = 0; i < w->tree.n_links; i++) {
        if (grobo_i_same_text(w->link_name[i], name)) {
            return i;
        }
    }
    return -1;
}

int grobo_sim_set_payload(grobo_sim *sim, const char *link, double mass_kg)
{
    grobo_i_world *w = grobo_i_world_of(sim);
    if (sim == NULL || !(mass_kg >= 0 && mass_kg <= PAYLOAD_MAX_KG)) {
        return GROBO_ERR_ARG;
    }
    if (w == NULL || w->plant.ctx != &w->tree) {
        return GROBO_ERR_UNSUPPORTED;
    }
    int index = find_link(w, link);
    if (index < 0) {
        return GROBO_ERR_NOTFOUND;
    }
    if (w->payload >= 0) {
        grobo_i_tree_load(&w->tree, w->payload, -w->payload_kg);
    }
    grobo_i_world_wake(sim);
    w->payload = index;
    w->payload_kg = mass_kg;
    grobo_i_tree_load(&w->tree, index, mass_kg);
    return GROBO_OK;
}

int grobo_sim_set_supply_mohm(grobo_sim *sim, uint32_t mohm)
{
    grobo_i_world *w = grobo_i_world_of(sim);
    if (sim == NULL || mohm > SUPPLY_MAX_MOHM) {
        return GROBO_ERR_ARG;
    }
    if (w == NULL) {
        return GROBO_ERR_UNSUPPORTED;
    }
    grobo_i_world_wake(sim);
    w->supply_ohm = mohm / 1000.0;
    return GROBO_OK;
}

int grobo_sim_physics_look(const grobo_sim_physics *physics, int joint,
                           grobo_sim_physics_view *view)
{
    const grobo_i_world *w = (const grobo_i_world *)physics;
    if (w == NULL || view == NULL || joint < 0 || joint >= w->n) {
        return GROBO_ERR_ARG;
    }
    const grobo_i_joint_world *j = &w->joint[joint];
    const grobo_sim_state *state = &w->state[joint];
    *view = (grobo_sim_physics_view){.angle_rad = state->angle_rad,
                                     .speed_rad_s = state->speed_rad_s,
                                     .load_nm = state->load_nm,
                                     .motor_nm = j->motor_nm * j->ratio,
                                     .duty = j->body.duty,
                                     .winding_a = j->body.winding_ma / 1000,
                                     .set_rad = j->set_rad,
                                     .motor = &j->motor};
    return GROBO_OK;
}

uint64_t grobo_sim_physics_skipped(const grobo_sim_physics *physics)
{
    return physics == NULL ? 0 : ((const grobo_i_world *)physics)->skipped;
}
