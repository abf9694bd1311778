/* SPDX-License-Identifier: MIT */
/* A motion that waits for its start: for who begins several robots together. */
#include <grobo/core/robot.h>

#include "src/robot/query.h"
#include "src/robot/turn.h"

int grobo_robot_start_at(grobo_robot *robot, int64_t start_us)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    int result = grobo_i_is_latched(robot)
                     ? GROBO_ERR_LATCHED
                     : grobo_sequencer_start_at(&robot->sequencer, start_us, robot->now_us);
    grobo_i_end(robot);
    return result;
}
