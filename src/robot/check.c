/* SPDX-License-Identifier: MIT */
/* Whether the robot is there: the script of a check. Each line of a robot is asked after the one
 * before has answered, and all must answer. */
#include "src/robot/job.h"
#include "src/robot/lines.h"
#include "src/robot/slot.h"
#include "src/robot/steps.h"

#if GROBO_LINES_MAX > 1
static int line_of_check(const grobo_robot *robot)
{
    return robot->check_line;
}

static int check_part(grobo_robot *robot, int part)
{
    return grobo_i_lines_check(robot, part);
}

static bool goes_to_next_line(grobo_robot *robot)
{
    robot->check_line++;
    return robot->check_line < grobo_i_lines(robot);
}

static int step_check_begin(grobo_robot *robot)
{
    robot->check_line = 0;
    return GROBO_I_NEXT;
}
#else
static int line_of_check(const grobo_robot *robot)
{
    (void)robot;
    return 0;
}

static int check_part(grobo_robot *robot, int part)
{
    return robot->driver->check(robot->driver, robot->driver_ctx, part, &robot->built);
}

static bool goes_to_next_line(const grobo_robot *robot)
{
    (void)robot;
    return false;
}
#endif

static int step_check(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    grobo_robot_slot *slot = grobo_i_slot_take(robot, GROBO_I_USE_JOB);
    if (slot == NULL) {
        return GROBO_ERR_FULL;
    }
    int more = check_part(robot, job->part);
    grobo_i_slot_on(slot, line_of_check(robot));
    if (more > 0) {
        slot->order = job->order;
        slot->txn.start_by_us = job->leave_by_us;
        more = grobo_i_slot_send(slot, &robot->built, job->priority);
        return more < 0 ? more : GROBO_I_ASK;
    }
    grobo_i_slot_drop(slot);
    return more < 0 ? more : job->part == 0 ? GROBO_ERR_UNSUPPORTED : job->result;
}

static int step_check_next(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    bool failed = job->result < 0;
    if (failed || goes_to_next_line(robot)) {
        job->part = failed ? job->part + 1 : 0;
        grobo_i_job_goto(robot, step_check);
    }
    return GROBO_I_NEXT;
}

const grobo_robot_step_fn grobo_i_script_check[] = {
#if GROBO_LINES_MAX > 1
    step_check_begin,
#endif
    step_check, step_check_next, NULL};
