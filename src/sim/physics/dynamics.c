/* SPDX-License-Identifier: MIT */
/*
 * Rigid links on a fixed base. All vectors are in the base's frame and about its origin, so that
 * motions, forces and masses of different links add as they are: no transforms between links.
 * Recursive Newton-Euler and composite rigid bodies as R. Featherstone, Rigid Body Dynamics
 * Algorithms (2008), chapters 5 and 6, write them.
 */
#include <math.h>
#include <string.h>

#include "src/base/assert.h"
#include "src/sim/physics/dynamics.h"

/* A step's speeds are settled when a round changes none by more than this, rad/s. */
#define SETTLED_RAD_S 1e-10
#define ROUNDS_MAX 200

enum { XX, YY, ZZ, XY, XZ, YZ };

/* ---- vectors ------------------------------------------------------------------------------- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* to += k * a */
static void add(double to[3], double k, const double a[3])
{
    to[0] += k * a[0];
    to[1] += k * a[1];
    to[2] += k * a[2];
}

static void rotate(double out[3], const double r[9], const double v[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = dot(&r[3 * i], v);
    }
}

static void multiply(double out[9], const double a[9], const double b[9])
{
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            out[3 * i + k] = a[3 * i] * b[k] + a[3 * i + 1] * b[3 + k] + a[3 * i + 2] * b[6 + k];
        }
    }
}

/* By an angle about an axis of length 1 (Rodrigues). */
static void turn_about(double out[9], const double axis[3], double angle_rad)
{
    double s = sin(angle_rad), c = cos(angle_rad), rest = 1 - c;
    double x = axis[0], y = axis[1], z = axis[2];
    const double made[9] = {c + x * x * rest,     x * y * rest - z * s, x * z * rest + y * s,
                            y * x * rest + z * s, c + y * y * rest,     y * z * rest - x * s,
                            z * x * rest - y * s, z * y * rest + x * s, c + z * z * rest};
    memcpy(out, made, sizeof made);
}

static double both(const grobo_i_spatial *motion, const grobo_i_spatial *force)
{
    return dot(motion->turn, force->turn) + dot(motion->move, force->move);
}

/* ---- masses -------------------------------------------------------------------------------- */

/* A point mass adds this to an inertia about the origin. */
static void add_point(double second[6], double mass, const double c[3])
{
    second[XX] += mass * (c[1] * c[1] + c[2] * c[2]);
    second[YY] += mass * (c[0] * c[0] + c[2] * c[2]);
    second[ZZ] += mass * (c[0] * c[0] + c[1] * c[1]);
    second[XY] -= mass * c[0] * c[1];
    second[XZ] -= mass * c[0] * c[2];
    second[YZ] -= mass * c[1] * c[2];
}

static void add_mass(grobo_i_mass *to, const grobo_i_mass *from)
{
    to->mass += from->mass;
    add(to->first, 1, from->first);
    for (int i = 0; i < 6; i++) {
        to->second[i] += from->second[i];
    }
}

/* The same body about another origin: its frame's origin is at p, turned by r. */
static void move_mass(grobo_i_mass *out, const grobo_i_mass *in, const double p[3],
                      const double r[9])
{
    const double *s = in->second;
    const double full[9] = {s[XX], s[XY], s[XZ], s[XY], s[YY], s[YZ], s[XZ], s[YZ], s[ZZ]};
    double half[9], first[3], ri[9];
    rotate(first, r, in->first);
    multiply(half, r, full);
    for (int i = 0; i < 3; i++) { /* half r^T */
        for (int k = 0; k < 3; k++) {
            ri[3 * i + k] = dot(&half[3 * i], &r[3 * k]);
        }
    }
    double pf = dot(p, first), m = in->mass;
    out->mass = m;
    out->second[XX] = ri[0] + 2 * (pf - p[0] * first[0]);
    out->second[YY] = ri[4] + 2 * (pf - p[1] * first[1]);
    out->second[ZZ] = ri[8] + 2 * (pf - p[2] * first[2]);
    out->second[XY] = ri[1] - p[0] * first[1] - p[1] * first[0];
    out->second[XZ] = ri[2] - p[0] * first[2] - p[2] * first[0];
    out->second[YZ] = ri[5] - p[1] * first[2] - p[2] * first[1];
    add_point(out->second, m, p);
    memcpy(out->first, first, sizeof first);
    add(out->first, m, p);
}

/* Momentum of a mass in motion; the force that accelerates it, at no speed. */
static void momentum(grobo_i_spatial *out, const grobo_i_mass *m, const grobo_i_spatial *motion)
{
    const double *w = motion->turn, *v = motion->move, *s = m->second;
    double turned[3];
    cross(turned, w, m->first);
    for (int i = 0; i < 3; i++) {
        out->move[i] = m->mass * v[i] + turned[i];
    }
    cross(out->turn, m->first, v);
    out->turn[0] += s[XX] * w[0] + s[XY] * w[1] + s[XZ] * w[2];
    out->turn[1] += s[XY] * w[0] + s[YY] * w[1] + s[YZ] * w[2];
    out->turn[2] += s[XZ] * w[0] + s[YZ] * w[1] + s[ZZ] * w[2];
}

/* ---- the tree ------------------------------------------------------------------------------ */

static bool finite_all(const double *v, int n)
{
    for (int i = 0; i < n; i++) {
        if (!isfinite(v[i])) {
            return false;
        }
    }
    return true;
}

static bool link_ok(const grobo_sim_link *link, int index, int n_joints, uint64_t *seen)
{
    if (!finite_all(link->origin_m, 3) || !finite_all(link->r, 9) || !finite_all(link->axis, 3) ||
        !finite_all(link->com_m, 3) || !finite_all(link->inertia_kgm2, 6) ||
        !isfinite(link->mass_kg) || link->mass_kg < 0 || link->parent < -1 ||
        link->parent >= index || link->joint < -1 || link->joint >= n_joints) {
        return false;
    }
    if (link->joint < 0) {
        return true;
    }
    bool twice = (*seen >> link->joint & 1) != 0;
    *seen |= UINT64_C(1) << link->joint;
    return !twice && fabs(dot(link->axis, link->axis) - 1) < 1e-5;
}

static void weigh(grobo_i_mass *to, const grobo_sim_link *link, const double at_m[3],
                  const double r[9])
{
    grobo_i_mass own = {.mass = link->mass_kg}, moved;
    add(own.first, link->mass_kg, link->com_m);
    memcpy(own.second, link->inertia_kgm2, sizeof own.second);
    add_point(own.second, link->mass_kg, link->com_m);
    move_mass(&moved, &own, at_m, r);
    add_mass(to, &moved);
}

/* Rows of the mass matrix: joints that bear each other. */
static void find_coupled(grobo_i_tree *tree)
{
    for (int i = 0; i < tree->n; i++) {
        for (int up = tree->body[i].parent; up >= 0; up = tree->body[up].parent) {
            int a = tree->body[i].joint, b = tree->body[up].joint;
            tree->coupled[a][tree->n_coupled[a]++] = (uint8_t)b;
            tree->coupled[b][tree->n_coupled[b]++] = (uint8_t)a;
        }
    }
}

int grobo_i_tree_make(grobo_i_tree *tree, const grobo_sim_link *links, int n_links, int n_joints)
{
    static const double no_turn[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    double r[2 * GROBO_JOINTS_MAX][9]; /* of a link's frame in its body's */
    uint64_t seen = 0;
    if (n_links < 0 || (n_links > 0 && links == NULL)) {
        return GROBO_ERR_ARG;
    }
    if (n_links > 2 * GROBO_JOINTS_MAX || n_joints > GROBO_JOINTS_MAX) {
        return GROBO_ERR_CAP;
    }
    memset(tree, 0, sizeof *tree);
    tree->n_joints = n_joints;
    tree->n_links = n_links;
    for (int i = 0; i < n_links; i++) {
        const grobo_sim_link *link = &links[i];
        if (!link_ok(link, i, n_joints, &seen)) {
            return GROBO_ERR_ARG;
        }
        double at_m[3] = {0, 0, 0}, turned[9];
        int body = -1;
        memcpy(turned, no_turn, sizeof turned);
        if (link->parent >= 0) {
            body = tree->link[link->parent].body;
            rotate(at_m, r[link->parent], link->origin_m);
            add(at_m, 1, tree->link[link->parent].at_m);
            multiply(turned, r[link->parent], link->r);
        } else {
            add(at_m, 1, link->origin_m);
            memcpy(turned, link->r, sizeof turned);
        }
        if (link->joint >= 0) {
            grobo_i_rigid *made = &tree->body[tree->n];
            made->joint = link->joint;
            made->parent = body;
            memcpy(made->at_m, at_m, sizeof at_m);
            memcpy(made->r, turned, sizeof turned);
            memcpy(made->axis, link->axis, sizeof made->axis);
            body = tree->n++;
            memset(at_m, 0, sizeof at_m);
            memcpy(turned, no_turn, sizeof turned);
        }
        tree->link[i].body = body;
        memcpy(tree->link[i].at_m, at_m, sizeof at_m);
        memcpy(r[i], turned, sizeof turned);
        if (body >= 0) {
            weigh(&tree->body[body].mass, link, at_m, turned);
        }
    }
    find_coupled(tree);
    return GROBO_OK;
}

void grobo_i_tree_load(grobo_i_tree *tree, int link, double mass_kg)
{
    GROBO_ASSERT(link >= 0 && link < tree->n_links);
    int body = tree->link[link].body;
    if (body >= 0) {
        const double *at_m = tree->link[link].at_m;
        tree->body[body].mass.mass += mass_kg;
        add(tree->body[body].mass.first, mass_kg, at_m);
        add_point(tree->body[body].mass.second, mass_kg, at_m);
    }
}

void grobo_i_tree_place(grobo_i_tree *tree, const double *q_rad)
{
    for (int i = 0; i < tree->n; i++) {
        grobo_i_rigid *body = &tree->body[i];
        double turn[9], still[9];
        turn_about(turn, body->axis, q_rad[body->joint]);
        if (body->parent >= 0) {
            const grobo_i_rigid *parent = &tree->body[body->parent];
            rotate(body->p_m, parent->turned, body->at_m);
            add(body->p_m, 1, parent->p_m);
            multiply(still, parent->turned, body->r);
        } else {
            memcpy(body->p_m, body->at_m, sizeof body->p_m);
            memcpy(still, body->r, sizeof still);
        }
        multiply(body->turned, still, turn);
        rotate(body->axis_now.turn, body->turned, body->axis);
        cross(body->axis_now.move, body->p_m, body->axis_now.turn);
        move_mass(&body->now, &body->mass, body->p_m, body->turned);
    }
}

void grobo_i_tree_torques(const grobo_i_tree *tree, const double *speed_rad_s,
                          const double *accel_rad_s2, double *torque_nm)
{
    grobo_i_spatial v[GROBO_I_BODIES_MAX], a[GROBO_I_BODIES_MAX], f[GROBO_I_BODIES_MAX];
    memset(torque_nm, 0, (size_t)tree->n_joints * sizeof *torque_nm);
    for (int i = 0; i < tree->n; i++) {
        const grobo_i_rigid *body = &tree->body[i];
        const grobo_i_spatial *s = &body->axis_now;
        double rate = speed_rad_s[body->joint],
               change = accel_rad_s2 != NULL ? accel_rad_s2[body->joint] : 0;
        if (body->parent >= 0) {
            v[i] = v[body->parent];
            a[i] = a[body->parent];
        } else {
            memset(&v[i], 0, sizeof v[i]);
            memset(&a[i], 0, sizeof a[i]);
            add(a[i].move, -1, tree->gravity_m_s2);
        }
        double part[3];
        add(a[i].turn, change, s->turn);
        add(a[i].move, change, s->move);
        cross(part, v[i].turn, s->turn);
        add(a[i].turn, rate, part);
        cross(part, v[i].turn, s->move);
        add(a[i].move, rate, part);
        cross(part, v[i].move, s->turn);
        add(a[i].move, rate, part);
        add(v[i].turn, rate, s->turn);
        add(v[i].move, rate, s->move);
        grobo_i_spatial p;
        momentum(&f[i], &body->now, &a[i]);
        momentum(&p, &body->now, &v[i]);
        cross(part, v[i].turn, p.turn);
        add(f[i].turn, 1, part);
        cross(part, v[i].move, p.move);
        add(f[i].turn, 1, part);
        cross(part, v[i].turn, p.move);
        add(f[i].move, 1, part);
    }
    for (int i = tree->n - 1; i >= 0; i--) {
        const grobo_i_rigid *body = &tree->body[i];
        torque_nm[body->joint] = both(&body->axis_now, &f[i]);
        if (body->parent >= 0) {
            add(f[body->parent].turn, 1, f[i].turn);
            add(f[body->parent].move, 1, f[i].move);
        }
    }
}

void grobo_i_tree_masses(grobo_i_tree *tree)
{
    const int n = tree->n_joints;
    for (int i = 0; i < tree->n; i++) {
        tree->body[i].carried = tree->body[i].now;
    }
    for (int i = tree->n - 1; i >= 0; i--) {
        const grobo_i_rigid *body = &tree->body[i];
        grobo_i_spatial p;
        momentum(&p, &body->carried, &body->axis_now);
        tree->mass[body->joint * n + body->joint] = both(&body->axis_now, &p);
        for (int up = body->parent; up >= 0; up = tree->body[up].parent) {
            double m = both(&tree->body[up].axis_now, &p);
            tree->mass[body->joint * n + tree->body[up].joint] = m;
            tree->mass[tree->body[up].joint * n + body->joint] = m;
        }
        if (body->parent >= 0) {
            add_mass(&tree->body[body->parent].carried, &body->carried);
        }
    }
}

/* ---- a step of time ------------------------------------------------------------------------ */

static double clamp(double x, double min, double max)
{
    return x < min ? min : x > max ? max : x;
}

/*
 * Speeds at the end of a step: (M + A + dt D) v = M v0 + A v0 + dt (torque - load) + dt f with
 * |f| at most the friction and against v, and v within its bounds. That is the minimum of a convex
 * function whose only coupling is the matrix; joint by joint (Gauss and Seidel) it is found in few
 * rounds, as armatures make the diagonal large. Starting from the speeds before keeps it the same
 * for the same inputs.
 */
static void solve(const grobo_i_tree *tree, const grobo_sim_drive *drive, double dt_s,
                  const double *wanted, double *speed)
{
    const int n = tree->n_joints;
    double change = SETTLED_RAD_S * 2;
    for (int round = 0; round < ROUNDS_MAX && change > SETTLED_RAD_S; round++) {
        change = 0;
        for (int i = 0; i < n; i++) {
            const double *row = &tree->mass[i * n];
            double rest = wanted[i];
            for (int k = 0; k < tree->n_coupled[i]; k++) {
                int other = tree->coupled[i][k];
                rest -= row[other] * speed[other];
            }
            double stop = dt_s * drive[i].friction_nm;
            double left = fabs(rest) > stop ? rest - copysign(stop, rest) : 0;
            double whole = row[i] + drive[i].armature_kgm2 + dt_s * drive[i].damping_nms;
            double v = whole > 0 ? left / whole : 0;
            v = clamp(v, drive[i].low_rad_s, drive[i].high_rad_s);
            double moved = fabs(v - speed[i]);
            change = moved > change ? moved : change;
            speed[i] = v;
        }
    }
}

int grobo_i_tree_step(void *ctx, const grobo_sim_drive *drive, double dt_s, grobo_sim_state *state)
{
    grobo_i_tree *tree = ctx;
    const int n = tree->n_joints;
    double q[GROBO_JOINTS_MAX] = {0}, v[GROBO_JOINTS_MAX] = {0}, load[GROBO_JOINTS_MAX],
           wanted[GROBO_JOINTS_MAX];
    for (int i = 0; i < n; i++) {
        q[i] = state[i].angle_rad;
        v[i] = state[i].speed_rad_s;
    }
    grobo_i_tree_place(tree, q);
    grobo_i_tree_torques(tree, v, NULL, load);
    grobo_i_tree_masses(tree);
    for (int i = 0; i < n; i++) {
        const double *row = &tree->mass[i * n];
        wanted[i] =
            (row[i] + drive[i].armature_kgm2) * v[i] + dt_s * (drive[i].torque_nm - load[i]);
        for (int k = 0; k < tree->n_coupled[i]; k++) {
            wanted[i] += row[tree->coupled[i][k]] * v[tree->coupled[i][k]];
        }
    }
    solve(tree, drive, dt_s, wanted, v);
    for (int i = 0; i < n; i++) {
        state[i].angle_rad = q[i] + dt_s * v[i];
        state[i].speed_rad_s = v[i];
        state[i].load_nm = -load[i];
    }
    return GROBO_OK;
}
