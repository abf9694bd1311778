/* SPDX-License-Identifier: MIT */
/* Joints by name, groups of a program's own, and emergencies in words, on the engine. */
#include <math.h>
#include <string.h>

#include "src/classic/view.h"

static const grobo_model *model_of(const classic_view *view)
{
    return grobo_robot_driver(view->robot)->model;
}

void grobo_classic_view_init(classic_view *view, grobo_robot *robot)
{
    memset(view, 0, sizeof *view);
    view->robot = robot;
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

int grobo_classic_find(const classic_view *view, const char *name, grobo_joint_mask *joints)
{
    const grobo_model *model = model_of(view);
    if (name == NULL) {
        return GROBO_ERR_ARG;
    }
    if (is_same(name, "all")) { /* whether or not the model has a group of that name */
        *joints = GROBO_JOINTS_ALL(model->n_joints);
        return model->n_joints;
    }
    for (unsigned i = 0; i < view->n_groups; i++) {
        if (is_same(view->groups[i].name, name)) {
            *joints = view->groups[i].joints;
            return grobo_joints_count(*joints);
        }
    }
    if (is_number(name)) { /* the model would take it for a group's */
        return GROBO_ERR_NOTFOUND;
    }
    return grobo_model_find_joints(model, name, strlen(name), joints);
}

int grobo_classic_add_group(classic_view *view, const char *name, const char *const *joints,
                            size_t n)
{
    if (name == NULL || (joints == NULL && n > 0)) {
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
    if (grobo_classic_find(view, name, &found) >= 0) {
        return GROBO_ERR_EXISTS;
    }
    for (size_t i = 0; i < n; i++) {
        int result = grobo_classic_find(view, joints[i], &found);
        if (result < 0) {
            return result;
        }
        group |= found;
    }
    if (view->n_groups == VIEW_GROUPS) {
        return GROBO_ERR_FULL;
    }
    memcpy(view->groups[view->n_groups].name, name, length + 1);
    view->groups[view->n_groups].joints = group;
    view->n_groups++;
    return grobo_joints_count(group);
}

int grobo_classic_motors_of(const classic_view *view, const char *const *names, size_t n,
                            int *motors)
{
    int joints[GROBO_JOINTS_MAX];

    if ((names == NULL && n > 0) || motors == NULL || n > GROBO_JOINTS_MAX) {
        return GROBO_ERR_ARG;
    }
    for (size_t i = 0; i < n; i++) {
        joints[i] = names[i] == NULL
                        ? GROBO_ERR_ARG
                        : grobo_model_find_joint(model_of(view), names[i], strlen(names[i]));
        if (joints[i] < 0) {
            return GROBO_ERR_NOTFOUND;
        }
    }
    for (size_t i = 0; i < n; i++) {
        motors[i] = grobo_model_motor_of_joint(model_of(view), joints[i]);
    }
    return (int)n;
}

/* ---- servo ---------------------------------------------------------------------------------- */

int grobo_classic_servo_name(classic_view *view, const char *name, bool on)
{
    grobo_joint_mask joints = 0;
    int found = grobo_classic_find(view, name, &joints);

    return found < 0
               ? found
               : grobo_robot_torque(view->robot, joints, on ? GROBO_TORQUE_ON : GROBO_TORQUE_OFF);
}

int grobo_classic_read_angles(const classic_view *view, int64_t max_age_us, double *angle_rad,
                              size_t capacity)
{
    grobo_posture posture;
    int known = grobo_robot_posture(view->robot, max_age_us, &posture);
    int written = grobo_posture_all_rad(&posture, angle_rad, capacity);
    return written < 0 ? written : known;
}

/* ---- emergency ------------------------------------------------------------------------------ */

/* A text being put together in a bounded buffer; what does not fit is counted all the same. */
typedef struct writing {
    char text[VIEW_REASON_MAX_BYTES];
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

int grobo_classic_emergency(const classic_view *view, char *reason, size_t reason_bytes, int *joint)
{
    grobo_trip_info trip;
    writing w = {.used = 0};
    grobo_robot_tripped(view->robot, &trip);
    if (trip.trip == GROBO_TRIP_NONE) {
        return 0;
    }
    put(&w, grobo_trip_name(trip.trip), sizeof w.text);
    if (trip.joint >= 0) {
        put(&w, ": ", 2);
        put(&w, grobo_model_joint(model_of(view), trip.joint)->name, GROBO_NAME_MAX_BYTES);
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
