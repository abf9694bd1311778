/* SPDX-License-Identifier: MIT */
/*
 * Rigid links on a fixed base: inverse dynamics, mass matrix, a step of time. A tree is made once
 * and then only read; working space is in it, so it belongs to one thread.
 */
#ifndef GROBO_SIM_DYNAMICS_H
#define GROBO_SIM_DYNAMICS_H

#include <grobo/core/sim_physics.h>

enum { GROBO_I_BODIES_MAX = GROBO_JOINTS_MAX };

/* A motion or a force, in the base's frame: about its origin, and of the point there. */
typedef struct grobo_i_spatial {
    double turn[3], move[3];
} grobo_i_spatial;

/* Mass, mass times centre, inertia about an origin: xx, yy, zz, xy, xz, yz. */
typedef struct grobo_i_mass {
    double mass, first[3], second[6];
} grobo_i_mass;

/* What moves with one joint, as one rigid body. */
typedef struct grobo_i_rigid {
    int joint, parent; /* parent: index of an earlier body; -1: the base */
    double at_m[3], r[9], axis[3];
    grobo_i_mass mass; /* about its joint's origin, in its frame */
    /* at the angles of the latest call */
    double p_m[3], turned[9];
    grobo_i_spatial axis_now;
    grobo_i_mass now, carried; /* about the base's origin; carried: with all that it bears */
} grobo_i_rigid;

typedef struct grobo_i_tree {
    int n_joints, n;
    double gravity_m_s2[3];
    grobo_i_rigid body[GROBO_I_BODIES_MAX];
    /* of the latest grobo_i_tree_masses(): row by row, n_joints wide; 0 where bodies do not bear
     * each other */
    double mass[GROBO_I_BODIES_MAX * GROBO_I_BODIES_MAX];
    uint8_t coupled[GROBO_I_BODIES_MAX][GROBO_I_BODIES_MAX]; /* other joints of a row ... */
    uint8_t n_coupled[GROBO_I_BODIES_MAX];                   /* ... that are not 0 */
    /* of the last link, for a payload */
    int n_links;
    struct {
        int body; /* -1: the base */
        double at_m[3];
    } link[2 * GROBO_JOINTS_MAX];
} grobo_i_tree;

/* Checks and merges links. 0, GROBO_ERR_ARG or GROBO_ERR_CAP. */
int grobo_i_tree_make(grobo_i_tree *tree, const grobo_sim_link *links, int n_links, int n_joints);

/* Adds a mass at a link's origin, takes one away where it is negative. */
void grobo_i_tree_load(grobo_i_tree *tree, int link, double mass_kg);

/* Where everything is at these angles; what follows is there. */
void grobo_i_tree_place(grobo_i_tree *tree, const double *q_rad);

/* The torques that joints must give for these accelerations (NULL: 0), gravity included. */
void grobo_i_tree_torques(const grobo_i_tree *tree, const double *speed_rad_s,
                          const double *accel_rad_s2, double *torque_nm);

/* Fills tree->mass. */
void grobo_i_tree_masses(grobo_i_tree *tree);

/* A grobo_sim_plant: ctx is the tree. */
int grobo_i_tree_step(void *tree, const grobo_sim_drive *drive, double dt_s,
                      grobo_sim_state *state);

#endif
