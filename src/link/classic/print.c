/* SPDX-License-Identifier: MIT */
/* GR001 for people, into a stream that the caller gives. */
#include <string.h>

#include <grobo/gr001.h>

#include "src/link/classic/gr001.h"

enum { LINE_BYTES = 128 };

static int put(FILE *stream, const char *text)
{
    return fputs(text, stream) < 0 ? GROBO_ERR_IO : GROBO_OK;
}

/* A line a motor: number, name, value in `unit`, divided by 10 to the power of `decimals`. */
static int print_values(const grobo_model *model, const int32_t *value, int decimals,
                        const char *unit, FILE *stream)
{
    uint8_t joints[GROBO_JOINTS_MAX];
    int n = grobo_i_gr001_order(model, joints);
    int result = GROBO_OK;
    double scale = decimals == 0 ? 1 : 1000;
    for (int i = 0; i < n && result >= 0; i++) {
        char line[LINE_BYTES];
        const grobo_joint *joint = &model->joints[joints[i]];
        if (value[i] < 0) {
            continue;
        }
        (void)snprintf(line, sizeof line, "%2d %-12s %6.*f %s\n", joint->motor, joint->name,
                       decimals, value[i] / scale, unit);
        result = put(stream, line);
    }
    return result;
}

int grobo_gr001_print_voltages(const grobo_robot *robot, FILE *stream)
{
    if (robot == NULL || stream == NULL) {
        return GROBO_ERR_ARG;
    }
    int32_t voltage_mv[GROBO_JOINTS_MAX];
    char line[LINE_BYTES] = "mean -\n";
    (void)grobo_gr001_voltages(robot, GROBO_NEVER_US, voltage_mv, GROBO_JOINTS_MAX);
    int result = print_values(grobo_robot_driver(robot)->model, voltage_mv, 2, "V", stream);
    int mean_mv = grobo_gr001_mean_voltage_mv(robot, GROBO_NEVER_US);
    if (mean_mv >= 0) {
        (void)snprintf(line, sizeof line, "mean            %6.2f V\n", mean_mv / 1000.0);
    }
    return result < 0 ? result : put(stream, line);
}

int grobo_gr001_print_currents(const grobo_robot *robot, FILE *stream)
{
    if (robot == NULL || stream == NULL) {
        return GROBO_ERR_ARG;
    }
    int32_t current_ma[GROBO_JOINTS_MAX];
    (void)grobo_gr001_currents(robot, GROBO_NEVER_US, current_ma, GROBO_JOINTS_MAX);
    return print_values(grobo_robot_driver(robot)->model, current_ma, 0, "mA", stream);
}

/* ---- the body -------------------------------------------------------------------------------- */

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

/* An angle in eight columns; empty where there is no joint. */
static void cell(const grobo_posture *posture, int joint, char *text, size_t bytes)
{
    if (joint == NONE) {
        (void)snprintf(text, bytes, "%8s", "");
    } else if ((posture->set & GROBO_JOINT_BIT(joint)) == 0) {
        (void)snprintf(text, bytes, "%8s", "-");
    } else {
        /* By way of the wire's unit, which knows no -0.0. */
        (void)snprintf(text, bytes, "%8.1f", grobo_ddeg_from_rad(posture->angle_rad[joint]) / 10.0);
    }
}

int grobo_gr001_print_posture(const grobo_posture *posture, FILE *stream)
{
    if (stream == NULL || posture == NULL || posture->n_joints != grobo_gr001_model.n_joints) {
        return GROBO_ERR_ARG;
    }
    int result = put(stream, "                   right  middle    left\n");
    for (size_t i = 0; i < sizeof body / sizeof body[0] && result >= 0; i++) {
        char line[LINE_BYTES];
        char text[3][16];
        cell(posture, body[i].right, text[0], sizeof text[0]);
        cell(posture, body[i].middle, text[1], sizeof text[1]);
        cell(posture, body[i].left, text[2], sizeof text[2]);
        int length =
            snprintf(line, sizeof line, "%-16s%s%s%s", body[i].part, text[0], text[1], text[2]);
        while (length > 0 && line[length - 1] == ' ') {
            length--;
        }
        memcpy(line + length, "\n", 2);
        result = put(stream, line);
    }
    return result;
}
