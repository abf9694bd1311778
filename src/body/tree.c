/* SPDX-License-Identifier: MIT */
/* The rigid-body tree: forward kinematics, centre of mass, momentum, zero-moment point. Textbook
 * mechanics (Newton and Euler for a chain of rigid bodies); the ZMP as
 * choreonoid-whole-body.md, section "Waist balancer", point 2, writes it. */
#include <string.h>

#include "src/body/body.h"
#include "src/body/vec.h"

/* Part of the weight below which the ground's force counts as none. */
#define FREE_FALL 1e-6

static bool finite_all(const double *v, int n)
{
    for (int i = 0; i < n; i++) {
        if (!isfinite(v[i])) {
            return false;
        }
    }
    return true;
}

static bool link_ok(const grobo_body_model *model, int index, bool *seen)
{
    const grobo_body_link *link = &model->links[index];

    if (!finite_all(link->offset_m, 3) || !finite_all(link->com_m, 3) ||
        !finite_all(link->inertia_kgm2, 9) || !isfinite(link->mass_kg) || link->mass_kg < 0) {
        return false;
    }
    if (index == 0) {
        return link->parent == -1 && link->joint == -1;
    }
    if (link->parent < 0 || link->parent >= index || link->joint < 0 ||
        link->joint >= model->n_joints || seen[link->joint]) {
        return false;
    }
    seen[link->joint] = true;
    return fabs(vec_dot(link->axis, link->axis) - 1) < 1e-9;
}

int grobo_body_model_check(const grobo_body_model *model)
{
    bool seen[GROBO_JOINTS_MAX] = {false};
    double mass_kg = 0;

    if (model == NULL || model->links == NULL || model->n_links < 1 ||
        model->n_links > GROBO_BODY_LINKS_MAX || model->n_joints != model->n_links - 1 ||
        model->n_joints > GROBO_JOINTS_MAX) {
        return GROBO_ERR_ARG;
    }
    for (int i = 0; i < model->n_links; i++) {
        if (!link_ok(model, i, seen)) {
            return GROBO_ERR_ARG;
        }
        mass_kg += model->links[i].mass_kg;
    }
    for (int foot = 0; foot < 2; foot++) {
        struct grobo_i_leg leg;

        if (!finite_all(model->feet[foot].sole_m, 3) || !finite_all(model->feet[foot].half_m, 2) ||
            grobo_i_leg_find(model, foot, &leg) < 0) {
            return GROBO_ERR_ARG;
        }
    }
    return mass_kg > 0 && model->feet[0].link != model->feet[1].link ? 0 : GROBO_ERR_ARG;
}

void grobo_i_step_down(const grobo_body_link *link, double angle_rad, const grobo_transform *parent,
                       grobo_transform *out)
{
    double turn[9], offset[3];

    mat_vec(offset, parent->r, link->offset_m);
    vec_add_scaled(out->p_m, parent->p_m, 1, offset);
    mat_axis_angle(turn, link->axis, angle_rad);
    mat_mul(out->r, parent->r, turn);
}

void grobo_i_step_up(const grobo_body_link *link, double angle_rad, const grobo_transform *child,
                     grobo_transform *out)
{
    double turn[9], offset[3];

    mat_axis_angle(turn, link->axis, -angle_rad);
    mat_mul(out->r, child->r, turn);
    mat_vec(offset, out->r, link->offset_m);
    vec_add_scaled(out->p_m, child->p_m, -1, offset);
}

void grobo_body_forward(const grobo_body_model *model, const grobo_transform *root,
                        const double *q_rad, grobo_transform *links)
{
    if (model == NULL || q_rad == NULL || links == NULL) {
        return;
    }
    static const grobo_transform upright = {{0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};

    if (root != NULL) {
        links[0] = *root;
    } else {
        links[0] = upright;
        memcpy(links[0].p_m, model->links[0].offset_m, sizeof links[0].p_m);
    }
    for (int i = 1; i < model->n_links; i++) {
        const grobo_body_link *link = &model->links[i];

        grobo_i_step_down(link, q_rad[link->joint], &links[link->parent], &links[i]);
    }
}

double grobo_body_com(const grobo_body_model *model, const grobo_transform *links, double com_m[3])
{
    if (model == NULL || links == NULL || com_m == NULL) {
        return 0;
    }
    double sum[3] = {0, 0, 0};
    double mass_kg = 0;

    for (int i = 0; i < model->n_links; i++) {
        const grobo_body_link *link = &model->links[i];
        double local[3];

        mat_vec(local, links[i].r, link->com_m);
        vec_add_scaled(local, local, 1, links[i].p_m);
        vec_add_scaled(sum, sum, link->mass_kg, local);
        mass_kg += link->mass_kg;
    }
    for (int k = 0; k < 3; k++) {
        com_m[k] = sum[k] / mass_kg;
    }
    return mass_kg;
}

/* What one link adds: m v to P, c x m v + R I R^T w to L. c is its centre of mass in the world,
 * v that point's velocity. */
static void momentum_of_link(const grobo_body_link *link, const grobo_transform *at,
                             const double v_m_s[3], const double w_rad_s[3], grobo_momentum *sum)
{
    double arm[3], c[3], v[3], spin[3], local[3], turn[3];

    mat_vec(arm, at->r, link->com_m);
    vec_add_scaled(c, at->p_m, 1, arm);
    vec_cross(v, w_rad_s, arm);
    vec_add_scaled(v, v, 1, v_m_s);
    vec_add_scaled(sum->p_kgm_s, sum->p_kgm_s, link->mass_kg, v);
    vec_cross(turn, c, v);
    vec_add_scaled(sum->l_kgm2_s, sum->l_kgm2_s, link->mass_kg, turn);
    mat_t_vec(local, at->r, w_rad_s);
    mat_vec(spin, link->inertia_kgm2, local);
    mat_vec(turn, at->r, spin);
    vec_add_scaled(sum->l_kgm2_s, sum->l_kgm2_s, 1, turn);
}

void grobo_body_momentum(const grobo_body_model *model, const grobo_transform *links,
                         const grobo_body_velocity *velocity, grobo_momentum *momentum)
{
    if (model == NULL || links == NULL || velocity == NULL || momentum == NULL) {
        return;
    }
    double v[GROBO_BODY_LINKS_MAX][3], w[GROBO_BODY_LINKS_MAX][3];

    memset(momentum, 0, sizeof *momentum);
    memcpy(v[0], velocity->linear_m_s, sizeof v[0]);
    memcpy(w[0], velocity->angular_rad_s, sizeof w[0]);
    for (int i = 0; i < model->n_links; i++) {
        const grobo_body_link *link = &model->links[i];

        if (i > 0) {
            double axis[3], arm[3], turn[3];

            mat_vec(axis, links[i].r, link->axis);
            vec_add_scaled(w[i], w[link->parent], velocity->joint_rad_s[link->joint], axis);
            vec_add_scaled(arm, links[i].p_m, -1, links[link->parent].p_m);
            vec_cross(turn, w[link->parent], arm);
            vec_add_scaled(v[i], v[link->parent], 1, turn);
        }
        momentum_of_link(link, &links[i], v[i], w[i], momentum);
    }
}

void grobo_body_zmp(const double com_m[3], double mass_kg, const grobo_momentum *rate,
                    double zmp_m[3])
{
    if (com_m == NULL || rate == NULL || zmp_m == NULL) {
        return;
    }
    const double weight = mass_kg * GROBO_BODY_GRAVITY_M_S2;
    const double *dp = rate->p_kgm_s;
    const double *dl = rate->l_kgm2_s;
    double force = dp[2] + weight;

    if (fabs(force) < FREE_FALL * weight) {
        force = FREE_FALL * weight;
    }
    zmp_m[0] = (dp[0] * zmp_m[2] - dl[1] + weight * com_m[0]) / force;
    zmp_m[1] = (dp[1] * zmp_m[2] + dl[0] + weight * com_m[1]) / force;
}
