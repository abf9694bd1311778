/* SPDX-License-Identifier: MIT */
/*
 * Trajectories that are told in segments: what of a trajectory the next frame asks for. segments.c
 * tells more of them in time.
 *
 * grobo_robot_axis.trajectory is the whole move, as for a whole goal; told_to_us is how far along
 * it the servo was told to go. Frames are built when they leave, so that a renewal lies on the
 * trajectory whenever that is. /
 */
#include <math.h>

#include "src/base/instant.h"
#include "src/robot/axis.h"
#include "src/robot/robot.h"
#include "src/robot/stand.h"
#include "src/robot/state.h"
#include "src/robot/trajectories.h"

/* A whole segment: a multiple of the wire's unit. */
static int64_t most_us(const grobo_robot *robot, int joint)
{
    int64_t step_us = grobo_i_driver_of(robot, joint)->time_step_us;
    return GROBO_SEGMENT_US < step_us ? step_us : GROBO_SEGMENT_US / step_us * step_us;
}

/* Where a trajectory is by then, and never outside the limits: it may begin there. */
static double place(const grobo_robot *robot, int joint, const grobo_robot_trajectory *trajectory,
                    int64_t at_us)
{
    const grobo_i_limits limits = grobo_i_joint_limits(robot, joint);
    return fmin(fmax(grobo_i_trajectory_at(trajectory, at_us), limits.min_rad), limits.max_rad);
}

/* How long the next part of a trajectory takes: a whole segment or what is left, and to its
 * limit one that is still outside by then, no faster than on all of the trajectory. */
static int64_t part_us(const grobo_robot *robot, int joint,
                       const grobo_robot_trajectory *trajectory, int64_t now_us)
{
    int64_t step_us = grobo_i_driver_of(robot, joint)->time_step_us;
    int64_t end_us = grobo_i_sooner(trajectory->to_us, now_us + most_us(robot, joint));
    double way_rad = trajectory->to_rad - trajectory->from_rad;
    double left_rad = place(robot, joint, trajectory, end_us) - trajectory->from_rad;
    double way_us = (double)(trajectory->to_us - trajectory->from_us);
    if (fabs(left_rad) > fabs(grobo_i_trajectory_at(trajectory, end_us) - trajectory->from_rad)) {
        int64_t in_us = trajectory->from_us + (int64_t)(left_rad / way_rad * way_us);
        end_us = grobo_i_sooner(grobo_i_later(in_us, end_us), trajectory->to_us);
    }
    return (end_us - now_us + step_us - 1) / step_us * step_us;
}

/* The end is repeated, too, while there is time for it: a frame may be lost. */
static bool is_renewed(const grobo_robot *robot, const grobo_robot_axis *axis)
{
    bool late = axis->trajectory.to_us - robot->now_us < robot->renew_us;
    return grobo_i_trajectory_is_short(axis) ||
           (grobo_i_has_target(axis) && grobo_i_is_in_segments(axis) && !late);
}

bool grobo_i_goes_in_parts(const grobo_robot *robot, const grobo_robot_order *order)
{
    grobo_goals goals = robot->config.goals;
    bool parts =
        goals == GROBO_GOALS_SEGMENTS || (goals == GROBO_GOALS_DEFAULT && robot->driver->arm);
    return parts && !order->stops;
}

bool grobo_i_segments_wanted(const grobo_robot *robot, int joint, int64_t time_us)
{
    return time_us > most_us(robot, joint);
}

bool grobo_i_segments_cut(const grobo_robot *robot, const grobo_robot_order *order,
                          const grobo_target *whole, grobo_target *part)
{
    bool cut = false, parts = grobo_i_goes_in_parts(robot, order);
    for (int j = 0; parts && j < robot->driver->model->n_joints; j++) {
        int64_t time_us = whole->joint_time_us[j];
        if (!grobo_i_has(whole->posture.set, j) || !grobo_i_segments_wanted(robot, j, time_us)) {
            continue;
        }
        if (!cut) {
            *part = *whole;
            cut = true;
        }
        const grobo_robot_trajectory trajectory = {
            grobo_i_axis_commanded(&robot->axes[j], robot->now_us), whole->posture.angle_rad[j], 0,
            time_us};
        part->joint_time_us[j] = part_us(robot, j, &trajectory, 0);
        part->posture.angle_rad[j] = place(robot, j, &trajectory, part->joint_time_us[j]);
    }
    return cut;
}

grobo_joint_mask grobo_i_joints_that(const grobo_robot *robot,
                                     bool (*is)(const grobo_robot_axis *axis, int64_t now_us))
{
    grobo_joint_mask joints = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        joints |= is(&robot->axes[j], robot->now_us) ? GROBO_JOINT_BIT(j) : 0;
    }
    return joints;
}

grobo_joint_mask grobo_i_trajectories_renewed(const grobo_robot *robot)
{
    grobo_joint_mask joints = 0;
    for (int j = 0; robot->in_segments && j < robot->driver->model->n_joints; j++) {
        joints |= is_renewed(robot, &robot->axes[j]) ? GROBO_JOINT_BIT(j) : 0;
    }
    return joints;
}

void grobo_i_segments_begin(grobo_robot *robot, int joint)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    if (grobo_i_trajectories_renewed(robot) == 0) {
        robot->renewed_us = robot->now_us;
    }
    grobo_i_joint_to(axis, GROBO_I_JOINT_SEGMENT);
    robot->in_segments = true;
    axis->told_to_us = robot->now_us + part_us(robot, joint, &axis->trajectory, robot->now_us);
}

void grobo_i_segments_aim(const grobo_robot *robot, grobo_joint_mask joints, grobo_target *target)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        if (grobo_i_has(joints, j) && is_renewed(robot, axis) && axis->told_to_us > robot->now_us) {
            int64_t time_us = part_us(robot, j, &axis->trajectory, robot->now_us);
            target->joint_time_us[j] = time_us;
            target->posture.angle_rad[j] =
                place(robot, j, &axis->trajectory, robot->now_us + time_us);
            target->posture.set |= GROBO_JOINT_BIT(j);
        }
    }
}

void grobo_i_segments_told(grobo_robot *robot, const grobo_target *target)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(target->posture.set, j)) {
            robot->axes[j].told_to_us = robot->now_us + target->joint_time_us[j];
            grobo_i_stand_forget(&robot->axes[j]);
        }
    }
}

int64_t grobo_i_segments_due(const grobo_robot *robot)
{
    bool some = grobo_i_trajectories_renewed(robot) != 0;
    return some ? robot->renewed_us + robot->renew_us : GROBO_NEVER_US;
}
