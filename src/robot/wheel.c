/* SPDX-License-Identifier: MIT */
/*
 * What a frame may tell wheels, judged as it leaves. A wheel goes on from the speed that it was
 * told last to the one that was asked for, by no more than its acceleration makes of the time
 * between; what stops it leaves at once, behind a latch as well.
 */
#include "src/base/instant.h"
#include "src/robot/axis.h"
#include "src/robot/often.h"
#include "src/robot/robot.h"
#include "src/robot/slot.h"
#include "src/robot/wheel.h"

#if !GROBO_DRIVERS_PLAIN

/* Of a wheel that was told nothing for long the speed changes by no more than in this time. */
#define STEP_MOST_US 150000

/* The next speed on the way from the one it was told to the one asked for. */
static double next_speed(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    double wanted_rad_s = axis->asked_until_us > robot->now_us ? axis->asked_rad_s : 0;
    int64_t us = grobo_i_sooner(robot->now_us - axis->told_speed_us, STEP_MOST_US);
    double most = grobo_i_joint(robot->driver->model, joint)->accel_rad_s2 * (double)us / 1e6;
    return axis->told_rad_s + fmin(fmax(wanted_rad_s - axis->told_rad_s, -most), most);
}

/* A wheel turns only where its servo was read to be one, to have torque and to be alive. */
static int judge_wheel(grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    robot->fault_joint = joint;
    if (robot->trip.latched) {
        return GROBO_ERR_LATCHED;
    }
    if (!grobo_i_is_sensed(axis)) {
        return GROBO_ERR_STALE;
    }
    bool may = grobo_i_axis_is_on(axis) && !grobo_i_may_sleep(robot, joint) &&
               grobo_i_torque_is_limited(robot, joint);
    return may ? GROBO_OK : GROBO_ERR_STATE;
}

/* True of one that an order for speed 0 is for. A servo that is no wheel would take the frame for
 * something else. */
static bool is_stopped(const grobo_robot *robot, const grobo_robot_order *order, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool halted = grobo_i_has(robot->halted, joint);
    return axis->status != GROBO_ERR_SETUP &&
           (order->kind == GROBO_I_ORDER_HALT
                ? grobo_i_wheel_turns(axis) || (halted && !grobo_i_axis_is_limp(axis))
                : grobo_i_is_sensed(axis) && !grobo_i_axis_is_on(axis) && !robot->trip.latched);
}

int grobo_i_wheel_judge(grobo_robot *robot, const grobo_robot_order *order, grobo_i_speeds *speeds)
{
    int result = GROBO_OK;
    speeds->joints = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (!grobo_i_has(order->joints, j)) {
            continue;
        }
        speeds->rad_s[j] = 0;
        bool goes = order->kind == GROBO_I_ORDER_SPEED;
        int may = goes ? judge_wheel(robot, j) : GROBO_OK;
        result = may < 0 ? may : result;
        if (goes && may >= 0) {
            speeds->rad_s[j] = next_speed(robot, j);
        }
        speeds->joints |= (goes ? may >= 0 : is_stopped(robot, order, j)) ? GROBO_JOINT_BIT(j) : 0;
    }
    return speeds->joints != 0 ? GROBO_OK : result < 0 ? result : GROBO_ERR_EMPTY;
}

grobo_joint_mask grobo_i_wheel_note(grobo_robot *robot, const grobo_i_speeds *speeds)
{
    grobo_joint_mask stopped = 0;
    bool begins = false;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        grobo_robot_axis *axis = &robot->axes[j];
        if (grobo_i_has(speeds->joints, j)) {
            bool turned = axis->told_rad_s != 0;
            stopped |= turned && speeds->rad_s[j] == 0 ? GROBO_JOINT_BIT(j) : 0;
            begins = begins || (!turned && speeds->rad_s[j] != 0);
            axis->told_rad_s = speeds->rad_s[j];
            axis->told_speed_us = robot->now_us;
        }
    }
    if (begins) {
        grobo_i_often_soon(robot);
    }
    return stopped;
}

void grobo_i_wheels_forget(grobo_robot *robot, grobo_joint_mask joints)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(joints & robot->wheels, j)) {
            robot->axes[j].asked_rad_s = 0;
        }
    }
}

#endif
