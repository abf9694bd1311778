/* SPDX-License-Identifier: MIT */
/* A robot with a waist and two feet as a body whose legs can be solved: its links with frames that
 * all stand upright at 0, parts that are fixed joined to what carries them. */
#include <math.h>
#include <string.h>

#include <grobo/robot_file.h>

#include "src/body/body.h"
#include "src/robots/robots.h"

/* A part's frame in that of the waist, all joints at 0. */
typedef struct frame {
    double p_m[3], r[9];
    int link; /* of the body */
} frame;

static void multiply(const double a[9], const double b[9], double out[9])
{
    for (int i = 0; i < 9; i++) {
        out[i] = a[i / 3 * 3] * b[i % 3] + a[i / 3 * 3 + 1] * b[3 + i % 3] +
                 a[i / 3 * 3 + 2] * b[6 + i % 3];
    }
}

static void turn(const double r[9], const double v[3], double out[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = r[3 * i] * v[0] + r[3 * i + 1] * v[1] + r[3 * i + 2] * v[2];
    }
}

static void place(const grobo_robot_link *link, const frame *parent, frame *to)
{
    double own[9], at[3];
    grobo_i_rotation_of_rpy(own, link->origin_rad);
    turn(parent->r, link->origin_m, at);
    for (int i = 0; i < 3; i++) {
        to->p_m[i] = parent->p_m[i] + at[i];
    }
    multiply(parent->r, own, to->r);
}

/* The inertia of a point mass away from where it is taken about. */
static void add_far(double inertia[9], double mass_kg, const double d[3])
{
    double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    for (int i = 0; i < 9; i++) {
        inertia[i] += mass_kg * ((i % 4 == 0 ? square : 0) - d[i / 3] * d[i % 3]);
    }
}

/* A part's mass joins that of a link of the body, which is where `origin` is. */
static void add_mass(grobo_body_link *to, const grobo_robot_link *from, const frame *at,
                     const double origin_m[3])
{
    const double *i = from->inertia_kgm2;
    const double own[9] = {i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2]};
    double half[9], turned[9], back[9], com[3], before[3], after[3];
    double mass_kg = to->mass_kg + from->mass_kg;
    if (from->mass_kg <= 0) {
        return;
    }
    for (int k = 0; k < 9; k++) {
        back[k] = at->r[k % 3 * 3 + k / 3];
    }
    multiply(at->r, own, half);
    multiply(half, back, turned);
    turn(at->r, from->com_m, com);
    for (int k = 0; k < 3; k++) {
        com[k] += at->p_m[k] - origin_m[k];
        double joined = (to->mass_kg * to->com_m[k] + from->mass_kg * com[k]) / mass_kg;
        before[k] = to->com_m[k] - joined;
        after[k] = com[k] - joined;
        to->com_m[k] = to->mass_kg > 0 ? joined : com[k];
    }
    for (int k = 0; k < 9; k++) {
        to->inertia_kgm2[k] += turned[k];
    }
    if (to->mass_kg > 0) {
        add_far(to->inertia_kgm2, to->mass_kg, before);
        add_far(to->inertia_kgm2, from->mass_kg, after);
    }
    to->mass_kg = mass_kg;
}

/* Links of the body, each joint's where its part is; `origin` of each in the waist's frame. */
static void make_links(const grobo_robot_def *def, grobo_robot_body *body, frame *frames)
{
    double origin_m[GROBO_BODY_LINKS_MAX][3] = {{0}};
    const frame upright = {.r = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    for (int i = 0; i < def->n_links; i++) {
        const grobo_robot_link *from = &def->links[i];
        frame *at = &frames[i];
        *at = upright;
        if (i > 0) {
            place(from, &frames[from->parent], at);
            at->link = frames[from->parent].link;
        }
        if (i == 0 || from->joint >= 0) {
            int parent = at->link;
            at->link = body->model.n_links++;
            grobo_body_link *to = &body->links[at->link];
            to->name = from->name;
            to->parent = i == 0 ? -1 : parent;
            to->joint = from->joint;
            turn(at->r, from->axis, to->axis);
            for (int k = 0; k < 3; k++) {
                origin_m[at->link][k] = at->p_m[k];
                to->offset_m[k] = i == 0 ? from->origin_m[k] : at->p_m[k] - origin_m[parent][k];
            }
        }
        add_mass(&body->links[at->link], from, at, origin_m[at->link]);
    }
    /* Soles: from the frames of the file's parts to those of the body's links; the right one, which
     * is at the smaller y, is the first. */
    const grobo_robot_foot *feet = def->feet;
    int right = frames[feet[0].link].p_m[1] <= frames[feet[1].link].p_m[1] ? 0 : 1;
    for (int side = 0; side < 2; side++) {
        const grobo_robot_foot *from = &feet[side == 0 ? right : 1 - right];
        const frame *at = &frames[from->link];
        grobo_body_foot *to = &body->model.feet[side];
        to->link = at->link;
        turn(at->r, from->sole_m, to->sole_m);
        for (int k = 0; k < 3; k++) {
            to->sole_m[k] += at->p_m[k] - origin_m[at->link][k];
        }
        to->half_m[0] = from->half_m[0];
        to->half_m[1] = from->half_m[1];
    }
}

int grobo_robot_def_body(const grobo_robot_def *def, grobo_robot_body *body)
{
    frame frames[GROBO_ROBOT_LINKS_MAX];
    if (def == NULL || body == NULL) {
        return GROBO_ERR_ARG;
    }
    if (def->n_feet != 2 || def->n_links == 0 || def->n_links > GROBO_ROBOT_LINKS_MAX ||
        def->links[0].joint >= 0) {
        return GROBO_ERR_UNSUPPORTED;
    }
    memset(body, 0, sizeof *body);
    body->model.name = def->model->name;
    body->model.links = body->links;
    body->model.n_joints = def->model->n_joints;
    make_links(def, body, frames);
    return grobo_body_model_check(&body->model) < 0 ? GROBO_ERR_UNSUPPORTED : GROBO_OK;
}
