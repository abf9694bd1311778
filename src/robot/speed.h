/* SPDX-License-Identifier: MIT */
/* Limits of targets, and the least times of trajectories (speed.c). */
#ifndef GROBO_ROBOT_SPEED_H
#define GROBO_ROBOT_SPEED_H

#include <grobo/core/static.h>

/* Gives every joint of a target as much more time as it needs from where it is now.
 * @return 0, or GROBO_ERR_SPEED where the wire has no time that is long enough. */
int grobo_i_gate_time(grobo_robot *robot, const grobo_robot_order *order, grobo_target *target);
/* Has joints follow others, and checks numbers and limits of a target; clamps if so configured. The
 * fault is kept for grobo_robot_fault(). @return 0, GROBO_ERR_NAN, _LIMIT, _ARG. */
int grobo_i_gate_target(grobo_robot *robot, grobo_posture *target);
/* The next move is the first from a sensed posture: a slow one. */
void grobo_i_gate_soften(grobo_robot *robot);
/* How long a whole goal takes then, from where the joints are now; GROBO_NEVER_US where the wire
 * has no time that is long enough. */
int64_t grobo_i_gate_soft_us(const grobo_robot *robot, const grobo_posture *target);
/* Before a target of a caller's own stream, from his loop or as a raw frame: the first of them is
 * the slow one. */
void grobo_i_gate_single(grobo_robot *robot);

/* ---- for the judgement of an order (gate.c) -------------------------------------------------- */

/* A halt: joints stop where they are so long after it was asked for, or so long after it leaves if
 * that is later, so that none is thrown back; at half the speed. */
#define GROBO_I_HALT_AHEAD_US 50000
#define GROBO_I_HALT_LEAST_US 25000
#define GROBO_I_HALT_TIME_US 100000

/* grobo_posture_check() and grobo_posture_clamp() by the limits that hold: those of the model, or
 * the narrower ones that the servo keeps. */
int grobo_i_target_check(const grobo_robot *robot, const grobo_posture *target, int *joint);
int grobo_i_target_clamp(const grobo_robot *robot, grobo_posture *target);
/* The speed that a joint may have, in rad/s; soft: the approach speed at most. */
double grobo_i_speed_limit(const grobo_robot *robot, int joint, bool soft);
/* Where the trajectory of an order begins: for one that brings a joint to rest where the joint is,
 * for any other where its trajectory before is by now. */
double grobo_i_begin_of(const grobo_robot *robot, const grobo_robot_order *order, int joint);
/* The least time of a trajectory, in microseconds. */
double grobo_i_trajectory_us(const grobo_robot *robot, int joint, double from_rad, double to_rad,
                             bool soft);

#endif
