/* SPDX-License-Identifier: MIT */
/* What may be asked, and the lock around it (query.c). */
#ifndef GROBO_ROBOT_QUERY_I_H
#define GROBO_ROBOT_QUERY_I_H

#include <grobo/core/static.h>

/* Around whatever is told or asked of the engine, where several threads may; see
 * grobo_robot_host. Functions where a word has 32 bits: code is short there. */
#if SIZE_MAX > UINT32_MAX
static inline void grobo_i_lock(const grobo_robot *robot)
{
    if (robot->host.lock != NULL) {
        robot->host.lock(robot->host.ctx);
    }
}
static inline void grobo_i_unlock(const grobo_robot *robot)
{
    if (robot->host.unlock != NULL) {
        robot->host.unlock(robot->host.ctx);
    }
}
#else
void grobo_i_lock(const grobo_robot *robot);
void grobo_i_unlock(const grobo_robot *robot);
#endif
/* The time of a request or a question. */
int64_t grobo_i_now(const grobo_robot *robot);

/* True if requests that move are refused: behind a latched stop, and one that is on its
 * trajectory. */
bool grobo_i_is_latched(const grobo_robot *robot);

/* True if a frame waits that the wire has time for now; `any`: or any, and the line is free. */
bool grobo_i_has_frame(const grobo_robot *robot, int line, bool any, int64_t now_us);

/* True if the frame that has just left stops joints. */
bool grobo_i_frame_stops(const grobo_robot *robot, int line);
/* grobo_robot_stops() of a line. */
bool grobo_i_stops(const grobo_robot *robot, int line, int64_t now_us);

/* True if that is true of a job that runs; NULL: if one runs. */
bool grobo_i_jobs_any(const grobo_robot *robot, bool (*is)(const grobo_robot_task *job));

/* grobo_robot_is_playing() for the engine itself, which is locked. */
bool grobo_i_is_playing(const grobo_robot *robot);

/* True while there are events that were not told. */
bool grobo_i_has_to_tell(const grobo_robot *robot);

/* True while joints are being moved, by a job or by the sequencer. */
bool grobo_i_in_motion(const grobo_robot *robot);

#endif
