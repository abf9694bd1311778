/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include <grobo/core/wheel.h>

#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cli/robot.h"
#include "tools/grctl/lang/lang.h"

const char *joints_nearest(const grobo_model *model, const char *name, size_t length, bool groups)
{
    cli_guess guess = {.name = name, .length = length};
    for (int i = 0; i < model->n_joints; i++) {
        cli_guess_try(&guess, grobo_model_joint(model, i)->name);
    }
    for (int i = 0; groups && i < model->n_groups; i++) {
        cli_guess_try(&guess, model->groups[i].name);
    }
    return guess.best;
}

/* A joint to name in a message: of GR001 the right knee. */
static int an_example(const grobo_model *model)
{
    return model->n_joints > 3 ? 3 : 0;
}

/* "m4": the second joint with that motor, on another line than the first; -1: there is none. */
static int second_of_motor(const grobo_model *model, const char *name, size_t length, int *first)
{
    char digits[8];
    double motor;
    if (length < 2 || length > sizeof digits || (name[0] != 'm' && name[0] != 'M')) {
        return -1;
    }
    snprintf(digits, sizeof digits, "%.*s", (int)(length - 1), name + 1);
    *first = cli_read_number(digits, &motor) ? grobo_model_joint_of_motor(model, (int)motor) : -1;
    for (int j = *first + 1; *first >= 0 && j < model->n_joints; j++) {
        if (grobo_model_joint(model, j)->motor == (int)motor) {
            return j;
        }
    }
    return -1;
}

static int unknown(app *a, const char *what, const char *name, size_t length, bool groups)
{
    const char *nearest = joints_nearest(app_model(a), name, length, groups);
    int first, second = second_of_motor(app_model(a), name, length, &first);
    if (second >= 0) {
        return app_fail(a, EXIT_USAGE, "NOTFOUND",
                        "'%.*s' is %s and %s, of two lines: name the joint", (int)length, name,
                        grobo_model_joint(app_model(a), first)->name,
                        grobo_model_joint(app_model(a), second)->name);
    }
    if (nearest) {
        return app_fail(a, EXIT_USAGE, "NOTFOUND", "no %s called '%.*s'; did you mean %s?", what,
                        (int)length, name, nearest);
    }
    const grobo_model *model = app_model(a);
    char known[512] = "";
    size_t used = 0;
    for (int i = 0; i < model->n_groups && used < sizeof known; i++) {
        used += (size_t)snprintf(known + used, sizeof known - used, "%s%s",
                                 i ? " " : _(", groups are "), model->groups[i].name);
    }
    int joint = an_example(model);
    return app_fail(a, EXIT_USAGE, "NOTFOUND",
                    "no %s called '%.*s'; joints are named as %s, m%d or j%d%s; see 'grctl joints'",
                    what, (int)length, name, grobo_model_joint(model, joint)->name,
                    grobo_model_joint(model, joint)->motor, joint, known);
}

const char *joints_servo(const app *a, int joint, const char *prefix, char *buffer)
{
    const grobo_joint *is = grobo_model_joint(app_model(a), joint);
    if (a->on_line || robot_of(a)->n_lines > 0) {
        snprintf(buffer, JOINTS_SERVO_BYTES, "%s", is->name);
    } else {
        snprintf(buffer, JOINTS_SERVO_BYTES, "%s%d", prefix, is->motor);
    }
    return buffer;
}

const char *joints_servo_of(const app *a, int id, const char *prefix, char *buffer)
{
    int joint = grobo_model_joint_of_motor(app_model(a), id);
    if (joint >= 0) {
        return joints_servo(a, joint, prefix, buffer);
    }
    snprintf(buffer, JOINTS_SERVO_BYTES, "%s%d", prefix, id);
    return buffer;
}

int joints_parse_all(app *a, int n, const char *const *names, grobo_joint_mask *joints)
{
    int status = 0;
    *joints = n > 0 ? 0 : GROBO_JOINTS_ALL(app_model(a)->n_joints);
    for (int i = 0; i < n && !status; i++) {
        grobo_joint_mask found;
        if (grobo_model_find_joints(app_model(a), names[i], strlen(names[i]), &found) < 0) {
            status = unknown(a, _("joint or group"), names[i], strlen(names[i]), true);
        } else {
            *joints |= found;
        }
    }
    return status;
}

/* The number behind the j of "j12", or -1. */
static int joint_number(const char *name, size_t length)
{
    int number = 0;
    if (length < 2 || length > 3 || (name[0] != 'j' && name[0] != 'J')) {
        return -1;
    }
    for (size_t i = 1; i < length; i++) {
        if (name[i] < '0' || name[i] > '9') {
            return -1;
        }
        number = number * 10 + (name[i] - '0');
    }
    return number;
}

int joints_parse_motion(app *a, const char *list, const grobo_model *model, int n_joints,
                        grobo_joint_mask *joints)
{
    for (;; list++) {
        size_t length = strcspn(list, ",");
        int number = joint_number(list, length);
        grobo_joint_mask found = 0;
        if (number >= 0 && number < n_joints) {
            found = GROBO_JOINT_BIT(number);
        } else if (model && grobo_model_find_joints(model, list, length, &found) < 0) {
            return unknown(a, _("joint or group"), list, length, true);
        } else if (!model) {
            return app_fail(a, EXIT_USAGE, "NOTFOUND",
                            "no joint called '%.*s'; those of a body we do not know are j0 to j%d",
                            (int)length, list, n_joints - 1);
        }
        *joints |= found & GROBO_JOINTS_ALL(n_joints);
        list += length;
        if (*list == '\0') {
            return 0;
        }
    }
}

int joints_parse_one(app *a, const char *name, size_t length, int *status)
{
    int joint = grobo_model_find_joint(app_model(a), name, length);
    const grobo_joint *like = grobo_model_joint(app_model(a), an_example(app_model(a)));
    grobo_joint_mask group;
    if (joint >= 0) {
        return joint;
    }
    if (grobo_model_find_joints(app_model(a), name, length, &group) >= 0) {
        *status = app_fail(a, EXIT_USAGE, "NOTFOUND",
                           "'%.*s' is a group; one joint is wanted, named as %s, m%d or j%d",
                           (int)length, name, like->name, like->motor, an_example(app_model(a)));
    } else {
        *status = unknown(a, _("joint"), name, length, false);
    }
    return -1;
}

bool joints_read_angle(const grobo_model *model, int joint, const char *text, double *angle_rad)
{
    char number[64];
    size_t length = strspn(text, "0123456789+-.eE");
    /* The e of "5e1", and not that of "deg". */
    const char *unit = text + length;
    double value;
    if (length >= sizeof number) {
        return false;
    }
    memcpy(number, text, length);
    number[length] = '\0';
    if (!cli_read_number(number, &value)) {
        return false;
    }
    if (strcmp(unit, "deg") == 0) {
        *angle_rad = grobo_rad_from_deg(value);
        return true;
    }
    *angle_rad = grobo_model_angle(model, joint, value);
    return *unit == '\0' || strcmp(unit, grobo_unit_name(grobo_model_unit(model, joint))) == 0;
}

static const char *value_text(double value, grobo_unit unit, int decimals, char *buffer)
{
    double least = pow(10, -decimals) / 2;
    const char *name = unit == GROBO_UNIT_DEG ? _("deg") : grobo_unit_name(unit);
    snprintf(buffer, JOINTS_TEXT_BYTES, "%.*f %s", decimals, fabs(value) < least ? 0.0 : value,
             name); /* no -0.0 */
    return buffer;
}

const char *joints_text(const grobo_model *model, int joint, double angle_rad, int decimals,
                        char *buffer)
{
    return value_text(grobo_model_value(model, joint, angle_rad), grobo_model_unit(model, joint),
                      decimals, buffer);
}

const char *joints_error_text(const grobo_model *model, int joint, double deg, char *buffer)
{
    return value_text(fabs(grobo_model_change(model, joint, grobo_rad_from_deg(deg))),
                      grobo_model_unit(model, joint), 1, buffer);
}

const char *joints_mark(const grobo_model *model, int joint)
{
    grobo_unit unit = grobo_model_unit(model, joint);
    return unit == GROBO_UNIT_DEG ? "  " : unit == GROBO_UNIT_MM ? "mm" : "% ";
}

void joints_add_unit(json_t *object, const grobo_model *model, int joint)
{
    grobo_unit unit = grobo_model_unit(model, joint);
    if (unit != GROBO_UNIT_DEG) {
        json_object_set_new(object, "unit", json_string(grobo_unit_name(unit)));
    }
}

void joints_add_scale(json_t *object, const grobo_model *model, int joint)
{
    const grobo_joint *j = grobo_model_joint(model, joint);
    if (grobo_model_unit(model, joint) != GROBO_UNIT_DEG) {
        joints_add_unit(object, model, joint);
        json_object_set_new(object, "unit_zero_deg",
                            app_json_number(grobo_deg_from_rad(j->unit_zero_rad), 6));
        json_object_set_new(object, "unit_deg",
                            app_json_number(grobo_deg_from_rad(j->unit_rad), 9));
    }
}

void joints_add_value(json_t *object, const char *key, const grobo_model *model, int joint,
                      double angle_rad)
{
    if (grobo_model_unit(model, joint) != GROBO_UNIT_DEG) {
        json_object_set_new(object, key,
                            app_json_number(grobo_model_value(model, joint, angle_rad), 2));
    }
}

int joints_check_limits(app *a, const grobo_posture *posture, const char *doing)
{
    int joint = 0;
    grobo_joint_mask wheels = posture->set & grobo_model_wheels(app_model(a));
    while (wheels && !(wheels & GROBO_JOINT_BIT(joint))) {
        joint++;
    }
    if (wheels) {
        const char *name = grobo_model_joint(app_model(a), joint)->name;
        return app_fail(a, EXIT_USAGE, "ARG", "%s: %s is a wheel; use 'grctl drive %s=DEG/S'",
                        doing, name, name);
    }
    int error = grobo_posture_check(posture, app_model(a), &joint);
    if (!error) {
        return 0;
    }
    const grobo_model *model = app_model(a);
    const grobo_joint *j = grobo_model_joint(model, joint);
    double low = grobo_model_value(model, joint, j->min_rad);
    double high = grobo_model_value(model, joint, j->max_rad);
    char text[JOINTS_TEXT_BYTES];
    return app_fail(a, EXIT_SAFETY, grobo_error_name(error),
                    "%s: %s (motor %d) to %s is outside its limits %.0f to %.0f", doing, j->name,
                    j->motor, joints_text(model, joint, posture->angle_rad[joint], 1, text),
                    fmin(low, high), fmax(low, high));
}

json_t *joints_json(grobo_joint_mask joints)
{
    json_t *list = json_array();
    for (int j = 0; j < GROBO_JOINTS_MAX; j++) {
        if (joints & GROBO_JOINT_BIT(j)) {
            json_array_append_new(list, json_integer(j));
        }
    }
    return list;
}

json_t *joints_groups_json(const grobo_model *model, int joint)
{
    json_t *list = json_array();
    for (int i = 0; i < model->n_groups; i++) {
        if (model->groups[i].joints & GROBO_JOINT_BIT(joint)) {
            json_array_append_new(list, json_string(model->groups[i].name));
        }
    }
    return list;
}
