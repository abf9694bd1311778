/* SPDX-License-Identifier: MIT */
/* The queue of events. */
#include "src/robot/robot.h"

void grobo_i_tell(grobo_robot *robot, const grobo_event *event)
{
    if (robot->events_n == GROBO_ROBOT_EVENTS ||
        (event->kind == GROBO_EVENT_JOINT && robot->events_n >= GROBO_ROBOT_EVENTS / 2)) {
        robot->counters.lost_events++;
        return;
    }
    grobo_event *place =
        &robot->events[(robot->events_head + robot->events_n) % GROBO_ROBOT_EVENTS];
    *place = *event;
    place->now_us = robot->now_us;
    robot->events_n++;
}
