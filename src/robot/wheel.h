/* SPDX-License-Identifier: MIT */
/*
 * Wheels: joints with a speed and no angle to go to. A wheel is never sent on a trajectory, so that
 * its state (state.h) is unknown, idle or ready; what it does is the speed that it was told last
 * and what was read of it. A build for plain drivers has none of it.
 *
 *   wheel.c   judges the speeds of an order, and notes them as its frame leaves
 *   drive.c   the request, the frames that keep wheels turning and change their speeds, the end
 *
 * An order for wheels alone is a SPEED (each goes on to the speed that was asked for), a HALT or a
 * HOLD (speed 0, of one that turns or may turn, and of one without torque before it gets it).
 */
#ifndef GROBO_ROBOT_WHEEL_H
#define GROBO_ROBOT_WHEEL_H

#include <math.h>
#include <stdlib.h>

#include "src/robot/axis.h"
#include "src/robot/reading.h"
#include "src/robot/robot.h"
#include "src/robot/slot.h"
#include "src/robot/state.h"

/* Speeds of an order: what its frame has the joints do. */
typedef struct grobo_i_speeds {
    grobo_joint_mask joints;
#if !GROBO_DRIVERS_PLAIN
    double rad_s[GROBO_JOINTS_MAX];
#endif
} grobo_i_speeds;

#if GROBO_DRIVERS_PLAIN
static inline grobo_joint_mask grobo_i_wheels(const grobo_robot *robot)
{
    (void)robot;
    return 0;
}
static inline bool grobo_i_wheel_is_told(const grobo_robot_axis *axis)
{
    (void)axis;
    return false;
}
static inline double grobo_i_wheel_goal(const grobo_robot_axis *axis)
{
    (void)axis;
    return 0;
}
static inline void grobo_i_wheels_forget(grobo_robot *robot, grobo_joint_mask joints)
{
    (void)robot;
    (void)joints;
}
static inline void grobo_i_wheels_step(const grobo_robot *robot)
{
    (void)robot;
}
static inline int64_t grobo_i_wheels_deadline(const grobo_robot *robot)
{
    (void)robot;
    return GROBO_NEVER_US;
}
static inline void grobo_i_wheels_link(const grobo_robot *robot, bool up)
{
    (void)robot;
    (void)up;
}
static inline int grobo_i_wheel_judge(const grobo_robot *robot, const grobo_robot_order *order,
                                      grobo_i_speeds *speeds)
{
    (void)robot;
    (void)order;
    (void)speeds;
    return GROBO_ERR_UNSUPPORTED;
}
static inline grobo_joint_mask grobo_i_wheel_note(const grobo_robot *robot,
                                                  const grobo_i_speeds *speeds)
{
    (void)robot;
    (void)speeds;
    return 0;
}
#else
static inline grobo_joint_mask grobo_i_wheels(const grobo_robot *robot)
{
    return robot->wheels;
}
/* The speed that its servo was told is not 0, as far as is known. */
static inline bool grobo_i_wheel_is_told(const grobo_robot_axis *axis)
{
    return axis->told_rad_s != 0 || axis->asked_rad_s != 0;
}
/* The speed that its servo says it was told. */
static inline double grobo_i_wheel_goal(const grobo_robot_axis *axis)
{
    return axis->state.goal_rad_s;
}
/* What was asked of these is void; nothing is sent. */
void grobo_i_wheels_forget(grobo_robot *robot, grobo_joint_mask joints);
/* Sends what is due for wheels, and ends what nobody has renewed; when that is next. */
void grobo_i_wheels_step(grobo_robot *robot);
int64_t grobo_i_wheels_deadline(const grobo_robot *robot);
/* The line came or went: wheels that turned when it went are stopped when it comes. */
void grobo_i_wheels_link(grobo_robot *robot, bool up);
/* The speeds that the frame of an order tells its wheels now. @return 0, or why it must not
 * leave */
int grobo_i_wheel_judge(grobo_robot *robot, const grobo_robot_order *order, grobo_i_speeds *speeds);
/* They were told so. @return those that are to stand now and turned before */
grobo_joint_mask grobo_i_wheel_note(grobo_robot *robot, const grobo_i_speeds *speeds);
#endif

static inline bool grobo_i_is_wheel(const grobo_robot *robot, int joint)
{
    return grobo_i_has(grobo_i_wheels(robot), joint);
}

/* True of an order for wheels. Its joints are of one kind. */
static inline bool grobo_i_is_of_wheels(const grobo_robot *robot, const grobo_robot_order *order)
{
    bool speeds = order->kind == GROBO_I_ORDER_SPEED || order->kind == GROBO_I_ORDER_HALT ||
                  order->kind == GROBO_I_ORDER_HOLD;
    return speeds && (order->joints & grobo_i_wheels(robot)) != 0;
}

/* True of a wheel that was read to turn last. */
static inline bool grobo_i_wheel_is_seen(const grobo_robot_axis *axis)
{
    return (axis->state.valid & GROBO_FIELD_SPEED) != 0 &&
           abs(axis->state.speed_dps) >= GROBO_I_SLOW_DPS;
}

/* True of a wheel that turns with torque, or will, or of which that is not known. */
static inline bool grobo_i_wheel_turns(const grobo_robot_axis *axis)
{
    bool goal = (axis->state.valid & GROBO_FIELD_GOAL) != 0 && grobo_i_wheel_goal(axis) != 0;
    return !grobo_i_axis_is_limp(axis) &&
           (grobo_i_wheel_is_told(axis) || !grobo_i_is_sensed(axis) || goal ||
            grobo_i_wheel_is_seen(axis));
}

/* True of one that turns with torque, or was told to. */
static inline bool grobo_i_wheel_moves(const grobo_robot_axis *axis)
{
    return !grobo_i_axis_is_limp(axis) &&
           (grobo_i_wheel_is_told(axis) ||
            (grobo_i_is_sensed(axis) && grobo_i_wheel_is_seen(axis)));
}

/* A difference of angles of a wheel is one within half a turn. */
static inline double grobo_i_wheel_apart(const grobo_robot *robot, int joint, double by_rad)
{
    return grobo_i_is_wheel(robot, joint) ? remainder(by_rad, 2 * 3.14159265358979323846) : by_rad;
}

#endif
