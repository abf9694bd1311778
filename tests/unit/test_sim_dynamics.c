/* SPDX-License-Identifier: MIT */
/*
 * Motors and links of the simulator against what others computed: 40 runs of servos' models by the
 * project that identified them, 60 poses of an SO-101. The reference material is beside the
 * checkout; without it these are skipped.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/body.h>
#include <grobo/robot_file.h>

#include "src/base/memory.h"
#include "src/robots/robots.h"
#include "src/sim/physics/physics.h"
#include "tests/support/files.h"
#include "tests/support/test.h"

#define GOLDEN "data/golden/servo/"
#define PI 3.14159265358979323846
#define STEP_S 0.001
#define ROWS_S 0.02
#define RUN_S 6.0

/* ---- 60 poses ------------------------------------------------------------------------------ */

/* The dynamics of a robot; freed by the caller with grobo_sim_physics_free(). */
static grobo_i_world *world_of(const grobo_robot_def *def)
{
    grobo_sim_physics *physics = NULL;
    assert_int_equal(grobo_robot_def_physics(def, false, NULL, &physics), 0);
    return (grobo_i_world *)physics;
}

/* As the poses were computed with. */
static void set_gravity(grobo_i_world *world, double g)
{
    world->tree.gravity_m_s2[0] = world->tree.gravity_m_s2[1] = 0;
    world->tree.gravity_m_s2[2] = -g;
}

static FILE *open_golden(const char *name)
{
    char path[256];
    (void)snprintf(path, sizeof path, GOLDEN "%s", name);
    FILE *file = fopen(shared_file(path), "r");
    if (file == NULL) {
        print_message("reference material missing: %s\n", path);
        skip();
    }
    return file;
}

TEST(so101_has_the_torques_of_sixty_poses)
{
    enum { N = 6, VALUES = 4 * N };
    FILE *file = open_golden("so101-inverse-dynamics.csv");
    grobo_i_world *world = world_of(&grobo_i_robot_so101);
    char line[1024];
    int poses = 0;
    double worst = 0;
    set_gravity(world, 9.81);
    assert_non_null(fgets(line, sizeof line, file));
    while (fgets(line, sizeof line, file) != NULL) {
        double value[VALUES], torque[N];
        char *at = line;
        for (int i = 0; i < VALUES; i++) {
            value[i] = strtod(at, &at);
            at += *at == ',';
        }
        grobo_i_tree_place(&world->tree, value);
        grobo_i_tree_torques(&world->tree, value + N, value + 2 * N, torque);
        for (int i = 0; i < N; i++) {
            worst = fmax(worst, fabs(torque[i] - value[3 * N + i]));
        }
        poses++;
    }
    (void)fclose(file);
    grobo_sim_physics_free(&world->base);
    print_message("largest difference of %d poses: %.2g Nm\n", poses, worst);
    assert_int_equal(poses, 60);
    assert_true(worst < 1e-5);
}

/* ---- the other kinematics -------------------------------------------------------------------- */

/* The links of gr001.yaml and those of whole-body playback are one robot: the torque that holds a
 * pose is the slope of its height, which other code computes. */
TEST(gr001_weighs_as_much_by_its_heights)
{
    enum { N = 20, POSES = 20 };
    const double slope_rad = 1e-5, g = 9.80665;
    uint32_t random = 7;
    grobo_i_world *world = world_of(grobo_robot_def_at(0));
    set_gravity(world, g);
    for (int pose = 0; pose < POSES; pose++) {
        double q[N], torque[N], still[N] = {0};
        grobo_transform links[GROBO_BODY_LINKS_MAX];
        for (int i = 0; i < N; i++) {
            random = random * 1664525u + 1013904223u;
            q[i] = (random >> 8) / (double)(1 << 24) * 2 - 1;
        }
        grobo_i_tree_place(&world->tree, q);
        grobo_i_tree_torques(&world->tree, still, NULL, torque);
        for (int i = 0; i < N; i++) {
            double at = q[i], height_m[2], com_m[3], mass_kg = 0;
            for (int side = 0; side < 2; side++) {
                q[i] = at + (side == 0 ? -slope_rad : slope_rad);
                grobo_body_forward(grobo_gr001_body(), NULL, q, links);
                mass_kg = grobo_body_com(grobo_gr001_body(), links, com_m);
                height_m[side] = com_m[2];
            }
            q[i] = at;
            double by_height = mass_kg * g * (height_m[1] - height_m[0]) / (2 * slope_rad);
            assert_true(fabs(torque[i] - by_height) < 1e-7);
        }
    }
    grobo_sim_physics_free(&world->base);
}

/* A mass matrix is what inverse dynamics gives for one acceleration at a time; and it is what
 * kinetic energy needs: positive. */
TEST(mass_matrices_are_those_of_inverse_dynamics)
{
    for (size_t d = 0; grobo_robot_def_at(d) != NULL; d++) {
        grobo_i_world *world = world_of(grobo_robot_def_at(d));
        grobo_i_tree *tree = &world->tree;
        const int n = tree->n_joints;
        double q[GROBO_JOINTS_MAX], still[GROBO_JOINTS_MAX] = {0}, bias[GROBO_JOINTS_MAX];
        for (int i = 0; i < n; i++) {
            q[i] = 0.3 * sin(3 * i + 1);
        }
        grobo_i_tree_place(tree, q);
        grobo_i_tree_masses(tree);
        grobo_i_tree_torques(tree, still, NULL, bias);
        for (int i = 0; i < n; i++) {
            double accel[GROBO_JOINTS_MAX] = {0}, torque[GROBO_JOINTS_MAX];
            accel[i] = 1;
            grobo_i_tree_torques(tree, still, accel, torque);
            for (int k = 0; k < n; k++) {
                assert_true(fabs(torque[k] - bias[k] - tree->mass[k * n + i]) < 1e-12);
                assert_true(tree->mass[k * n + i] == tree->mass[i * n + k]);
            }
            assert_true(tree->mass[i * n + i] >= 0);
        }
        grobo_sim_physics_free(&world->base);
    }
}

/* Without friction and damping a swinging arm keeps its energy, but for what steps cost. */
TEST(a_free_swing_keeps_its_energy)
{
    enum { N = 6, STEPS = 2000 };
    grobo_i_world *world = world_of(&grobo_i_robot_so101);
    grobo_sim_drive drive[N];
    grobo_sim_state state[N];
    double first = 0, least = INFINITY, most = -INFINITY;
    memset(state, 0, sizeof state);
    for (int i = 0; i < N; i++) {
        drive[i] = (grobo_sim_drive){
            .armature_kgm2 = 0.0284, .low_rad_s = -INFINITY, .high_rad_s = INFINITY};
        state[i].angle_rad = 0.5;
    }
    for (int k = 0; k < STEPS; k++) {
        double q[N], v[N], still[N] = {0}, torque[N], height = 0, moving = 0;
        for (int i = 0; i < N; i++) {
            q[i] = state[i].angle_rad;
            v[i] = state[i].speed_rad_s;
        }
        grobo_i_tree_place(&world->tree, q);
        grobo_i_tree_masses(&world->tree);
        grobo_i_tree_torques(&world->tree, still, NULL, torque);
        for (int i = 0; i < N; i++) {
            moving += v[i] * v[i] * drive[i].armature_kgm2 / 2;
            for (int j = 0; j < N; j++) {
                moving += v[i] * v[j] * world->tree.mass[i * N + j] / 2;
            }
        }
        for (int b = 0; b < world->tree.n; b++) {
            height += world->tree.body[b].now.first[2] * 9.80665;
        }
        first = k == 0 ? height + moving : first;
        least = fmin(least, height + moving - first);
        most = fmax(most, height + moving - first);
        assert_int_equal(grobo_i_tree_step(&world->tree, drive, STEP_S, state), 0);
    }
    grobo_sim_physics_free(&world->base);
    print_message("energy: from %.4f to %.4f J beside its first\n", least, most);
    assert_true(most - least < 0.03);
}

/* ---- 40 runs ------------------------------------------------------------------------------- */

typedef struct run {
    char file[80], servo[16], model[4], trajectory[24];
    double kp, vin, mass_kg, arm_kg, length_m, offset_rad;
    grobo_sim_motor motor;
} run;

static double cubic(double from, double to, double s)
{
    s = s < 0 ? 0 : s > 1 ? 1 : s;
    return from + (to - from) * (3 * s * s - 2 * s * s * s);
}

/* The goal at a time; false: the torque is off. */
static bool goal_at(const run *r, double t, double *goal)
{
    const char *name = r->trajectory;
    if (strcmp(name, "lift_and_drop") == 0) {
        *goal = cubic(0, -PI / 2, t / 2);
        return t < 2;
    }
    if (strcmp(name, "sin_time_square") == 0) {
        *goal = sin(t * t);
    } else if (strcmp(name, "up_and_down") == 0) {
        *goal = t < 3 ? cubic(0, PI / 2, t / 3) : cubic(PI / 2, 0.8 * PI / 2, (t - 3) / 3);
    } else if (strcmp(name, "sin_sin") == 0) {
        *goal = sin(t) * PI / 2 + 0.5 * sin(5 * t) * sin(2 * t);
    } else {
        assert_string_equal(name, "steps");
        *goal = t > 5 ? 0 : t > 4 ? 0.75 : t > 2.5 ? 1.55 : t > 1 ? 0.75 : 0;
    }
    return true;
}

/* What an integrator does with a run: the state moves on by a step. */
typedef struct pendulum {
    const run *run;
    grobo_i_tree *tree;
    double q, v, load_nm;
} pendulum;

static double inertia(const run *r)
{
    return (r->mass_kg + r->arm_kg / 3) * r->length_m * r->length_m;
}

static double weight_nm(const run *r, double q)
{
    return -(r->mass_kg + r->arm_kg / 2) * 9.80665 * r->length_m * sin(q + r->offset_rad);
}

/* The rule that the runs were made with, half a step's acceleration in the angle included. */
static void step_as_they(pendulum *p, double volts, bool on)
{
    const grobo_sim_motor *motor = &p->run->motor;
    double i = inertia(p->run) + motor->armature_kgm2, e = weight_nm(p->run, p->q);
    double m = on ? grobo_i_motor_torque(motor, volts, p->v) : 0;
    double most = grobo_i_motor_friction(&motor->friction, m, e, p->v);
    double stop = i / STEP_S * p->v + m + e;
    double a = (m + e - copysign(fmin(fabs(stop), most), stop)) / i;
    p->v = fmin(fmax(p->v + a * STEP_S, -100), 100);
    p->q += p->v * STEP_S + a * STEP_S * STEP_S / 2;
}

/* The simulator's: a link of the library's dynamics, implicit in damping. */
static void step_as_we(pendulum *p, double volts, bool on)
{
    const grobo_sim_motor *motor = &p->run->motor;
    double m = on ? grobo_i_motor_torque(motor, volts, p->v) : 0;
    double back = motor->kt_nm_a * motor->kt_nm_a;
    grobo_sim_drive drive = {.torque_nm = on ? motor->kt_nm_a * volts / motor->resistance_ohm : 0,
                             .damping_nms = on ? back / motor->resistance_ohm : 0,
                             .friction_nm =
                                 grobo_i_motor_friction(&motor->friction, m, p->load_nm, p->v),
                             .armature_kgm2 = motor->armature_kgm2,
                             .low_rad_s = -100,
                             .high_rad_s = 100};
    grobo_sim_state state = {.angle_rad = p->q, .speed_rad_s = p->v, .load_nm = p->load_nm};
    assert_int_equal(grobo_i_tree_step(p->tree, &drive, STEP_S, &state), 0);
    p->q = state.angle_rad;
    p->v = state.speed_rad_s;
    p->load_nm = state.load_nm;
}

static void make_pendulum(const run *r, grobo_i_tree *tree)
{
    double mass = r->mass_kg + r->arm_kg;
    double com = (r->mass_kg + r->arm_kg / 2) * r->length_m / mass;
    double c = cos(r->offset_rad), s = sin(r->offset_rad);
    const grobo_sim_link link = {.parent = -1,
                                 .joint = 0,
                                 .r = {c, 0, s, 0, 1, 0, -s, 0, c},
                                 .axis = {0, 1, 0},
                                 .mass_kg = mass,
                                 .com_m = {0, 0, -com},
                                 .inertia_kgm2 = {0, inertia(r) - mass * com * com, 0, 0, 0, 0}};
    assert_int_equal(grobo_i_tree_make(tree, &link, 1, 1), 0);
    tree->gravity_m_s2[2] = -9.80665;
}

/* Largest difference of the angle, rad. */
static double replay(const run *r, void (*step)(pendulum *, double, bool))
{
    char line[256];
    double worst = 0, set = 0;
    grobo_i_tree *tree = grobo_i_new(NULL, sizeof *tree);
    pendulum p = {.run = r, .tree = tree};
    FILE *file = open_golden(r->file);
    assert_non_null(tree);
    make_pendulum(r, tree);
    assert_non_null(fgets(line, sizeof line, file));
    for (int k = 0; k * STEP_S < RUN_S - STEP_S / 2; k++) {
        double t = k * STEP_S, goal = 0, way = r->motor.profile_rad_s * STEP_S;
        bool on = goal_at(r, t, &goal);
        if (k % (int)lround(ROWS_S / STEP_S) == 0) {
            double golden = NAN;
            assert_non_null(fgets(line, sizeof line, file));
            assert_int_equal(sscanf(line, "%*f,%*f,%*d,%lf", &golden), 1);
            worst = fmax(worst, fabs(golden - p.q));
        }
        set = way > 0 ? fmin(fmax(goal, set - way), set + way) : goal;
        double duty = (set - p.q) * r->kp * r->motor.duty_per_rad;
        duty = fmin(fmax(duty, -r->motor.duty_max), r->motor.duty_max);
        step(&p, r->vin * duty, on);
    }
    (void)fclose(file);
    grobo_i_free(NULL, tree, sizeof *tree);
    return worst;
}

static bool next_run(FILE *index, run *r)
{
    static const char *const names[][2] = {{"sts3215", "STS3215"},
                                           {"xl330", "XL330-M288"},
                                           {"mx64", "MX-64"},
                                           {"mx106", "MX-106"},
                                           {"xl320", "XL-320"}};
    char line[256];
    if (fgets(line, sizeof line, index) == NULL ||
        sscanf(line, "%79s %15s %3s %lf %lf %lf %lf %lf %23s %lf", r->file, r->servo, r->model,
               &r->kp, &r->vin, &r->mass_kg, &r->arm_kg, &r->length_m, r->trajectory,
               &r->offset_rad) != 10) {
        return false;
    }
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        if (strcmp(names[i][0], r->servo) == 0) {
            const grobo_servo_model model = {.name = names[i][1]};
            assert_int_equal(grobo_sim_motor_of(&model, &r->motor), 0);
            r->motor.torque_max_nm = 0; /* the fit knows no bound */
            return true;
        }
    }
    fail_msg("no servo %s", r->servo);
    return false;
}

/* By the way of integrating: what may differ, on top of which trajectory. */
static void replay_all(void (*step)(pendulum *, double, bool),
                       double (*allowed)(const char *trajectory))
{
    char line[256];
    FILE *index = open_golden("index.tsv");
    run r;
    int n = 0, n_wrong = 0;
    double worst = 0;
    assert_non_null(fgets(line, sizeof line, index));
    while (next_run(index, &r)) {
        double difference = replay(&r, step);
        worst = fmax(worst, difference);
        if (!(difference <= allowed(r.trajectory))) {
            print_message("%s: %.4g mrad\n", r.file, difference * 1000);
            n_wrong++;
        }
        n++;
    }
    (void)fclose(index);
    print_message("largest difference of %d runs: %.4g mrad\n", n, worst * 1000);
    assert_int_equal(n, 40);
    assert_int_equal(n_wrong, 0);
}

static double one_mrad(const char *trajectory)
{
    (void)trajectory;
    return 0.001;
}

/* What another integrator that is implicit in damping differs by, as the reference rounds it (the
 * last: 0.2 mrad). */
static double by_integrator(const char *trajectory)
{
    return strcmp(trajectory, "lift_and_drop") == 0     ? 0.038
           : strcmp(trajectory, "sin_time_square") == 0 ? 0.025
           : strcmp(trajectory, "steps") == 0           ? 0.011
           : strcmp(trajectory, "sin_sin") == 0         ? 0.003
                                                        : 0.00025;
}

TEST(motors_repeat_forty_runs_by_their_own_rule)
{
    replay_all(step_as_they, one_mrad);
}

TEST(motors_repeat_forty_runs_by_the_simulators_steps)
{
    replay_all(step_as_we, by_integrator);
}
