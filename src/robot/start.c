/* SPDX-License-Identifier: MIT */
/* A motion that waits for its start: for who begins several robots together. */
#include "src/robot/robot.h"

bool grobo_robot_is_ready(const grobo_robot *robot)
{
    if (robot == NULL) {
        return false;
    }
    grobo_i_lock(robot);
    bool ready = grobo_sequencer_is_ready(&robot->sequencer);
    grobo_i_unlock(robot);
    return ready;
}

int grobo_robot_start_at(grobo_robot *robot, int64_t start_us)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    int result = robot->trip.latched
                     ? GROBO_ERR_LATCHED
                     : grobo_sequencer_start_at(&robot->sequencer, start_us, robot->now_us);
    grobo_i_end(robot);
    return result;
}
