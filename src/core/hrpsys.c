/* SPDX-License-Identifier: MIT */
#include <grobo/hrpsys.h>

#include <string.h>

static const grobo_model *model_of(const grobo_hrpsys *hrpsys)
{
    return grobo_robot_driver(hrpsys->robot)->model;
}

void grobo_hrpsys_init(grobo_hrpsys *hrpsys, grobo_robot *robot)
{
    memset(hrpsys, 0, sizeof *hrpsys);
    hrpsys->robot = robot;
    (void)grobo_posture_init(&hrpsys->command, model_of(hrpsys)->n_joints);
}

static grobo_torque torque_of(bool on)
{
    return on ? GROBO_TORQUE_ON : GROBO_TORQUE_OFF;
}

int grobo_hrpsys_servo(grobo_hrpsys *hrpsys, int joint, bool on, int64_t now_us)
{
    if (joint < 0 || joint >= model_of(hrpsys)->n_joints) {
        return GROBO_ERR_ARG;
    }
    return grobo_robot_torque(hrpsys->robot, GROBO_JOINT_BIT(joint), torque_of(on), now_us);
}

static bool same_text(const char *a, const char *b)
{
    while (*a != '\0' && *a == *b) {
        a++;
        b++;
    }
    return *a == *b;
}

/* Joints of an added group, a group of the model or a joint. */
static int find_joints(const grobo_hrpsys *hrpsys, const char *name, grobo_joint_mask *joints)
{
    for (unsigned i = 0; i < hrpsys->n_groups; i++) {
        if (same_text(hrpsys->groups[i].name, name)) {
            *joints = hrpsys->groups[i].joints;
            return GROBO_OK;
        }
    }
    return grobo_model_find_joints(model_of(hrpsys), name, strlen(name), joints);
}

int grobo_hrpsys_servo_name(grobo_hrpsys *hrpsys, const char *name, bool on, int64_t now_us)
{
    grobo_joint_mask joints = 0;
    int found = find_joints(hrpsys, name, &joints);
    return found < 0 ? found : grobo_robot_torque(hrpsys->robot, joints, torque_of(on), now_us);
}

int grobo_hrpsys_read_joint_angles(const grobo_hrpsys *hrpsys, double *angle_rad, size_t capacity,
                                   int64_t now_us)
{
    grobo_posture posture;
    int known = grobo_robot_posture(hrpsys->robot, now_us, GROBO_NEVER_US, &posture);
    int written = grobo_posture_all_rad(&posture, angle_rad, capacity);
    return written < 0 ? written : known;
}

int grobo_hrpsys_write_joint_commands(grobo_hrpsys *hrpsys, const double *angle_rad, size_t n)
{
    grobo_posture command = hrpsys->command;
    if (n != command.n_joints) {
        return GROBO_ERR_ARG;
    }
    memcpy(command.angle_rad, angle_rad, n * sizeof angle_rad[0]);
    command.set = GROBO_JOINTS_ALL(n);
    int result = grobo_posture_check(&command, model_of(hrpsys), NULL);
    if (result >= 0) {
        hrpsys->command = command;
    }
    return result;
}

int grobo_hrpsys_set_period_us(grobo_hrpsys *hrpsys, int64_t period_us)
{
    if (period_us < 1 || period_us > GROBO_PLAY_TIME_MAX_US) {
        return GROBO_ERR_ARG;
    }
    hrpsys->command.time_us = period_us;
    return GROBO_OK;
}

int grobo_hrpsys_one_step(grobo_hrpsys *hrpsys, int64_t now_us)
{
    if (hrpsys->command.set == 0) {
        return GROBO_ERR_EMPTY;
    }
    return grobo_robot_send(hrpsys->robot, &hrpsys->command, now_us);
}

int grobo_hrpsys_check_emergency(const grobo_hrpsys *hrpsys, grobo_trip_info *reason)
{
    grobo_trip_info info;
    grobo_robot_tripped(hrpsys->robot, &info);
    if (info.trip == GROBO_TRIP_NONE) {
        return 0;
    }
    if (reason != NULL) {
        *reason = info;
    }
    return 1;
}

int grobo_hrpsys_add_joint_group(grobo_hrpsys *hrpsys, const char *name, const char *const *joints,
                                 size_t n)
{
    grobo_joint_mask taken = 0;
    grobo_joint_mask group = 0;
    size_t length = strlen(name);
    if (length == 0 || n == 0) {
        return GROBO_ERR_ARG;
    }
    if (length >= GROBO_NAME_MAX_BYTES) {
        return GROBO_ERR_CAP;
    }
    if (find_joints(hrpsys, name, &taken) >= 0) {
        return GROBO_ERR_EXISTS;
    }
    for (size_t i = 0; i < n; i++) {
        int joint = grobo_model_find_joint(model_of(hrpsys), joints[i], strlen(joints[i]));
        if (joint < 0) {
            return joint;
        }
        group |= GROBO_JOINT_BIT(joint);
    }
    if (hrpsys->n_groups == GROBO_HRPSYS_GROUPS) {
        return GROBO_ERR_FULL;
    }
    memcpy(hrpsys->groups[hrpsys->n_groups].name, name, length + 1);
    hrpsys->groups[hrpsys->n_groups].joints = group;
    hrpsys->n_groups++;
    return GROBO_OK;
}

int grobo_hrpsys_names_to_ids(const grobo_hrpsys *hrpsys, const char *const *names, size_t n,
                              int *ids)
{
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
