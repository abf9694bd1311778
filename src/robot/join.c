/* SPDX-License-Identifier: MIT */
/*
 * Programs ask joint by joint: torque on in a loop over all ids, an angle after the other. Where
 * each request had a job of its own, the first few would be carried out and the others refused: a
 * robot half on. Here a request joins one for other joints that was made just before, by the mask
 * of its joints, and shares its number: one job for all, with the frames of one.
 *
 * A job is joined before it has done anything that the joints of the request would miss:
 * - a reading and torque on, while it reads and has not read these joints, nor asked for them;
 * - a move of single joints, while it reads its joints, by moves of single other joints. In a job
 *   of its own a move with another time ends when it is there, so it joins only where all places
 *   are taken. Each joint has its time, and one that fails does not keep the others.
 * - torque off and brake, while its frames wait for the line: those that have not left are made
 *   anew for all. Where there is no room for another job, one that reads back begins anew.
 * A joint is joined once, so a job ends however many requests come. None goes before a request that
 * waits and has one of its joints.
 */
#include "src/base/assert.h"
#include "src/robot/job.h"
#include "src/robot/orders.h"
#include "src/robot/queue.h"
#include "src/robot/robot.h"
#include "src/robot/slot.h"

/* ---- moves, readings, torque on -------------------------------------------------------------- */

static void merge(grobo_posture *into, int32_t *into_us, const grobo_robot_request *from)
{
    for (int j = 0; j < from->target.n_joints; j++) {
        if (grobo_i_has(from->target.set, j)) {
            into->angle_rad[j] = from->target.angle_rad[j];
            into_us[j] = from->joint_time_us[j];
        }
    }
    into->set |= from->target.set;
}

/* True if no place is free for a move of its own, now or when those that wait begin: then moves of
 * other times join, too. */
static bool may_differ(const grobo_robot *robot)
{
    return !grobo_i_jobs_have_room(robot, false) || robot->queued >= GROBO_ROBOT_JOBS - 1;
}

/* Its first step: it reads its joints, of which it knows nothing yet. */
static bool reads_first(const grobo_robot_task *job)
{
    return job->at == 1 && job->activity == GROBO_I_READ;
}

static bool is_joinable(const grobo_robot *robot, const grobo_robot_task *job,
                        const grobo_robot_request *request)
{
    if (job->kind != request->kind || !reads_first(job)) {
        return false;
    }
    grobo_joint_mask known = job->joints | job->superseded | job->failed | job->out;
    if (request->kind == GROBO_JOB_MOVE) {
        return request->singly && job->singly && (known & request->joints) == 0 &&
               (job->target.time_us == request->target.time_us || may_differ(robot));
    }
    return (request->kind != GROBO_JOB_SENSE || job->sense == request->sense) &&
           (known & request->joints & ~job->todo) == 0 &&
           !grobo_i_slots_read(robot, job->number, request->joints);
}

static bool is_waited_for(const grobo_robot *robot, grobo_joint_mask joints)
{
    for (unsigned i = 0; i < robot->queued; i++) {
        if ((robot->queue[i].joints & joints) != 0) {
            return true;
        }
    }
    return false;
}

/* Joints that a job of these uses, which is not this one. */
static grobo_joint_mask used_beside(const grobo_robot *robot, const grobo_robot_task *job)
{
    grobo_joint_mask used = 0;
    for (int i = 0; i < GROBO_ROBOT_JOBS; i++) {
        const grobo_robot_task *other = &robot->jobs[i];
        bool joins = other->kind == GROBO_JOB_NONE || other->kind == GROBO_JOB_SENSE ||
                     (other->kind == GROBO_JOB_MOVE && job->kind == GROBO_JOB_MOVE);
        used |= joins || other == job || job->kind == GROBO_JOB_SENSE ? 0 : other->joints;
    }
    return used;
}

int grobo_i_join_job(grobo_robot *robot, const grobo_robot_request *request)
{
    grobo_robot_task *job = robot->jobs;
    while (job < robot->jobs + GROBO_ROBOT_JOBS && !is_joinable(robot, job, request)) {
        job++;
    }
    if (job == robot->jobs + GROBO_ROBOT_JOBS || is_waited_for(robot, request->joints) ||
        (used_beside(robot, job) & request->joints) != 0) {
        return 0;
    }
    if (request->kind == GROBO_JOB_MOVE) {
        grobo_i_jobs_leave(robot, request->joints);
        merge(&job->target, job->joint_time_us, request);
    }
    if (request->kind != GROBO_JOB_SENSE) {
        robot->free_joints &= ~request->joints;
    }
    job->todo |= request->joints;
    job->joints |= request->joints;
    return job->number;
}

int grobo_i_join_waiting(grobo_robot *robot, const grobo_robot_request *request)
{
    bool moves = request->kind == GROBO_JOB_MOVE;
    for (unsigned i = robot->queued; i-- > 0;) {
        grobo_robot_request *other = &robot->queue[i];
        bool overlaps = (other->joints & request->joints) != 0;
        bool alike = other->kind == request->kind && other->sense == request->sense;
        bool singly = request->singly && other->singly && !overlaps &&
                      (other->target.time_us == request->target.time_us || may_differ(robot));
        if (alike && (!moves || singly)) {
            other->joints |= request->joints;
            if (moves) { /* other kinds have no target */
                merge(&other->target, other->joint_time_us, request);
            }
            return other->number;
        }
        if (overlaps) {
            return 0;
        }
    }
    return 0;
}

/* ---- torque off and brake -------------------------------------------------------------------- */

/* Its second step has made its frames, and they go out. */
static bool sends(const grobo_robot_task *job)
{
    return job->at == 2 && job->activity == GROBO_I_DRAIN && job->rounds == 0;
}

static void send_with(grobo_robot *robot, grobo_robot_task *job, grobo_joint_mask joints)
{
    grobo_robot_task *current = robot->job;
    grobo_joint_mask waiting = grobo_i_slots_take_back(robot, job->number);
    job->joints |= joints;
    job->pending |= joints;
    robot->job = job;
    robot->acting = job->number;
    /* What finds no room is as what is lost: it is read back, and sent again. */
    (void)grobo_i_gate_torque(robot, waiting | joints, job->torque, GROBO_I_WHOLE);
    robot->acting = 0;
    robot->job = current;
}

static void begin_anew(grobo_robot *robot, grobo_robot_task *job, grobo_joint_mask joints)
{
    grobo_i_slots_cancel_job(robot, job->number);
    job->joints |= joints;
    job->todo = 0;
    job->at = 0;
    job->activity = GROBO_I_NEXT;
    grobo_i_job_run(robot);
}

int grobo_i_join_off(grobo_robot *robot, grobo_joint_mask joints, grobo_torque mode, bool sent)
{
    GROBO_ASSERT(mode != GROBO_TORQUE_ON && robot->acting == 0);
    for (int i = 0; i < GROBO_ROBOT_JOBS; i++) {
        grobo_robot_task *job = &robot->jobs[i];
        bool same = job->kind == GROBO_JOB_TORQUE && job->torque == mode;
        if (!same || (!sent && !sends(job))) {
            continue;
        }
        int number = job->number;
        grobo_joint_mask more = joints & ~job->joints;
        if (more != 0) {
            grobo_i_jobs_leave(robot, more);
        }
        if (sent) {
            begin_anew(robot, job, more);
        } else if (more != 0) {
            send_with(robot, job, more);
        }
        return number;
    }
    return 0;
}
