/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "tests/support/axes_kit.h"
#include "tests/support/many_joints.h"
#include "tests/support/rig.h"
#include "tests/support/test.h"

grobo_robot robot;
grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
grobo_robot_axis before[GROBO_JOINTS_MAX];
int inspected;

static grobo_driver plain = GROBO_TABLE_INIT(grobo_driver);
static int driver_ctx;

/* ---- the driver's functions, called with the context that the robot was given ---------------- */

static int posture_in_context(const grobo_driver *self, void *ctx, const grobo_target *target,
                              int part, grobo_exchange *exchange)
{
    assert_ptr_equal(ctx, &driver_ctx);
    return plain.posture(self, NULL, target, part, exchange);
}

static int torque_in_context(const grobo_driver *self, void *ctx, grobo_joint_mask joints,
                             grobo_torque mode, int part, grobo_exchange *exchange)
{
    assert_ptr_equal(ctx, &driver_ctx);
    return plain.torque(self, NULL, joints, mode, part, exchange);
}

static int inspect_in_context(const grobo_driver *self, void *ctx, const uint8_t *frame,
                              size_t size, grobo_target *target, grobo_joint_mask *torqued)
{
    assert_ptr_equal(ctx, &driver_ctx);
    int result = plain.inspect(self, NULL, frame, size, target, torqued);
    return inspected < 0 ? inspected : result;
}

/* ---- a robot in a known state ---------------------------------------------------------------- */

void make_robot(int n, const grobo_robot_config *config)
{
    plain = *many_unlike_joints(rig_wiring, n);
    driver = plain;
    driver.posture = posture_in_context;
    driver.torque = torque_in_context;
    driver.inspect = inspect_in_context;
    inspected = GROBO_OK;
    assert_int_equal(grobo_robot_init(&robot, &driver, &driver_ctx, config, NOW), GROBO_OK);
    grobo_robot_link_up(&robot, NOW);
}

void start_with(const grobo_robot_config *config)
{
    make_robot(N, config);
    robot.soft = false;
    robot.played_joints = GROBO_JOINTS_ALL(N);
    for (int j = 0; j < N; j++) {
        grobo_robot_axis *axis = &robot.axes[j];
        axis->state = (grobo_joint_state){.angle_rad = here_rad(j),
                                          .goal_rad = here_rad(j),
                                          .valid = 0xFF,
                                          .torque = GROBO_TORQUE_ON};
        axis->trajectory = (grobo_robot_trajectory){here_rad(j), here_rad(j), NOW - 20, NOW - 10};
        axis->angle_us = axis->full_us = axis->goal_us = axis->torque_us = NOW - 5;
        axis->own_until_us = NOW - 3;
        axis->told_us = axis->told_to_us = axis->seen_us = NOW - 7;
        axis->seen_rad = here_rad(j);
        axis->last = 3;
        axis->phase = GROBO_I_JOINT_SENT;
        axis->torque_known = axis->wants_torque = true;
    }
    for (int j = N; j < GROBO_JOINTS_MAX; j++) { /* of no joint: who looks there finds one moving */
        robot.axes[j] = (grobo_robot_axis){.trajectory = {0, 1, NOW - S, NOW + 9 * S},
                                           .told_to_us = NOW,
                                           .next = 1,
                                           .phase = j % 2 == 0 ? GROBO_I_JOINT_EXTERNAL
                                                               : GROBO_I_JOINT_IN_SEGMENTS};
    }
    keep_axes();
}

void start(void)
{
    start_with(NULL);
}

double here_rad(int joint)
{
    return RAD(joint - 20);
}

double speed_dps(int joint)
{
    return 100 + 5 * joint;
}

int other_of(int joint)
{
    return (joint * 7 + 3) % N == joint ? (joint + 1) % N : (joint * 7 + 3) % N;
}

int third_of(int joint)
{
    return (joint + 5) % N == other_of(joint) ? (joint + 6) % N : (joint + 5) % N;
}

grobo_joint_mask bits(int joint, int other)
{
    return GROBO_JOINT_BIT(joint) | GROBO_JOINT_BIT(other);
}

grobo_joint_mask all_but(int joint)
{
    return GROBO_JOINTS_ALL(N) & ~GROBO_JOINT_BIT(joint);
}

void make_limp(int joint)
{
    robot.axes[joint].state.torque = GROBO_TORQUE_OFF;
    robot.axes[joint].wants_torque = false;
    robot.axes[joint].phase = GROBO_I_JOINT_READY;
}

void set_going(int joint)
{
    robot.axes[joint].trajectory =
        (grobo_robot_trajectory){here_rad(joint), here_rad(joint) + RAD(20), NOW - S, NOW + S};
}

void latch(grobo_trip reason)
{
    robot.trip = (grobo_trip_info){.trip = reason, .joint = -1, .latched = true};
}

grobo_joint_mask halting(void)
{
    static grobo_robot as_it_is;
    grobo_joint_mask halted = 0;
    as_it_is = robot;
    for (int i = 0; i < GROBO_ROBOT_SLOTS; i++) {
        if (robot.slots[i].use != GROBO_I_USE_HALT || robot.slots[i].txn.sent_us >= 0 ||
            grobo_i_gate_leave(&robot.slots[i]) < 0) {
            continue;
        }
        for (int j = 0; j < N; j++) {
            bool told = robot.axes[j].told_us != as_it_is.axes[j].told_us;
            halted |= told ? GROBO_JOINT_BIT(j) : 0;
        }
    }
    robot = as_it_is;
    return halted;
}

/* ---- comparing ------------------------------------------------------------------------------- */

void keep_axes(void)
{
    memcpy(before, robot.axes, sizeof before);
}

#define SAME(field)                                                                                \
    if (is->field != be->field) {                                                                  \
        fail_msg("joint %d: " #field " is %.9g, not %.9g", joint, (double)is->field,               \
                 (double)be->field);                                                               \
    }

static void expect_axis(int joint)
{
    const grobo_robot_axis *is = &robot.axes[joint];
    const grobo_robot_axis *be = &before[joint];
    SAME(state.angle_rad)
    SAME(state.goal_rad)
    SAME(state.torque)
    SAME(goal_us)
    SAME(own_until_us)
    SAME(angle_us)
    SAME(torque_us)
    SAME(told_us)
    SAME(trajectory.from_rad)
    SAME(trajectory.to_rad)
    SAME(trajectory.from_us)
    SAME(trajectory.to_us)
    SAME(last)
    SAME(next)
    SAME(next_rad)
    SAME(next_time_us)
    SAME(told_to_us)
    SAME(phase)
    SAME(torque_known)
    SAME(wants_torque)
}

void expect_axes(void)
{
    for (int j = 0; j < GROBO_JOINTS_MAX; j++) {
        expect_axis(j);
    }
}

void expect_equal(double is, double be, const char *what)
{
    if (!(fabs(is - be) < 1e-9)) {
        fail_msg("%s is %.9g, not %.9g", what, is, be);
    }
}
