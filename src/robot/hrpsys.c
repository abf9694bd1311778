/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include <grobo/core/hrpsys.h>

#include "src/model/joint.h"

static const grobo_model *model_of(const grobo_hrpsys *hrpsys)
{
    return grobo_robot_driver(hrpsys->robot)->model;
}

void grobo_hrpsys_init(grobo_hrpsys *hrpsys, grobo_robot *robot)
{
    if (hrpsys == NULL || robot == NULL) {
        return;
    }
    memset(hrpsys, 0, sizeof *hrpsys);
    hrpsys->robot = robot;
    (void)grobo_posture_init(&hrpsys->command, model_of(hrpsys)->n_joints);
}

/* ---- names ---------------------------------------------------------------------------------- */

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

static bool is_same(const char *a, const char *b)
{
    while (*a != '\0' && lower(*a) == lower(*b)) {
        a++;
        b++;
    }
    return *a == '\0' && *b == '\0';
}

static bool is_number(const char *text)
{
    while (*text >= '0' && *text <= '9') {
        text++;
    }
    return *text == '\0';
}

int grobo_hrpsys_find(const grobo_hrpsys *hrpsys, const char *name, grobo_joint_mask *joints)
{
    if (hrpsys == NULL || name == NULL || joints == NULL) {
        return GROBO_ERR_ARG;
    }
    const grobo_model *model = model_of(hrpsys);
    if (is_same(name, "all")) { /* whether or not the model has a group of that name */
        *joints = GROBO_JOINTS_ALL(model->n_joints);
        return model->n_joints;
    }
    for (unsigned i = 0; i < hrpsys->n_groups; i++) {
        if (is_same(hrpsys->groups[i].name, name)) {
            *joints = hrpsys->groups[i].joints;
            return grobo_joints_count(*joints);
        }
    }
    if (is_number(name)) { /* the model would take it for a group's */
        return GROBO_ERR_NOTFOUND;
    }
    return grobo_model_find_joints(model, name, strlen(name), joints);
}

int grobo_hrpsys_add_joint_group(grobo_hrpsys *hrpsys, const char *name, const char *const *joints,
                                 size_t n)
{
    if (hrpsys == NULL || name == NULL || (joints == NULL && n > 0)) {
        return GROBO_ERR_ARG;
    }
    grobo_joint_mask found = 0;
    grobo_joint_mask group = 0;
    size_t length = strlen(name);
    if (is_number(name) || n == 0) { /* no digits at all are a number too */
        return GROBO_ERR_ARG;
    }
    if (length >= GROBO_NAME_MAX_BYTES) {
        return GROBO_ERR_CAP;
    }
    if (grobo_hrpsys_find(hrpsys, name, &found) >= 0) {
        return GROBO_ERR_EXISTS;
    }
    for (size_t i = 0; i < n; i++) {
        int result = grobo_hrpsys_find(hrpsys, joints[i], &found);
        if (result < 0) {
            return result;
        }
        group |= found;
    }
    if (hrpsys->n_groups == GROBO_HRPSYS_GROUPS) {
        return GROBO_ERR_FULL;
    }
    memcpy(hrpsys->groups[hrpsys->n_groups].name, name, length + 1);
    hrpsys->groups[hrpsys->n_groups].joints = group;
    hrpsys->n_groups++;
    return grobo_joints_count(group);
}

int grobo_hrpsys_names_to_ids(const grobo_hrpsys *hrpsys, const char *const *names, size_t n,
                              int *ids)
{
    if (hrpsys == NULL || (names == NULL && n > 0) || ids == NULL) {
        return GROBO_ERR_ARG;
    }
    const grobo_model *model = model_of(hrpsys);
    for (size_t i = 0; i < n; i++) {
        if (grobo_model_find_joint(model, names[i], strlen(names[i])) < 0) {
            return GROBO_ERR_NOTFOUND;
        }
    }
    for (size_t i = 0; i < n; i++) {
        ids[i] = grobo_model_find_joint(model, names[i], strlen(names[i]));
    }
    return (int)n;
}

int grobo_hrpsys_names_to_motors(const grobo_hrpsys *hrpsys, const char *const *names, size_t n,
                                 int *motors)
{
    if (hrpsys == NULL || motors == NULL) {
        return GROBO_ERR_ARG;
    }
    int result = grobo_hrpsys_names_to_ids(hrpsys, names, n, motors);
    for (int i = 0; i < result; i++) {
        motors[i] = grobo_model_motor_of_joint(model_of(hrpsys), motors[i]);
    }
    return result;
}

/* ---- servo ---------------------------------------------------------------------------------- */

static int switch_joints(grobo_hrpsys *hrpsys, grobo_joint_mask joints, bool on)
{
    grobo_torque mode = on ? GROBO_TORQUE_ON : GROBO_TORQUE_OFF;
    int number = grobo_robot_torque(hrpsys->robot, joints, mode);
    if (number > 0) {
        hrpsys->command.set &= ~joints;
    }
    return number;
}

int grobo_hrpsys_servo(grobo_hrpsys *hrpsys, int joint, bool on)
{
    if (hrpsys == NULL || joint < 0 || joint >= model_of(hrpsys)->n_joints) {
        return GROBO_ERR_ARG;
    }
    return switch_joints(hrpsys, GROBO_JOINT_BIT(joint), on);
}

int grobo_hrpsys_servo_name(grobo_hrpsys *hrpsys, const char *name, bool on)
{
    grobo_joint_mask joints = 0;
    int found = grobo_hrpsys_find(hrpsys, name, &joints);
    return found < 0 ? found : switch_joints(hrpsys, joints, on);
}

/* ---- angles --------------------------------------------------------------------------------- */

int grobo_hrpsys_read_joint_angles(const grobo_hrpsys *hrpsys, int64_t max_age_us,
                                   double *angle_rad, size_t capacity)
{
    if (hrpsys == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_posture posture;
    int known = grobo_robot_posture(hrpsys->robot, max_age_us, &posture);
    int written = grobo_posture_all_rad(&posture, angle_rad, capacity);
    return written < 0 ? written : known;
}

int grobo_hrpsys_write_joint_commands(grobo_hrpsys *hrpsys, const double *angle_rad, size_t n)
{
    if (hrpsys == NULL || angle_rad == NULL || n != hrpsys->command.n_joints) {
        return GROBO_ERR_ARG;
    }
    for (size_t j = 0; j < n; j++) {
        if (!isfinite(angle_rad[j])) {
            return GROBO_ERR_NAN;
        }
    }
    memcpy(hrpsys->command.angle_rad, angle_rad, n * sizeof angle_rad[0]);
    hrpsys->command.set = GROBO_JOINTS_ALL(n);
    return GROBO_OK;
}

int grobo_hrpsys_set_period_us(grobo_hrpsys *hrpsys, int64_t period_us)
{
    if (hrpsys == NULL || period_us < 1 || period_us > GROBO_PLAY_TIME_MAX_US) {
        return GROBO_ERR_ARG;
    }
    hrpsys->command.time_us = period_us;
    return GROBO_OK;
}

/* Joints that are known to hold. */
static grobo_joint_mask holding(const grobo_hrpsys *hrpsys)
{
    grobo_joint_mask joints = 0;
    for (int j = 0; j < hrpsys->command.n_joints; j++) {
        grobo_joint_info info;
        (void)grobo_robot_joint(hrpsys->robot, j, &info);
        if (info.torque_known && info.state.torque == GROBO_TORQUE_ON) {
            joints |= GROBO_JOINT_BIT(j);
        }
    }
    return joints;
}

int grobo_hrpsys_one_step(grobo_hrpsys *hrpsys)
{
    if (hrpsys == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_posture target = hrpsys->command;
    grobo_trip_info trip;
    if (target.set == 0) {
        return GROBO_ERR_EMPTY;
    }
    grobo_robot_tripped(hrpsys->robot, &trip);
    if (trip.latched) { /* the better reason, where it took the torque too */
        return GROBO_ERR_LATCHED;
    }
    target.set &= holding(hrpsys);
    return target.set == 0 ? GROBO_ERR_STATE : grobo_robot_send(hrpsys->robot, &target);
}

/* ---- emergency ------------------------------------------------------------------------------ */

/* A text being put together in a bounded buffer; what does not fit is counted all the same. */
typedef struct writing {
    char text[GROBO_HRPSYS_REASON_MAX_BYTES];
    size_t used;
} writing;

static void put(writing *w, const char *text, size_t most)
{
    for (; *text != '\0' && most > 0 && w->used + 1 < sizeof w->text; most--) {
        w->text[w->used++] = *text++;
    }
}

static void put_number(writing *w, double value)
{
    char digits[12];
    size_t at = sizeof digits - 1;
    long rest = lround(fmin(fabs(value), 1e9));
    digits[at] = '\0';
    do {
        digits[--at] = (char)('0' + rest % 10);
        rest /= 10;
    } while (rest > 0);
    put(w, value < 0 ? "-" : "", 1);
    put(w, &digits[at], sizeof digits);
}

/* What stands before and behind the value of a trip; NULL where it has none. */
typedef struct telling {
    const char *before, *behind;
} telling;

static const telling tellings[] = {
    [GROBO_TRIP_TEMPERATURE] = {" at ", " deg C"},   [GROBO_TRIP_OVERHEATED] = {" at ", " deg C"},
    [GROBO_TRIP_CURRENT] = {" at ", " mA"},          [GROBO_TRIP_VOLTAGE] = {" at ", " mV"},
    [GROBO_TRIP_LOST_REPLIES] = {", ", " in a row"}, [GROBO_TRIP_ESTOP] = {NULL, NULL},
};

int grobo_hrpsys_check_emergency(const grobo_hrpsys *hrpsys, char *reason, size_t reason_bytes,
                                 int *joint)
{
    if (hrpsys == NULL || reason == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_trip_info trip;
    writing w = {.used = 0};
    grobo_robot_tripped(hrpsys->robot, &trip);
    if (trip.trip == GROBO_TRIP_NONE) {
        return 0;
    }
    put(&w, grobo_trip_name(trip.trip), sizeof w.text);
    if (trip.joint >= 0) {
        put(&w, ": ", 2);
        put(&w, grobo_i_joint(model_of(hrpsys), trip.joint)->name, GROBO_NAME_MAX_BYTES);
    }
    const telling *how = &tellings[trip.trip];
    if (how->before != NULL && trip.value != 0) { /* an overheated servo may not say how hot */
        put(&w, how->before, sizeof w.text);
        put_number(&w, trip.value);
        put(&w, how->behind, sizeof w.text);
    }
    if (w.used >= reason_bytes) {
        return GROBO_ERR_SPACE;
    }
    memcpy(reason, w.text, w.used);
    reason[w.used] = '\0';
    if (joint != NULL) {
        *joint = trip.joint;
    }
    return 1;
}
