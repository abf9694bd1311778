/* SPDX-License-Identifier: MIT */
/* The begin and the end of a call and of a frame, and what always holds then (turn.c, holds.c). */
#ifndef GROBO_ROBOT_TURN_I_H
#define GROBO_ROBOT_TURN_I_H

#include <grobo/core/static.h>

/* Every call of the pump that may change something stands between these two: the outermost leave
 * tells the events, without the lock. */
void grobo_i_enter(grobo_robot *robot, int64_t now_us);
void grobo_i_leave(grobo_robot *robot);
/* The same around every request. Where a host is woken, the pump tells the events. */
void grobo_i_begin(grobo_robot *robot);
void grobo_i_end(grobo_robot *robot);
/* One of several joints has answered: grobo_robot.each. */
void grobo_i_reply_came(grobo_robot_slot *slot, const grobo_packet *reply);
/* A frame is over: grobo_robot.over. The slot is a copy. */
void grobo_i_frame_over(grobo_robot_slot *slot, int result, const grobo_packet *reply);

/* Asserts what always holds between two calls; nothing with NDEBUG. */
void grobo_i_robot_assert(const grobo_robot *robot);

#endif
