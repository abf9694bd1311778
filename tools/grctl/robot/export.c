/* SPDX-License-Identifier: MIT */
/*
 * A robot's links and joints for programs that simulate bodies: MJCF (MuJoCo) and URDF. Both have
 * the same frames, masses, inertias and limits. What a robot's file does not know is a guess here,
 * and a comment in the file says so: shapes, friction, motors.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/cli/heap.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/robot/make.h"

/* Of soles and floor. Nobody has measured it. */
#define SOLE_FRICTION 0.8
/* Of a sole's plate, and of shapes whose inertia says nothing. */
#define PLATE_M 0.002
/* Of a mass whose inertia is not known: that of a ball. */
#define BALL_M 0.02

typedef struct outline {
    heap *to;
    const grobo_robot_def *def;
    const grobo_robot_sim *setting; /* its servos */
    bool urdf, free;
} outline;

static const grobo_robot_foot *foot_of(const outline *e, int link)
{
    for (int i = 0; i < e->def->n_feet; i++) {
        if (e->def->feet[i].link == link) {
            return &e->def->feet[i];
        }
    }
    return NULL;
}

static bool has_inertia(const grobo_robot_link *link)
{
    return link->inertia_kgm2[0] > 0 && link->inertia_kgm2[1] > 0 && link->inertia_kgm2[2] > 0;
}

/* Half the edges of the box of the link's mass that has its moments of inertia. */
static void box_of(const grobo_robot_link *link, double half_m[3])
{
    const double *i = link->inertia_kgm2;
    double sum = i[0] + i[1] + i[2];
    for (int k = 0; k < 3; k++) {
        double square = has_inertia(link) ? 1.5 * (sum - 2 * i[k]) / link->mass_kg : 0;
        half_m[k] = fmax(square > 0 ? sqrt(square) : 0, PLATE_M);
    }
}

static void ball_of(const grobo_robot_link *link, double inertia[6])
{
    double ball = 0.4 * link->mass_kg * BALL_M * BALL_M;
    memset(inertia, 0, 6 * sizeof *inertia);
    for (int k = 0; k < 3; k++) {
        inertia[k] = ball;
    }
    if (has_inertia(link)) {
        memcpy(inertia, link->inertia_kgm2, sizeof link->inertia_kgm2);
    }
}

/* ---- what is not known ---------------------------------------------------------------------- */

static void put_motors(const outline *e)
{
    for (int j = 0; j < e->def->model->n_joints; j++) {
        grobo_sim_motor motor;
        bool again = false;
        for (int k = 0; k < j; k++) {
            again = again || e->setting->servos[k] == e->setting->servos[j];
        }
        if (!again && grobo_sim_motor_of(e->setting->servos[j], &motor) == 0) {
            heap_print(e->to, "    %s: %sidentified: %s.\n", e->setting->servos[j]->name,
                       motor.from == GROBO_SIM_MOTOR_IDENTIFIED ? "" : "not ", motor.source);
        }
    }
}

static void put_unknown(const outline *e)
{
    const grobo_robot_def *def = e->def;
    int without = 0;
    for (int i = 0; i < def->n_links; i++) {
        without += def->links[i].mass_kg > 0 && !has_inertia(&def->links[i]);
    }
    heap_print(e->to,
               "<!-- %s, by grctl robot export. Frames, masses, inertias and limits are those of "
               "the robot's file.\n  Not known, and guessed:\n    Shapes: boxes of the same "
               "inertia. They meet the floor, not each other.\n",
               def->name);
    if (def->n_feet) {
        heap_print(e->to, "    Friction of the soles: %g.\n", SOLE_FRICTION);
    }
    if (without) {
        heap_print(e->to, "    Inertia of %d links that have a mass alone: that of a ball.\n",
                   without);
    }
    heap_print(e->to, "  Motors and gears are not in here: python -m grobo.physics has them.\n");
    put_motors(e);
    heap_print(e->to, "-->\n");
}

/* ---- MJCF ----------------------------------------------------------------------------------- */

static void put_mjcf_mass(const outline *e, const grobo_robot_link *link)
{
    const double *c = link->com_m;
    double i[6];
    if (link->mass_kg <= 0) {
        return;
    }
    ball_of(link, i);
    heap_print(e->to,
               "<inertial pos=\"%.12g %.12g %.12g\" mass=\"%.12g\" fullinertia=\"%.12g %.12g %.12g "
               "%.12g %.12g %.12g\"/>\n",
               c[0], c[1], c[2], link->mass_kg, i[0], i[1], i[2], i[3], i[4], i[5]);
}

static void put_mjcf_shape(const outline *e, int index)
{
    const grobo_robot_link *link = &e->def->links[index];
    const grobo_robot_foot *foot = foot_of(e, index);
    const double *c = link->com_m;
    double half_m[3];
    if (foot) {
        heap_print(e->to,
                   "<geom name=\"%s_sole\" class=\"sole\" pos=\"%.9g %.9g %.9g\" size=\"%.9g %.9g "
                   "%.9g\"/>\n",
                   link->name, foot->sole_m[0], foot->sole_m[1], foot->sole_m[2] + PLATE_M,
                   foot->half_m[0], foot->half_m[1], PLATE_M);
    } else if (link->mass_kg > 0) {
        box_of(link, half_m);
        heap_print(e->to, "<geom class=\"part\" pos=\"%.9g %.9g %.9g\" size=\"%.9g %.9g %.9g\"/>\n",
                   c[0], c[1], c[2], half_m[0], half_m[1], half_m[2]);
    }
}

static void put_mjcf_link(const outline *e, int index)
{
    const grobo_robot_link *link = &e->def->links[index];
    const double *p = link->origin_m, *r = link->origin_rad, *a = link->axis;
    heap_print(e->to, "<body name=\"%s\" pos=\"%.12g %.12g %.12g\" euler=\"%.12g %.12g %.12g\">\n",
               link->name, p[0], p[1], p[2], r[0], r[1], r[2]);
    if (link->parent < 0 && e->free) {
        heap_print(e->to, "<freejoint name=\"base\"/>\n");
    }
    if (link->joint >= 0) {
        const grobo_joint *joint = &e->def->model->joints[link->joint];
        heap_print(e->to, "<joint name=\"%s\" axis=\"%.12g %.12g %.12g\" range=\"%.9g %.9g\"/>\n",
                   joint->name, a[0], a[1], a[2], joint->min_rad, joint->max_rad);
    }
    put_mjcf_mass(e, link);
    put_mjcf_shape(e, index);
    for (int k = index + 1; k < e->def->n_links; k++) {
        if (e->def->links[k].parent == index) {
            put_mjcf_link(e, k);
        }
    }
    heap_print(e->to, "</body>\n");
}

static void put_mjcf(const outline *e)
{
    heap_print(e->to, "<mujoco model=\"%s\">\n", e->def->name);
    put_unknown(e);
    heap_print(e->to,
               "<compiler angle=\"radian\" eulerseq=\"XYZ\" boundmass=\"1e-9\" "
               "boundinertia=\"1e-12\"/>\n"
               "<option timestep=\"0.001\" gravity=\"0 0 -9.80665\" integrator=\"implicitfast\"/>\n"
               "<default>\n<joint type=\"hinge\" limited=\"true\"/>\n<geom type=\"box\" mass=\"0\" "
               "contype=\"0\" conaffinity=\"1\"/>\n"
               "<default class=\"part\"><geom rgba=\"0.4 0.5 0.7 1\"/></default>\n"
               "<default class=\"sole\"><geom rgba=\"0.2 0.2 0.2 1\" friction=\"%g 0.005 "
               "0.0001\"/></default>\n</default>\n<worldbody>\n"
               "<light pos=\"0 0 3\" dir=\"0 0 -1\"/>\n",
               SOLE_FRICTION);
    if (e->free) {
        heap_print(e->to, "<geom name=\"floor\" type=\"plane\" size=\"5 5 0.1\" contype=\"1\" "
                          "conaffinity=\"1\" rgba=\"0.8 0.8 0.8 1\"/>\n");
    }
    for (int i = 0; i < e->def->n_links; i++) {
        if (e->def->links[i].parent < 0) {
            put_mjcf_link(e, i);
        }
    }
    heap_print(e->to, "</worldbody>\n</mujoco>\n");
}

/* ---- URDF ----------------------------------------------------------------------------------- */

static void put_urdf_shape(const outline *e, int index)
{
    static const char *const kinds[] = {"visual", "collision"};
    const grobo_robot_link *link = &e->def->links[index];
    const grobo_robot_foot *foot = foot_of(e, index);
    double half_m[3] = {0}, at_m[3];
    if (!foot && link->mass_kg <= 0) {
        return;
    }
    box_of(link, half_m);
    memcpy(at_m, link->com_m, sizeof at_m);
    if (foot) {
        memcpy(at_m, foot->sole_m, sizeof at_m);
        at_m[2] += PLATE_M;
        half_m[0] = foot->half_m[0];
        half_m[1] = foot->half_m[1];
        half_m[2] = PLATE_M;
    }
    for (int i = 0; i < 2; i++) {
        heap_print(e->to,
                   "<%s><origin xyz=\"%.9g %.9g %.9g\"/><geometry><box size=\"%.9g %.9g "
                   "%.9g\"/></geometry></%s>\n",
                   kinds[i], at_m[0], at_m[1], at_m[2], 2 * half_m[0], 2 * half_m[1], 2 * half_m[2],
                   kinds[i]);
    }
}

static void put_urdf_link(const outline *e, int index)
{
    const grobo_robot_link *link = &e->def->links[index];
    const double *c = link->com_m;
    double i[6];
    heap_print(e->to, "<link name=\"%s\">\n", link->name);
    if (link->mass_kg > 0) {
        ball_of(link, i);
        heap_print(e->to,
                   "<inertial><origin xyz=\"%.12g %.12g %.12g\"/><mass value=\"%.12g\"/><inertia "
                   "ixx=\"%.12g\" iyy=\"%.12g\" izz=\"%.12g\" ixy=\"%.12g\" ixz=\"%.12g\" "
                   "iyz=\"%.12g\"/></inertial>\n",
                   c[0], c[1], c[2], link->mass_kg, i[0], i[1], i[2], i[3], i[4], i[5]);
    }
    put_urdf_shape(e, index);
    heap_print(e->to, "</link>\n");
}

/* What the servo gives at the joint, as its motor is known. */
static double effort_nm(const outline *e, int joint)
{
    const grobo_servo_model *servo = e->setting->servos[joint];
    grobo_sim_motor motor;
    double gear = fabs(e->def->model->joints[joint].gear);
    if (grobo_sim_motor_of(servo, &motor) < 0) {
        return 0;
    }
    gear = gear > 0 ? gear : 1;
    double stall_nm = motor.kt_nm_a * servo->voltage_mv / 1000 / motor.resistance_ohm;
    return gear * (motor.torque_max_nm > 0 ? fmin(motor.torque_max_nm, stall_nm) : stall_nm);
}

static void put_urdf_joint(const outline *e, int index)
{
    const grobo_robot_link *link = &e->def->links[index];
    const double *p = link->origin_m, *r = link->origin_rad, *a = link->axis;
    const grobo_joint *joint = link->joint >= 0 ? &e->def->model->joints[link->joint] : NULL;
    heap_print(e->to,
               "<joint name=\"%s%s\" type=\"%s\"><parent link=\"%s\"/><child link=\"%s\"/><origin "
               "xyz=\"%.12g %.12g %.12g\" rpy=\"%.12g %.12g %.12g\"/>",
               joint ? joint->name : link->name, joint ? "" : "_fixed",
               joint ? "revolute" : "fixed", e->def->links[link->parent].name, link->name, p[0],
               p[1], p[2], r[0], r[1], r[2]);
    if (joint) {
        heap_print(e->to,
                   "<axis xyz=\"%.12g %.12g %.12g\"/><limit lower=\"%.9g\" upper=\"%.9g\" "
                   "effort=\"%.6g\" velocity=\"%.6g\"/>",
                   a[0], a[1], a[2], joint->min_rad, joint->max_rad, effort_nm(e, link->joint),
                   joint->max_speed_rad_s);
    }
    heap_print(e->to, "</joint>\n");
}

static void put_urdf(const outline *e)
{
    heap_print(e->to, "<robot name=\"%s\">\n", e->def->name);
    put_unknown(e);
    for (int i = 0; i < e->def->n_links; i++) {
        put_urdf_link(e, i);
    }
    for (int i = 0; i < e->def->n_links; i++) {
        if (e->def->links[i].parent >= 0) {
            put_urdf_joint(e, i);
        }
    }
    heap_print(e->to, "</robot>\n");
}

/* ---- out ------------------------------------------------------------------------------------ */

/* One root, and each joint moves a link: else the file would not be that robot. */
static const char *complaint_of(const grobo_robot_def *def)
{
    int roots = 0;
    grobo_joint_mask moved = 0;
    for (int i = 0; i < def->n_links; i++) {
        roots += def->links[i].parent < 0;
        moved |= def->links[i].joint >= 0 ? GROBO_JOINT_BIT(def->links[i].joint) : 0;
    }
    if (!def->n_links) {
        return N_("its file has no links; docs/guide/own-robot.md describes them");
    }
    if (roots != 1) {
        return N_("its links have several roots");
    }
    return moved == GROBO_JOINTS_ALL(def->model->n_joints) ? NULL
                                                           : N_("a joint of it moves no link");
}

int sketch_export(app *a, const grobo_robot_def *def, bool urdf, bool free_base, const char *out)
{
    heap text = {0};
    grobo_robot_sim setting;
    const outline e = {&text, def, &setting, urdf, free_base || def->n_feet > 0};
    const char *complaint = complaint_of(def);
    if (complaint || grobo_robot_def_sim(def, def->wiring, &setting) < 0) {
        return app_fail(a, EXIT_FILE, "UNSUPPORTED", "%s: %s", def->name,
                        complaint ? _(complaint) : "");
    }
    (urdf ? put_urdf : put_mjcf)(&e);
    if (!text.bytes) {
        return app_fail_error(a, EXIT_ROBOT, GROBO_ERR_NOMEM, "robot");
    }
    int status = out ? sketch_save(a, out, text.bytes) : EXIT_DONE;
    if (!status && a->json) {
        app_print_json(json_pack("{s:s,s:s,s:o?,s:o?}", "name", def->name, "format",
                                 urdf ? "urdf" : "mjcf", "file", out ? app_json_text(out) : NULL,
                                 "text", out ? NULL : json_string(text.bytes)));
    } else if (!status && !out) {
        app_print("%s", text.bytes);
    }
    free(text.bytes);
    return status;
}
