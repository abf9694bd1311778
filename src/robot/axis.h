/* SPDX-License-Identifier: MIT */
/* Where a joint is, by what it was sent to and what was read (axis.c). */
#ifndef GROBO_ROBOT_AXIS_I_H
#define GROBO_ROBOT_AXIS_I_H

#include <math.h>

#include <grobo/core/static.h>

#include "src/robot/state.h"

/* How far its goal is beyond the place where it stands by that: the error that carries its weight;
 * 0 where nothing is known of one (weight.c). The second is what a stop keeps of it. */
static inline double grobo_i_load(const grobo_robot_axis *axis)
{
    return GROBO_DRIVERS_PLAIN ? 0 : axis->load_rad;
}
static inline double grobo_i_load_kept(const grobo_robot_axis *axis)
{
    bool kept = axis->load_is_sure || (grobo_i_has_target(axis) && !grobo_i_is_stray(axis));
    return kept ? grobo_i_load(axis) : 0;
}

/* True if its goal was read, or its servo answered with it, behind the frame that left last: one
 * read at the very moment when that left is the goal before. */
bool grobo_i_goal_is_told(const grobo_robot_axis *axis);
/* True while the servo was not told the end of its trajectory. */
bool grobo_i_trajectory_is_short(const grobo_robot_axis *axis);
/* A servo that reports the time of its trajectory is counted along it. */
static inline bool grobo_i_axis_is_counted(const grobo_robot_axis *axis)
{
    return GROBO_DRIVERS_PLAIN || (axis->state.valid & GROBO_FIELD_TIME) != 0;
}
/* The goal that its servo has, where that is known; false else. */
bool grobo_i_axis_goal(const grobo_robot *robot, int joint, double *goal_rad);
/* The largest error that can be of a weight. */
double grobo_i_load_most(const grobo_robot *robot, int joint);
/* True of a joint that turns as a body that hangs in the goal of its servo: it sinks from there, or
 * swings about the place where it stood. */
bool grobo_i_swings(const grobo_robot *robot, int joint);
/* True of a joint near the goal of its servo, which it may sag from, since it was told that goal or
 * since then, and which did not have the time to come to rest. */
bool grobo_i_may_sag(const grobo_robot *robot, int joint, int64_t since_us);

/* All joints of the model. */
grobo_joint_mask grobo_i_all_joints(const grobo_robot *robot);

/* The first of these joints, of which there is one at least. */
int grobo_i_lowest(grobo_joint_mask joints);
/* Goals that differ by no more are the same on the wire. */
double grobo_i_same_goal_rad(const grobo_robot *robot, int joint);
/* Where a trajectory is by then. */
double grobo_i_trajectory_at(const grobo_robot_trajectory *trajectory, int64_t now_us);
/* Where a joint is by now on the move it was sent on. */
double grobo_i_axis_commanded(const grobo_robot_axis *axis, int64_t now_us);
/* When it is there: on that move, or on the one its servo is on where it lost the frame. */
int64_t grobo_i_axis_until(const grobo_robot_axis *axis);
/* False where a joint is known to be there, or to be without torque. One that was told to let go
 * may not have heard it. */
bool grobo_i_axis_moves(const grobo_robot_axis *axis, int64_t now_us);
/* Where it was last asked to go, whether that frame has left or waits. */
double grobo_i_axis_target(const grobo_robot_axis *axis);
/* An angle this far from the trajectory that a joint was sent on is not of a joint on that
 * trajectory: more than what the fastest one does while a frame is on its trajectory. */
#define GROBO_I_OFF_TRAJECTORY_RAD (12 * 0.017453292519943295)
/* A servo that tells the time of its trajectory, and no speed, may hang so near its goal. */
#define GROBO_I_HANGS_RAD (5 * 0.017453292519943295)
/* So long after it was told a joint turns that can, and no frame is under way. */
#define GROBO_I_BEGUN_US 100000
/* grobo_robot_axis.seen_dps of a reading without a speed. */
#define GROBO_I_NO_SPEED INT16_MIN
/* True of servos that tell how fast they turn and which way, and not how long: what was read last
 * is all that is known of their turning. */
bool grobo_i_axis_tells_turn(const grobo_robot *robot, int joint);
/* Where a joint is now. What counts is where it was read and how it can have gone on from there:
 * it may be behind its trajectory by far, too weak for it or still turning the other way. A
 * reading from before the last frame that left to it says where it was then, and nothing of how
 * it turns now. */
double grobo_i_axis_place(const grobo_robot *robot, int joint);
/* How fast it turns by that, in radians a second. */
double grobo_i_axis_speed(const grobo_robot *robot, int joint);
/* How long it needs to come to rest, in microseconds; 0 of servos without ramps. */
double grobo_i_axis_brake_us(const grobo_robot *robot, int joint);
/* Where it comes to rest that is told so now, and no sooner than by then. */
double grobo_i_axis_reached(const grobo_robot *robot, int joint, int64_t rest_us);
/* What was read of where a joint is; and that it is told to go elsewhere from now on. */
void grobo_i_axis_seen(grobo_robot_axis *axis, int64_t asked_us, const grobo_joint_state *got);
void grobo_i_axis_told(grobo_robot *robot, int joint);
/* True of one that an angle alone has shown not to be at the end of its trajectory: it may turn. */
bool grobo_i_axis_is_late(const grobo_robot_axis *axis);
/* True of one whose trajectory is over and that was read not to be there yet, or lately to turn
 * and not to be on it. */
bool grobo_i_axis_lags(const grobo_robot *robot, int joint);
/* Takes the sensed angle for where a joint is, nothing being asked of it. */
void grobo_i_axis_rest(grobo_robot_axis *axis, int64_t now_us);
/* Takes what was read for where a joint is: at the angle, or on the move the servo told of. */
void grobo_i_axis_here(grobo_robot_axis *axis, int64_t now_us);
/* The limits of a joint: those of the model, or the narrower ones that its servo keeps. */
typedef struct grobo_i_limits {
    double min_rad, max_rad;
} grobo_i_limits;
grobo_i_limits grobo_i_joint_limits(const grobo_robot *robot, int joint);
/* False where a joint has a torque limit that its servo was not read to keep. */
bool grobo_i_torque_is_limited(const grobo_robot *robot, int joint);
/* True if it is known to have torque. */
bool grobo_i_axis_is_on(const grobo_robot_axis *axis);
/* True if it is known to have none, or to brake. */
bool grobo_i_axis_is_limp(const grobo_robot_axis *axis);
/* A servo that restarts hears nothing for longer: KRS find out for 500 ms how they are to be driven
 * (ICS 3.5 manual). Of the others the makers do not say. */
#define GROBO_I_RESTART_US 400000
/* True if its servo may have restarted since it was known to have torque, and its next goal would
 * wake it, wherever it sank to: nothing came from it for so long, or a reply was lost. */
bool grobo_i_may_sleep(const grobo_robot *robot, int joint);
/* True where nobody knows where a joint is: it was not read since the line is there, it was read
 * to turn beside its trajectory a while ago, or its servo may have restarted. A stop reads it
 * before it halts it. */
bool grobo_i_axis_is_unknown(const grobo_robot *robot, int joint);
/* False behind an emergency stop, which halts nobody where it takes the torque; of halts from
 * before it those alone leave that grobo_robot_latch() has found waiting. */
bool grobo_i_may_halt(const grobo_robot *robot);
/* The trajectory of a joint in segments ends where it was told to go. */
void grobo_i_axis_cut(grobo_robot_axis *axis);
/* True while a joint is on the trajectory it was sent on, or a target waits for the line. */
bool grobo_i_moving(const grobo_robot *robot, int64_t now_us);
/* True if one of these moves though nothing was asked of it, nobody knows where to; *joint is the
 * first of them, else -1. */
bool grobo_i_externally_moved(const grobo_robot *robot, grobo_joint_mask joints, int *joint);
/* True if all of these were sensed; else *joint is one that was not. */
bool grobo_i_all_sensed(const grobo_robot *robot, grobo_joint_mask joints, int *joint);
/* True if all of these are known to have torque. */
bool grobo_i_all_on(const grobo_robot *robot, grobo_joint_mask joints);

static inline bool grobo_i_near_rad(double a_rad, double b_rad, double within_rad)
{
    return fabs(a_rad - b_rad) <= within_rad;
}

#endif
