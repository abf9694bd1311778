/* SPDX-License-Identifier: MIT */
/* What was measured of motors, in their order, and postures: for people, into a stream. */
#include <math.h>

#include "src/classic/view.h"

static const grobo_model *model_of(const grobo_robot *robot)
{
    return grobo_robot_driver(robot)->model;
}

/* Joints in the order of their motors; joints: room for GROBO_JOINTS_MAX. How many. */
static int order(const grobo_model *model, uint8_t *joints)
{
    for (int n = 0; n < model->n_joints; n++) {
        int at = n;
        for (; at > 0 &&
               grobo_model_joint(model, joints[at - 1])->motor > grobo_model_joint(model, n)->motor;
             at--) {
            joints[at] = joints[at - 1];
        }
        joints[at] = (uint8_t)n;
    }
    return model->n_joints;
}

/* Values of one field in motor order. */
static int values(const grobo_robot *robot, grobo_field field, int32_t *value)
{
    uint8_t joints[GROBO_JOINTS_MAX];
    int n = order(model_of(robot), joints), known = 0;

    for (int i = 0; i < n; i++) {
        grobo_joint_info info;
        (void)grobo_robot_joint(robot, joints[i], &info);
        bool read = (info.state.valid & field) != 0 && info.full_age_us != GROBO_NEVER_US;
        int32_t measured =
            field == GROBO_FIELD_VOLTAGE ? info.state.voltage_mv : info.state.current_ma;
        value[i] = read ? measured : -1;
        known += read;
    }
    return known;
}

int grobo_classic_voltages(const grobo_robot *robot, int32_t voltage_mv[GROBO_JOINTS_MAX])
{
    return values(robot, GROBO_FIELD_VOLTAGE, voltage_mv);
}

int grobo_classic_currents(const grobo_robot *robot, int32_t current_ma[GROBO_JOINTS_MAX])
{
    return values(robot, GROBO_FIELD_CURRENT, current_ma);
}

int grobo_classic_mean_mv(const grobo_robot *robot)
{
    int32_t voltage_mv[GROBO_JOINTS_MAX];
    int n = grobo_classic_voltages(robot, voltage_mv);
    double sum_mv = 0;

    for (int i = 0; i < model_of(robot)->n_joints; i++) {
        sum_mv += voltage_mv[i] < 0 ? 0 : voltage_mv[i];
    }
    return n == 0 ? GROBO_ERR_STALE : (int)lround(sum_mv / n);
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
        const grobo_joint *joint = grobo_model_joint(model, joints[i]);
        if (value[i] >= 0 && fprintf(stream, "%2d %-12s %6.*f %s\n", joint->motor, joint->name,
                                     decimals, value[i] / scale, unit) < 0) {
            return GROBO_ERR_IO;
        }
    }
    return GROBO_OK;
}

int grobo_classic_print_voltages(const grobo_robot *robot, FILE *stream)
{
    int32_t voltage_mv[GROBO_JOINTS_MAX];
    (void)grobo_classic_voltages(robot, voltage_mv);
    int result = print_values(model_of(robot), voltage_mv, 2, "V", stream);
    int mean_mv = grobo_classic_mean_mv(robot);
    if (result < 0) {
        return result;
    }
    int written = mean_mv < 0 ? fprintf(stream, "mean -\n")
                              : fprintf(stream, "mean            %6.2f V\n", mean_mv / 1000.0);
    return written < 0 ? GROBO_ERR_IO : GROBO_OK;
}

int grobo_classic_print_currents(const grobo_robot *robot, FILE *stream)
{
    int32_t current_ma[GROBO_JOINTS_MAX];
    (void)grobo_classic_currents(robot, current_ma);
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

int grobo_classic_print_posture(const grobo_posture *posture, FILE *stream)
{
    if (posture->n_joints != grobo_gr001_model()->n_joints) {
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
