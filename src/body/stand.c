/* SPDX-License-Identifier: MIT */
/* A pose on the ground, of which only the angles are known; and what moves between two poses. */
#include <string.h>

#include "src/body/body.h"
#include "src/body/polygon.h"
#include "src/body/vec.h"

/* A sole whose corners are all so near to the ground stands on it. */
#define STANDS_M 0.004
/* So far below the other one is no rounding: it would stand in the ground. */
#define BELOW_M 1e-6

void grobo_i_sole_corners(const grobo_body_foot *foot, const grobo_transform *at,
                          double corner_m[4][3])
{
    static const double sign[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};

    for (int i = 0; i < 4; i++) {
        const double local[3] = {foot->sole_m[0] + sign[i][0] * foot->half_m[0],
                                 foot->sole_m[1] + sign[i][1] * foot->half_m[1], foot->sole_m[2]};
        double arm[3];

        mat_vec(arm, at->r, local);
        vec_add_scaled(corner_m[i], at->p_m, 1, arm);
    }
}

int grobo_i_support(const bool standing[2], double (*sole_m)[4][3], double (*hull)[2])
{
    double points[8][2];
    int n = 0;

    for (int foot = 0; foot < 2; foot++) {
        for (int i = 0; i < 4 && standing[foot]; i++) {
            memcpy(points[n++], sole_m[foot][i], sizeof points[0]);
        }
    }
    return n > 0 ? grobo_i_convex_hull(points, n, hull) : 0;
}

void grobo_i_momentum_between(const grobo_body_model *model, const struct grobo_i_pose *at,
                              const struct grobo_i_pose *next, double rate_hz,
                              grobo_momentum *momentum)
{
    double joint_rad_s[GROBO_JOINTS_MAX], turn[9], w[3];
    grobo_body_velocity velocity = {{0, 0, 0}, {0, 0, 0}, joint_rad_s};

    for (int j = 0; j < model->n_joints; j++) {
        joint_rad_s[j] = (next->q_rad[j] - at->q_rad[j]) * rate_hz;
    }
    mat_t_mul(turn, at->links[0].r, next->links[0].r);
    grobo_i_rotation_vector(w, turn);
    mat_vec(velocity.angular_rad_s, at->links[0].r, w);
    for (int k = 0; k < 3; k++) {
        velocity.linear_m_s[k] = (next->links[0].p_m[k] - at->links[0].p_m[k]) * rate_hz;
        velocity.angular_rad_s[k] *= rate_hz;
    }
    grobo_body_momentum(model, at->links, &velocity, momentum);
}

/* ---- a pose that stands ---------------------------------------------------------------------- */

/* The root, where this foot's sole lies flat on the ground, its centre where it is with straight
 * legs. */
static void stand_on(const grobo_body_model *model, int side, const double *q_rad,
                     grobo_transform *root)
{
    static const double straight_rad[GROBO_JOINTS_MAX];
    const grobo_body_foot *foot = &model->feet[side];
    grobo_transform links[GROBO_BODY_LINKS_MAX];
    double sole_m[3], to_root_m[3];

    grobo_body_forward(model, NULL, straight_rad, links);
    vec_add_scaled(sole_m, links[foot->link].p_m, 1, foot->sole_m);
    sole_m[2] = 0;
    grobo_body_forward(model, NULL, q_rad, links);
    const grobo_transform *at = &links[foot->link];

    /* The foot in the frame of the root, turned back: root = sole - R (foot + Rfoot sole). */
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            root->r[3 * i + k] = at->r[3 * k + i];
        }
    }
    vec_add_scaled(to_root_m, at->p_m, -1, links[0].p_m);
    mat_vec(root->p_m, root->r, to_root_m);
    vec_add_scaled(root->p_m, root->p_m, 1, foot->sole_m);
    vec_add_scaled(root->p_m, sole_m, -1, root->p_m);
}

static double lowest_m(double (*corner_m)[3])
{
    double lowest = corner_m[0][2];

    for (int i = 1; i < 4; i++) {
        lowest = fmin(lowest, corner_m[i][2]);
    }
    return lowest;
}

static bool lies_flat(double (*corner_m)[3])
{
    bool flat = true;

    for (int i = 0; i < 4; i++) {
        flat = flat && fabs(corner_m[i][2]) < STANDS_M;
    }
    return flat;
}

static void see_feet(const grobo_body_model *model, const double *q_rad, grobo_body_stand *stand)
{
    grobo_transform links[GROBO_BODY_LINKS_MAX];
    double hull[17][2];

    grobo_body_forward(model, &stand->root, q_rad, links);
    (void)grobo_body_com(model, links, stand->com_m);
    for (int foot = 0; foot < 2; foot++) {
        grobo_i_sole_corners(&model->feet[foot], &links[model->feet[foot].link],
                             stand->sole_m[foot]);
        stand->standing[foot] = lies_flat(stand->sole_m[foot]);
    }
    stand->n_support = grobo_i_support(stand->standing, stand->sole_m, hull);
    memcpy(stand->support_m, hull, (size_t)stand->n_support * sizeof hull[0]);
}

int grobo_body_stand_pose(const grobo_body_model *model, const double *q_rad,
                          const grobo_transform *root, grobo_body_stand *stand)
{
    if (model == NULL || q_rad == NULL || stand == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_body_stand s;

    memset(&s, 0, sizeof s);
    for (int j = 0; j < model->n_joints; j++) {
        if (!isfinite(q_rad[j])) {
            return GROBO_ERR_NAN;
        }
    }
    if (root != NULL) {
        s.root = *root;
        see_feet(model, q_rad, &s);
    } else {
        stand_on(model, 0, q_rad, &s.root);
        see_feet(model, q_rad, &s);
        if (lowest_m(s.sole_m[1]) < -BELOW_M) {
            s.foot = 1;
            stand_on(model, 1, q_rad, &s.root);
            see_feet(model, q_rad, &s);
        }
    }
    *stand = s;
    return GROBO_OK;
}

double grobo_body_stand_margin(const grobo_body_stand *stand, const double *point_m)
{
    double hull[8][2];

    if (stand == NULL || point_m == NULL || stand->n_support == 0) {
        return -INFINITY;
    }
    memcpy(hull, stand->support_m, sizeof hull);
    return grobo_i_polygon_margin(hull, stand->n_support, point_m);
}

int grobo_body_zmp_of_poses(const grobo_body_model *model, const grobo_transform root[3],
                            const double *const q_rad[3], double dt_s, double zmp_m[3])
{
    if (model == NULL || root == NULL || q_rad == NULL || zmp_m == NULL || !(dt_s > 0)) {
        return GROBO_ERR_ARG;
    }
    grobo_transform links[3][GROBO_BODY_LINKS_MAX];
    struct grobo_i_pose pose[3];
    grobo_momentum before, after, rate;
    double com_m[3];

    for (int i = 0; i < 3; i++) {
        grobo_body_forward(model, &root[i], q_rad[i], links[i]);
        pose[i] = (struct grobo_i_pose){q_rad[i], links[i]};
    }
    grobo_i_momentum_between(model, &pose[0], &pose[1], 1 / dt_s, &before);
    grobo_i_momentum_between(model, &pose[1], &pose[2], 1 / dt_s, &after);
    for (int k = 0; k < 3; k++) {
        rate.p_kgm_s[k] = (after.p_kgm_s[k] - before.p_kgm_s[k]) / dt_s;
        rate.l_kgm2_s[k] = (after.l_kgm2_s[k] - before.l_kgm2_s[k]) / dt_s;
    }
    const double mass_kg = grobo_body_com(model, links[1], com_m);

    zmp_m[2] = 0;
    grobo_body_zmp(com_m, mass_kg, &rate, zmp_m);
    return GROBO_OK;
}
