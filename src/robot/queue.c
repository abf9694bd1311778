/* SPDX-License-Identifier: MIT */
/*
 * Which jobs run side by side, and what waits for its turn. Moves, readings, torque, registers and
 * raw frames of different joints do not disturb each other; a reading disturbs nobody. A move takes
 * its joints from the move before it. What else there is has the robot for itself. Moves, readings
 * and torque on that cannot begin yet wait, in their order; join.c joins them.
 */
#include <string.h>

#include "src/base/assert.h"
#include "src/base/instant.h"
#include "src/robot/job.h"
#include "src/robot/query.h"
#include "src/robot/queue.h"
#include "src/robot/steps.h"
#include "src/robot/stop.h"

/* ---- side by side ---------------------------------------------------------------------------- */

static bool is_alone(const grobo_robot_task *job)
{
    return !grobo_i_job_is_shared(job->kind);
}

/* Joints that jobs use in another way than this kind could join in. */
static grobo_joint_mask taken_from(const grobo_robot *robot, grobo_job_kind kind)
{
    grobo_joint_mask taken = 0;
    for (int i = 0; i < GROBO_ROBOT_JOBS; i++) {
        const grobo_robot_task *job = &robot->jobs[i];
        bool joins = job->kind == GROBO_JOB_NONE || job->kind == GROBO_JOB_SENSE ||
                     (job->kind == GROBO_JOB_MOVE && kind == GROBO_JOB_MOVE);
        taken |= joins || kind == GROBO_JOB_SENSE ? 0 : job->joints;
    }
    return taken;
}

int grobo_i_admit(grobo_robot *robot, grobo_job_kind kind, grobo_joint_mask joints, bool moves)
{
    if (!robot->link) {
        return GROBO_ERR_CLOSED;
    }
    grobo_i_make_way(robot);
    if (kind != GROBO_JOB_SENSE) {
        grobo_i_jobs_end(robot, grobo_i_move_settles, GROBO_OK);
    }
    grobo_i_jobs_close_up(robot);
    if (moves && grobo_i_is_latched(robot)) {
        return GROBO_ERR_LATCHED;
    }
    bool apart = !grobo_i_job_is_shared(kind) && grobo_i_jobs_any(robot, NULL);
    if (apart || grobo_i_jobs_any(robot, is_alone) || !grobo_i_jobs_have_room(robot, false) ||
        (taken_from(robot, kind) & joints) != 0) {
        return GROBO_I_LATER;
    }
    return GROBO_OK;
}

grobo_joint_mask grobo_i_joints_of_moves(const grobo_robot *robot)
{
    grobo_joint_mask joints = 0;
    for (int i = 0; i < GROBO_ROBOT_JOBS; i++) {
        joints |= robot->jobs[i].kind == GROBO_JOB_MOVE ? robot->jobs[i].joints : 0;
    }
    for (unsigned i = 0; i < robot->queued; i++) {
        joints |= robot->queue[i].kind == GROBO_JOB_MOVE ? robot->queue[i].joints : 0;
    }
    return joints;
}

/* ---- moves, readings, torque on -------------------------------------------------------------- */

/* What a motion sets is the motion's; who wants to move that stops it first. */
static bool is_played(const grobo_robot *robot, grobo_joint_mask joints)
{
    return grobo_i_is_playing(robot) && (robot->clip_joints & joints) != 0;
}

int grobo_i_move_takes(grobo_robot *robot, grobo_joint_mask joints)
{
    if ((taken_from(robot, GROBO_JOB_MOVE) & joints) != 0 || is_played(robot, joints)) {
        return GROBO_ERR_STATE;
    }
    if (joints != 0) {
        grobo_i_jobs_leave(robot, joints);
    }
    return GROBO_OK;
}

static int admit(grobo_robot *robot, const grobo_robot_request *request)
{
    bool moves = request->kind != GROBO_JOB_SENSE;
    int result = grobo_i_admit(robot, request->kind, request->joints, moves);
    if (result < 0) {
        return result;
    }
    /* Frames of a motion would part goal and present angle of what gets torque again. */
    bool played = request->kind == GROBO_JOB_TORQUE ? grobo_i_is_playing(robot)
                                                    : is_played(robot, request->joints);
    bool leaving = robot->job->kind == GROBO_JOB_EXIT || robot->job->kind == GROBO_JOB_ESTOP;
    return moves && (played || leaving) ? GROBO_ERR_STATE : result;
}

/* Torque on waits for other torque and for a place, and is refused while its joints do anything
 * else. */
static bool may_wait(const grobo_robot *robot, const grobo_robot_request *request)
{
    bool busy = false;
    for (int i = 0; i < GROBO_ROBOT_JOBS; i++) {
        const grobo_robot_task *job = &robot->jobs[i];
        bool joins = job->kind == GROBO_JOB_NONE || job->kind == GROBO_JOB_SENSE ||
                     job->kind == GROBO_JOB_TORQUE;
        busy = busy || (!joins && (is_alone(job) || (job->joints & request->joints) != 0));
    }
    return request->kind != GROBO_JOB_TORQUE || !busy;
}

static const grobo_robot_step_fn *script_of(grobo_job_kind kind)
{
    return kind == GROBO_JOB_MOVE     ? grobo_i_script_move
           : kind == GROBO_JOB_TORQUE ? grobo_i_script_torque_on
                                      : grobo_i_script_sense;
}

static int begin(grobo_robot *robot, const grobo_robot_request *request)
{
    if (request->kind == GROBO_JOB_MOVE) {
        grobo_i_jobs_leave(robot, request->joints);
        grobo_i_jobs_close_up(robot);
    }
    if (request->kind != GROBO_JOB_SENSE) {
        robot->free_joints &= ~request->joints;
    }
    int number = grobo_i_job_start(robot, request->kind, script_of(request->kind), request->number);
    robot->job->joints = request->joints;
    if (request->kind == GROBO_JOB_MOVE) {
        robot->job->target = request->target;
    } else {
        robot->job->target.set = 0;
        robot->job->target.time_us = 0;
    }
    robot->job->sense = request->sense;
    robot->job->torque = GROBO_TORQUE_ON;
    robot->job->singly = request->singly;
    if (request->singly) {
        memcpy(robot->job->joint_time_us, request->joint_time_us, sizeof request->joint_time_us);
    }
    grobo_i_job_run(robot);
    return number;
}

/* Of the events that may wait, so many are kept for the ends of what runs and waits, and for what
 * a stop tells. */
#define EVENTS_TO_END (GROBO_ROBOT_JOBS + GROBO_ROBOT_QUEUE + 4)

int grobo_i_queue_ask(grobo_robot *robot, const grobo_robot_request *request)
{
    int result = admit(robot, request);
    if (result < 0) {
        return result;
    }
    bool some = robot->jobs[0].kind != GROBO_JOB_NONE; /* where one runs, the first does */
    int joined = some ? grobo_i_join_job(robot, request) : 0;
    if (joined == 0 && result == GROBO_I_LATER && !may_wait(robot, request)) {
        return GROBO_ERR_STATE;
    }
    joined = joined != 0 ? joined : grobo_i_join_waiting(robot, request);
    if (joined != 0) {
        return joined;
    }
    if (result >= 0 && robot->events_n >= GROBO_ROBOT_EVENTS - EVENTS_TO_END) {
        result = GROBO_ERR_FULL; /* the pump has not told for long what has ended */
    }
    if (result < 0) {
        return result;
    }
    if (result == GROBO_OK && robot->queued == 0) {
        return begin(robot, request);
    }
    if (robot->queued == GROBO_ROBOT_QUEUE) {
        return GROBO_ERR_FULL;
    }
    grobo_robot_request *last = &robot->queue[robot->queued++];
    *last = *request;
    last->number = grobo_i_job_number(robot);
    last->begin_by_us = robot->now_us + GROBO_ROBOT_QUEUE_US;
    return last->number;
}

void grobo_i_queue_step(grobo_robot *robot)
{
    robot->queue_may_go = false;
    while (robot->queued > 0) {
        grobo_robot_request first = robot->queue[0];
        int result = robot->now_us < first.begin_by_us ? admit(robot, &first) : GROBO_ERR_STALE;
        if (result == GROBO_I_LATER) {
            return;
        }
        robot->queued--;
        memmove(&robot->queue[0], &robot->queue[1], robot->queued * sizeof robot->queue[0]);
        if (result == GROBO_OK) {
            (void)begin(robot, &first);
        } else {
            grobo_i_queue_tell(robot, &first, result);
        }
    }
}

int64_t grobo_i_queue_deadline(const grobo_robot *robot)
{
    if (robot->queued == 0) {
        return GROBO_NEVER_US;
    }
    return robot->queue_may_go ? robot->now_us : robot->queue[0].begin_by_us;
}
