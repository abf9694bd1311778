/* SPDX-License-Identifier: MIT */
/*
 * How often joints are read while one moves, or is strained: further from its set point than its
 * load explains (blocked.c). A line that has no time for that is read as at rest.
 */
#include "src/base/instant.h"
#include "src/robot/axis.h"
#include "src/robot/budget.h"
#include "src/robot/often.h"
#include "src/robot/query.h"
#include "src/robot/robot.h"
#include "src/robot/wheel.h"

#if !GROBO_DRIVERS_PLAIN

/* Joints are read so often while one moves, or one is strained; half of the line's time at most. */
#define MOVES_US 100000
#define STRAINED_US 50000
#define LINE_PART 2
/* Servos of wheels that have a watchdog are heard so often in its time: it may be as short as it
 * should be, and does not go off where wheels stand. */
#define WHEELS_PART 3

/* In which all joints are read with half of the line's time. */
static int64_t line_us(grobo_robot *robot)
{
    const grobo_driver *driver = robot->driver;
    if (robot->line_us == 0) {
        uint32_t one_us = 0;
        const grobo_i_line line = grobo_i_line_of_robot(robot);
        (void)grobo_i_reading_cost(&line, &one_us);
        int readings = driver->sense_many != NULL ? 1 : driver->model->n_joints;
        robot->line_us = LINE_PART * (int64_t)one_us * readings;
    }
    return robot->line_us;
}

static bool wheels_move(const grobo_robot *robot)
{
    bool move = false;
    for (int j = 0; robot->wheels != 0 && j < robot->driver->model->n_joints; j++) {
        move = move || (grobo_i_is_wheel(robot, j) && grobo_i_wheel_moves(&robot->axes[j]));
    }
    return move;
}

bool grobo_i_often(const grobo_robot *robot)
{
    bool moves = grobo_i_in_motion(robot) && grobo_i_moving(robot, robot->now_us);
    moves = moves || wheels_move(robot);
    bool full = grobo_i_is_playing(robot) && robot->line_us > MOVES_US;
    return (robot->strained != 0 || moves) && !full && !robot->trip.latched;
}

int64_t grobo_i_often_rest(grobo_robot *robot, int64_t rest_us)
{
    int64_t most_us = grobo_i_later(robot->driver->watchdog_us / WHEELS_PART, line_us(robot));
    bool watched = robot->wheels != 0 && robot->driver->watchdog != NULL &&
                   robot->driver->watchdog_us > 0 && rest_us != GROBO_SENSE_NEVER;
    return watched ? grobo_i_sooner(rest_us, most_us) : rest_us;
}

int64_t grobo_i_often_interval(grobo_robot *robot, int64_t rest_us)
{
    rest_us = grobo_i_often_rest(robot, rest_us);
    if (!grobo_i_often(robot)) {
        return rest_us;
    }
    int64_t often_us = grobo_i_later(robot->strained != 0 ? STRAINED_US : MOVES_US, line_us(robot));
    return grobo_i_sooner(often_us, rest_us);
}

void grobo_i_often_soon(grobo_robot *robot)
{
    int64_t next_us = robot->now_us + grobo_i_later(STRAINED_US, line_us(robot));
    if (robot->config.sense_interval_us != GROBO_SENSE_NEVER && grobo_i_often(robot)) {
        robot->sense_us = grobo_i_sooner(robot->sense_us, next_us);
    }
}

void grobo_i_often_strained(grobo_robot *robot, int joint, bool strained)
{
    grobo_joint_mask bit = GROBO_JOINT_BIT(joint);
    if (strained && !grobo_i_has(robot->strained, joint)) {
        grobo_i_often_soon(robot);
    }
    robot->strained = strained ? robot->strained | bit : robot->strained & ~bit;
}

#endif
