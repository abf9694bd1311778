/* SPDX-License-Identifier: MIT */
/*
 * What a stop has halted is read back: a frame may be lost, and then a joint goes on to its goal. A
 * joint waits in grobo_robot.halted from the moment its halt has left. Each reading of it, whatever
 * asked for it, ends that or has the halt repeated; the background asks for one at once. Where a
 * job reads all joints for that (an exit, an emergency stop), it repeats by itself.
 */
#include <math.h>
#include <stdlib.h>

#include "src/base/instant.h"
#include "src/robot/axis.h"
#include "src/robot/halted.h"
#include "src/robot/orders.h"
#include "src/robot/reading.h"
#include "src/robot/robot.h"
#include "src/robot/slot.h"
#include "src/robot/stand.h"
#include "src/robot/state.h"
#include "src/robot/wheel.h"

/* Where the last reading showed nothing the next one waits so long. */
#define AGAIN_US 40000
/* Where nobody knows to: it moves until its halt has left, and the halt is refused no sooner. */
#define ASTRAY_US 100000
/* Of servos that tell no goal: one that is so far beside its halt so long after it was to be there
 * has lost it. A weight has none so far from its goal. */
#define LATE_US 40000
#define BESIDE_RAD (6 * 0.017453292519943295)

/* Not in its first step, which waits for what moves to stand: a lost halt is found before that. */
static bool is_read_by_a_job(const grobo_robot *robot)
{
    const grobo_robot_task *job = robot->job;
    return (job->kind == GROBO_JOB_EXIT || job->kind == GROBO_JOB_ESTOP) && job->at > 0;
}

static bool has_lost_it(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    if (grobo_i_goal_is_told(axis)) {
        return !grobo_i_goal_is_taken(robot, joint);
    }
    return GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed) &&
           axis->seen_us > axis->trajectory.to_us + LATE_US &&
           fabs(axis->state.angle_rad + grobo_i_load(axis) - axis->trajectory.to_rad) > BESIDE_RAD;
}

/* So far beside its halt, a joint was not where it was taken to be: it had lost a frame before. */
#define BESIDE_HALT_RAD (5 * 0.017453292519943295)
/* Later, a weight may have drawn it there: one that is halted anew each time sinks to its end. Of
 * servos that report the time of their way, the place of the goal is known. */
#define ELSEWHERE_US 50000

static bool is_beside(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    double here_rad = grobo_i_trajectory_at(&axis->trajectory, axis->angle_us);
    double off_rad = axis->state.angle_rad + grobo_i_load(axis) - here_rad;
    return fabs(off_rad) > BESIDE_HALT_RAD && !grobo_i_rests(robot, joint);
}

static bool was_elsewhere(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool turns = axis->seen_dps != GROBO_I_NO_SPEED && abs(axis->seen_dps) >= GROBO_I_SLOW_DPS;
    return turns && !grobo_i_axis_is_counted(axis) &&
           axis->angle_us - axis->told_us <= ELSEWHERE_US && is_beside(robot, joint);
}

void grobo_i_astray(grobo_robot *robot, int joint)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    if (grobo_i_is_wheel(robot, joint)) {
        return; /* its speed shows that it moves */
    }
    grobo_i_axis_here(axis, robot->now_us);
    axis->trajectory.to_us = grobo_i_later(axis->trajectory.to_us, robot->now_us + ASTRAY_US);
    grobo_i_joint_to(axis, GROBO_I_JOINT_STRAYS);
}

/* A wheel comes to rest by then where its servo has taken speed 0. */
#define WHEEL_RESTS_US 300000

/* A wheel stands by two positions alone. */
static void look_wheel(grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool lost = grobo_i_goal_is_told(axis) && grobo_i_wheel_goal(axis) != 0;
    bool turns = robot->now_us - axis->told_us > WHEEL_RESTS_US && grobo_i_wheel_is_seen(axis);
    if (grobo_i_axis_is_limp(axis) || grobo_i_stands(robot, joint)) {
        robot->halted &= ~GROBO_JOINT_BIT(joint);
    } else if ((lost || turns) && !is_read_by_a_job(robot)) {
        grobo_i_gate_halt_again(robot, GROBO_JOINT_BIT(joint));
    }
}

/* The goal of a halt may be the one that the joint had before. It shows that the halt came where
 * the joint is read to rest behind the end of its trajectory; before that it may pass its goal, and
 * turn back. A servo that reports the time of its way shows the halt by that. */
static bool is_on_its_halt(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool rests = GROBO_DRIVERS_PLAIN || (axis->stood_us >= axis->trajectory.to_us &&
                                         grobo_i_rests(robot, joint) && grobo_i_is_calm(axis));
    return rests && grobo_i_goal_is_told(axis) && grobo_i_goal_is_taken(robot, joint) &&
           !is_beside(robot, joint);
}

void grobo_i_halted_look(grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    if (!grobo_i_has(robot->halted, joint) || axis->still_us == GROBO_NEVER_US) {
        return; /* this was asked for before */
    }
    if (grobo_i_is_wheel(robot, joint)) {
        look_wheel(robot, joint);
        return;
    }
    bool again = has_lost_it(robot, joint) || was_elsewhere(robot, joint);
    if (is_on_its_halt(robot, joint) || grobo_i_axis_is_limp(axis) ||
        grobo_i_stands(robot, joint)) {
        robot->halted &= ~GROBO_JOINT_BIT(joint);
    } else if (again && !is_read_by_a_job(robot)) {
        grobo_i_astray(robot, joint);
        grobo_i_gate_halt_again(robot, GROBO_JOINT_BIT(joint));
    }
}

int64_t grobo_i_halted_at(const grobo_robot *robot)
{
    return robot->halted == 0 || is_read_by_a_job(robot) ? GROBO_NEVER_US : robot->halted_us;
}

bool grobo_i_halted_due(const grobo_robot *robot)
{
    return grobo_i_halted_at(robot) <= robot->now_us;
}

int grobo_i_halted_next(grobo_robot *robot)
{
    robot->halted_round &= robot->halted;
    robot->halted_round = robot->halted_round == 0 ? robot->halted : robot->halted_round;
    int joint = grobo_i_lowest(robot->halted_round);
    robot->halted_round &= ~GROBO_JOINT_BIT(joint);
    robot->halted_us = robot->halted_round == 0 ? robot->now_us + AGAIN_US : robot->halted_us;
    return joint;
}

grobo_joint_mask grobo_i_halted_ask(grobo_robot *robot)
{
    robot->halted_us = robot->now_us + AGAIN_US;
    return robot->halted;
}

/* All is read back, and nothing that stops waits for the line. */
static bool is_over(const grobo_robot *robot)
{
    bool over = robot->halted == 0 && robot->halted_all != 0;
    for (int i = 0; over && i < robot->slots_end; i++) {
        over = robot->slots[i].use == GROBO_I_USE_FREE || !robot->slots[i].order.stops;
    }
    return over;
}

int64_t grobo_i_halted_deadline(const grobo_robot *robot)
{
    return is_over(robot)                               ? robot->now_us
           : grobo_i_halted_at(robot) == GROBO_NEVER_US ? GROBO_NEVER_US
                                                        : robot->halted_by_us;
}

void grobo_i_halted_step(grobo_robot *robot)
{
    if (grobo_i_halted_deadline(robot) > robot->now_us) {
        return;
    }
    grobo_event event = {.kind = GROBO_EVENT_HALTED};
    event.u.halted.joints = robot->halted_all & ~robot->halted;
    event.u.halted.failed = robot->halted;
    grobo_i_tell(robot, &event);
    robot->halted = robot->halted_all = robot->halted_round = 0;
}
