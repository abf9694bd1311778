/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cli/robot.h"
#include "tools/grctl/play/whole.h"
#include "tools/grctl/web/pose.h"
#include "tools/grctl/web/serve.h"

enum { METRE_DECIMALS = 5, TURN_DECIMALS = 6, INERTIA_DECIMALS = 9 };

static const char *const sides[] = {"right", "left"};

const grobo_body_model *pose_body(const app *a)
{
    return whole_legs(a, app_model(a));
}

/* ---- numbers --------------------------------------------------------------------------------- */

static json_t *list_json(const double *values, int n, int decimals)
{
    json_t *list = json_array();
    for (int i = 0; i < n; i++) {
        json_array_append_new(list, app_json_number(values[i], decimals));
    }
    return list;
}

json_t *pose_angles_json(const grobo_posture *posture, int n_joints, int decimals)
{
    json_t *list = json_array();
    for (int j = 0; j < n_joints; j++) {
        bool set = j < posture->n_joints && (posture->set & GROBO_JOINT_BIT(j));
        json_array_append_new(
            list, app_json_number(set ? grobo_deg_from_rad(posture->angle_rad[j]) : NAN, decimals));
    }
    return list;
}

json_t *pose_placement_json(const grobo_transform *at)
{
    return json_pack("{s:o,s:o}", "p_m", list_json(at->p_m, 3, METRE_DECIMALS), "rotation",
                     list_json(at->r, 9, TURN_DECIMALS));
}

static bool read_numbers(const json_t *list, size_t n, double *values)
{
    double read[9 > GROBO_JOINTS_MAX ? 9 : GROBO_JOINTS_MAX];
    if (json_array_size(list) != n) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        const json_t *number = json_array_get(list, i);
        if (!json_is_number(number) || fabs(json_number_value(number)) > GROBO_BODY_NUMBER_MAX) {
            return false;
        }
        read[i] = json_number_value(number);
    }
    memcpy(values, read, n * sizeof *values);
    return true;
}

static bool read_angles(const json_t *list, int n_joints, double *q_rad)
{
    double deg[GROBO_JOINTS_MAX];
    bool fine = read_numbers(list, (size_t)n_joints, deg);
    for (int j = 0; fine && j < n_joints; j++) {
        q_rad[j] = grobo_rad_from_deg(deg[j]);
    }
    return fine;
}

/* Columns of length 1, at right angles: else whatever is placed by it would be bent. */
static bool is_rotation(const double r[9])
{
    for (int i = 0; i < 3; i++) {
        for (int k = i; k < 3; k++) {
            double dot = r[i] * r[k] + r[3 + i] * r[3 + k] + r[6 + i] * r[6 + k];
            if (fabs(dot - (i == k)) > 1e-3) {
                return false;
            }
        }
    }
    return true;
}

bool pose_read_placement(const json_t *p_m, const json_t *rotation, grobo_transform *at)
{
    grobo_transform read = *at;
    if ((p_m && !read_numbers(p_m, 3, read.p_m)) ||
        (rotation && (!read_numbers(rotation, 9, read.r) || !is_rotation(read.r)))) {
        return false;
    }
    *at = read;
    return true;
}

/* ---- what it is made of ---------------------------------------------------------------------- */

void pose_rotation(double r[9], const double rpy_rad[3])
{
    const double cr = cos(rpy_rad[0]), sr = sin(rpy_rad[0]), cp = cos(rpy_rad[1]),
                 sp = sin(rpy_rad[1]);
    const double cy = cos(rpy_rad[2]), sy = sin(rpy_rad[2]);
    const double m[9] = {cp * cy,
                         sr * sp * cy - cr * sy,
                         cr * sp * cy + sr * sy,
                         cp * sy,
                         sr * sp * sy + cr * cy,
                         cr * sp * sy - sr * cy,
                         -sp,
                         sr * cp,
                         cr * cp};
    memcpy(r, m, sizeof m);
}

static json_t *link_json(const grobo_robot_link *l)
{
    double r[9];
    pose_rotation(r, l->origin_rad);
    return json_pack("{s:s,s:i,s:i,s:o,s:o,s:o,s:o,s:n}", "name", l->name, "parent", l->parent,
                     "joint", l->joint, "origin_m", list_json(l->origin_m, 3, METRE_DECIMALS),
                     "rotation", list_json(r, 9, TURN_DECIMALS), "axis",
                     list_json(l->axis, 3, TURN_DECIMALS), "mass_kg",
                     app_json_number(l->mass_kg, 5), "com_m");
}

static json_t *body_link_json(const grobo_body_link *l)
{
    static const double straight[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    return json_pack(
        "{s:s,s:i,s:i,s:o,s:o,s:o,s:o,s:o,s:o}", "name", l->name, "parent", l->parent, "joint",
        l->joint, "origin_m", list_json(l->offset_m, 3, METRE_DECIMALS), "rotation",
        list_json(straight, 9, 0), "axis", list_json(l->axis, 3, TURN_DECIMALS), "mass_kg",
        app_json_number(l->mass_kg, 5), "com_m", list_json(l->com_m, 3, METRE_DECIMALS),
        "inertia_kgm2", list_json(l->inertia_kgm2, 9, INERTIA_DECIMALS));
}

json_t *pose_links_json(const app *a)
{
    const grobo_body_model *body = pose_body(a);
    const grobo_robot_def *def = robot_of(a);
    json_t *list = json_array();
    for (int i = 0; body && i < body->n_links; i++) {
        json_array_append_new(list, body_link_json(&body->links[i]));
    }
    for (int i = 0; !body && i < def->n_links; i++) {
        json_array_append_new(list, link_json(&def->links[i]));
    }
    return list;
}

/* The joints of a leg, waist to foot. */
static void leg_joints(const grobo_body_model *body, int side, int joints[GROBO_BODY_LEG_JOINTS])
{
    int link = body->feet[side].link;
    for (int i = GROBO_BODY_LEG_JOINTS - 1; i >= 0 && link > 0; i--) {
        joints[i] = body->links[link].joint;
        link = body->links[link].parent;
    }
}

json_t *pose_feet_json(const app *a)
{
    const grobo_body_model *body = pose_body(a);
    json_t *feet = json_array();
    double mass_kg = 0;
    for (int i = 0; body && i < body->n_links; i++) {
        mass_kg += body->links[i].mass_kg;
    }
    for (int side = 0; body && side < 2; side++) {
        const grobo_body_foot *foot = &body->feet[side];
        int joints[GROBO_BODY_LEG_JOINTS] = {0};
        json_t *leg = json_array();
        leg_joints(body, side, joints);
        for (int i = 0; i < GROBO_BODY_LEG_JOINTS; i++) {
            json_array_append_new(leg, json_integer(joints[i]));
        }
        json_array_append_new(
            feet, json_pack("{s:s,s:i,s:o,s:o,s:o}", "side", sides[side], "link", foot->link,
                            "sole_m", list_json(foot->sole_m, 3, METRE_DECIMALS), "half_m",
                            list_json(foot->half_m, 2, METRE_DECIMALS), "joints", leg));
    }
    if (!body) {
        json_decref(feet);
        return json_null();
    }
    return json_pack("{s:o,s:o}", "feet", feet, "mass_kg", app_json_number(mass_kg, 5));
}

/* ---- where it stands ------------------------------------------------------------------------- */

json_t *pose_stand_json(const grobo_body_stand *stand, const double *zmp_m)
{
    json_t *soles = json_array(), *support = json_array();
    for (int side = 0; side < 2; side++) {
        json_t *corners = json_array();
        for (int i = 0; i < 4; i++) {
            json_array_append_new(corners, list_json(stand->sole_m[side][i], 3, METRE_DECIMALS));
        }
        json_array_append_new(soles, json_pack("{s:s,s:b,s:o}", "side", sides[side], "standing",
                                               stand->standing[side], "corners_m", corners));
    }
    for (int i = 0; i < stand->n_support; i++) {
        json_array_append_new(support, list_json(stand->support_m[i], 2, METRE_DECIMALS));
    }
    return json_pack(
        "{s:o,s:o,s:o,s:o,s:o,s:o}", "root", pose_placement_json(&stand->root), "com_m",
        list_json(stand->com_m, 3, METRE_DECIMALS), "zmp_m",
        zmp_m ? list_json(zmp_m, 3, METRE_DECIMALS) : json_null(), "soles", soles, "support_m",
        support, "margin_m",
        app_json_number(grobo_body_stand_margin(stand, zmp_m ? zmp_m : stand->com_m), 5));
}

bool pose_stand(const app *a, const grobo_posture *posture, grobo_body_stand *stood)
{
    const grobo_body_model *body = pose_body(a);
    double q_rad[GROBO_JOINTS_MAX];
    for (int j = 0; body && j < body->n_joints; j++) {
        bool set = j < posture->n_joints && (posture->set & GROBO_JOINT_BIT(j));
        q_rad[j] = set ? posture->angle_rad[j] : grobo_model_joint(app_model(a), j)->init_rad;
    }
    return body && grobo_body_stand_pose(body, q_rad, NULL, stood) == GROBO_OK;
}

json_t *pose_root_json(const app *a, const grobo_posture *posture)
{
    grobo_body_stand stood;
    return pose_stand(a, posture, &stood) ? pose_placement_json(&stood.root) : json_null();
}

/* ---- a handle that is dragged ---------------------------------------------------------------- */

/* A place in the world, in the frame of another. */
static void in_frame_of(const grobo_transform *frame, const grobo_transform *at,
                        grobo_transform *local)
{
    for (int i = 0; i < 3; i++) {
        local->p_m[i] = 0;
        for (int k = 0; k < 3; k++) {
            local->p_m[i] += frame->r[3 * k + i] * (at->p_m[k] - frame->p_m[k]);
            local->r[3 * i + k] = frame->r[i] * at->r[k] + frame->r[3 + i] * at->r[3 + k] +
                                  frame->r[6 + i] * at->r[6 + k];
        }
    }
}

/* What is dragged, and where all of it is. */
typedef struct dragging {
    const grobo_body_model *body;
    double q_rad[GROBO_JOINTS_MAX];
    grobo_transform root, feet[2];
} dragging;

static bool reach(dragging *d)
{
    for (int side = 0; side < 2; side++) {
        int joints[GROBO_BODY_LEG_JOINTS] = {0};
        double leg_rad[GROBO_BODY_LEG_JOINTS];
        grobo_transform target;
        in_frame_of(&d->root, &d->feet[side], &target);
        leg_joints(d->body, side, joints);
        if (grobo_body_leg_exact(d->body, side, &target, leg_rad) < 0) {
            return false;
        }
        for (int i = 0; i < GROBO_BODY_LEG_JOINTS; i++) {
            d->q_rad[joints[i]] = leg_rad[i];
        }
    }
    return true;
}

static json_t *beyond_limits(const grobo_model *model, const double *q_rad)
{
    static const double slack_rad = 0.05 * 3.14159265358979323846 / 180; /* the wire's half unit */
    grobo_joint_mask beyond = 0;
    for (int j = 0; j < model->n_joints; j++) {
        if (q_rad[j] < grobo_model_joint(model, j)->min_rad - slack_rad ||
            q_rad[j] > grobo_model_joint(model, j)->max_rad + slack_rad) {
            beyond |= GROBO_JOINT_BIT(j);
        }
    }
    return joints_json(beyond);
}

/* The pose that is given, and where its feet are. */
static bool read_pose(const json_t *body, dragging *d)
{
    const json_t *root = json_object_get(body, "root");
    grobo_transform links[GROBO_BODY_LINKS_MAX];
    grobo_body_stand stood;
    if (!read_angles(json_object_get(body, "angle_deg"), d->body->n_joints, d->q_rad) ||
        grobo_body_stand_pose(d->body, d->q_rad, NULL, &stood) < 0) {
        return false;
    }
    d->root = stood.root;
    if (root && !pose_read_placement(json_object_get(root, "p_m"),
                                     json_object_get(root, "rotation"), &d->root)) {
        return false;
    }
    grobo_body_forward(d->body, &d->root, d->q_rad, links);
    for (int side = 0; side < 2; side++) {
        d->feet[side] = links[d->body->feet[side].link];
    }
    return true;
}

static grobo_transform *handle_of(dragging *d, const char *name)
{
    return !name                             ? NULL
           : strcmp(name, "right_foot") == 0 ? &d->feet[0]
           : strcmp(name, "left_foot") == 0  ? &d->feet[1]
           : strcmp(name, "waist") == 0      ? &d->root
                                             : NULL;
}

static void reply_pose(serve *s, http_request *r, dragging *d, bool reached, json_t *limits)
{
    grobo_body_stand stood;
    double deg[GROBO_JOINTS_MAX];
    grobo_body_stand_pose(d->body, d->q_rad, &d->root, &stood);
    for (int j = 0; j < s->model->n_joints; j++) {
        deg[j] = grobo_deg_from_rad(d->q_rad[j]);
    }
    http_reply_json(r, 200,
                    json_pack("{s:b,s:o,s:o,s:[o,o],s:o,s:o}", "reached", reached, "angle_deg",
                              list_json(deg, s->model->n_joints, 4), "root",
                              pose_placement_json(&d->root), "feet",
                              pose_placement_json(&d->feet[0]), pose_placement_json(&d->feet[1]),
                              "body", pose_stand_json(&stood, NULL), "limits", limits));
}

void pose_ik(serve *s, http_request *r, const json_t *body)
{
    dragging was = {.body = pose_body(s->a)};
    if (!was.body) {
        http_refuse(r, 422, "unsupported", "ik: the legs of this robot are not known");
        return;
    }
    bool fine = read_pose(body, &was);
    dragging d = was;
    grobo_transform *handle = handle_of(&d, json_string_value(json_object_get(body, "handle")));
    fine = fine && handle && json_object_get(body, "p_m") &&
           pose_read_placement(json_object_get(body, "p_m"), json_object_get(body, "rotation"),
                               handle);
    if (!fine) {
        http_refuse(r, 422, "arg",
                    "ik: angle_deg has all joints, handle is right_foot, left_foot or waist, p_m "
                    "and rotation are where it shall be");
        return;
    }
    bool reached = reach(&d);
    json_t *limits = reached ? beyond_limits(s->model, d.q_rad) : json_array();
    reached = reached && json_array_size(limits) == 0;
    reply_pose(s, r, reached ? &d : &was, reached, limits);
}
