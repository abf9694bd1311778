/* SPDX-License-Identifier: MIT */
/* Runs the script of a job: one step after the other, waiting where a step says so. */
#include <string.h>

#include "src/base/assert.h"
#include "src/base/instant.h"
#include "src/robot/axis.h"
#include "src/robot/job.h"
#include "src/robot/orders.h"
#include "src/robot/robot.h"
#include "src/robot/slot.h"
#include "src/robot/state.h"

/* ---- which jobs there are -------------------------------------------------------------------- */

bool grobo_i_job_is_shared(grobo_job_kind kind)
{
    return kind == GROBO_JOB_MOVE || kind == GROBO_JOB_SENSE || kind == GROBO_JOB_TORQUE ||
           kind == GROBO_JOB_RAW || kind == GROBO_JOB_REGISTERS;
}

int grobo_i_job_number(grobo_robot *robot)
{
    robot->last_number = robot->last_number == INT32_MAX ? 1 : robot->last_number + 1;
    return robot->last_number;
}

static grobo_robot_task *free_job(grobo_robot *robot, int n)
{
    for (int i = 0; i < n; i++) {
        if (robot->jobs[i].kind == GROBO_JOB_NONE) {
            return &robot->jobs[i];
        }
    }
    return NULL;
}

bool grobo_i_jobs_have_room(const grobo_robot *robot, bool last)
{
    int n = last ? GROBO_ROBOT_JOBS : GROBO_ROBOT_JOBS - 1;
    for (int i = 0; i < n; i++) {
        if (robot->jobs[i].kind == GROBO_JOB_NONE) {
            return true;
        }
    }
    return false;
}

int grobo_i_job_start(grobo_robot *robot, grobo_job_kind kind, const grobo_robot_step_fn *script,
                      int number)
{
    grobo_robot_task *job = free_job(robot, GROBO_ROBOT_JOBS);
    GROBO_ASSERT(job != NULL && kind != GROBO_JOB_NONE);
    robot->job = job;
    job->script = script;
    job->number = number != 0 ? number : grobo_i_job_number(robot);
    job->kind = kind;
    job->at = 0;
    job->activity = GROBO_I_NEXT;
    job->result = GROBO_OK;
    job->joint = -1;
    job->value = 0;
    job->joints = job->superseded = job->todo = 0;
    job->failed = job->pending = 0;
    job->order = (grobo_robot_order){0};
    job->leave_by_us = 0;
    job->sense = GROBO_SENSE_ALL;
    job->priority = GROBO_PRIORITY_USER;
    job->part = job->rounds = job->restarts = 0;
    job->reply_bytes = 0;
    job->begun_us = robot->now_us;
    job->until_us = job->bound_us = GROBO_NEVER_US;
    job->lets_go = job->sits = job->singly = false;
    job->out = job->turned = 0;
    return job->number;
}

void grobo_i_job_end(grobo_robot *robot, int result)
{
    grobo_robot_task *job = robot->job;
    GROBO_ASSERT(job->kind != GROBO_JOB_NONE && result <= GROBO_OK);
    /* An error that is not one joint's: nothing shows that any of them is done. */
    bool whole = result < 0 && (result != job->result || job->failed == 0);
    if (result == GROBO_OK && job->out != 0) {
        result = job->out_result;
        job->joint = job->out_joint;
        job->value = job->out_value;
    }
    if (result == GROBO_OK && job->superseded != 0) {
        result = GROBO_ERR_SUPERSEDED;
    }
    grobo_event event = {.kind = GROBO_EVENT_JOB};
    event.u.job.number = job->number;
    event.u.job.kind = job->kind;
    event.u.job.result = result;
    event.u.job.joint = job->joint;
    event.u.job.value = job->value;
    event.u.job.failed = job->failed | job->superseded | job->out | (whole ? job->joints : 0);
    event.u.job.data = robot->reply;
    event.u.job.size = job->reply_bytes;
    if (job->kind == GROBO_JOB_ESTOP && result != GROBO_ERR_UNPLUGGED) {
        robot->stop_owed = false;
    }
    job->kind = GROBO_JOB_NONE;
    robot->queue_may_go = true;
    grobo_i_slots_cancel_job(robot, job->number);
    if (event.u.job.kind != GROBO_JOB_SETTLE) {
        grobo_i_tell(robot, &event);
    }
}

void grobo_i_jobs_end(grobo_robot *robot, bool (*is)(const grobo_robot_task *job), int result)
{
    grobo_robot_task *current = robot->job;
    for (int i = 0; i < GROBO_ROBOT_JOBS; i++) {
        robot->job = &robot->jobs[i];
        if (robot->job->kind != GROBO_JOB_NONE && (is == NULL || is(robot->job))) {
            grobo_i_job_end(robot, result);
        }
    }
    robot->job = current;
}

/* Frames of its own that carry joints of both are lost, too: a move sends again what was not
 * taken. */
void grobo_i_jobs_leave(grobo_robot *robot, grobo_joint_mask joints)
{
    grobo_robot_task *current = robot->job;
    for (int i = 0; i < GROBO_ROBOT_JOBS; i++) {
        grobo_robot_task *job = &robot->jobs[i];
        grobo_joint_mask left = job->joints & joints;
        bool leaves = job->kind == GROBO_JOB_MOVE || job->kind == GROBO_JOB_TORQUE;
        if (!leaves || left == 0) {
            continue;
        }
        job->superseded |= left;
        job->joints &= ~left;
        job->target.set &= ~left;
        job->todo &= ~left;
        job->pending &= ~left;
        job->failed &= ~left;
        job->result = job->failed == 0 ? GROBO_OK : job->result;
        robot->job = job;
        if (job->joints == 0) {
            grobo_i_job_end(robot, GROBO_OK);
        }
    }
    robot->job = current;
    grobo_i_slots_cancel_goals(robot, joints, false);
}

void grobo_i_queue_tell(grobo_robot *robot, const grobo_robot_request *request, int result)
{
    grobo_event event = {.kind = GROBO_EVENT_JOB};
    event.u.job = (grobo_event_job){
        .number = request->number, .kind = request->kind, .result = result, .joint = -1};
    event.u.job.failed = request->joints;
    grobo_i_tell(robot, &event);
}

void grobo_i_queue_end(grobo_robot *robot, int result)
{
    for (unsigned i = 0; i < robot->queued; i++) {
        grobo_i_queue_tell(robot, &robot->queue[i], result);
    }
    robot->queued = 0;
}

void grobo_i_job_fail_joint(grobo_robot *robot, int joint, int error, double value)
{
    grobo_robot_task *job = robot->job;
    GROBO_ASSERT(error < 0 && joint >= 0 && joint < robot->driver->model->n_joints);
    if (job->failed == 0) {
        job->result = error;
        job->joint = joint;
        job->value = value;
    }
    job->failed |= GROBO_JOINT_BIT(joint);
}

void grobo_i_job_give_up(grobo_robot *robot, grobo_joint_mask joints)
{
    grobo_robot_task *job = robot->job;
    GROBO_ASSERT(job->singly && job->result < 0 && joints != 0);
    if (job->out == 0) {
        job->out_result = job->result;
        job->out_joint = job->joint;
        job->out_value = job->value;
    }
    job->out |= joints;
    job->joints &= ~joints;
    job->target.set &= ~joints;
    job->todo &= ~joints;
    job->pending &= ~joints;
    job->failed &= ~joints;
    job->result = job->failed == 0 ? GROBO_OK : job->result;
}

void grobo_i_job_goto(grobo_robot *robot, grobo_robot_step_fn step)
{
    unsigned at = 0;
    while (robot->job->script[at] != NULL && robot->job->script[at] != step) {
        at++;
    }
    GROBO_ASSERT(robot->job->script[at] == step);
    robot->job->at = at;
}

/* ---- activities: 1 under way, 0 over, < 0 the job has failed --------------------------------- */

/* True if a frame of this job is under way; `asks`: one whose answer goes to the job. */
static bool has_frame(const grobo_robot *robot, const grobo_robot_task *job, bool asks)
{
    for (int i = 0; i < robot->slots_end; i++) {
        const grobo_robot_slot *slot = &robot->slots[i];
        if (slot->use != GROBO_I_USE_FREE && slot->job == job->number &&
            (!asks || slot->use == GROBO_I_USE_JOB)) {
            return true;
        }
    }
    return false;
}

static int keep_asking(grobo_robot *robot)
{
    return has_frame(robot, robot->job, true) ? 1 : 0;
}

/* Jobs before this one give some back. */
static int await_room(const grobo_robot *robot)
{
    return robot->job == robot->jobs ? GROBO_ERR_FULL : 1;
}

static int keep_reading(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    if (has_frame(robot, job, true)) {
        return 1;
    }
    if (job->todo == 0) {
        return 0;
    }
    const grobo_driver *driver = robot->driver;
    grobo_robot_slot *slot = grobo_i_slot_take(robot, GROBO_I_USE_JOB);
    if (slot == NULL) {
        return await_room(robot);
    }
    slot->joint = (uint8_t)grobo_i_lowest(job->todo);
    slot->reads = true;
    bool first = GROBO_I_EXTRA(grobo_i_driver_of(robot, slot->joint), keeps_setup) &&
                 !grobo_i_is_sensed(&robot->axes[slot->joint]);
    grobo_sense_kind kind = first ? GROBO_SENSE_ALL : job->sense;
    slot->kind = (uint8_t)kind;
    int result = driver->sense(driver, robot->driver_ctx, slot->joint, kind, &robot->built);
    if (result < 0) {
        grobo_i_slot_drop(slot);
        return result;
    }
    result = grobo_i_slot_send(slot, &robot->built, job->priority);
    return result == GROBO_ERR_FULL ? await_room(robot) : result < 0 ? result : 1;
}

static int keep_draining(grobo_robot *robot)
{
    return has_frame(robot, robot->job, false) ? 1 : 0;
}

static int keep_waiting(grobo_robot *robot)
{
    return robot->now_us < robot->job->until_us ? 1 : 0;
}

static int (*const keep[])(grobo_robot *robot) = {
    [GROBO_I_ASK] = keep_asking,
    [GROBO_I_READ] = keep_reading,
    [GROBO_I_DRAIN] = keep_draining,
    [GROBO_I_WAIT] = keep_waiting,
};

/* One go: carries on with the activity, or takes the next step. 0: go on, 1: wait. */
static int advance(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    if (job->activity != GROBO_I_NEXT) {
        int going = keep[job->activity](robot);
        if (going != 0) {
            return going;
        }
        job->activity = GROBO_I_NEXT;
    }
    grobo_robot_step_fn step = job->script[job->at];
    if (step == NULL) {
        grobo_i_job_end(robot, job->result);
        return 1;
    }
    job->at++;
    int activity = step(robot);
    if (activity < 0) {
        return activity;
    }
    GROBO_ASSERT(activity <= GROBO_I_WAIT);
    job->activity = (uint8_t)activity;
    return 0;
}

/* The bound is over. Who was to be limp is told so once more, in a frame that outlives the job: the
 * one of the job may not have left. Who sits down yet is halted where he is, and holds. */
static void run_out(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    grobo_joint_mask joints = 0;
    for (int j = 0; job->lets_go && j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        bool limp = axis->torque_known && axis->state.torque == GROBO_TORQUE_OFF;
        joints |= limp ? 0 : GROBO_JOINT_BIT(j);
    }
    job->failed |= job->pending;
    if (job->sits) {
        grobo_i_slots_cancel_goals(robot, job->joints, true);
        grobo_i_gate_halt(robot, job->joints);
    }
    if (joints != 0) {
        (void)grobo_i_gate_torque(robot, joints, GROBO_TORQUE_OFF, GROBO_I_WHOLE);
    }
    grobo_i_job_end(robot, GROBO_ERR_TIMEOUT);
}

static void run(grobo_robot *robot)
{
    while (robot->job->kind != GROBO_JOB_NONE) {
        if (robot->now_us >= robot->job->bound_us) {
            run_out(robot);
            return;
        }
        robot->acting = robot->job->number;
        int going = advance(robot);
        robot->acting = 0;
        if (going < 0) {
            grobo_i_job_end(robot, going);
        } else if (going > 0) {
            return;
        }
    }
}

void grobo_i_job_run(grobo_robot *robot)
{
    if (robot->acting != 0) {
        return; /* whoever runs comes by */
    }
    for (int i = 0; i < GROBO_ROBOT_JOBS; i++) {
        if (robot->jobs[i].kind != GROBO_JOB_NONE) {
            robot->job = &robot->jobs[i];
            run(robot);
        }
    }
    robot->job = robot->jobs;
}

void grobo_i_jobs_close_up(grobo_robot *robot)
{
    GROBO_ASSERT(robot->acting == 0);
    robot->job = robot->jobs;
    for (int i = 1; i < GROBO_ROBOT_JOBS && robot->jobs[0].kind == GROBO_JOB_NONE; i++) {
        if (robot->jobs[i].kind != GROBO_JOB_NONE) {
            robot->jobs[0] = robot->jobs[i];
            robot->jobs[i].kind = GROBO_JOB_NONE;
        }
    }
}

static int64_t deadline_of(const grobo_robot *robot, const grobo_robot_task *job)
{
    bool asks = job->activity == GROBO_I_ASK || job->activity == GROBO_I_READ;
    int64_t at_us = job->activity == GROBO_I_WAIT ? job->until_us : GROBO_NEVER_US;
    /* Drained frames and a job just begun have no event of their own: look again at once. */
    if (job->activity == GROBO_I_NEXT || (asks && !has_frame(robot, job, true)) ||
        (job->activity == GROBO_I_DRAIN && !has_frame(robot, job, false))) {
        at_us = robot->now_us;
    }
    return at_us < job->bound_us ? at_us : job->bound_us;
}

int64_t grobo_i_job_deadline(const grobo_robot *robot)
{
    int64_t at_us = GROBO_NEVER_US;
    for (int i = 0; i < GROBO_ROBOT_JOBS; i++) {
        if (robot->jobs[i].kind != GROBO_JOB_NONE) {
            at_us = grobo_i_sooner(at_us, deadline_of(robot, &robot->jobs[i]));
        }
    }
    return at_us;
}

/* ---- what comes back ------------------------------------------------------------------------- */

static void take_answer(grobo_robot *robot, int result, const grobo_packet *reply)
{
    grobo_robot_task *job = robot->job;
    job->reply_bytes = 0;
    /* An ACK has no data, and then no place of it. */
    if (reply != NULL && reply->data_bytes > 0 && reply->data_bytes <= sizeof robot->reply) {
        memcpy(robot->reply, reply->data, reply->data_bytes);
        job->reply_bytes = reply->data_bytes;
    }
    job->result = result;
}

static grobo_robot_task *job_of(const grobo_robot_slot *slot)
{
    for (int i = 0; i < GROBO_ROBOT_JOBS; i++) {
        grobo_robot_task *job = &slot->robot->jobs[i];
        if (job->kind != GROBO_JOB_NONE && slot->job == job->number) {
            return job;
        }
    }
    return NULL;
}

bool grobo_i_job_has(const grobo_robot_slot *slot)
{
    return job_of(slot) != NULL;
}

void grobo_i_job_done(const grobo_robot_slot *slot, int result, const grobo_packet *reply)
{
    grobo_robot *robot = slot->robot;
    grobo_robot_task *current = robot->job;
    grobo_robot_task *job = job_of(slot);
    if (job == NULL) {
        return; /* what was read has ended it */
    }
    robot->job = job;
    if (!slot->reads) {
        take_answer(robot, result, reply);
    } else if (grobo_i_has(job->joints, slot->joint)) {
        job->todo &= ~GROBO_JOINT_BIT(slot->joint);
        if (result < 0) {
            grobo_i_job_fail_joint(robot, slot->joint, result, 0);
        }
    }
    robot->job = current;
    grobo_i_job_run(robot);
}

void grobo_i_job_refused(const grobo_robot_slot *slot, int result)
{
    grobo_robot *robot = slot->robot;
    grobo_robot_task *current = robot->job;
    grobo_robot_task *job = job_of(slot);
    if (job != NULL) {
        robot->job = job;
        grobo_i_job_end(robot, result);
        robot->job = current;
    }
}
