/* SPDX-License-Identifier: MIT */
/* Raw frames and registers. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include <grobo/core/robot.h>

#include "tests/support/restless.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { GOALS_MAX = 4 };

/* ---- raw frames ------------------------------------------------------------------------------ */

/* Hands a packet over as a raw frame of this wiring. */
static void send_raw(restless *u, const uint8_t *packet, int n, restless_effect effect)
{
    uint8_t frame[GROBO_FRAME_MAX_BYTES];
    assert_true(n > 0);
    if (grobo_driver_wiring(u->rig->driver) == GROBO_WIRING_BOARD) {
        n = grobo_board_relay(packet, (size_t)n, frame, sizeof frame);
        assert_true(n > 0);
        packet = frame;
    }
    int result = grobo_robot_raw(&u->rig->robot, packet, (size_t)n);
    judge_raw_asked(&u->judge, packet, (size_t)n, result);
    restless_told(u, GROBO_JOB_NONE, result, effect);
}

/* A goal whose time is mostly one that the joint can keep, by where it is now. */
static grobo_rs30x_goal random_goal(restless *u)
{
    int joint = (int)restless_pick(u, 20);
    const grobo_joint *limits = &u->rig->driver->model->joints[joint];
    double deg = fmin(fmax(restless_angle_deg(u, joint), -150), 150);
    double way_deg = fabs(deg - rig_angle_deg(u->rig, joint));
    double least_cs = 100 * way_deg / grobo_deg_from_rad(limits->max_speed_rad_s);
    double soft_cs = 100 * way_deg / 60;
    uint32_t how = restless_pick(u, 5);
    double cs = how == 0   ? restless_pick(u, 100)
                : how == 1 ? least_cs * (70 + restless_pick(u, 28)) / 100 /* a little too fast */
                : how == 2 ? least_cs + 1 + restless_pick(u, 10)
                           : soft_cs + 10 + restless_pick(u, 50);
    grobo_rs30x_goal goal = {
        .id = limits->motor, .pos_ddeg = (int16_t)lround(deg * 10), .time_cs = (uint16_t)cs};
    return goal;
}

/* One goal in a short packet that asks for an ACK. */
static int acked_goal(const grobo_rs30x_goal *goal, uint8_t *packet, size_t size)
{
    uint16_t ddeg = (uint16_t)goal->pos_ddeg;
    const uint8_t data[4] = {(uint8_t)ddeg, (uint8_t)(ddeg >> 8), (uint8_t)goal->time_cs,
                             (uint8_t)(goal->time_cs >> 8)};
    const grobo_rs30x_packet asked = {.kind = GROBO_RS30X_SHORT,
                                      .id = goal->id,
                                      .flags = GROBO_RS30X_WANT_ACK,
                                      .address = GROBO_RS30X_GOAL,
                                      .length = sizeof data,
                                      .count = 1,
                                      .data = data,
                                      .data_bytes = sizeof data};
    return grobo_rs30x_build(&asked, packet, size);
}

/* The last joints first. */
static int later_joint(const void *a, const void *b)
{
    const grobo_rs30x_goal *x = a;
    const grobo_rs30x_goal *y = b;
    return grobo_model_joint_of_motor(&grobo_i_gr001_model, y->id) -
           grobo_model_joint_of_motor(&grobo_i_gr001_model, x->id);
}

/* The engine asks for no ACK, puts one goal in a short packet, and goals in the order of joints: by
 * that the judge can tell raw frames from its own. */
void restless_raw_goal(restless *u)
{
    uint8_t packet[GROBO_FRAME_MAX_BYTES];
    grobo_rs30x_goal goals[GOALS_MAX];
    size_t n = 1 + restless_pick(u, GOALS_MAX);
    n = u->rig->robot.config.accept_unknown_raw ? 1 : n; /* two for one joint have no meaning */
    for (size_t i = 0; i < n; i++) {
        goals[i] = random_goal(u);
    }
    qsort(goals, n, sizeof goals[0], later_joint);
    int size = restless_pick(u, 3) == 0 ? acked_goal(goals, packet, sizeof packet)
                                        : grobo_rs30x_write_goals(goals, n, packet, sizeof packet);
    send_raw(u, packet, size, RESTLESS_MOVES);
}

/* With an ACK, or one joint twice: the engine makes no such frame. */
void restless_raw_torque(restless *u)
{
    uint8_t packet[GROBO_FRAME_MAX_BYTES];
    grobo_rs30x_byte bytes[GOALS_MAX];
    uint8_t value = (uint8_t)restless_pick(u, 3);
    for (size_t i = 0; i < GOALS_MAX - 1; i++) {
        bytes[i] =
            (grobo_rs30x_byte){u->rig->driver->model->joints[restless_pick(u, 20)].motor, value};
    }
    bytes[GOALS_MAX - 1] = bytes[0];
    int size =
        restless_pick(u, 2) == 0
            ? grobo_rs30x_write_u8(bytes[0].id, GROBO_RS30X_WANT_ACK, GROBO_RS30X_TORQUE, value,
                                   packet, sizeof packet)
            : grobo_rs30x_write_bytes(GROBO_RS30X_TORQUE, bytes, GOALS_MAX, packet, sizeof packet);
    send_raw(u, packet, size, RESTLESS_MOVES);
}

/* Questions, a harmless write, a restart in disguise, and bytes without a meaning. */
void restless_raw_other(restless *u)
{
    uint8_t packet[GROBO_FRAME_MAX_BYTES] = {0x50, 0x4D, 1};
    uint8_t id = u->rig->driver->model->joints[restless_pick(u, 20)].motor;
    int size = 0;
    switch (restless_pick(u, 6)) {
    case 0:
        size = grobo_rs30x_read(id, GROBO_RS30X_POSITION, 2, packet, sizeof packet);
        break;
    case 1:
        size = grobo_rs30x_read(id, GROBO_RS30X_GOAL, 24, packet, sizeof packet);
        break;
    case 2:
        size = grobo_rs30x_write_u8(id, GROBO_RS30X_WANT_ACK, GROBO_RS30X_CW_MARGIN, 3, packet,
                                    sizeof packet);
        break;
    case 3:
        size = grobo_rs30x_write_u8(id, GROBO_RS30X_REBOOT, GROBO_RS30X_CW_MARGIN, 2, packet,
                                    sizeof packet);
        break;
    default:
        for (int i = 3; i < 16; i++) {
            packet[i] = (uint8_t)restless_pick(u, 256);
        }
        /* A motion of the board's own, or rubbish where it is refused. */
        size = u->rig->robot.config.accept_unknown_raw || restless_pick(u, 2) == 0 ? 3 : 16;
        int result = grobo_robot_raw(&u->rig->robot, packet, (size_t)size);
        judge_raw_asked(&u->judge, packet, (size_t)size, result);
        restless_told(u, GROBO_JOB_NONE, result, RESTLESS_MOVES);
        return;
    }
    send_raw(u, packet, size, RESTLESS_NOTHING);
}

/* ---- registers ------------------------------------------------------------------------------- */

/* Registers that may be written, here with the values that they have, and those that may not. */
static const struct {
    uint8_t address, length, data[4];
} writes[] = {
    {GROBO_RS30X_CW_MARGIN, 1, {2}},
    {GROBO_RS30X_CCW_MARGIN, 1, {2}},
    {GROBO_RS30X_DELAY, 1, {0}},
    {GROBO_RS30X_REVERSE, 1, {0}},
    {GROBO_RS30X_CW_LIMIT, 4, {1500 & 0xFF, 1500 >> 8, -1500 & 0xFF, (-1500 >> 8) & 0xFF}},
    {GROBO_RS30X_GOAL, 4, {0, 0, 0, 0}},
    {GROBO_RS30X_GOAL_TIME, 2, {0, 0}},
    {GROBO_RS30X_TORQUE, 1, {GROBO_TORQUE_ON}},
};

void restless_registers(restless *u)
{
    uint8_t id = u->rig->driver->model->joints[restless_pick(u, 20)].motor;
    grobo_register_io io = {.id = id, .address = GROBO_RS30X_GOAL, .length = 24};
    if (restless_pick(u, 3) == 0) {
        io.address = (uint8_t)restless_pick(u, 54);
        io.length = (uint8_t)(1 + restless_pick(u, 24));
    } else if (restless_pick(u, 2) == 0) {
        size_t i = restless_pick(u, sizeof writes / sizeof writes[0]);
        io.address = writes[i].address;
        io.length = writes[i].length;
        io.data = writes[i].data;
    }
    int result = grobo_robot_registers(&u->rig->robot, &io);
    restless_told(u, GROBO_JOB_REGISTERS, result, RESTLESS_NOTHING);
}
