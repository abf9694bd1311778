/* SPDX-License-Identifier: MIT */
/*
 * A simulated robot whose links are in another process: mujoco_plant.py fills grobo_sim_plant.
 *
 * usage: plant_pipe --mjcf    prints the links of an SO-101 as MuJoCo wants them
 *        plant_pipe --dynamics ROBOT N
 *                             prints N poses of a robot (a name, or a file with a slash): angles,
 *                             torques of gravity, mass matrix, as our own dynamics have them
 *        plant_pipe           for each step, torque, damping, friction, armature, angle, speed
 *                             of each joint go to standard output; angle, speed and load come from
 *                             standard input, as doubles of this machine. The arm holds, moves,
 *                             stops on the way, and holds; what it did is judged, and told on
 *                             standard error.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/sim.h>
#include <grobo/core/sim_static.h>
#include <grobo/posture.h>
#include <grobo/robot_file.h>

#include "src/sim/physics/physics.h"

enum { LIFT = 1, ELBOW = 2, SECOND_US = 1000000 };

static grobo_sim sim;
static const grobo_robot_def *def;

/* ---- links ----------------------------------------------------------------------------------- */

static void print_body(int index)
{
    const grobo_robot_link *l = &def->links[index];
    const double *p = l->origin_m, *a = l->origin_rad, *c = l->com_m, *i = l->inertia_kgm2;
    printf("<body name=\"%s\" pos=\"%.9g %.9g %.9g\" euler=\"%.9g %.9g %.9g\">\n", l->name, p[0],
           p[1], p[2], a[0], a[1], a[2]);
    if (l->joint >= 0) {
        const grobo_joint *joint = &def->model->joints[l->joint];
        printf("<joint name=\"%s\" type=\"hinge\" axis=\"%.9g %.9g %.9g\" armature=\"0.0284\" "
               "limited=\"true\" range=\"%.9g %.9g\"/>\n",
               joint->name, l->axis[0], l->axis[1], l->axis[2], joint->min_rad, joint->max_rad);
    }
    if (l->mass_kg > 0) {
        printf("<inertial pos=\"%.9g %.9g %.9g\" mass=\"%.9g\" fullinertia=\"%.9g %.9g %.9g %.9g "
               "%.9g %.9g\"/>\n",
               c[0], c[1], c[2], l->mass_kg, i[0], i[1], i[2], i[3], i[4], i[5]);
    } else { /* the tool: what touches the table */
        printf("<geom type=\"sphere\" size=\"0.01\" mass=\"0\"/>\n");
    }
    for (int k = index + 1; k < def->n_links; k++) {
        if (def->links[k].parent == index) {
            print_body(k);
        }
    }
    printf("</body>\n");
}

static void print_mjcf(void)
{
    printf("<mujoco><compiler angle=\"radian\" eulerseq=\"XYZ\"/>\n"
           "<option timestep=\"0.001\" gravity=\"0 0 -9.80665\" integrator=\"implicitfast\"/>\n"
           "<worldbody><geom type=\"plane\" size=\"1 1 0.1\"/>\n");
    print_body(0);
    printf("</worldbody></mujoco>\n");
}

/* ---- dynamics -------------------------------------------------------------------------------- */

static void print_numbers(const double *numbers, int n)
{
    for (int i = 0; i < n; i++) {
        printf("%.12g ", numbers[i]);
    }
}

static int print_dynamics(const char *name, int poses)
{
    grobo_robot_def *read = NULL;
    grobo_sim_physics *physics = NULL;
    uint32_t random = 1;
    int error = strchr(name, '/') ? grobo_robot_def_read_file(name, NULL, NULL, &read) : 0;
    const grobo_robot_def *of = read != NULL ? read : grobo_robot_def_find(name);
    if (error < 0 || of == NULL || grobo_robot_def_physics(of, false, NULL, &physics) < 0) {
        return 2;
    }
    grobo_i_tree *tree = &((grobo_i_world *)physics)->tree;
    int n = of->model->n_joints;
    for (int pose = 0; pose < poses; pose++) {
        double q_rad[GROBO_JOINTS_MAX], torque_nm[GROBO_JOINTS_MAX];
        const double still[GROBO_JOINTS_MAX] = {0};
        for (int j = 0; j < n; j++) {
            const grobo_joint *joint = &of->model->joints[j];
            random = random * 1664525u + 1013904223u;
            q_rad[j] =
                joint->min_rad + (joint->max_rad - joint->min_rad) * (random >> 8) / 16777216;
        }
        grobo_i_tree_place(tree, q_rad);
        grobo_i_tree_torques(tree, still, NULL, torque_nm);
        grobo_i_tree_masses(tree);
        print_numbers(q_rad, n);
        print_numbers(torque_nm, n);
        print_numbers(tree->mass, n * n);
        printf("\n");
    }
    grobo_sim_physics_free(physics);
    grobo_robot_def_free(read);
    return 0;
}

/* ---- a step ---------------------------------------------------------------------------------- */

static int step(void *ctx, const grobo_sim_drive *drive, double dt_s, grobo_sim_state *state)
{
    int n = *(const int *)ctx;
    (void)dt_s;
    for (int i = 0; i < n; i++) {
        const double out[] = {drive[i].torque_nm,     drive[i].damping_nms, drive[i].friction_nm,
                              drive[i].armature_kgm2, state[i].angle_rad,   state[i].speed_rad_s};
        if (fwrite(out, sizeof out, 1, stdout) != 1) {
            return GROBO_ERR_IO;
        }
    }
    (void)fflush(stdout);
    for (int i = 0; i < n; i++) {
        double in[3];
        if (fread(in, sizeof in, 1, stdin) != 1) {
            return GROBO_ERR_IO;
        }
        state[i] = (grobo_sim_state){in[0], in[1], in[2]};
    }
    return GROBO_OK;
}

static double angle_deg(int servo)
{
    grobo_sim_view view;
    return grobo_sim_look(&sim, servo, &view) < 0 ? NAN : view.angle_mdeg / 1000.0;
}

static int32_t address(int servo, grobo_register_role role)
{
    return grobo_servo_register_of(sim.servo[servo].model, role)->address;
}

static void send_to(double deg)
{
    (void)grobo_sim_set_register(&sim, LIFT, address(LIFT, GROBO_ROLE_GOAL),
                                 2048 + (int32_t)lround(deg * 4096 / 360));
}

static bool judge(const char *what, int servo, double least_deg, double most_deg)
{
    double at_deg = angle_deg(servo);
    bool good = at_deg >= least_deg && at_deg <= most_deg;
    fprintf(stderr, "%s: %s at %.2f deg (%g to %g): %s\n", what, def->model->joints[servo].name,
            at_deg, least_deg, most_deg, good ? "good" : "BAD");
    return good;
}

int main(int argc, char **argv)
{
    static grobo_robot_sim setting;
    static int n;
    int64_t now_us = 0;
    grobo_sim_physics *physics = NULL;
    def = grobo_robot_def_find("so101");
    if (argc > 1 && strcmp(argv[1], "--mjcf") == 0) {
        print_mjcf();
        return 0;
    }
    if (argc > 3 && strcmp(argv[1], "--dynamics") == 0) {
        return print_dynamics(argv[2], (int)strtol(argv[3], NULL, 10));
    }
    n = def->model->n_joints;
    const grobo_sim_plant plant = {.step = step, .ctx = &n};
    const grobo_sim_physics_config config = {GROBO_SIM_PHYSICS_CONFIG_INIT, .model = def->model,
                                             .plant = &plant};
    if (grobo_robot_def_sim(def, def->wiring, &setting) < 0 ||
        grobo_sim_physics_new(&config, NULL, &physics) < 0) {
        return 2;
    }
    setting.config.physics = physics;
    if (grobo_sim_init(&sim, &setting.config, now_us) < 0) {
        return 2;
    }
    for (int i = 0; i < n; i++) {
        (void)grobo_sim_set_register(&sim, i, address(i, GROBO_ROLE_TORQUE), 1);
    }
    grobo_sim_step(&sim, now_us += 2 * SECOND_US);
    bool good =
        judge("holds with the arm stretched out, and sags", LIFT, 1, 3); /* 1.9 by our links */
    send_to(-40);
    grobo_sim_step(&sim, now_us += SECOND_US / 10);
    good = judge("moves up", LIFT, -39, 0) && good;
    double stopped_deg = angle_deg(LIFT);
    send_to(stopped_deg);
    grobo_sim_step(&sim, now_us += 2 * SECOND_US);
    good = judge("stops, and holds", LIFT, stopped_deg - 2, stopped_deg + 4) && good;
    send_to(-40);
    grobo_sim_step(&sim, now_us += 2 * SECOND_US);
    good = judge("goes on, and holds", LIFT, -40, -37) && good;
    for (int i = 0; i < n; i++) {
        (void)grobo_sim_set_register(&sim, i, address(i, GROBO_ROLE_TORQUE), 0);
    }
    grobo_sim_step(&sim, now_us += 3 * SECOND_US);
    good = judge("falls without torque, onto the table", ELBOW, 10, 101) && good;
    grobo_sim_physics_free(physics);
    return good ? 0 : 1;
}
