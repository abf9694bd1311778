/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include <grobo/core/unit.h>
#include <grobo/posture.h>

#include "src/base/angle.h"
#include "src/base/sized.h"
#include "src/model/joint.h"

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

/* True if name is text[0..length-1] but for case. */
static bool is_name(const char *name, const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        if (name[i] == '\0' || lower(name[i]) != lower(text[i])) {
            return false;
        }
    }
    return name[length] == '\0';
}

/* A number of one to three digits, or -1. */
static int small_number(const char *text, size_t length)
{
    int value = 0;
    if (length < 1 || length > 3) {
        return -1;
    }
    for (size_t i = 0; i < length; i++) {
        if (text[i] < '0' || text[i] > '9') {
            return -1;
        }
        value = value * 10 + (text[i] - '0');
    }
    return value;
}

/* Of the servo for the joint, with its sense. */
static double ratio_of(const grobo_joint *joint)
{
    double gear = joint->gear > 0 ? joint->gear : 1;
    return joint->sign < 0 ? -gear : gear;
}

double grobo_joint_to_servo(const grobo_joint *joint, double angle_rad)
{
    if (joint == NULL) {
        return 0;
    }
    bool geared = !grobo_i_soft_zero(joint->gear) && joint->gear > 0;
    double turned_rad = geared ? angle_rad * joint->gear : angle_rad;
    turned_rad = joint->sign < 0 ? -turned_rad : turned_rad;
    return grobo_i_soft_zero(joint->zero_rad) ? turned_rad : turned_rad + joint->zero_rad;
}

double grobo_joint_from_servo(const grobo_joint *joint, double servo_rad)
{
    return joint == NULL ? 0 : (servo_rad - joint->zero_rad) / ratio_of(joint);
}

static bool is_mount_good(const grobo_joint *joint)
{
    return joint->torque_limit_pct <= 100 && isfinite(joint->zero_rad) && joint->gear >= 0 &&
           isfinite(joint->gear);
}

/* Angles of a joint and of the one that it follows say the same. */
#define SAME_RAD 1e-6

static bool is_same(double a_rad, double b_rad)
{
    return fabs(a_rad - b_rad) <= SAME_RAD;
}

/* A joint that follows another one can go where that one sends it, and nowhere else. */
static bool is_follower_good(const grobo_model *model, const grobo_joint *joint)
{
    double ratio = grobo_i_ratio(joint), apart_rad = grobo_i_apart(joint);
    if (!grobo_i_may_follow(model)) {
        return true;
    }
    if (ratio == 0) {
        return grobo_i_first(joint) == 0 && apart_rad == 0;
    }
    if (grobo_i_first(joint) >= model->n_joints || !isfinite(ratio) || !isfinite(apart_rad) ||
        apart_rad < 0) {
        return false;
    }
    const grobo_joint *first = grobo_i_joint(model, grobo_i_first(joint));
    double low_rad = first->min_rad * ratio, high_rad = first->max_rad * ratio;
    return first != joint && grobo_i_ratio(first) == 0 &&
           is_same(joint->min_rad, fmin(low_rad, high_rad)) &&
           is_same(joint->max_rad, fmax(low_rad, high_rad)) &&
           is_same(joint->init_rad, first->init_rad * ratio);
}

/* Degrees have no scale of their own; a unit has one. */
static bool is_unit_good(const grobo_model *model, const grobo_joint *joint)
{
    if (!grobo_i_may_have_unit(model)) {
        return true;
    }
    double unit_rad = grobo_i_unit_rad(joint), zero_rad = grobo_i_unit_zero(joint);
    return grobo_i_unit(joint) == GROBO_UNIT_DEG
               ? unit_rad == 0 && zero_rad == 0
               : grobo_i_unit(joint) <= GROBO_UNIT_PCT && unit_rad != 0 && isfinite(unit_rad) &&
                     isfinite(zero_rad);
}

/* A wheel goes to no angle; nothing else has an acceleration. */
static bool is_wheel_good(const grobo_model *model, int j)
{
#if GROBO_DRIVERS_PLAIN
    (void)model;
    (void)j;
    return true;
#else
    const grobo_joint *joint = grobo_i_joint(model, j);
    if (!grobo_i_may_be_wheel(model)) {
        return true;
    }
    return joint->wheel ? joint->min_rad == 0 && joint->max_rad == 0 && joint->ratio == 0 &&
                              joint->unit == GROBO_UNIT_DEG && joint->accel_rad_s2 > 0 &&
                              isfinite(joint->accel_rad_s2)
                        : joint->accel_rad_s2 == 0;
#endif
}

static bool is_mirror_good(const grobo_model *model, int j)
{
    const grobo_joint *joint = grobo_i_joint(model, j);
    return joint->mirror < model->n_joints && grobo_i_joint(model, joint->mirror)->mirror == j &&
           (joint->mirror_sign == 1 || joint->mirror_sign == -1) &&
           grobo_i_joint(model, joint->mirror)->mirror_sign == joint->mirror_sign;
}

static bool is_joint_good(const grobo_model *model, int j)
{
    const grobo_joint *joint = grobo_i_joint(model, j);
    if (joint->name == NULL || joint->name[0] == '\0' || joint->motor > GROBO_SERVO_ID_MAX) {
        return false;
    }
    if (!isfinite(joint->min_rad) || !isfinite(joint->max_rad) ||
        !(joint->min_rad <= joint->init_rad && joint->init_rad <= joint->max_rad) ||
        !(joint->max_speed_rad_s > 0.0 && isfinite(joint->max_speed_rad_s))) {
        return false;
    }
    return is_mount_good(joint) && is_mirror_good(model, j) && is_follower_good(model, joint) &&
           is_unit_good(model, joint) && is_wheel_good(model, j) &&
           grobo_i_joint_line(model, j) < GROBO_LINES_MAX;
}

static bool is_joint_unique(const grobo_model *model, int j)
{
    const grobo_joint *joint = grobo_i_joint(model, j);
    for (int i = 0; i < j; i++) {
        bool same_line = grobo_i_joint_line(model, i) == grobo_i_joint_line(model, j);
        if ((grobo_i_joint(model, i)->motor == joint->motor && same_line) ||
            is_name(grobo_i_joint(model, i)->name, joint->name, strlen(joint->name))) {
            return false;
        }
    }
    return true;
}

static bool is_group_good(const grobo_model *model, int g)
{
    const grobo_group *group = &model->groups[g];
    if (group->name == NULL || group->name[0] == '\0' ||
        (group->joints & ~GROBO_JOINTS_ALL(model->n_joints)) != 0) {
        return false;
    }
    for (int i = 0; i < g; i++) {
        if (is_name(model->groups[i].name, group->name, strlen(group->name))) {
            return false;
        }
    }
    return true;
}

/* Whether the sizes of model and joints are those of a version. */
static bool is_size_good(const grobo_model *model)
{
#if GROBO_TABLES_FIXED
    return model != NULL && model->joints != NULL;
#else
    bool good = model != NULL && GROBO_I_FITS(model, limit_slack_deg) && model->joints != NULL;
    for (int j = 0; good && j < model->n_joints; j++) {
        const grobo_joint *joint = grobo_i_joint(model, j);
        good = grobo_i_table_fits(joint, model->joint_size, sizeof *joint,
                                  GROBO_I_END_OF(joint, torque_limit_pct));
    }
    return good;
#endif
}

const grobo_joint *grobo_model_joint(const grobo_model *model, int joint)
{
    bool known = model != NULL && joint >= 0 && joint < model->n_joints;
    return known ? grobo_i_joint(model, joint) : NULL;
}

int grobo_model_check(const grobo_model *model)
{
    if (!is_size_good(model) || model->name == NULL || model->n_joints < 1 ||
        model->n_joints > GROBO_JOINTS_MAX || (model->groups == NULL && model->n_groups > 0) ||
        !(model->limit_slack_deg >= 0 && model->limit_slack_deg <= GROBO_LIMIT_SLACK_MAX_DEG)) {
        return GROBO_ERR_ARG;
    }
    for (int j = 0; j < model->n_joints; j++) {
        if (!is_joint_good(model, j) || !is_joint_unique(model, j)) {
            return GROBO_ERR_ARG;
        }
    }
    for (int g = 0; g < model->n_groups; g++) {
        if (!is_group_good(model, g)) {
            return GROBO_ERR_ARG;
        }
    }
    return 0;
}

double grobo_model_take_slack(const grobo_model *model, int joint, double angle_rad)
{
    if (model == NULL) {
        return 0;
    }
    const grobo_joint *limits = grobo_i_joint(model, joint);
    const bool low = angle_rad < limits->min_rad;
    const double limit_rad = low ? limits->min_rad : limits->max_rad;

    if (!isfinite(angle_rad) || (!low && angle_rad <= limits->max_rad)) {
        return angle_rad;
    }
    /* on the wire's grid, as limits are judged: within half a step is no excess */
    int excess = grobo_ddeg_from_rad(angle_rad) - grobo_ddeg_from_rad(limit_rad);

    excess = low ? -excess : excess;
    return excess > 0 && excess <= 10 * model->limit_slack_deg ? limit_rad : angle_rad;
}

int grobo_model_joint_of_motor(const grobo_model *model, int motor)
{
    if (model == NULL) {
        return GROBO_ERR_ARG;
    }
    for (int j = 0; j < model->n_joints; j++) {
        if (grobo_i_joint(model, j)->motor == motor) {
            return j;
        }
    }
    return GROBO_ERR_NOTFOUND;
}

int grobo_model_motor_of_joint(const grobo_model *model, int joint)
{
    if (model == NULL || joint < 0 || joint >= model->n_joints) {
        return GROBO_ERR_ARG;
    }
    return grobo_i_joint(model, joint)->motor;
}

/* Of a robot of several lines two servos may have the id: then it names neither. */
static int only_joint_of_motor(const grobo_model *model, int motor)
{
    int joint = grobo_model_joint_of_motor(model, motor);
    for (int j = joint + 1; joint >= 0 && j < model->n_joints; j++) {
        if (grobo_i_joint(model, j)->motor == motor) {
            return GROBO_ERR_NOTFOUND;
        }
    }
    return joint;
}

int grobo_model_find_joint(const grobo_model *model, const char *name, size_t length)
{
    if (model == NULL || (name == NULL && length > 0)) {
        return GROBO_ERR_ARG;
    }
    for (int j = 0; j < model->n_joints; j++) {
        if (is_name(grobo_i_joint(model, j)->name, name, length)) {
            return j;
        }
    }
    if (length < 2) {
        return GROBO_ERR_NOTFOUND;
    }
    int number = small_number(name + 1, length - 1);
    if (lower(name[0]) == 'm' && number >= 0) {
        return only_joint_of_motor(model, number);
    }
    if (lower(name[0]) == 'j' && number >= 0 && number < model->n_joints) {
        return number;
    }
    return GROBO_ERR_NOTFOUND;
}

int grobo_joints_count(grobo_joint_mask joints)
{
    int n = 0;
    for (; joints != 0; joints &= joints - 1) {
        n++;
    }
    return n;
}

int grobo_model_find_joints(const grobo_model *model, const char *name, size_t length,
                            grobo_joint_mask *joints)
{
    if ((name == NULL && length > 0) || model == NULL || joints == NULL) {
        return GROBO_ERR_ARG;
    }
    int number = small_number(name, length);
    for (int g = 0; g < model->n_groups; g++) {
        if (g == number || is_name(model->groups[g].name, name, length)) {
            *joints = model->groups[g].joints;
            return grobo_joints_count(*joints);
        }
    }
    int joint = grobo_model_find_joint(model, name, length);
    if (joint < 0) {
        return joint;
    }
    *joints = GROBO_JOINT_BIT(joint);
    return 1;
}
