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
#include "src/robot/wheel.h"

#define DEG 0.017453292519943295
/* A smaller error is as much a matter of steps and friction: it is not worth another goal. */
#define LEAST_RAD (0.5 * DEG)
/* A goal as near to the one that the joint has is that one; the most that a wrong load does. */
#define KEEPS_RAD (2 * DEG)
#define AHEAD_RAD (1 * DEG)
/* A joint slower than this hangs in its load; one that was sent somewhere not before that time. */
#define CALM_DPS 3
#define RESTS_US 300000
/* A joint that carries and is no faster begins its way at the goal that it has. */
#define BEGINS_DPS 40
/* No servo that tells no speed is further from its goal by a weight. */
#define SAGS_RAD (6 * DEG)
/* Another program may have given it another goal by then, where nobody looks. */
#define LATER_US 3000000

/* A stream tells a joint its goal again and again, and what shows that it stands begins anew each
 * time (grobo_i_stands()): so does the error to a goal that stays the same. */
static void note_apart(grobo_robot *robot, int joint)
{
#if !GROBO_DRIVERS_PLAIN
    grobo_robot_axis *axis = &robot->axes[joint];
    const grobo_robot_trajectory *trajectory = &axis->trajectory;
    double same_rad = grobo_i_same_goal_rad(robot, joint);
    double apart_rad = trajectory->to_rad - axis->state.angle_rad;
    bool sent = grobo_i_has_target(axis) && !grobo_i_is_stray(axis);
    bool there = sent && fabs(trajectory->to_rad - trajectory->from_rad) <= same_rad;
    if (!there || axis->apart_us == 0 || fabs(apart_rad - axis->apart_rad) > LEAST_RAD) {
        axis->apart_rad = apart_rad;
        axis->apart_us = there ? robot->now_us : 0;
    }
#else
    (void)robot;
    (void)joint;
#endif
}

static bool stays_apart(const grobo_robot *robot, int joint)
{
#if !GROBO_DRIVERS_PLAIN
    int64_t since_us = robot->axes[joint].apart_us;
    return since_us != 0 && robot->now_us - since_us >= grobo_i_stand_us(robot, joint);
#else
    (void)robot;
    (void)joint;
    return false;
#endif
}

/* True of a joint that hangs in the goal that it has: this reading shows that goal, or one since
 * the frame of its trajectory, and it does not swing any more. */
static bool hangs(const grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool tells = (got->valid & GROBO_FIELD_GOAL) != 0, stands = grobo_i_stands(robot, joint);
    if (GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed) && !stands) {
        return stays_apart(robot, joint) && grobo_i_goal_is_told(axis) &&
               grobo_i_goal_is_taken(robot, joint);
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

/* True of a joint that is beside its own trajectory by the load that it was taken to have. */
static bool is_borne_out(const grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    if (!grobo_i_has_target(axis) || grobo_i_is_stray(axis) ||
        (got->valid & GROBO_FIELD_SPEED) == 0 || abs(got->speed_dps) > CALM_DPS) {
        return false;
    }
    double set_rad = grobo_i_trajectory_at(&axis->trajectory, robot->now_us);
    return fabs(set_rad - axis->state.angle_rad - axis->load_rad) <= LEAST_RAD;
}

/* What a reading shows of the load that was taken before. */
static void look_at_load(grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    if (grobo_i_axis_is_limp(axis)) {
        axis->load_rad = 0;
    }
    if (axis->load_rad != 0 && !axis->load_is_sure) {
        axis->load_is_sure = is_borne_out(robot, joint, got);
    }
    if (GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed)) {
        note_apart(robot, joint);
    }
}

void grobo_i_load_take(grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    double goal_rad;
    look_at_load(robot, joint, got);
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

/* A joint that is no faster, and so far from its goal. Of a servo that tells no speed none is known
 * until it was read twice since its last frame: one so near its goal hangs there, or is there
 * soon. */
static bool is_calm(const grobo_robot *robot, int joint, double away_rad, int most_dps)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool known = axis->seen_dps != GROBO_I_NO_SPEED;
    bool near = GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed) &&
                fabs(away_rad) <= SAGS_RAD;
    return known ? abs(axis->seen_dps) <= most_dps : near;
}

void grobo_i_begin_at_goal(grobo_robot *robot, int joint)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    double goal_rad = axis->state.goal_rad;
    bool slow = is_calm(robot, joint, goal_rad - axis->state.angle_rad, BEGINS_DPS);
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

/* What carries a joint is not known before it stood for long (grobo_i_stands()); its goal is. */
bool grobo_i_hangs_in_goal(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    const grobo_robot_trajectory *trajectory = &axis->trajectory;
    double away_rad = trajectory->to_rad - axis->state.angle_rad;
    if (grobo_i_axis_is_counted(axis) || grobo_i_is_wheel(robot, joint) ||
        !grobo_i_has_target(axis) || grobo_i_is_stray(axis) || !grobo_i_axis_is_on(axis) ||
        axis->goal_us == GROBO_NEVER_US || !grobo_i_goal_is_taken(robot, joint)) {
        return false;
    }
    bool slow = is_calm(robot, joint, away_rad, CALM_DPS);
    /* It had this goal before: whether the last frame came does not matter. */
    bool nowhere =
        fabs(trajectory->to_rad - trajectory->from_rad) <= grobo_i_same_goal_rad(robot, joint);
    bool rests = grobo_i_goal_is_told(axis) && trajectory->to_us <= robot->now_us &&
                 !grobo_i_trajectory_is_short(axis) && grobo_i_rests(robot, joint) &&
                 axis->seen_dps * away_rad <= 0;
    return slow && (nowhere || rests) && fabs(away_rad) <= grobo_i_load_most(robot, joint);
}

double grobo_i_lag_kept(const grobo_robot *robot, int joint, double rest_rad)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    if (!GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed) ||
        !grobo_i_has_target(axis) || grobo_i_load_kept(axis) != 0) {
        return 0;
    }
    bool sent = !grobo_i_is_stray(axis);
    if (!sent && (axis->goal_us == GROBO_NEVER_US || axis->goal_us < axis->told_us)) {
        return 0;
    }
    /* A halt of several frames is aimed anew for each. */
    double set_rad = !sent             ? axis->state.goal_rad
                     : axis->last == 0 ? axis->trajectory.to_rad
                                       : grobo_i_axis_commanded(axis, robot->now_us);
    double lag_rad = set_rad - rest_rad;
    bool ahead = sent && lag_rad * (axis->trajectory.to_rad - axis->trajectory.from_rad) < 0;
    double most_rad = ahead ? AHEAD_RAD : KEEPS_RAD; /* none is by its speed */
    return fmin(fmax(lag_rad, -most_rad), most_rad);
}

double grobo_i_goal_to_rest(const grobo_robot *robot, int joint, int64_t rest_us)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    double rest_rad = grobo_i_axis_reached(robot, joint, rest_us);
    double load_rad = grobo_i_load_kept(axis), goal_rad;
    if (grobo_i_hangs_in_goal(robot, joint)) {
        return axis->trajectory.to_rad;
    }
    if (load_rad == 0) {
        return GROBO_DRIVERS_PLAIN ? rest_rad : rest_rad + grobo_i_lag_kept(robot, joint, rest_rad);
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
