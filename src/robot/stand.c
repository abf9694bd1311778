/* SPDX-License-Identifier: MIT */
/*
 * Whether a joint stands, by what was read since the last frame that told it something and since
 * the last exit or emergency stop was asked for. A speed that a servo reports is not believed:
 * below a few degrees a second many report none. Either two positions lie so far apart in time and
 * so near in place that a joint which creeps at CREEPS_RAD_S would show, or the servo's own goal
 * was read back and reached; of one that says that it turns there, it is passed.
 */
#include <math.h>
#include <stdlib.h>

#include "src/robot/axis.h"
#include "src/robot/reading.h"
#include "src/robot/robot.h"
#include "src/robot/stand.h"
#include "src/robot/state.h"
#include "src/robot/wheel.h"

#define STANDS_RAD (0.5 * 0.017453292519943295)
#define CREEPS_RAD_S (0.9 * 0.017453292519943295)
/* Of servos that are coarser than any that is known. */
#define STANDS_MOST_US 1000000

static double still_rad(const grobo_robot *robot, int joint)
{
    return fmax(STANDS_RAD, 2 * grobo_i_driver_of(robot, joint)->angle_step_rad);
}

int64_t grobo_i_stand_us(const grobo_robot *robot, int joint)
{
    double apart_rad = still_rad(robot, joint) + grobo_i_driver_of(robot, joint)->angle_step_rad;
    return (int64_t)fmin(apart_rad / CREEPS_RAD_S * 1e6, STANDS_MOST_US);
}

/* A joint may have been set going by another program since what was read before that. */
static bool is_since_stop(const grobo_robot *robot, int64_t at_us)
{
    return at_us != GROBO_NEVER_US && at_us >= robot->stop_us;
}

void grobo_i_stand_forget(grobo_robot_axis *axis)
{
    axis->still_us = GROBO_NEVER_US;
    axis->goal_is_read = false;
}

void grobo_i_stand_seen(grobo_robot *robot, int joint, int64_t asked_us, double angle_rad)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    if (!is_since_stop(robot, asked_us)) {
        return;
    }
    bool known = is_since_stop(robot, axis->still_us) && grobo_i_is_sensed(axis) &&
                 asked_us - axis->stood_us <= GROBO_WATCH_US;
    double by_rad = grobo_i_wheel_apart(robot, joint, angle_rad - axis->still_rad);
    if (!known || fabs(by_rad) > still_rad(robot, joint)) {
        axis->still_rad = angle_rad;
        axis->still_us = robot->now_us;
    }
    axis->stood_us = asked_us;
}

bool grobo_i_stand_left(const grobo_robot_axis *axis)
{
    return axis->still_us > axis->stood_us;
}

/* By the speed that its servo reports: a joint may pass its goal before it comes to rest there. */
static bool is_read_to_turn(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    return axis->seen_dps != GROBO_I_NO_SPEED && abs(axis->seen_dps) >= GROBO_I_SLOW_DPS &&
           !GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed);
}

bool grobo_i_stands(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool known = grobo_i_is_sensed(axis) && is_since_stop(robot, axis->still_us);
    bool there = axis->goal_is_read && is_since_stop(robot, axis->goal_us) &&
                 fabs(axis->state.goal_rad - axis->state.angle_rad) <= still_rad(robot, joint) &&
                 !is_read_to_turn(robot, joint);
    if (grobo_i_is_wheel(robot, joint)) { /* it may come by the same place again */
        there = false;
        known = known && !grobo_i_wheel_turns(axis);
    }
    return known && (there || axis->stood_us - axis->still_us >= grobo_i_stand_us(robot, joint));
}

bool grobo_i_goal_is_taken(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    const grobo_robot_trajectory *trajectory = &axis->trajectory;
    double same_rad = grobo_i_same_goal_rad(robot, joint);
    double goal_rad = axis->state.goal_rad;
    if (!grobo_i_is_in_segments(axis) || axis->goal_us >= trajectory->to_us) {
        return fabs(goal_rad - trajectory->to_rad) <= same_rad;
    }
    double here_rad = grobo_i_trajectory_at(trajectory, axis->goal_us);
    return goal_rad >= fmin(here_rad, trajectory->to_rad) - same_rad &&
           goal_rad <= fmax(here_rad, trajectory->to_rad) + same_rad;
}

/* A servo that restarts hears again by then. */
#define HALTED_BY_US 2500000

/* So far apart, two positions of a joint that does not turn are no chance. */
#define RESTS_US 80000

bool grobo_i_rests(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    double off_rad = axis->state.angle_rad + grobo_i_load(axis) - axis->trajectory.to_rad;
    bool told = axis->seen_us >= axis->trajectory.to_us && axis->seen_dps != GROBO_I_NO_SPEED &&
                !GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed);
    bool slow = told && abs(axis->seen_dps) < GROBO_I_SLOW_DPS;
    bool again = axis->still_us != GROBO_NEVER_US && axis->stood_us - axis->still_us >= RESTS_US;
    return fabs(off_rad) <= still_rad(robot, joint) ? slow || !told || again
                                                    : again && (slow || !told);
}

/* No joint that swings is so long at one place. */
#define CALM_US 120000

bool grobo_i_is_calm(const grobo_robot_axis *axis)
{
    return axis->still_us != GROBO_NEVER_US && axis->stood_us - axis->still_us >= CALM_US;
}

grobo_joint_mask grobo_i_swinging(const grobo_robot *robot)
{
    grobo_joint_mask swing = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        bool carries = grobo_i_has_target(axis) && grobo_i_load(axis) != 0;
        bool calm = grobo_i_stands(robot, j) || (axis->stood_us >= axis->trajectory.to_us &&
                                                 grobo_i_rests(robot, j) && grobo_i_is_calm(axis));
        swing |= carries && !calm && grobo_i_may_sag(robot, j, 0) ? GROBO_JOINT_BIT(j) : 0;
    }
    return swing;
}

void grobo_i_halt_left(grobo_robot *robot, grobo_joint_mask joints, bool halts)
{
    grobo_joint_mask before = robot->halted;
    if (!halts) {
        robot->halted &= ~joints;
        robot->halted_all &= ~joints;
        return;
    }
    robot->halted_by_us = before == 0 ? robot->now_us + HALTED_BY_US : robot->halted_by_us;
    robot->halted_us = (joints & ~before) != 0 ? robot->now_us : robot->halted_us;
    robot->halted |= joints;
    robot->halted_all |= joints;
}

void grobo_i_halt_owe(grobo_robot *robot, grobo_joint_mask joints)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(joints, j)) {
            bool waits = grobo_i_has(robot->halts_owed, j);
            robot->hear_us = waits ? robot->hear_us : robot->now_us; /* it is asked at once */
            robot->halts_owed |= GROBO_JOINT_BIT(j);
            robot->halt_us = robot->now_us;
            if (grobo_i_is_in_segments(&robot->axes[j])) {
                grobo_i_axis_cut(&robot->axes[j]);
            }
        }
    }
}
