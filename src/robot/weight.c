/* SPDX-License-Identifier: MIT */
/*
 * Joints that carry weight. A servo holds by the error between its goal and its angle: without that
 * error it gives no torque. So a joint that holds stands beside its goal, and a goal that is set to
 * the angle read takes away the torque that carries it: the joint sinks by that error once more.
 *
 * The error is taken from readings of a joint that stands, and whose goal is known: the load of the
 * joint. Where a stop, an exit or the end of a motion brings a joint to rest, its goal is that much
 * beyond the place. A joint that swings about the place where it hangs keeps its goal.
 *
 * The load may be another one by now: of another posture, with less in the hand, with the wall gone
 * that the joint was pushed against. So the new goal is never further beyond where the joint was
 * sent by then than KEEPS_RAD: no stop throws a joint by more than that. An error that is larger
 * than any weight causes is that of a blocked joint, and is not kept.
 *
 * Servos that report the time of their trajectory (RS30x) are counted along it: they are halted at
 * the place of the goal, not of the shaft, which keeps the error without any of this. /
 */
#include <math.h>
#include <stdlib.h>

#include "src/base/instant.h"
#include "src/robot/axis.h"
#include "src/robot/robot.h"
#include "src/robot/stand.h"
#include "src/robot/state.h"
#include "src/robot/weight.h"

#define DEG 0.017453292519943295
/* A smaller error is as much a matter of steps and friction: it is not worth another goal. */
#define LEAST_RAD (0.5 * DEG)
/* A goal as near to the one that the joint has is that one; the most that a wrong load does. */
#define KEEPS_RAD (2 * DEG)
/* A joint slower than this hangs in its load; one that was sent somewhere not before that time. */
#define CALM_DPS 3
#define RESTS_US 300000
/* A joint that carries and is no faster begins its way at the goal that it has. */
#define BEGINS_DPS 40
/* Another program may have given it another goal by then, where nobody looks. */
#define LATER_US 3000000

/* True of a joint that hangs in the goal that it has: this reading shows that goal, or one since
 * the frame of its trajectory, and it does not swing any more. */
static bool hangs(const grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool tells = (got->valid & GROBO_FIELD_GOAL) != 0, stands = grobo_i_stands(robot, joint);
    if (GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed) && !stands) {
        return false;
    }
    if (!grobo_i_has_target(axis) || grobo_i_is_stray(axis)) {
        /* one that was told it just now has not begun */
        return tells && robot->now_us - axis->told_us >= RESTS_US;
    }
    int64_t since_us = robot->now_us - axis->trajectory.to_us;
    bool settled = since_us >= RESTS_US && since_us <= LATER_US;
    bool there = since_us >= 0 && stands && tells; /* one that begins stands as well */
    return (settled || there) && grobo_i_goal_is_told(axis) && grobo_i_goal_is_taken(robot, joint);
}

void grobo_i_load_take(grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    double goal_rad;
    if (grobo_i_axis_is_limp(axis)) {
        axis->load_rad = 0;
    }
    if ((got->valid & GROBO_FIELD_SPEED) == 0 || abs(got->speed_dps) > CALM_DPS ||
        !grobo_i_axis_is_on(axis) || !grobo_i_axis_goal(robot, joint, &goal_rad) ||
        got->speed_dps * (goal_rad - axis->state.angle_rad) > 0 || !hangs(robot, joint, got)) {
        return; /* one that turns to its goal creeps there, however late it is */
    }
    double load_rad = goal_rad - axis->state.angle_rad;
    double least_rad = fmax(LEAST_RAD, 2 * grobo_i_driver_of(robot, joint)->angle_step_rad);
    bool carries = fabs(load_rad) >= least_rad && fabs(load_rad) <= grobo_i_load_most(robot, joint);
    load_rad = carries ? load_rad : 0;
    bool sent = grobo_i_has_target(axis) && !grobo_i_is_stray(axis);
    bool same = fabs(load_rad - axis->load_rad) <= least_rad;
    axis->load_is_sure = sent || grobo_i_stands(robot, joint) || (axis->load_is_sure && same);
    axis->load_rad = load_rad;
}

void grobo_i_begin_at_goal(grobo_robot *robot, int joint)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    double goal_rad = axis->state.goal_rad;
    bool slow = axis->seen_dps != GROBO_I_NO_SPEED && abs(axis->seen_dps) <= BEGINS_DPS;
    bool stands = axis->trajectory.from_us == axis->trajectory.to_us;
    if (!grobo_i_axis_is_counted(axis) && grobo_i_axis_is_on(axis) && slow && stands &&
        grobo_i_goal_is_told(axis) &&
        fabs(goal_rad - axis->state.angle_rad) <= grobo_i_load_most(robot, joint)) {
        axis->trajectory.from_rad = axis->trajectory.to_rad = goal_rad;
    }
}

double grobo_i_goal_near(const grobo_robot_axis *axis, double goal_rad, double here_rad,
                         double most_rad, int side)
{
    double low_rad = (side > 0 ? here_rad : here_rad - most_rad) + fmin(grobo_i_load_kept(axis), 0);
    double high_rad =
        (side < 0 ? here_rad : here_rad + most_rad) + fmax(grobo_i_load_kept(axis), 0);
    return fmin(fmax(goal_rad, low_rad), high_rad);
}

double grobo_i_goal_to_rest(const grobo_robot *robot, int joint, int64_t rest_us)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    double rest_rad = grobo_i_axis_reached(robot, joint, rest_us);
    double load_rad = grobo_i_load_kept(axis), goal_rad;
    if (load_rad == 0) {
        return rest_rad;
    }
    bool known =
        grobo_i_axis_goal(robot, joint, &goal_rad) && grobo_i_axis_until(axis) <= robot->now_us;
    if (known && fabs(rest_rad + load_rad - goal_rad) <= KEEPS_RAD) {
        return goal_rad;
    }
    double set_rad = known ? goal_rad : grobo_i_axis_commanded(axis, rest_us);
    double beyond_rad = fmax(copysign(1, load_rad) * (set_rad - rest_rad), 0) + KEEPS_RAD;
    return rest_rad + copysign(fmin(fabs(load_rad), beyond_rad), load_rad);
}
