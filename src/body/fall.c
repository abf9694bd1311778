/* SPDX-License-Identifier: MIT */
/*
 * Whether a body falls that plays a motion. The joints follow the motion as servos do; the body is
 * free, begins on its feet, and only the corners of its soles meet the floor. So a foot bears what
 * it can bear, whatever the motion says of it.
 *
 * Momentum is the state (Newton and Euler for the whole body): the floor's forces and the weight
 * change it, and the velocity of the root is what the moving joints leave of it. The floor is a
 * spring and a damper under each corner, with Coulomb friction that sticks to an anchor.
 */
#include <string.h>

#include "src/body/body.h"
#include "src/body/vec.h"
#include "src/model/joint.h"

#define STEP_S 0.001
/* How far the floor gives way under the resting body, and its damping ratio. */
#define SINK_M 3e-4
#define DAMPING 0.3
/* Friction of rubber on a smooth floor; a guess, as in the exported models. */
#define FRICTION 0.8
/* A servo follows its goal by about so much. */
#define LAG_S 0.03
/* How far a servo gives way: its stiffness is so many times weight and height of the body's
 * centre, as RS30x servos have it in a GR001 (5 Nm/rad); friction and inertia delay it. */
#define STIFFNESS 3.0
#define YIELD_S 0.03
/* What dry friction of its gear holds of a load, of weight and height. */
#define HOLDS 0.016
/* Servos give way under load and real floors are not level: a motion that falls on a floor which
 * slopes so much, to any side, is in doubt. */
#define SLOPE_RAD (BODY_PI / 180 * 1.5)
/* It lies when both soles are turned up so far; until so far it may come back. */
#define FALLEN_RAD (BODY_PI / 6)
#define TILTED_RAD (BODY_PI / 18)
/* It stands so long before the motion, and has so long to fall behind it. */
#define BEFORE_S 0.2
#define AFTER_S 1.0
/* A longer motion is judged as far as here. */
#define MOST_S 600
/* Of its servos' speed, on the way to the first frame. */
#define APPROACH_PART 0.5

enum { CORNERS = 8 };

struct falling {
    grobo_body *body;
    const grobo_body_check_options *options;
    double mass_kg;
    double weight_m_s2[3]; /* gravity, as the floor sees it */
    double stiff_n_m, damp_ns_m;
    double q_rad[GROBO_JOINTS_MAX], goal_rad[GROBO_JOINTS_MAX], speed_rad_s[GROBO_JOINTS_MAX];
    double force_n[GROBO_BODY_LINKS_MAX][3]; /* weight and floor, on each link */
    double turn_nm[GROBO_BODY_LINKS_MAX][3]; /* about the world's origin */
    double yield_rad[GROBO_JOINTS_MAX];      /* how far the joints give way to that */
    double lever_nm;                         /* weight times height of the centre of mass */
    double first_rad[GROBO_JOINTS_MAX];      /* where the motion begins */
    grobo_transform root;
    grobo_transform links[GROBO_BODY_LINKS_MAX];
    double com_m[3];
    double p_kgm_s[3], l_kgm2_s[3]; /* momentum; the angular one about the centre of mass */
    double sole_m[2][4][3];
    double anchor_m[CORNERS][2]; /* where friction holds a corner */
    bool touches[CORNERS];
};

/* ---- geometry -------------------------------------------------------------------------------- */

static void place(struct falling *now)
{
    const grobo_body_model *model = now->body->model;

    grobo_body_forward(model, &now->root, now->q_rad, now->links);
    now->mass_kg = grobo_body_com(model, now->links, now->com_m);
    for (int foot = 0; foot < 2; foot++) {
        grobo_i_sole_corners(&model->feet[foot], &now->links[model->feet[foot].link],
                             now->sole_m[foot]);
    }
}

/* The sole that lies flatter on the floor. */
static const double *flatter_sole(const struct falling *now)
{
    const grobo_body_foot *feet = now->body->model->feet;
    const double *right = now->links[feet[0].link].r, *left = now->links[feet[1].link].r;

    return right[8] > left[8] ? right : left;
}

static double tilt_rad(const struct falling *now)
{
    return acos(fmin(flatter_sole(now)[8], 1));
}

/* ---- forces ---------------------------------------------------------------------------------- */

/* Force of the floor on a corner that moves with v. */
static void floor_force(struct falling *now, int i, const double v_m_s[3], double force_n[3])
{
    const double *at = now->sole_m[i / 4][i % 4];

    force_n[0] = force_n[1] = 0;
    force_n[2] = fmax(0, -now->stiff_n_m * at[2] - now->damp_ns_m * v_m_s[2]);
    if (at[2] >= 0 || force_n[2] <= 0) {
        now->touches[i] = false;
        force_n[2] = 0;
        return;
    }
    if (!now->touches[i]) {
        now->touches[i] = true;
        memcpy(now->anchor_m[i], at, sizeof now->anchor_m[i]);
    }
    for (int k = 0; k < 2; k++) {
        force_n[k] =
            -now->stiff_n_m / 2 * (at[k] - now->anchor_m[i][k]) - now->damp_ns_m / 2 * v_m_s[k];
    }
    const double holds_n = FRICTION * force_n[2], pull_n = hypot(force_n[0], force_n[1]);

    for (int k = 0; k < 2 && pull_n > holds_n; k++) {
        force_n[k] *= holds_n / pull_n;
        now->anchor_m[i][k] = at[k] + force_n[k] / (now->stiff_n_m / 2);
    }
}

static void load_link(struct falling *now, int link, const double at_m[3], const double force_n[3])
{
    double turn[3];

    vec_cross(turn, at_m, force_n);
    vec_add_scaled(now->force_n[link], now->force_n[link], 1, force_n);
    vec_add_scaled(now->turn_nm[link], now->turn_nm[link], 1, turn);
}

/* Each link's own weight; forces on feet come on top. */
static void load_by_weight(struct falling *now)
{
    const grobo_body_model *model = now->body->model;

    memset(now->force_n, 0, sizeof now->force_n);
    memset(now->turn_nm, 0, sizeof now->turn_nm);
    for (int i = 0; i < model->n_links; i++) {
        double at[3], force[3];

        mat_vec(at, now->links[i].r, model->links[i].com_m);
        vec_add_scaled(at, at, 1, now->links[i].p_m);
        for (int k = 0; k < 3; k++) {
            force[k] = model->links[i].mass_kg * now->weight_m_s2[k];
        }
        load_link(now, i, at, force);
    }
}

/* The joints give way to what friction does not hold; from the ends of the limbs to the waist. */
static void give_way(struct falling *now)
{
    const grobo_body_model *model = now->body->model;
    const double stiffness = STIFFNESS * now->lever_nm, holds = HOLDS / STIFFNESS;

    for (int i = model->n_links - 1; i > 0; i--) {
        const grobo_body_link *link = &model->links[i];
        double *yield = &now->yield_rad[link->joint];
        double arm[3], turn[3], axis[3];

        vec_cross(arm, now->links[i].p_m, now->force_n[i]);
        vec_add_scaled(turn, now->turn_nm[i], -1, arm);
        mat_vec(axis, now->links[i].r, link->axis);
        const double beyond = vec_dot(axis, turn) / stiffness - *yield;

        *yield += STEP_S / YIELD_S * (beyond - fmin(fmax(beyond, -holds), holds));
        for (int k = 0; k < 3; k++) {
            now->force_n[link->parent][k] += now->force_n[i][k];
            now->turn_nm[link->parent][k] += now->turn_nm[i][k];
        }
    }
}

/* Changes the momentum by a step of the floor's forces and the weight. */
static void push(struct falling *now, double (*before_m)[4][3])
{
    load_by_weight(now);
    for (int i = 0; i < CORNERS; i++) {
        const double *at = now->sole_m[i / 4][i % 4], *was = before_m[i / 4][i % 4];
        double v[3], force[3], arm[3], turn[3];

        for (int k = 0; k < 3; k++) {
            v[k] = (at[k] - was[k]) / STEP_S;
        }
        floor_force(now, i, v, force);
        load_link(now, now->body->model->feet[i / 4].link, at, force);
        vec_add_scaled(arm, at, -1, now->com_m);
        vec_cross(turn, arm, force);
        vec_add_scaled(now->p_kgm_s, now->p_kgm_s, STEP_S, force);
        vec_add_scaled(now->l_kgm2_s, now->l_kgm2_s, STEP_S, turn);
    }
    give_way(now);
    vec_add_scaled(now->p_kgm_s, now->p_kgm_s, now->mass_kg * STEP_S, now->weight_m_s2);
}

/* ---- motion ---------------------------------------------------------------------------------- */

/* The body's inertia about its centre of mass. */
static void inertia(const struct falling *now, double sum[9])
{
    const grobo_body_model *model = now->body->model;

    memset(sum, 0, 9 * sizeof *sum);
    for (int i = 0; i < model->n_links; i++) {
        const grobo_body_link *link = &model->links[i];
        const grobo_transform *at = &now->links[i];
        double arm[3], half[9], turned[9], back[9];

        mat_vec(arm, at->r, link->com_m);
        vec_add_scaled(arm, arm, 1, at->p_m);
        vec_add_scaled(arm, arm, -1, now->com_m);
        for (int k = 0; k < 9; k++) {
            back[k] = at->r[k % 3 * 3 + k / 3];
        }
        mat_mul(half, at->r, link->inertia_kgm2);
        mat_mul(turned, half, back);
        for (int k = 0; k < 9; k++) {
            const double own = k % 4 == 0 ? vec_dot(arm, arm) : 0;

            sum[k] += turned[k] + link->mass_kg * (own - arm[k / 3] * arm[k % 3]);
        }
    }
}

/* x = m^-1 b of a symmetric matrix that is positive, by Cramer's rule */
static void divide(double x[3], const double m[9], const double b[3])
{
    double across[3][3], all;

    vec_cross(across[0], &m[3], &m[6]);
    vec_cross(across[1], &m[6], &m[0]);
    vec_cross(across[2], &m[0], &m[3]);
    all = vec_dot(&m[0], across[0]);
    for (int k = 0; k < 3; k++) {
        x[k] = (b[0] * across[0][k] + b[1] * across[1][k] + b[2] * across[2][k]) / all;
    }
}

/* The root moves by what the joints leave of the momentum. */
static void move_root(struct falling *now)
{
    const grobo_body_velocity joints = {{0, 0, 0}, {0, 0, 0}, now->speed_rad_s};
    grobo_momentum own;
    double about[3], left[3], all[9], w[3], v[3], arm[3], turn[3], step[9], turned[9];

    grobo_body_momentum(now->body->model, now->links, &joints, &own);
    vec_cross(about, now->com_m, own.p_kgm_s);
    vec_add_scaled(left, now->l_kgm2_s, -1, own.l_kgm2_s);
    vec_add_scaled(left, left, 1, about);
    inertia(now, all);
    divide(w, all, left);
    vec_add_scaled(arm, now->com_m, -1, now->root.p_m);
    vec_cross(turn, w, arm);
    for (int k = 0; k < 3; k++) {
        v[k] = (now->p_kgm_s[k] - own.p_kgm_s[k]) / now->mass_kg - turn[k];
    }
    vec_add_scaled(now->root.p_m, now->root.p_m, STEP_S, v);
    const double speed = sqrt(vec_dot(w, w));

    if (speed > 0) {
        const double axis[3] = {w[0] / speed, w[1] / speed, w[2] / speed};

        mat_axis_angle(step, axis, speed * STEP_S);
        mat_mul(turned, step, now->root.r);
        memcpy(now->root.r, turned, sizeof turned);
    }
}

/* The servos follow their goals as far as the load lets them, no faster than they can. */
static void follow(struct falling *now)
{
    const grobo_body_model *model = now->body->model;
    const grobo_model *robot = now->options->robot;
    for (int j = 0; j < model->n_joints; j++) {
        const double most = robot != NULL ? grobo_i_joint(robot, j)->max_speed_rad_s : INFINITY;
        const double wanted = (now->goal_rad[j] + now->yield_rad[j] - now->q_rad[j]) / LAG_S;

        now->speed_rad_s[j] = fmin(fmax(wanted, -most), most);
        now->q_rad[j] += now->speed_rad_s[j] * STEP_S;
    }
}

static void advance(struct falling *now)
{
    double before_m[2][4][3];

    follow(now);
    move_root(now);
    memcpy(before_m, now->sole_m, sizeof before_m);
    place(now);
    push(now, before_m);
}

/* ---- what is played -------------------------------------------------------------------------- */

/* The goals of a frame; joints that the motion leaves alone stay where they begin. */
static void read_frame(struct falling *now, int frame, double *goal_rad)
{
    const grobo_model *robot = now->options->robot;
    const grobo_joint_mask moves = grobo_body_joints(now->body);
    double q_rad[GROBO_JOINTS_MAX];
    grobo_body_report report;

    (void)grobo_body_frame(now->body, frame, q_rad, &report);
    for (int j = 0; j < now->body->model->n_joints; j++) {
        if (robot == NULL || (moves & GROBO_JOINT_BIT(j)) != 0) {
            goal_rad[j] = robot != NULL ? grobo_model_take_slack(robot, j, q_rad[j]) : q_rad[j];
        }
    }
}

/* Stands as a user starts it: in the initial posture, or that of the first frame. */
static void stand_up(struct falling *now)
{
    const grobo_body_model *model = now->body->model;
    const grobo_model *robot = now->options->robot;
    grobo_body_stand stand;

    for (int j = 0; j < model->n_joints && robot != NULL; j++) {
        now->first_rad[j] = grobo_i_joint(robot, j)->init_rad;
    }
    memcpy(now->q_rad, now->first_rad, sizeof now->q_rad);
    read_frame(now, 0, now->first_rad);
    if (robot == NULL) {
        memcpy(now->q_rad, now->first_rad, sizeof now->q_rad);
    }
    memcpy(now->goal_rad, now->q_rad, sizeof now->goal_rad);
    (void)grobo_body_stand_pose(model, now->q_rad, NULL, &stand);
    now->root = stand.root;
    place(now);
    now->stiff_n_m = now->mass_kg * GROBO_BODY_GRAVITY_M_S2 / (CORNERS * SINK_M);
    now->lever_nm = now->mass_kg * GROBO_BODY_GRAVITY_M_S2 * fmax(now->com_m[2], 0.01);
    now->damp_ns_m = DAMPING * sqrt(now->stiff_n_m * now->mass_kg);
}

/* Continues for a time of the world; the time of the motion is at_s and goes on at a rate. False:
 * it lies. */
static bool carry_on(struct falling *now, double time_s, double at_s, double rate,
                     grobo_body_finding *fall)
{
    const int steps = (int)ceil(time_s / STEP_S - 1e-9);

    for (int i = 0; i < steps; i++) {
        advance(now);
        const double tilt = tilt_rad(now);

        if (tilt < TILTED_RAD) {
            fall->begin_s = at_s + i * STEP_S * rate;
        }
        if (!(tilt < FALLEN_RAD)) {
            fall->worst_s = fall->end_s = at_s + i * STEP_S * rate;
            return false;
        }
    }
    return true;
}

/* Moves from where it stands to the first frame. False: it lies. */
static bool approach(struct falling *now, grobo_body_finding *fall)
{
    const grobo_model *robot = now->options->robot;
    double from_rad[GROBO_JOINTS_MAX], time_s = 0;

    memcpy(from_rad, now->goal_rad, sizeof from_rad);
    for (int j = 0; j < now->body->model->n_joints && robot != NULL; j++) {
        time_s = fmax(time_s, fabs(now->first_rad[j] - from_rad[j]) /
                                  (APPROACH_PART * grobo_i_joint(robot, j)->max_speed_rad_s));
    }
    const int steps = (int)ceil(time_s * 100);

    for (int i = 1; i <= steps; i++) {
        for (int j = 0; j < now->body->model->n_joints; j++) {
            now->goal_rad[j] = from_rad[j] + (now->first_rad[j] - from_rad[j]) * i / steps;
        }
        if (!carry_on(now, 0.01, 0, 0, fall)) {
            return false;
        }
    }
    return true;
}

/* False: it lies. */
static bool play(struct falling *now, grobo_body_finding *fall)
{
    const double speed = now->options->speed_pct > 0 ? now->options->speed_pct / 100.0 : 1;
    const double frame_s = 1 / (now->body->options.rate_hz * speed);
    double at_s = 0, due_s = 0;

    if (!carry_on(now, BEFORE_S, 0, 0, fall) || !approach(now, fall)) {
        return false;
    }
    for (int i = 0; i < now->body->n_frames && i * frame_s < MOST_S; i++) {
        due_s += frame_s;
        at_s = i / now->body->options.rate_hz;
        read_frame(now, i, now->goal_rad);
        const double steps = floor(due_s / STEP_S);

        due_s -= steps * STEP_S;
        if (!carry_on(now, steps * STEP_S, at_s, speed, fall)) {
            return false;
        }
    }
    return carry_on(now, AFTER_S, at_s, 0, fall);
}

/* Where its soles lean. */
static int side_of(const struct falling *now)
{
    const double ahead = flatter_sole(now)[2], left = flatter_sole(now)[5];

    if (fabs(ahead) > fabs(left)) {
        return ahead > 0 ? GROBO_BODY_AHEAD : GROBO_BODY_BACK;
    }
    return left > 0 ? GROBO_BODY_LEFT : GROBO_BODY_RIGHT;
}

/* Where the floor falls off by a slope to the side x, y of the world. */
static bool falls_on(const struct falling *fresh, double slope_rad, const double side[2],
                     grobo_body_finding *fall)
{
    struct falling now = *fresh;

    *fall = (grobo_body_finding){.problem = GROBO_BODY_FALL, .worst = slope_rad};
    for (int k = 0; k < 2; k++) {
        now.weight_m_s2[k] = GROBO_BODY_GRAVITY_M_S2 * sin(slope_rad) * side[k];
    }
    now.weight_m_s2[2] = -GROBO_BODY_GRAVITY_M_S2 * cos(slope_rad);
    stand_up(&now);
    if (play(&now, fall)) {
        return false;
    }
    fall->index = side_of(&now);
    return true;
}

bool grobo_i_falls(grobo_body *body, const grobo_body_check_options *options,
                   grobo_body_finding *fall)
{
    static const double sides[][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    const struct falling fresh = {.body = body, .options = options};
    bool falls = falls_on(&fresh, 0, sides[0], fall);

    for (size_t i = 0; i < sizeof sides / sizeof sides[0] && !falls; i++) {
        falls = falls_on(&fresh, SLOPE_RAD, sides[i], fall);
    }
    return falls;
}
