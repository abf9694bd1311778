/* SPDX-License-Identifier: MIT */
/* What the files of the body room share. */
#ifndef GROBO_SRC_BODY_BODY_PRIV_H
#define GROBO_SRC_BODY_BODY_PRIV_H

#include <grobo/core/body.h>
#include <grobo/mem.h>

#include "src/body/track.h"

extern const grobo_body_model grobo_i_gr001_body;

/* ---- legs ---- */

/* A leg of a model: its links hip to foot and whether each axis points along +Z +X +Y +Y +Y +X. */
struct grobo_i_leg {
    int link[GROBO_BODY_LEG_JOINTS];
    int sign[GROBO_BODY_LEG_JOINTS];
};

/* Finds a leg. GROBO_ERR_ARG if the links above the foot are no leg of the known structure. */
int grobo_i_leg_find(const grobo_body_model *model, int foot, struct grobo_i_leg *leg);

/* Closed form; target in the frame of the waist. False: out of reach, q_rad untouched. */
bool grobo_i_leg_exact(const grobo_body_model *model, const struct grobo_i_leg *leg,
                       const grobo_transform *target, double q_rad[GROBO_BODY_LEG_JOINTS]);

/* One numeric problem: a leg walked from its waist (up false) or from its foot (up true). */
struct grobo_i_numeric {
    const grobo_body_model *model;
    const struct grobo_i_leg *leg;
    bool up;       /* start is the foot, goal the waist */
    bool compat11; /* the loop of Choreonoid 1.1 */
};

/* The path from start at some angles: its end, and the Jacobian, columns [axis x (p_end - p_joint);
 * axis] of the joints hip to foot in the world. The axis is negated for joints walked upwards. */
void grobo_i_leg_jacobian(const struct grobo_i_numeric *problem, const grobo_transform *start,
                          const double *q_rad, double jacobian[6][GROBO_BODY_LEG_JOINTS],
                          grobo_transform *end);

/* Iterates from q_rad (hip to ankle), which is changed only on success. */
bool grobo_i_leg_numeric(const struct grobo_i_numeric *problem, const grobo_transform *start,
                         const grobo_transform *goal, double q_rad[GROBO_BODY_LEG_JOINTS]);

/* w(R), the rotation vector of R as Choreonoid computes it: 0 where the angle is below 1.4e-3. */
void grobo_i_omega(double out[3], const double r[9]);

/* The rotation vector of R, accurate however small the angle, up to near half a turn. */
void grobo_i_rotation_vector(double out[3], const double r[9]);

/* Child from parent and parent from child across one joint. */
void grobo_i_step_down(const grobo_body_link *link, double angle_rad, const grobo_transform *parent,
                       grobo_transform *out);
void grobo_i_step_up(const grobo_body_link *link, double angle_rad, const grobo_transform *child,
                     grobo_transform *out);

/* Corners of a sole whose foot is there: counter-clockwise, seen from above. */
void grobo_i_sole_corners(const grobo_body_foot *foot, const grobo_transform *at,
                          double corner_m[4][3]);

/* Corners of the convex hull of the standing soles; hull has room for 17. Returns how many. */
int grobo_i_support(const bool standing[2], double (*sole_m)[4][3], double (*hull)[2]);

/* A pose, and the links that grobo_body_forward() gave for it. */
struct grobo_i_pose {
    const double *q_rad;
    const grobo_transform *links;
};

/* Momentum while moving from one pose to the next, in the former. */
void grobo_i_momentum_between(const grobo_body_model *model, const struct grobo_i_pose *at,
                              const struct grobo_i_pose *next, double rate_hz,
                              grobo_momentum *momentum);

/* R = Rz(yaw) Ry(pitch) Rx(roll) and back; rpy = roll, pitch, yaw. */
void grobo_i_rotation_of_rpy(double r[9], const double rpy[3]);
void grobo_i_rpy_of_rotation(double rpy[3], const double r[9]);

/* ---- a motion ---- */

/* The links that have tracks of their own. */
enum { GROBO_I_WAIST = 0, GROBO_I_RIGHT = 1, GROBO_I_LEFT = 2, GROBO_I_TARGETS = 3 };

struct grobo_body {
    const grobo_body_model *model;
    grobo_body_options options;
    struct grobo_i_leg leg[2];
    double end_s; /* time of the last key */
    int n_frames;
    struct grobo_i_track *joints;                 /* one a joint, in joint order */
    struct grobo_i_track target[GROBO_I_TARGETS]; /* x y z roll pitch yaw in the world */
    struct grobo_i_track height[2];               /* z of the feet, of the stealthy step */
    struct grobo_i_track zmp;                     /* x y z */
    double *q_rad;                                /* the state: the frame solved last */
    int base;                                     /* of that frame: the target it was solved from */
    uint32_t *order;                              /* keys by time, while being set up */
    double *time_s;                               /* times of the keys, each once */
    size_t n_poses;
    double *balance;       /* the balancer's arrays, first its x, y a frame; NULL: no balancer */
    const grobo_mem *mem;  /* of a body on the heap */
    size_t bytes;          /* of it */
    bool stop_unreachable; /* its clip gives an error where a leg does not reach */
};

/* Solves the pose at a time with the waist shifted in x and y. */
void grobo_i_solve(grobo_body *body, double time_s, const double shift_m[2],
                   grobo_body_report *report);

/* Adds the keys of the stealthy step to the tracks of the feet. */
void grobo_i_stealthy_step(grobo_body *body);

/* Plays the motion on a body that can fall. True: it falls; then *fall is the finding. */
bool grobo_i_falls(grobo_body *body, const grobo_body_check_options *options,
                   grobo_body_finding *fall);

/* Adds ZMP keys and moments of rest of the feet. */
void grobo_i_zmp_auto(grobo_body *body);

#endif
