/* SPDX-License-Identifier: MIT */
/* The only way to motors: judges and notes each order as its frame leaves (gate.c). */
#ifndef GROBO_ROBOT_GATE_I_H
#define GROBO_ROBOT_GATE_I_H

#include <grobo/core/static.h>

#include "src/robot/axis.h"
#include "src/robot/reading.h"
#include "src/robot/robot.h"
#include "src/robot/state.h"

/* A servo that is told a speed comes to rest at this one at least: a joint a degree beside where it
 * is taken to be would creep there. */
#define GROBO_I_REST_RAD_S (20 * 0.017453292519943295)

/* The frame of this slot would leave now: judges its order, builds the frame anew from it, and
 * notes what it does. @return 0, or why it must not leave: then nothing is noted. */
int grobo_i_gate_leave(grobo_robot_slot *slot);
/* The same judgement now, when a frame is asked for. */
int grobo_i_gate_judge(grobo_robot *robot, const grobo_robot_order *order,
                       const grobo_exchange *exchange);
/* Reads and judges a raw frame. *order is its order then. */
int grobo_i_gate_raw(grobo_robot *robot, const grobo_exchange *exchange, grobo_robot_order *order);
/* Judges, and builds part order->part of a GOAL, HALT, HOLD or TORQUE, as long as it may be when it
 * leaves; a GOAL in the call that has judged its target, grobo_i_gate_send(). Sets order->stands.
 * @return 1, or 0 where the driver has none; GROBO_ERR_CAP: several joints do not fit one frame. */
int grobo_i_gate_build(grobo_robot *robot, grobo_robot_order *order, grobo_exchange *exchange);
/* The targets of this order wait no more: they have left, or never will. */
void grobo_i_gate_unwait(grobo_robot *robot, const grobo_robot_order *order);
/* True if the engine cannot know whether the joint moves: its servo reports no speed, and it was
 * not sent anywhere. */
static inline bool grobo_i_is_mute(const grobo_robot *robot, int joint)
{
    return GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed) &&
           !grobo_i_has_target(&robot->axes[joint]);
}
/* True if it was read to turn so slowly that it may as well tremble, and was not sent anywhere. */
static inline bool grobo_i_may_creep(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    return !GROBO_DRIVERS_PLAIN && !grobo_i_has_target(axis) && axis->seen_dps != 0 &&
           axis->seen_dps != GROBO_I_NO_SPEED && axis->seen_dps < GROBO_I_SLOW_DPS &&
           axis->seen_dps > -GROBO_I_SLOW_DPS;
}
/* True if the goal read back is the one that holds. */
bool grobo_i_goal_holds(const grobo_robot *robot, int joint);
/* Holds a goal this far from the angle to be the angle, for switching torque on. */
#define GROBO_I_HOLD_NEAR_DEG 2.0
/* How far outside its limits a joint may stand to be switched on; it is drawn to the limit. */
#define GROBO_I_HOLD_OUTSIDE_DEG 3.0

#endif
