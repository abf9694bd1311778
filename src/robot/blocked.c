/* SPDX-License-Identifier: MIT */
/*
 * Joints that something holds up, and joints that are loaded with more than they carry.
 *
 * A servo that meets a wall, a hand or a part that is stuck pushes harder the further its set point
 * goes on: soon with all it has, for as long as it is told nothing else. Weight does that too, so
 * the error alone says little: what a joint carries is known from where it stood last (weight.c),
 * and may have become more since. These two show what no weight does:
 *
 *   blocked      the joint stands, while its set point moves on by AHEAD_RAD and is then further
 *                than load and friction explain
 *   overloaded   the joint is further from its set point than any weight has it, and does not come
 *                nearer: it sinks, or is pushed away
 *
 * Only joints whose servo was read to have the goal that it was sent are judged: one that lost a
 * frame stands as well. A joint with a limited torque is made to press on what it holds: its move
 * ends with its error, and is no reason to stop all others. Nor is a joint in free mode judged.
 *
 * The joint is stopped where it is, so that it presses no more. It takes two readings to show that
 * it stands; they come often meanwhile (often.c).
 */
#include <math.h>
#include <stdlib.h>

#include "src/base/instant.h"
#include "src/robot/axis.h"
#include "src/robot/blocked.h"
#include "src/robot/halted.h"
#include "src/robot/often.h"
#include "src/robot/query.h"
#include "src/robot/reading.h"
#include "src/robot/robot.h"
#include "src/robot/stand.h"
#include "src/robot/state.h"
#include "src/robot/trip.h"

#if !GROBO_DRIVERS_PLAIN

#define DEG 0.017453292519943295
/* A set point that goes on by so much, and is so far from the joint, would move it: one that lay on
 * a stop or a table stands until its servo has the error that lifts it. */
#define AHEAD_RAD (12 * DEG)
#define AWAY_RAD (4 * DEG)
#define END_RAD (2 * DEG)
/* While other joints turn, what it carries changes, and by no more than the largest load that it
 * was seen to carry for each radian of theirs. In a longer time nothing less than an overload
 * shows it. */
#define SLOW_US 1000000
/* Gears have more friction under load: one that carries and turns back stands for as long as its
 * error goes from what sinks it to what lifts it, which is this part of it and that of its friction
 * alone. The worst that is known is that of an XL330. */
#define FRICTION_PART 1.5
#define FRICTION_RAD (5 * DEG)
/* One that sets out from where it hung has friction on the other side first, which hid as much of
 * its load as that: an XL-320 with a fifth of what it lifts stands for 15 degrees. */
#define SETS_OUT_RAD (5 * DEG)
/* No servo that carries a weight is further from its set point: an XL330 at its softest has 25
 * degrees by the arm of a Koch and what that carries. */
#define OVERLOADED_RAD (35 * DEG)
#define CARRIED_RAD (25 * DEG)
/* A set point that has moved by less has not begun to. */
#define BEGINS_RAD (0.5 * DEG)
/* From here on a joint is strained: it is read more often. */
#define STRAINED_RAD (3 * DEG)
/* A joint that goes on by less stands; so long at least. */
#define STANDS_RAD (0.6 * DEG)
#define STANDS_US 100000
/* A loop that carries an arm is so late behind a way that begins, where others pull back, or where
 * its gears stick: an XL-320 at 100 degrees a second is 12 degrees behind before it has turned. */
#define STARTS_US 150000
/* What was seen longer ago than that is no beginning of anything: the host may have stalled, and
 * servos that watch it have stopped by themselves. */
#define UNSEEN_US 1500000

/* ---- judgement ------------------------------------------------------------------------------- */

static double stands_rad(const grobo_robot *robot, int joint)
{
    return fmax(STANDS_RAD, 2 * grobo_i_driver_of(robot, joint)->angle_step_rad);
}

/* A joint that turns back or sets out with a ramp stands that long. */
static int64_t stands_us(const grobo_robot *robot, int joint)
{
    double accel_rad_s2 = grobo_i_driver_of(robot, joint)->accel_rad_s2;
    double ramp_s = accel_rad_s2 > 0 ? 2 * sqrt(2 * stands_rad(robot, joint) / accel_rad_s2) : 0;
    return STANDS_US + (int64_t)(ramp_s * 1e6);
}

/* The set point of a joint that this program moves or holds, NaN of other joints, and whether it is
 * what its servo has. */
typedef struct set_point {
    double rad;
    bool known;
} set_point;

/* One that was never sent anywhere holds the goal that it was found with, if this reading shows it
 * to be still that one. It is judged where this program holds it, or moves others. */
static set_point found_goal(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    double moved_rad = fabs(axis->state.goal_rad - axis->block_set_rad);
    bool same =
        moved_rad <= grobo_i_same_goal_rad(robot, joint) || axis->block_us == GROBO_NEVER_US;
    bool held = axis->goal_us == robot->now_us && same;
    return (set_point){held ? axis->state.goal_rad : (double)NAN, held};
}

/* By this reading; servos that a goal wakes do not tell it but in their answer to it. */
static bool goal_is_known(const grobo_robot *robot, int joint)
{
    bool fresh = robot->axes[joint].goal_us == robot->now_us ||
                 grobo_i_driver_of(robot, joint)->goal_energises;
    return fresh && grobo_i_goal_is_told(&robot->axes[joint]) &&
           grobo_i_goal_is_taken(robot, joint);
}

static set_point set_of(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool sent = grobo_i_has_target(axis);
    if (!(sent || axis->wants_torque || grobo_i_in_motion(robot)) || !grobo_i_axis_is_on(axis) ||
        (sent && axis->trajectory.from_us > axis->told_us) ||
        grobo_i_joint(robot->driver->model, joint)->torque_limit_pct > 0 ||
        grobo_i_has(robot->free_joints, joint)) {
        return (set_point){(double)NAN, false};
    }
    if (!sent) {
        return found_goal(robot, joint);
    }
    int64_t asked_us = grobo_i_later(axis->seen_us, axis->trajectory.from_us);
    return (set_point){grobo_i_trajectory_at(&axis->trajectory, asked_us),
                       goal_is_known(robot, joint)};
}

bool grobo_i_blocked_wants_goal(const grobo_robot *robot, int joint)
{
    return grobo_i_has(robot->strained, joint) && !set_of(robot, joint).known;
}

/* What of the way to the set point no load explains: it may be less by now than it was. */
static double excess_rad(const grobo_robot_axis *axis, double set_rad)
{
    double off_rad = set_rad - axis->state.angle_rad, load_rad = grobo_i_load(axis);
    return off_rad - fmin(fmax(off_rad, fmin(load_rad, 0)), fmax(load_rad, 0));
}

void grobo_i_blocked_forget(grobo_robot *robot, int joint)
{
    robot->axes[joint].block_us = robot->axes[joint].over_us = GROBO_NEVER_US;
    robot->axes[joint].was_near = false;
    grobo_i_often_strained(robot, joint, false);
}

static void stop_for(grobo_robot *robot, grobo_trip reason, int joint, double off_rad)
{
    grobo_i_blocked_forget(robot, joint);
    if (!robot->trip.latched) {
        grobo_i_astray(robot, joint);
        grobo_i_trip(robot, reason, joint, fabs(grobo_deg_from_rad(off_rad)), true);
    }
}

/* True of one at an end of its range: it may lie on a stop, with a load that nobody has seen. */
static bool is_at_end(const grobo_robot *robot, int joint)
{
    const grobo_i_limits limits = grobo_i_joint_limits(robot, joint);
    double angle_rad = robot->axes[joint].state.angle_rad;
    return angle_rad < limits.min_rad + END_RAD || angle_rad > limits.max_rad - END_RAD;
}

/* The largest error that a joint was seen to stand with. */
static double most_carried_rad(const grobo_robot_axis *axis)
{
    double now_rad = fmax(fabs(grobo_i_load(axis)), axis->block_load_rad);
    return fmin(fmax(axis->carried_rad, now_rad), CARRIED_RAD);
}

/* How far the set point of a joint that stands must go on to show that something holds it. */
static double least_ahead_rad(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    if (is_at_end(robot, joint) || robot->now_us - axis->block_us > SLOW_US) {
        return OVERLOADED_RAD;
    }
    double load_rad = fmax(fabs(grobo_i_load(axis)), axis->block_load_rad);
    /* The torque of a weight is no more than that times the sine of an angle that they turn. */
    load_rad += axis->carried_rad * (robot->turned_rad - axis->block_turned_rad);
    double most_rad = fmax(AHEAD_RAD, FRICTION_RAD + FRICTION_PART * load_rad);
    most_rad += axis->block_load_rad > 0 ? SETS_OUT_RAD : 0;
    return fmin(most_rad, OVERLOADED_RAD);
}

/* True of one that was read to turn to its set point: it has just begun. */
static bool comes(const grobo_robot_axis *axis, double away_rad)
{
    return axis->seen_dps != GROBO_I_NO_SPEED && abs(axis->seen_dps) >= GROBO_I_SLOW_DPS &&
           axis->seen_dps * away_rad > 0;
}

/* Whether it stands while its set point moves on: from `axis->block_us` on, when that was where it
 * began last. */
static bool is_blocked(grobo_robot *robot, int joint, double set_rad)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    const grobo_robot_trajectory *way = &axis->trajectory;
    double away_rad = set_rad - axis->state.angle_rad;
    double ahead_rad = copysign(1, away_rad) * (set_rad - axis->block_set_rad);
    bool moved = axis->block_us == GROBO_NEVER_US || ahead_rad < -BEGINS_RAD ||
                 fabs(axis->state.angle_rad - axis->block_rad) > stands_rad(robot, joint);
    axis->block_set_rad = moved ? set_rad : axis->block_set_rad;
    if (moved || robot->now_us >= way->to_us) { /* on its way it lags besides */
        axis->block_load_rad = robot->now_us >= way->to_us ? fabs(away_rad) : 0;
    }
    if (moved || ahead_rad <= BEGINS_RAD) {
        axis->block_rad = axis->state.angle_rad;
        axis->block_us = robot->now_us;
        axis->block_turned_rad = robot->turned_rad;
        axis->carried_rad = most_carried_rad(axis);
        return false;
    }
    bool at_once = way->to_us - way->from_us < stands_us(robot, joint); /* one of many frames */
    int64_t begun_us = at_once ? axis->block_us : way->from_us;
    int64_t since_us = grobo_i_later(axis->block_us, begun_us + STARTS_US);
    return fabs(away_rad) >= AWAY_RAD && ahead_rad >= least_ahead_rad(robot, joint) &&
           robot->now_us - since_us >= stands_us(robot, joint) && !comes(axis, away_rad);
}

/* Whether it is further away than weight has it, and does not come nearer. */
static bool is_overloaded(grobo_robot *robot, int joint, double set_rad)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    double over_rad = excess_rad(axis, set_rad);
    bool near = fabs(over_rad) <= OVERLOADED_RAD;
    double on_rad = copysign(1, over_rad) * (axis->state.angle_rad - axis->over_rad);
    if (near || axis->over_us == GROBO_NEVER_US || on_rad > stands_rad(robot, joint)) {
        axis->was_near = near || axis->was_near;
        bool found_so = !axis->was_near; /* nobody has seen it go there */
        axis->over_us = near || found_so ? GROBO_NEVER_US : robot->now_us;
        axis->over_rad = axis->state.angle_rad;
        return false;
    }
    return robot->now_us - axis->over_us >= stands_us(robot, joint);
}

void grobo_i_blocked_look(grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    bool judged = grobo_i_has_target(axis) || axis->wants_torque || axis->looked_us != 0 ||
                  grobo_i_in_motion(robot); /* most joints of a robot that is watched are not */
    if (!judged || (got->valid & GROBO_FIELD_ANGLE) == 0) {
        return;
    }
    robot->turned_rad += axis->looked_us != 0 ? fabs(axis->state.angle_rad - axis->looked_rad) : 0;
    axis->looked_rad = axis->state.angle_rad;
    const set_point set = set_of(robot, joint);
    bool unseen = robot->now_us - axis->looked_us > UNSEEN_US;
    if (isnan(set.rad) || unseen) {
        grobo_i_blocked_forget(robot, joint);
    }
    axis->looked_us = robot->now_us;
    if (isnan(set.rad)) {
        return;
    }
    double off_rad = set.rad - axis->state.angle_rad - grobo_i_load(axis);
    grobo_i_often_strained(robot, joint, fabs(off_rad) > STRAINED_RAD);
    if (!set.known) {
        axis->block_us = axis->over_us = GROBO_NEVER_US;
        axis->was_near = false;
    } else if (is_blocked(robot, joint, set.rad)) {
        stop_for(robot, GROBO_TRIP_BLOCKED, joint, off_rad);
    } else if (is_overloaded(robot, joint, set.rad)) {
        stop_for(robot, GROBO_TRIP_OVERLOAD, joint, off_rad);
    }
}

#endif
