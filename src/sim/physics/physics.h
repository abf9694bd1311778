/* SPDX-License-Identifier: MIT */
/* A world while it runs. */
#ifndef GROBO_SIM_PHYSICS_PRIVATE_H
#define GROBO_SIM_PHYSICS_PRIVATE_H

#include <string.h>

#include "src/sim/physics/dynamics.h"
#include "src/sim/physics/motor.h"
#include "src/sim/servo/world.h"

/* Without the C library's strings: what the core has is enough. */
static inline bool grobo_i_same_text(const char *a, const char *b)
{
    size_t n = strlen(a);
    return strlen(b) == n && memcmp(a, b, n) == 0;
}

/* A joint's servo. */
typedef struct grobo_i_joint_world {
    grobo_sim_motor motor;
    grobo_i_loop loop;
    grobo_i_body body;
    double ratio;    /* turns of the servo for one of the joint, negative where they are opposed */
    double zero_rad; /* of the servo, where the joint is at 0 */
    double tick_rad; /* steps of the servo's encoder; 0: none */
    double integral; /* of the loop's error, rad s */
    double set_rad;  /* where the loop wants the servo */
    double motor_nm; /* at the servo */
    double push_nm;  /* a hand at the joint */
    double heat_ma2; /* sum of squares since it was warmed */
    double play_rad; /* where in its backlash the shaft hangs, from the middle */
    int32_t wall_mdeg[2];
} grobo_i_joint_world;

typedef struct grobo_i_world {
    grobo_sim_physics base;
    const grobo_mem *mem;
    grobo_sim_plant plant;
    double supply_ohm;
    uint64_t skipped, steps;
    int n;
    int payload; /* its link; -1: none */
    double payload_kg;
    bool steps_seen;              /* the loop sees the encoder's steps */
    bool given[GROBO_JOINTS_MAX]; /* its motor is of the configuration */
    int64_t low_us;               /* since when the supply is too low; GROBO_NEVER_US */
    grobo_i_joint_world joint[GROBO_JOINTS_MAX];
    grobo_sim_drive drive[GROBO_JOINTS_MAX];
    grobo_sim_state state[GROBO_JOINTS_MAX];
    grobo_i_tree tree;
    char link_name[2 * GROBO_JOINTS_MAX][GROBO_NAME_MAX_BYTES];
} grobo_i_world;

/* The world of a simulator; NULL: it has none. */
static inline grobo_i_world *grobo_i_world_of(const grobo_sim *sim)
{
    return sim == NULL ? NULL : (grobo_i_world *)sim->config.physics;
}

#endif
