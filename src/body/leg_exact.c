/* SPDX-License-Identifier: MIT */
/* Leg IK in closed form. Six joints: yaw Z, roll X, three pitches Y, roll X; three parallel axes
 * in a row make such a chain solvable without iteration, offsets between the axes included.
 *
 * Names, all in the frame of the waist: o1..o6 are the offsets of the links (the table's), th1..th6
 * the angles about +Z +X +Y +Y +Y +X. N = Rz(th1) Rx(th2) is the attitude of the hip roll link,
 * n = N y = (-s1 c2, c1 c2, s2) the direction of the pitch axes, M = R Rx(-th6) the attitude of the
 * ankle pitch link; M y = n as well. The derivation with a drawing: docs/guide/whole-body.md. */
#include <string.h>

#include "src/body/body.h"
#include "src/body/vec.h"

enum { YAW, HIP_ROLL, HIP_PITCH, KNEE, ANKLE_PITCH, ANKLE_ROLL };

/* Offsets along the pitch axes must cancel for the closed form to hold. */
#define OFFSET_TOLERANCE_M 1e-9
/* A shorter lever cannot tell a direction. */
#define LEVER_MIN 1e-9
/* How far a cosine may leave [-1, 1] by rounding alone. */
#define COSINE_TOLERANCE 1e-12

int grobo_i_leg_find(const grobo_body_model *model, int foot, struct grobo_i_leg *leg)
{
    static const int axis_of[GROBO_BODY_LEG_JOINTS] = {2, 0, 1, 1, 1, 0};
    int link = model->feet[foot].link;
    double sideways_m = 0;

    if (link < 1 || link >= model->n_links) {
        return GROBO_ERR_ARG;
    }
    for (int i = GROBO_BODY_LEG_JOINTS - 1; i >= 0; i--) {
        if (link < 1) {
            return GROBO_ERR_ARG;
        }
        const double along = model->links[link].axis[axis_of[i]];

        if (fabs(fabs(along) - 1) > 1e-9) {
            return GROBO_ERR_ARG;
        }
        leg->link[i] = link;
        leg->sign[i] = along > 0 ? 1 : -1;
        if (i >= HIP_PITCH) {
            sideways_m += model->links[link].offset_m[1];
        }
        link = model->links[link].parent;
    }
    return link == 0 && fabs(sideways_m) < OFFSET_TOLERANCE_M ? 0 : GROBO_ERR_ARG;
}

static double wrapped(double angle_rad)
{
    return angle_rad - 2 * BODY_PI * floor((angle_rad + BODY_PI) / (2 * BODY_PI));
}

/* out = R Rx(-angle) */
static void turn_back_x(double out[9], const double r[9], double angle_rad)
{
    static const double x[3] = {1, 0, 0};
    double turn[9];

    mat_axis_angle(turn, x, -angle_rad);
    mat_mul(out, r, turn);
}

/* Hip yaw and roll. The foot's x axis r lies across n: n r = 0; and the ankle lies as far along n
 * as the hip does: n (p - o1) = c2 o2y + s2 o2z. Both are c2 (...) + s2 (...) = 0; together they
 * leave A s1 + B c1 = C with two answers th1: in one the toes point ahead of the line from hip to
 * ankle, as a walker's do, in the other behind it. False: no answer, or a foot turned over. */
static bool hip_yaw_roll(const double offset2[3], const double p[3], const double r[9],
                         bool toes_ahead, double th[GROBO_BODY_LEG_JOINTS])
{
    const double foot_x[3] = {r[0], r[3], r[6]};
    const double foot_y[3] = {r[1], r[4], r[7]};
    const double z = p[2] - offset2[2];
    const double a = foot_x[0] * z - p[0] * foot_x[2];
    const double b = p[1] * foot_x[2] - foot_x[1] * z;
    const double c = offset2[1] * foot_x[2];
    const double lever = hypot(a, b);

    if (lever < LEVER_MIN || fabs(c) > lever * (1 + COSINE_TOLERANCE)) {
        return false;
    }
    const double part = asin(fmin(1, fmax(-1, c / lever)));
    const double th1 = (toes_ahead ? BODY_PI - part : part) - atan2(b, a);
    const double s1 = sin(th1), c1 = cos(th1);
    const double by_place[2] = {z, s1 * p[0] - c1 * p[1] + offset2[1]};
    const double by_foot[2] = {foot_x[2], s1 * foot_x[0] - c1 * foot_x[1]};
    const bool place = hypot(by_place[0], by_place[1]) >= hypot(by_foot[0], by_foot[1]) * fabs(z);
    const double *row = place ? by_place : by_foot;

    th[YAW] = wrapped(th1);
    /* c2 >= 0: legs do not fold sideways beyond the horizontal */
    th[HIP_ROLL] = row[0] < 0 ? atan2(-row[1], -row[0]) : atan2(row[1], row[0]);
    const double n[3] = {-s1 * cos(th[HIP_ROLL]), c1 * cos(th[HIP_ROLL]), sin(th[HIP_ROLL])};

    return vec_dot(n, foot_y) > 0;
}

/* Thigh (x4, z4) and shank (x5, z5) in the plane across n reach v, in the frame of N:
 * v = Ry(th3) (o4 + Ry(th4) o5); the shank bends backwards. */
static bool hip_pitch_knee(const double thigh[3], const double shank[3], const double v[3],
                           double th[GROBO_BODY_LEG_JOINTS])
{
    const double along = thigh[0] * shank[0] + thigh[2] * shank[2];
    const double across = thigh[0] * shank[2] - thigh[2] * shank[0];
    const double squares =
        thigh[0] * thigh[0] + thigh[2] * thigh[2] + shank[0] * shank[0] + shank[2] * shank[2];
    double cosine = (v[0] * v[0] + v[2] * v[2] - squares) / (2 * hypot(along, across));

    if (fabs(cosine) > 1 + COSINE_TOLERANCE) {
        return false;
    }
    cosine = fmin(1, fmax(-1, cosine));
    th[KNEE] = acos(cosine) + atan2(across, along);
    const double s = sin(th[KNEE]), c = cos(th[KNEE]);
    const double x = thigh[0] + c * shank[0] + s * shank[2];
    const double z = thigh[2] - s * shank[0] + c * shank[2];

    th[HIP_PITCH] = wrapped(atan2(v[0], v[2]) - atan2(x, z));
    return true;
}

/* th1..th6 of a foot at p (from o1), r. */
static bool leg_angles(const double *const offset[GROBO_BODY_LEG_JOINTS], const double p[3],
                       const double r[9], bool toes_ahead, double th[GROBO_BODY_LEG_JOINTS])
{
    static const double x_axis[3] = {1, 0, 0}, z_axis[3] = {0, 0, 1};
    double yaw[9], roll[9], hip[9], ankle[9], turn[9], n[3], local[3], v[3], part[3];

    if (!hip_yaw_roll(offset[HIP_ROLL], p, r, toes_ahead, th)) {
        return false;
    }
    mat_axis_angle(yaw, z_axis, th[YAW]);
    mat_axis_angle(roll, x_axis, th[HIP_ROLL]);
    mat_mul(hip, yaw, roll);
    n[0] = hip[1];
    n[1] = hip[4];
    n[2] = hip[7];
    mat_t_vec(local, r, n);
    th[ANKLE_ROLL] = atan2(-local[2], local[1]);
    turn_back_x(ankle, r, th[ANKLE_ROLL]);

    mat_vec(part, ankle, offset[ANKLE_ROLL]);
    vec_add_scaled(v, p, -1, part);
    mat_vec(part, yaw, offset[HIP_ROLL]);
    vec_add_scaled(v, v, -1, part);
    mat_t_vec(part, hip, v);
    vec_add_scaled(v, part, -1, offset[HIP_PITCH]);
    if (!hip_pitch_knee(offset[KNEE], offset[ANKLE_PITCH], v, th)) {
        return false;
    }
    mat_t_mul(turn, hip, ankle);
    th[ANKLE_PITCH] = wrapped(atan2(turn[2], turn[0]) - th[HIP_PITCH] - th[KNEE]);
    return true;
}

/* How much the leg leaves its plane; of two answers a walker's is the one that does less. */
static double twist(const double th[GROBO_BODY_LEG_JOINTS])
{
    return th[YAW] * th[YAW] + th[HIP_ROLL] * th[HIP_ROLL] + th[ANKLE_ROLL] * th[ANKLE_ROLL];
}

bool grobo_i_leg_exact(const grobo_body_model *model, const struct grobo_i_leg *leg,
                       const grobo_transform *target, double q_rad[GROBO_BODY_LEG_JOINTS])
{
    const double *offset[GROBO_BODY_LEG_JOINTS];
    double th[2][GROBO_BODY_LEG_JOINTS], p[3];
    bool ahead, behind;

    for (int i = 0; i < GROBO_BODY_LEG_JOINTS; i++) {
        offset[i] = model->links[leg->link[i]].offset_m;
    }
    vec_add_scaled(p, target->p_m, -1, offset[YAW]);
    ahead = leg_angles(offset, p, target->r, true, th[0]);
    behind = leg_angles(offset, p, target->r, false, th[1]);
    if (!ahead && !behind) {
        return false;
    }
    const double *best = !behind || (ahead && twist(th[0]) <= twist(th[1])) ? th[0] : th[1];

    for (int i = 0; i < GROBO_BODY_LEG_JOINTS; i++) {
        q_rad[i] = leg->sign[i] * best[i];
    }
    return true;
}

int grobo_body_leg_exact(const grobo_body_model *model, int foot, const grobo_transform *target,
                         double q_rad[GROBO_BODY_LEG_JOINTS])
{
    if (target == NULL || q_rad == NULL) {
        return GROBO_ERR_ARG;
    }
    struct grobo_i_leg leg;

    if (model == NULL || foot < 0 || foot > 1 || grobo_i_leg_find(model, foot, &leg) < 0) {
        return GROBO_ERR_ARG;
    }
    return grobo_i_leg_exact(model, &leg, target, q_rad) ? 0 : GROBO_ERR_UNREACHABLE;
}
