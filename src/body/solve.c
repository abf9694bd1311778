/* SPDX-License-Identifier: MIT */
/* One pose of a motion: joints from their own keys, legs from the targets of waist and feet.
 * choreonoid-whole-body.md, sections "Base link", "Slave feet", "Solving". */
#include <string.h>

#include "src/body/body.h"
#include "src/body/vec.h"

/* A shift that IK cannot follow is bisected to this. */
#define SHIFT_TOLERANCE_M 1e-4

struct solving {
    grobo_body *body;
    double time_s;
    double shift_m[3];                   /* of the waist; z is 0 */
    bool valid[GROBO_I_TARGETS];         /* takes part in IK now */
    double beta[GROBO_I_TARGETS];        /* weight of the joints' own keys */
    grobo_transform at[GROBO_I_TARGETS]; /* where it shall be */
    double key_rad[GROBO_JOINTS_MAX];    /* the joints' own keys */
    uint64_t unreachable;
};

/* Nearest key that its author made: from i on, backwards (step -1) or forwards (+1); -1: none. */
static int authored(const struct grobo_i_track *track, int i, int step)
{
    while (i >= 0 && i < track->n && (track->flags[i] & TRACK_AUX) != 0) {
        i += step;
    }
    return i >= 0 && i < track->n ? i : -1;
}

/* Weight of the joints' own keys of a slave foot: beta = r^2 (3 - 2 r). -1: the link is ignored. */
static double slave_weight(const struct grobo_i_track *track, double t_s)
{
    const int cur = grobo_i_track_find(track, t_s);
    const int p = authored(track, cur, -1);
    const int n = authored(track, cur + 1, 1);
    const bool p_slave = p >= 0 && (track->flags[p] & TRACK_SLAVE) != 0;
    const bool n_slave = n >= 0 && (track->flags[n] & TRACK_SLAVE) != 0;
    const double *t = track->t_s;
    double r = 0;

    if (p_slave) {
        if (n < 0 || n_slave) {
            return -1;
        }
        r = (t[n] - t_s) / (t[n] - t[p]);
        if ((track->flags[n] & TRACK_TOUCH) != 0) {
            r = (track->flags[cur] & TRACK_AUX) != 0 ? 0 : (t[cur + 1] - t_s) / (t[cur + 1] - t[p]);
        }
    } else if (p >= 0 && n_slave) {
        r = (t_s - t[p]) / (t[n] - t[p]);
        if ((track->flags[p] & TRACK_TOUCH) != 0) {
            r = cur + 1 == n ? (t_s - t[cur]) / (t[n] - t[cur]) : 0;
        }
    }
    return r * r * (3 - 2 * r);
}

static void read_joints(struct solving *now)
{
    grobo_body *body = now->body;

    for (int j = 0; j < body->model->n_joints; j++) {
        if (body->joints[j].n > 0) {
            grobo_i_track_value(&body->joints[j], now->time_s, &now->key_rad[j]);
            body->q_rad[j] = now->key_rad[j];
        }
    }
}

static void read_targets(struct solving *now)
{
    const grobo_body *body = now->body;

    for (int i = 0; i < GROBO_I_TARGETS; i++) {
        const struct grobo_i_track *track = &body->target[i];
        double v[6];

        if (track->n == 0) {
            continue;
        }
        now->beta[i] = slave_weight(track, now->time_s);
        now->valid[i] = now->beta[i] >= 0;
        grobo_i_track_value(track, now->time_s, v);
        if (i != GROBO_I_WAIST && body->height[i - GROBO_I_RIGHT].n > 0) {
            grobo_i_track_value(&body->height[i - GROBO_I_RIGHT], now->time_s, &v[2]);
        }
        /* a foot follows the waist as far as it follows its joints' own keys */
        const double part = i == GROBO_I_WAIST ? 1 : fmax(now->beta[i], 0);

        vec_add_scaled(v, v, part, now->shift_m);
        memcpy(now->at[i].p_m, v, sizeof now->at[i].p_m);
        grobo_i_rotation_of_rpy(now->at[i].r, v + 3);
    }
}

/* The link the tree is walked from: of those whose present key has the base flag the one with the
 * latest key, else the latest of all, of equals the last; -1: no target has begun. */
static int find_base(const struct solving *now)
{
    int best = -1;
    bool best_flagged = false;
    double best_s = 0;

    for (int i = 0; i < GROBO_I_TARGETS; i++) {
        const struct grobo_i_track *track = &now->body->target[i];
        const int key = grobo_i_track_find(track, now->time_s);

        if (key < 0) {
            continue;
        }
        const bool flagged = (track->flags[key] & TRACK_BASE) != 0;

        if (best < 0 || (flagged && !best_flagged) ||
            (flagged == best_flagged && track->t_s[key] >= best_s)) {
            best = i;
            best_flagged = flagged;
            best_s = track->t_s[key];
        }
    }
    return best;
}

/* One leg from base to goal, whichever of them is the foot. */
static bool solve_leg(const struct solving *now, int foot, bool up, const grobo_transform *base,
                      const grobo_transform *goal, double q_rad[GROBO_BODY_LEG_JOINTS])
{
    const grobo_body *body = now->body;
    const struct grobo_i_leg *leg = &body->leg[foot];

    if (body->options.ik == GROBO_BODY_IK_NUMERIC) {
        const struct grobo_i_numeric problem = {
            body->model, leg, up, body->options.balance == GROBO_BODY_BALANCE_COMPAT11};

        return grobo_i_leg_numeric(&problem, base, goal, q_rad);
    }
    const grobo_transform *waist = up ? goal : base;
    const grobo_transform *end = up ? base : goal;
    grobo_transform local;
    double apart[3];

    vec_add_scaled(apart, end->p_m, -1, waist->p_m);
    mat_t_vec(local.p_m, waist->r, apart);
    mat_t_mul(local.r, waist->r, end->r);
    return grobo_i_leg_exact(body->model, leg, &local, q_rad);
}

/* Where the shift w of the waist exceeds what a leg can follow, the goal moves along with it by the
 * smallest c w / |w|. Choreonoid does so for each goal: for a foot this gives up a part of the
 * shift; for a waist that is solved from a foot it adds to the shift, and rarely helps. */
static bool solve_with_less_shift(const struct solving *now, int foot, bool up,
                                  const grobo_transform *base, const grobo_transform *goal,
                                  double q_rad[GROBO_BODY_LEG_JOINTS])
{
    const double length_m = hypot(now->shift_m[0], now->shift_m[1]);
    const double beta = now->beta[up ? GROBO_I_WAIST : GROBO_I_RIGHT + foot];
    double low = 0, high = length_m * (1 - beta);
    bool found = false;

    if (length_m <= 0) {
        return false;
    }
    while (high - low > SHIFT_TOLERANCE_M) {
        const double c = 0.5 * (low + high);
        grobo_transform nearer = *goal;

        vec_add_scaled(nearer.p_m, goal->p_m, c / length_m, now->shift_m);
        if (solve_leg(now, foot, up, base, &nearer, q_rad)) {
            found = true;
            high = c;
        } else {
            low = c;
        }
    }
    return found;
}

/* Solves base..target and writes the joints between. */
static void solve_target(struct solving *now, int base, int target)
{
    grobo_body *body = now->body;
    const bool up = target == GROBO_I_WAIST;
    const int foot = (up ? base : target) - GROBO_I_RIGHT;
    const struct grobo_i_leg *leg = &body->leg[foot];
    const double beta = now->beta[target];
    double q[GROBO_BODY_LEG_JOINTS];
    bool solved;

    for (int i = 0; i < GROBO_BODY_LEG_JOINTS; i++) {
        q[i] = body->q_rad[body->model->links[leg->link[i]].joint];
    }
    solved = solve_leg(now, foot, up, &now->at[base], &now->at[target], q);
    if (!solved) {
        now->unreachable |= (uint64_t)1 << body->model->feet[foot].link;
        solved = solve_with_less_shift(now, foot, up, &now->at[base], &now->at[target], q);
    }
    for (int i = 0; i < GROBO_BODY_LEG_JOINTS && solved; i++) {
        const int j = body->model->links[leg->link[i]].joint;

        body->q_rad[j] = body->joints[j].n > 0 ? beta * now->key_rad[j] + (1 - beta) * q[i] : q[i];
    }
}

/* Where the legs put the waist when a foot is the base. This is its target as far as IK reached
 * it. */
static void waist_from_foot(const grobo_body *body, int foot, const grobo_transform *at,
                            grobo_transform *waist)
{
    grobo_transform below = *at;

    for (int i = GROBO_BODY_LEG_JOINTS - 1; i >= 0; i--) {
        const grobo_body_link *link = &body->model->links[body->leg[foot].link[i]];

        grobo_i_step_up(link, body->q_rad[link->joint], &below, waist);
        below = *waist;
    }
}

/* Walks the tree from the base link: waist to feet, or foot to waist and on to the other foot. */
static void solve_targets(struct solving *now, grobo_transform *root)
{
    static const double upright[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    grobo_body *body = now->body;
    const int base = find_base(now);

    body->base = base < 0 ? GROBO_I_WAIST : base;
    memcpy(root->p_m, body->model->links[0].offset_m, sizeof root->p_m);
    memcpy(root->r, upright, sizeof root->r);
    if (base < 0 || body->options.ik == GROBO_BODY_IK_OFF) {
        return;
    }
    if (base != GROBO_I_WAIST && now->valid[GROBO_I_WAIST]) {
        solve_target(now, base, GROBO_I_WAIST);
    }
    for (int i = GROBO_I_RIGHT; i <= GROBO_I_LEFT; i++) {
        if (i != base && now->valid[i] && (base == GROBO_I_WAIST || now->valid[GROBO_I_WAIST])) {
            solve_target(now, GROBO_I_WAIST, i);
        }
    }
    if (base == GROBO_I_WAIST) {
        *root = now->at[GROBO_I_WAIST];
    } else {
        waist_from_foot(body, base - GROBO_I_RIGHT, &now->at[base], root);
    }
}

/* A foot stands between two touching keys, and before the first key if that one touches.
 * With the stealthy step the keys of its height say so: those of its place begin to touch before it
 * is down. */
static bool stands(const grobo_body *body, int foot, double t_s)
{
    const struct grobo_i_track *track =
        body->height[foot].n > 0 ? &body->height[foot] : &body->target[GROBO_I_RIGHT + foot];
    const int key = grobo_i_track_find(track, t_s);

    if (track->n == 0 || (track->flags[key < 0 ? 0 : key] & TRACK_TOUCH) == 0) {
        return false;
    }
    return key == track->n - 1 || (track->flags[key + 1] & TRACK_TOUCH) != 0;
}

void grobo_i_solve(grobo_body *body, double time_s, const double shift_m[2],
                   grobo_body_report *report)
{
    struct solving now = {.body = body, .time_s = time_s};

    memcpy(now.shift_m, shift_m, 2 * sizeof *shift_m);
    memset(report, 0, sizeof *report);
    read_joints(&now);
    read_targets(&now);
    solve_targets(&now, &report->root);
    report->time_s = time_s;
    report->unreachable = now.unreachable;
    report->has_zmp = body->zmp.n > 0;
    if (report->has_zmp) {
        grobo_i_track_value(&body->zmp, time_s, report->zmp_m);
    }
    for (int foot = 0; foot < 2; foot++) {
        report->touching[foot] = stands(body, foot, time_s);
    }
}
