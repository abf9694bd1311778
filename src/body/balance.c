/* SPDX-License-Identifier: MIT */
/* The waist balancer: choreonoid-whole-body.md, section of that name, points 1 to 3. The waist is
 * shifted in x and y, frame by frame, until the ZMP of the moving body is the desired one. */
#include <string.h>

#include "src/body/balance.h"
#include "src/body/vec.h"

#define ROUNDS 2
#define SMOOTH_S 0.5
#define SHIFT_MAX_M 1.0
#define GRAVITY_MIN_M_S2 1.0
#define ADJUST_ROUNDS 50
#define ADJUST_TOLERANCE_M 1e-6
/* At the end the shift fades away only where the body stands over its ZMP anyway. */
#define AT_REST_M 2e-3

/* Whole-motion arrays: a row a frame. */
struct balancing {
    grobo_body *body;
    int n; /* frames */
    double dt_s;
    double (*shift_m)[2];
    double (*error_m)[2];  /* desired - computed ZMP; the solver's right side */
    double *a;             /* -cz / (g' dt^2), cz above the ground's plane */
    double *factor;        /* of the elimination */
    double adjust_m[2][2]; /* at the begin and the end: the shift that puts the body over its ZMP */
    bool adjusted[2];
};

/* A frame that is solved. */
struct pose {
    grobo_body_report report;
    double q_rad[GROBO_JOINTS_MAX];
    grobo_transform links[GROBO_BODY_LINKS_MAX];
    int base; /* link that it was solved from */
};

/* How the body moves from one frame to the next, as seen from its base link. */
struct motion {
    int base; /* link */
    double linear_m_s[3];
    double angular_rad_s[3];
    double joint_rad_s[GROBO_JOINTS_MAX];
};

size_t grobo_i_balance_doubles(int n_frames)
{
    return (size_t)n_frames * 6;
}

static void solve_frame(const struct balancing *now, int frame, const double shift_m[2],
                        struct pose *pose)
{
    grobo_body *body = now->body;
    const double t_s = fmin((double)frame * now->dt_s, body->end_s);

    grobo_i_solve(body, t_s, shift_m, &pose->report);
    memcpy(pose->q_rad, body->q_rad, (size_t)body->model->n_joints * sizeof *pose->q_rad);
    grobo_body_forward(body->model, &pose->report.root, pose->q_rad, pose->links);
    pose->base =
        body->base == GROBO_I_WAIST ? 0 : body->model->feet[body->base - GROBO_I_RIGHT].link;
}

/* Centre of mass less desired ZMP, x and y, of a pose at rest. */
static void offset_at_rest(const struct balancing *now, const struct pose *pose, double off_m[2])
{
    double com_m[3];

    (void)grobo_body_com(now->body->model, pose->links, com_m);
    off_m[0] = com_m[0] - pose->report.zmp_m[0];
    off_m[1] = com_m[1] - pose->report.zmp_m[1];
}

/* Finds w by w += zmp - cm. */
static bool adjust(const struct balancing *now, int frame, double shift_m[2])
{
    struct pose pose;
    double off_m[2];

    shift_m[0] = shift_m[1] = 0;
    for (int round = 0; round < ADJUST_ROUNDS; round++) {
        solve_frame(now, frame, shift_m, &pose);
        offset_at_rest(now, &pose, off_m);
        if (hypot(off_m[0], off_m[1]) < ADJUST_TOLERANCE_M) {
            return true;
        }
        shift_m[0] -= off_m[0];
        shift_m[1] -= off_m[1];
    }
    return false;
}

static int smooth_frames(const struct balancing *now)
{
    return (int)lround(SMOOTH_S * now->body->options.rate_hz);
}

/* Point 1: the adjustment, full near both ends, then faded by 1 - 3 s^2 + 2 s^3. */
static void start_values(struct balancing *now)
{
    const int full = smooth_frames(now);

    for (int end = 0; end < 2; end++) {
        now->adjusted[end] = adjust(now, end == 0 ? 0 : now->n - 1, now->adjust_m[end]);
        for (int i = 0; i < 2 * full && i < now->n; i++) {
            const double s = i < full ? 0 : (double)(i - full) / full;
            const double part = 1 - 3 * s * s + 2 * s * s * s;
            double *w = now->shift_m[end == 0 ? i : now->n - 1 - i];

            w[0] += part * now->adjust_m[end][0];
            w[1] += part * now->adjust_m[end][1];
        }
    }
}

/* Speeds between two frames: forward differences of the joints and of the base link. The base's
 * rotation vector is used as if it were given in the world. Where the base changes, it is the new
 * one: its place before is known from the pose. */
static void speeds(const struct balancing *now, const struct pose *from, const struct pose *to,
                   struct motion *motion)
{
    const grobo_transform *before = &from->links[to->base];
    const grobo_transform *after = &to->links[to->base];
    double turn[9];

    motion->base = to->base;
    for (int j = 0; j < now->body->model->n_joints; j++) {
        motion->joint_rad_s[j] = (to->q_rad[j] - from->q_rad[j]) / now->dt_s;
    }
    mat_t_mul(turn, before->r, after->r);
    grobo_i_omega(motion->angular_rad_s, turn);
    for (int k = 0; k < 3; k++) {
        motion->linear_m_s[k] = (after->p_m[k] - before->p_m[k]) / now->dt_s;
        motion->angular_rad_s[k] /= now->dt_s;
    }
}

/* The root's velocity, from the base's up the chain that ties them. */
static void root_velocity(const grobo_body_model *model, const struct pose *pose,
                          const struct motion *motion, grobo_body_velocity *velocity)
{
    double *v = velocity->linear_m_s, *w = velocity->angular_rad_s;

    memcpy(v, motion->linear_m_s, sizeof velocity->linear_m_s);
    memcpy(w, motion->angular_rad_s, sizeof velocity->angular_rad_s);
    velocity->joint_rad_s = motion->joint_rad_s;
    for (int i = motion->base; i > 0; i = model->links[i].parent) {
        const grobo_body_link *link = &model->links[i];
        double axis[3], arm[3], sweep[3];

        mat_vec(axis, pose->links[i].r, link->axis);
        vec_add_scaled(w, w, -motion->joint_rad_s[link->joint], axis);
        vec_add_scaled(arm, pose->links[i].p_m, -1, pose->links[link->parent].p_m);
        vec_cross(sweep, w, arm);
        vec_add_scaled(v, v, -1, sweep);
    }
}

/* One frame's row of the equations: a and the ZMP's error. */
static void frame_row(struct balancing *now, int frame, const struct pose *pose,
                      const struct motion *motion, grobo_momentum *last)
{
    const grobo_body_model *model = now->body->model;
    grobo_body_velocity velocity;
    grobo_momentum momentum, rate;
    double com_m[3], zmp_m[3], mass_kg, gravity;

    mass_kg = grobo_body_com(model, pose->links, com_m);
    root_velocity(model, pose, motion, &velocity);
    grobo_body_momentum(model, pose->links, &velocity, &momentum);
    for (int k = 0; k < 3; k++) {
        rate.p_kgm_s[k] = (momentum.p_kgm_s[k] - last->p_kgm_s[k]) / now->dt_s;
        rate.l_kgm2_s[k] = (momentum.l_kgm2_s[k] - last->l_kgm2_s[k]) / now->dt_s;
    }
    *last = momentum;
    memcpy(zmp_m, pose->report.zmp_m, sizeof zmp_m);
    grobo_body_zmp(com_m, mass_kg, &rate, zmp_m);
    gravity = GROBO_BODY_GRAVITY_M_S2;
    if (now->body->options.balance != GROBO_BODY_BALANCE_COMPAT11) {
        gravity = fmax(gravity + rate.p_kgm_s[2] / mass_kg, GRAVITY_MIN_M_S2);
    }
    /* a body below its ZMP is no pendulum: leave it alone */
    now->a[frame] = -fmax(com_m[2] - zmp_m[2], 0) / (gravity * now->dt_s * now->dt_s);
    now->error_m[frame][0] = pose->report.zmp_m[0] - zmp_m[0];
    now->error_m[frame][1] = pose->report.zmp_m[1] - zmp_m[1];
}

static void all_rows(struct balancing *now)
{
    struct pose pose[2];
    struct motion motion = {.base = 0};
    grobo_momentum last = {{0, 0, 0}, {0, 0, 0}};

    solve_frame(now, 0, now->shift_m[0], &pose[0]);
    for (int i = 0; i < now->n; i++) {
        if (i + 1 < now->n) {
            solve_frame(now, i + 1, now->shift_m[i + 1], &pose[(i + 1) % 2]);
            speeds(now, &pose[i % 2], &pose[(i + 1) % 2], &motion);
        }
        frame_row(now, i, &pose[i % 2], &motion, &last);
    }
}

/* Thomas's algorithm for a u[i-1] + b u[i] + a u[i+1] = d, b = 1 - 2 a; u replaces d. The forward
 * sweep skips row n - 2, as Choreonoid's does: its factor and its u stay 0 and the row behind it
 * goes on from the pivot of the row before it. */
static void solve_rows(struct balancing *now)
{
    double pivot = 1 - 2 * now->a[0];

    now->error_m[0][0] /= pivot;
    now->error_m[0][1] /= pivot;
    for (int i = 1; i < now->n; i++) {
        double *u = now->error_m[i];

        if (i == now->n - 2) {
            now->factor[i] = u[0] = u[1] = 0;
            continue;
        }
        now->factor[i] = now->a[i - 1] / pivot;
        pivot = 1 - 2 * now->a[i] - now->a[i] * now->factor[i];
        u[0] = (u[0] - now->a[i] * now->error_m[i - 1][0]) / pivot;
        u[1] = (u[1] - now->a[i] * now->error_m[i - 1][1]) / pivot;
    }
    for (int i = now->n - 2; i >= 0; i--) {
        now->error_m[i][0] -= now->factor[i + 1] * now->error_m[i + 1][0];
        now->error_m[i][1] -= now->factor[i + 1] * now->error_m[i + 1][1];
    }
}

static void move_waist(struct balancing *now)
{
    for (int i = 0; i < now->n; i++) {
        double *w = now->shift_m[i];

        w[0] += now->error_m[i][0];
        w[1] += now->error_m[i][1];
        const double length_m = hypot(w[0], w[1]);

        if (length_m > SHIFT_MAX_M) {
            w[0] *= SHIFT_MAX_M / length_m;
            w[1] *= SHIFT_MAX_M / length_m;
        }
    }
}

/* Point 3: w = rho w + (1 - rho) adj, rho = 10 s^3 - 15 s^4 + 6 s^5. */
static void smooth_end(struct balancing *now, int end)
{
    const int frames = smooth_frames(now);

    for (int i = 0; i < frames && i < now->n; i++) {
        const double s = (double)i / frames;
        const double rho = s * s * s * (10 - 15 * s + 6 * s * s);
        double *w = now->shift_m[end == 0 ? i : now->n - 1 - i];

        w[0] = rho * w[0] + (1 - rho) * now->adjust_m[end][0];
        w[1] = rho * w[1] + (1 - rho) * now->adjust_m[end][1];
    }
}

static bool rests_at_end(const struct balancing *now)
{
    static const double none[2] = {0, 0};
    struct pose pose;
    double off_m[2];

    if (now->adjusted[1]) {
        return true;
    }
    solve_frame(now, now->n - 1, none, &pose);
    offset_at_rest(now, &pose, off_m);
    return hypot(off_m[0], off_m[1]) < AT_REST_M;
}

void grobo_i_balance(grobo_body *body)
{
    struct balancing now = {.body = body, .n = body->n_frames};
    double *memory = body->balance;
    const size_t n = (size_t)body->n_frames;

    now.dt_s = 1 / body->options.rate_hz;
    now.shift_m = (double(*)[2])memory;
    now.error_m = (double(*)[2])(memory + 2 * n);
    now.a = memory + 4 * n;
    now.factor = memory + 5 * n;
    if (body->zmp.n == 0) {
        return;
    }
    if (body->options.balance == GROBO_BODY_BALANCE_COMPAT11) {
        start_values(&now);
    }
    for (int round = 0; round < ROUNDS; round++) {
        all_rows(&now);
        solve_rows(&now);
        move_waist(&now);
    }
    smooth_end(&now, 0);
    if (rests_at_end(&now)) {
        smooth_end(&now, 1);
    }
}
