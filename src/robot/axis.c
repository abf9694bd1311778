/* SPDX-License-Identifier: MIT */
/* Where a joint is, by what it was sent to and by what was read last. */
#include <math.h>
#include <stdlib.h>

#include "src/base/assert.h"
#include "src/base/instant.h"
#include "src/robot/robot.h"

/* The goals of a way are on the wire's grid: this part of its step is no other goal. */
#define SAME_GOAL_STEPS 0.6

double grobo_i_same_goal_rad(const grobo_robot *robot)
{
    return SAME_GOAL_STEPS * robot->driver->angle_step_rad;
}

double grobo_i_way_at(const grobo_robot_way *way, int64_t now_us)
{
    int64_t at_us = grobo_i_later(now_us, way->from_us);
    if (at_us >= way->to_us) {
        return way->to_rad;
    }
    double part = (double)(at_us - way->from_us) / (double)(way->to_us - way->from_us);
    return way->from_rad + (way->to_rad - way->from_rad) * part;
}

double grobo_i_axis_commanded(const grobo_robot_axis *axis, int64_t now_us)
{
    if (axis->off_way) {
        const grobo_robot_way own = {axis->state.angle_rad, axis->state.goal_rad, axis->angle_us,
                                     axis->own_until_us};
        return axis->own_until_us > axis->angle_us ? grobo_i_way_at(&own, now_us)
                                                   : axis->state.angle_rad;
    }
    int64_t at_us = axis->in_segments ? grobo_i_sooner(now_us, axis->told_to_us) : now_us;
    return grobo_i_way_at(&axis->way, at_us);
}

int64_t grobo_i_axis_until(const grobo_robot_axis *axis)
{
    return axis->off_way ? axis->own_until_us : axis->way.to_us;
}

/* A servo slower than this part of its way is too weak for it; one that begins softly keeps up. */
#define WEAK_PART 0.9

static bool is_weak(const grobo_robot_axis *axis)
{
    double way_rad = fabs(axis->way.to_rad - axis->way.from_rad);
    double time_s = (double)(axis->way.to_us - axis->way.from_us) / 1e6;
    double speed_rad_s = grobo_rad_from_deg(abs(axis->state.speed_dps));
    return (axis->state.valid & GROBO_FIELD_SPEED) != 0 && !axis->off_way &&
           speed_rad_s * time_s < WEAK_PART * way_rad;
}

double grobo_i_axis_reached(const grobo_robot *robot, int joint, int64_t now_us)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    double way_rad = grobo_i_axis_commanded(axis, now_us);
    double most_rad = robot->driver->model->joints[joint].max_speed_rad_s *
                      (double)(now_us - axis->seen_us) / 1e6;
    double left_rad = way_rad - axis->seen_rad;
    bool behind = is_weak(axis) && fabs(left_rad) - most_rad > GROBO_I_OFF_WAY_RAD;
    return behind ? axis->seen_rad + copysign(most_rad, left_rad) : way_rad;
}

grobo_i_limits grobo_i_joint_limits(const grobo_robot *robot, int joint)
{
    const grobo_joint *model = &robot->driver->model->joints[joint];
    const grobo_joint_state *state = &robot->axes[joint].state;
    grobo_i_limits limits = {model->min_rad, model->max_rad};
    if ((state->valid & GROBO_FIELD_RANGE) != 0) {
        limits.min_rad = fmax(limits.min_rad, state->low_rad);
        limits.max_rad = fmin(limits.max_rad, state->high_rad);
    }
    return limits;
}

bool grobo_i_torque_is_limited(const grobo_robot *robot, int joint)
{
    const grobo_joint_state *state = &robot->axes[joint].state;
    return robot->driver->model->joints[joint].torque_limit_pct == 0 ||
           ((state->valid & GROBO_FIELD_TORQUE_LIMIT) != 0 && state->torque_limited);
}

double grobo_i_axis_target(const grobo_robot_axis *axis)
{
    return axis->next != 0 ? axis->next_rad : axis->way.to_rad;
}

void grobo_i_axis_rest(grobo_robot_axis *axis, int64_t now_us)
{
    double angle_rad = axis->state.angle_rad;
    axis->way = (grobo_robot_way){angle_rad, angle_rad, now_us, now_us};
    axis->in_segments = axis->off_way = false;
}

void grobo_i_axis_here(grobo_robot_axis *axis, int64_t now_us)
{
    grobo_i_axis_rest(axis, now_us);
    if (axis->own_until_us > axis->angle_us) { /* by now it may have arrived */
        axis->way = (grobo_robot_way){axis->state.angle_rad, axis->state.goal_rad, axis->angle_us,
                                      axis->own_until_us};
    }
}

bool grobo_i_axis_is_on(const grobo_robot_axis *axis)
{
    return axis->torque_known && axis->state.torque == GROBO_TORQUE_ON;
}

bool grobo_i_may_sleep(const grobo_robot *robot, int joint)
{
    return robot->driver->goal_wakes &&
           robot->now_us - robot->axes[joint].heard_us > GROBO_I_RESTART_US;
}

bool grobo_i_may_halt(const grobo_robot *robot)
{
    return robot->trip.trip != GROBO_TRIP_ESTOP || robot->holds_at_stop;
}

void grobo_i_axis_cut(grobo_robot_axis *axis)
{
    axis->way.to_rad = grobo_i_way_at(&axis->way, axis->told_to_us);
    axis->way.to_us = grobo_i_sooner(axis->way.to_us, axis->told_to_us);
    axis->in_segments = false;
}

bool grobo_i_axis_moves(const grobo_robot_axis *axis, int64_t now_us)
{
    bool limp = axis->torque_known && axis->state.torque != GROBO_TORQUE_ON;
    return !limp && grobo_i_later(grobo_i_axis_until(axis), axis->way.to_us) > now_us;
}

bool grobo_i_moving(const grobo_robot *robot, int64_t now_us)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        if (axis->next != 0 || (axis->sensed && grobo_i_axis_moves(axis, now_us))) {
            return true;
        }
    }
    return false;
}

bool grobo_i_adrift(const grobo_robot *robot, grobo_joint_mask joints, int *joint)
{
    *joint = -1;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(joints, j) && robot->axes[j].adrift) {
            *joint = j;
            return true;
        }
    }
    return false;
}

bool grobo_i_all_sensed(const grobo_robot *robot, grobo_joint_mask joints, int *joint)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(joints, j) && !robot->axes[j].sensed) {
            *joint = j;
            return false;
        }
    }
    return true;
}

bool grobo_i_all_on(const grobo_robot *robot, grobo_joint_mask joints)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(joints, j) && !grobo_i_axis_is_on(&robot->axes[j])) {
            return false;
        }
    }
    return true;
}

grobo_joint_mask grobo_i_all_joints(const grobo_robot *robot)
{
    return GROBO_JOINTS_ALL(robot->driver->model->n_joints);
}

int grobo_i_lowest(grobo_joint_mask joints)
{
    GROBO_ASSERT(joints != 0);
    int j = 0;
    while (!grobo_i_has(joints, j)) {
        j++;
    }
    return j;
}
