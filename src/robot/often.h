/* SPDX-License-Identifier: MIT */
/* How often joints are read while one moves or is strained (often.c). A build for plain drivers
 * reads them as at rest. */
#ifndef GROBO_ROBOT_OFTEN_H
#define GROBO_ROBOT_OFTEN_H

#include <grobo/core/static.h>

#if GROBO_DRIVERS_PLAIN
static inline bool grobo_i_often(const grobo_robot *robot)
{
    (void)robot;
    return false;
}
static inline int64_t grobo_i_often_interval(const grobo_robot *robot, int64_t rest_us)
{
    (void)robot;
    return rest_us;
}
static inline int64_t grobo_i_often_rest(const grobo_robot *robot, int64_t rest_us)
{
    return grobo_i_often_interval(robot, rest_us);
}
static inline void grobo_i_often_soon(const grobo_robot *robot)
{
    (void)robot;
}
#else
/* True while joints are read more often than they have to be. */
bool grobo_i_often(const grobo_robot *robot);
/* How often all joints are read at rest: rest_us, or what the watchdog of wheels needs. */
int64_t grobo_i_often_rest(grobo_robot *robot, int64_t rest_us);
/* How often all joints are read; rest_us: at rest. */
int64_t grobo_i_often_interval(grobo_robot *robot, int64_t rest_us);
/* A joint is sent somewhere: the next reading is that near. */
void grobo_i_often_soon(grobo_robot *robot);
/* A joint is strained, or no more. */
void grobo_i_often_strained(grobo_robot *robot, int joint, bool strained);
#endif

#endif
