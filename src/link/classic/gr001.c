/* SPDX-License-Identifier: MIT */
/* GR001 by motor number and in motor order, on the engine; and for people, into a stream. */
#include <math.h>

#include <grobo/core/gr001.h>

#include "src/model/joint.h"
#include "src/motion/store/container.h"
#include "src/robots/robots.h"

static const grobo_model *model_of(const grobo_robot *robot)
{
    return grobo_robot_driver(robot)->model;
}

/* Joints in the order of their motors; joints: room for GROBO_JOINTS_MAX. How many. */
static int order(const grobo_model *model, uint8_t *joints)
{
    for (int n = 0; n < model->n_joints; n++) {
        int at = n;
        for (;
             at > 0 && grobo_i_joint(model, joints[at - 1])->motor > grobo_i_joint(model, n)->motor;
             at--) {
            joints[at] = joints[at - 1];
        }
        joints[at] = (uint8_t)n;
    }
    return model->n_joints;
}

/* The joint of a motor, or an error. */
static int joint_of(const grobo_robot *robot, int motor)
{
    return robot == NULL ? GROBO_ERR_ARG : grobo_model_joint_of_motor(model_of(robot), motor);
}

/* ---- one motor, a group of motors ------------------------------------------------------------ */

int grobo_gr001_torque(grobo_robot *robot, int motor, grobo_torque mode)
{
    int joint = joint_of(robot, motor);
    return joint < 0 ? joint : grobo_robot_torque(robot, GROBO_JOINT_BIT(joint), mode);
}

int grobo_gr001_servo(grobo_robot *robot, grobo_gr001_group group, grobo_torque mode)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    const grobo_model *model = model_of(robot);
    if ((unsigned)group >= model->n_groups) {
        return GROBO_ERR_NOTFOUND;
    }
    return grobo_robot_torque(robot, model->groups[group].joints, mode);
}

static bool is_time(int time_cs)
{
    return time_cs >= 0 && time_cs <= GROBO_PLAY_TIME_MAX_US / GROBO_PLAY_TIME_UNIT_US;
}

int grobo_gr001_move(grobo_robot *robot, int motor, int angle_ddeg, int time_cs)
{
    grobo_posture target;
    int joint = joint_of(robot, motor);
    if (joint < 0) {
        return joint;
    }
    if (!is_time(time_cs)) {
        return GROBO_ERR_ARG;
    }
    (void)grobo_posture_init(&target, model_of(robot)->n_joints);
    (void)grobo_posture_set_rad(&target, joint, grobo_rad_from_ddeg(angle_ddeg));
    /* One unit, which the engine stretches to what the joint can do. */
    target.time_us = (time_cs == 0 ? 1 : time_cs) * (int64_t)GROBO_PLAY_TIME_UNIT_US;
    return grobo_robot_move(robot, &target);
}

int grobo_gr001_sense(grobo_robot *robot, int motor)
{
    int joint = joint_of(robot, motor);
    return joint < 0 ? joint : grobo_robot_sense(robot, GROBO_JOINT_BIT(joint), GROBO_SENSE_FULL);
}

int grobo_gr001_angle(const grobo_robot *robot, int motor, int64_t max_age_us, int *angle_ddeg)
{
    grobo_joint_info info;
    int joint = angle_ddeg == NULL ? GROBO_ERR_ARG : joint_of(robot, motor);
    if (joint < 0) {
        return joint;
    }
    (void)grobo_robot_joint(robot, joint, &info);
    if (info.angle_age_us == GROBO_NEVER_US || info.angle_age_us > max_age_us) {
        return GROBO_ERR_STALE;
    }
    *angle_ddeg = grobo_ddeg_from_rad(info.state.angle_rad);
    return GROBO_OK;
}

int grobo_gr001_pack_goal(int angle_ddeg, int time_cs, uint8_t *data, size_t cap)
{
    if (data == NULL) {
        return GROBO_ERR_ARG;
    }
    if (angle_ddeg < -1500 || angle_ddeg > 1500 || !is_time(time_cs)) {
        return GROBO_ERR_LIMIT;
    }
    if (cap < 4) {
        return GROBO_ERR_SPACE;
    }
    unsigned angle = (uint16_t)angle_ddeg;
    data[0] = (uint8_t)(angle & 0xFF);
    data[1] = (uint8_t)(angle >> 8);
    data[2] = (uint8_t)(time_cs & 0xFF);
    data[3] = (uint8_t)(time_cs >> 8);
    return 4;
}

/* ---- all motors ------------------------------------------------------------------------------ */

int grobo_gr001_posture(const grobo_model *model, const int16_t *angle_ddeg, size_t n, int time_cs,
                        grobo_posture *posture)
{
    if (model == NULL || (angle_ddeg == NULL && n > 0) || posture == NULL) {
        return GROBO_ERR_ARG;
    }
    uint8_t joints[GROBO_JOINTS_MAX];
    if (n > (size_t)order(model, joints)) {
        return GROBO_ERR_CAP;
    }
    if (!is_time(time_cs)) {
        return GROBO_ERR_ARG;
    }
    (void)grobo_posture_init(posture, model->n_joints);
    for (size_t i = 0; i < n; i++) {
        (void)grobo_posture_set_rad(posture, joints[i], grobo_rad_from_ddeg(angle_ddeg[i]));
    }
    posture->time_us = time_cs * (int64_t)GROBO_PLAY_TIME_UNIT_US;
    return (int)n;
}

int grobo_gr001_set_angles(grobo_robot *robot, const double *angle_rad, size_t n, int64_t time_us)
{
    if (robot == NULL || angle_rad == NULL) {
        return GROBO_ERR_ARG;
    }
    uint8_t joints[GROBO_JOINTS_MAX];
    grobo_posture target;
    const grobo_model *model = model_of(robot);
    if (n != (size_t)order(model, joints)) {
        return GROBO_ERR_ARG;
    }
    (void)grobo_posture_init(&target, model->n_joints);
    for (size_t i = 0; i < n; i++) {
        target.angle_rad[joints[i]] = angle_rad[i]; /* what is no number, the engine refuses */
    }
    target.set = GROBO_JOINTS_ALL(model->n_joints);
    target.time_us = time_us;
    return grobo_robot_move(robot, &target);
}

int grobo_gr001_get_angles(const grobo_robot *robot, int64_t max_age_us, double *angle_rad,
                           size_t capacity)
{
    if (robot == NULL || angle_rad == NULL) {
        return GROBO_ERR_ARG;
    }
    uint8_t joints[GROBO_JOINTS_MAX];
    double by_joint[GROBO_JOINTS_MAX];
    grobo_posture sensed;
    int n = order(model_of(robot), joints);
    if (capacity < (size_t)n) {
        return GROBO_ERR_SPACE;
    }
    int fresh = grobo_robot_posture(robot, max_age_us, &sensed);
    (void)grobo_posture_all_rad(&sensed, by_joint, GROBO_JOINTS_MAX);
    for (int i = 0; i < n; i++) {
        angle_rad[i] = by_joint[joints[i]];
    }
    return fresh;
}

/* Values of one field in motor order. */
static int values(const grobo_robot *robot, grobo_field field, int64_t max_age_us, int32_t *value,
                  size_t capacity)
{
    uint8_t joints[GROBO_JOINTS_MAX];
    int known = 0;
    if (robot == NULL || value == NULL) {
        return GROBO_ERR_ARG;
    }
    int n = order(model_of(robot), joints);
    if (capacity < (size_t)n) {
        return GROBO_ERR_SPACE;
    }
    for (int i = 0; i < n; i++) {
        grobo_joint_info info;
        (void)grobo_robot_joint(robot, joints[i], &info);
        bool fresh = (info.state.valid & field) != 0 && info.full_age_us != GROBO_NEVER_US &&
                     info.full_age_us <= max_age_us;
        int32_t measured =
            field == GROBO_FIELD_VOLTAGE ? info.state.voltage_mv : info.state.current_ma;
        value[i] = fresh ? measured : -1;
        known += fresh;
    }
    return known;
}

int grobo_gr001_voltages(const grobo_robot *robot, int64_t max_age_us, int32_t *voltage_mv,
                         size_t capacity)
{
    return values(robot, GROBO_FIELD_VOLTAGE, max_age_us, voltage_mv, capacity);
}

int grobo_gr001_currents(const grobo_robot *robot, int64_t max_age_us, int32_t *current_ma,
                         size_t capacity)
{
    return values(robot, GROBO_FIELD_CURRENT, max_age_us, current_ma, capacity);
}

int grobo_gr001_mean_voltage_mv(const grobo_robot *robot, int64_t max_age_us)
{
    int32_t voltage_mv[GROBO_JOINTS_MAX];
    int n = values(robot, GROBO_FIELD_VOLTAGE, max_age_us, voltage_mv, GROBO_JOINTS_MAX);
    double sum_mv = 0;
    if (n <= 0) {
        return n < 0 ? n : GROBO_ERR_STALE;
    }
    for (int i = 0; i < model_of(robot)->n_joints; i++) {
        sum_mv += voltage_mv[i] < 0 ? 0 : voltage_mv[i];
    }
    return (int)lround(sum_mv / n);
}

/* ---- the record ------------------------------------------------------------------------------ */

int grobo_gr001_record(grobo_motion *record, const grobo_robot *robot, int64_t time_us)
{
    if (record == NULL || robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_posture sensed;
    int fresh = grobo_robot_posture(robot, GROBO_GR001_RECORD_AGE_US, &sensed);
    if (fresh < sensed.n_joints) {
        return GROBO_ERR_STALE;
    }
    sensed.time_us = time_us;
    int result = grobo_i_record(record, &sensed);
    return result < 0 ? result : (int)grobo_motion_size(record);
}

int grobo_gr001_play_record(const grobo_motion *record, grobo_robot *robot,
                            const grobo_play_options *options, grobo_clip *clip)
{
    if (record == NULL || clip == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_clip made;
    int result = grobo_motion_clip(record, NULL, &made);
    if (result < 0) {
        return result;
    }
    int number = grobo_robot_play(robot, &made, options);
    if (number < 0) {
        grobo_motion_clip_free(&made);
        return number;
    }
    *clip = made;
    return number;
}

/* ---- for people ------------------------------------------------------------------------------ */

/* A line a motor: number, name, value in `unit`, divided by 10 to the power of `decimals`. */
static int print_values(const grobo_model *model, const int32_t *value, int decimals,
                        const char *unit, FILE *stream)
{
    uint8_t joints[GROBO_JOINTS_MAX];
    int n = order(model, joints);
    double scale = decimals == 0 ? 1 : 1000;
    for (int i = 0; i < n; i++) {
        const grobo_joint *joint = grobo_i_joint(model, joints[i]);
        if (value[i] >= 0 && fprintf(stream, "%2d %-12s %6.*f %s\n", joint->motor, joint->name,
                                     decimals, value[i] / scale, unit) < 0) {
            return GROBO_ERR_IO;
        }
    }
    return GROBO_OK;
}

int grobo_gr001_print_voltages(const grobo_robot *robot, FILE *stream)
{
    if (robot == NULL || stream == NULL) {
        return GROBO_ERR_ARG;
    }
    int32_t voltage_mv[GROBO_JOINTS_MAX];
    (void)grobo_gr001_voltages(robot, GROBO_NEVER_US, voltage_mv, GROBO_JOINTS_MAX);
    int result = print_values(model_of(robot), voltage_mv, 2, "V", stream);
    int mean_mv = grobo_gr001_mean_voltage_mv(robot, GROBO_NEVER_US);
    if (result < 0) {
        return result;
    }
    int written = mean_mv < 0 ? fprintf(stream, "mean -\n")
                              : fprintf(stream, "mean            %6.2f V\n", mean_mv / 1000.0);
    return written < 0 ? GROBO_ERR_IO : GROBO_OK;
}

int grobo_gr001_print_currents(const grobo_robot *robot, FILE *stream)
{
    if (robot == NULL || stream == NULL) {
        return GROBO_ERR_ARG;
    }
    int32_t current_ma[GROBO_JOINTS_MAX];
    (void)grobo_gr001_currents(robot, GROBO_NEVER_US, current_ma, GROBO_JOINTS_MAX);
    return print_values(model_of(robot), current_ma, 0, "mA", stream);
}

enum { NONE = -1 };

/* One line of the body, as seen from the front: joints of its right, its middle, its left. */
typedef struct body_row {
    const char *part;
    int8_t right, middle, left;
} body_row;

static const body_row body[] = {
    {"neck yaw", NONE, 13, NONE},    {"shoulder pitch", 14, NONE, 17},
    {"shoulder roll", 15, NONE, 18}, {"elbow pitch", 16, NONE, 19},
    {"chest pitch", NONE, 12, NONE}, {"hip yaw", 0, NONE, 6},
    {"hip roll", 1, NONE, 7},        {"hip pitch", 2, NONE, 8},
    {"knee pitch", 3, NONE, 9},      {"ankle pitch", 4, NONE, 10},
    {"ankle roll", 5, NONE, 11},
};

/* An angle; empty where there is no joint. */
static const char *cell(const grobo_posture *posture, int joint, char text[16])
{
    if (joint == NONE) {
        return "";
    }
    if ((posture->set & GROBO_JOINT_BIT(joint)) == 0) {
        return "-";
    }
    /* By way of the wire's unit, which knows no -0.0. */
    (void)snprintf(text, 16, "%.1f", grobo_ddeg_from_rad(posture->angle_rad[joint]) / 10.0);
    return text;
}

int grobo_gr001_print_posture(const grobo_posture *posture, FILE *stream)
{
    if (stream == NULL || posture == NULL || posture->n_joints != grobo_i_gr001_model.n_joints) {
        return GROBO_ERR_ARG;
    }
    int written = fprintf(stream, "                   right  middle    left\n");
    for (size_t i = 0; i < sizeof body / sizeof body[0] && written >= 0; i++) {
        char text[3][16];
        const char *left = cell(posture, body[i].left, text[2]);
        written =
            fprintf(stream, "%-16s%8s%8s%*s\n", body[i].part, cell(posture, body[i].right, text[0]),
                    cell(posture, body[i].middle, text[1]), *left != '\0' ? 8 : 0, left);
    }
    return written < 0 ? GROBO_ERR_IO : GROBO_OK;
}
