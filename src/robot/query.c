/* SPDX-License-Identifier: MIT */
/* What may be asked of the engine. */
#include <grobo/core/robot.h>

#include "src/robot/axis.h"
#include "src/robot/lines.h"
#include "src/robot/query.h"
#include "src/robot/slot.h"
#include "src/robot/stand.h"
#include "src/robot/state.h"

#if SIZE_MAX <= UINT32_MAX
void grobo_i_lock(const grobo_robot *robot)
{
    if (robot->host.lock != NULL) {
        robot->host.lock(robot->host.ctx);
    }
}

void grobo_i_unlock(const grobo_robot *robot)
{
    if (robot->host.unlock != NULL) {
        robot->host.unlock(robot->host.ctx);
    }
}
#endif

int64_t grobo_i_now(const grobo_robot *robot)
{
    int64_t now_us = robot->host.clock != NULL ? robot->host.clock(robot->host.ctx) : 0;
    return now_us > robot->now_us ? now_us : robot->now_us;
}

bool grobo_i_is_latched(const grobo_robot *robot)
{
    const grobo_robot_host *host = &robot->host;
    return robot->trip.latched || (host->is_stopped != NULL && host->is_stopped(host->ctx));
}

bool grobo_i_has_frame(const grobo_robot *robot, int line, bool any, int64_t now_us)
{
    const grobo_bus *bus = grobo_i_bus_read(robot, line);
    grobo_i_lock(robot);
    bool has = bus->waiting > 0 && bus->active == NULL &&
               (any || grobo_bus_deadline(bus, now_us) <= now_us);
    grobo_i_unlock(robot);
    return has;
}

static bool stops(const grobo_robot_slot *slot)
{
    return slot->order.stops ||
           (slot->txn.priority == GROBO_PRIORITY_STOP && slot->order.kind != GROBO_I_ORDER_NONE);
}

bool grobo_i_frame_stops(const grobo_robot *robot, int line)
{
    const grobo_bus *bus = grobo_i_bus_read(robot, line);
    grobo_i_lock(robot);
    bool does = bus->active != NULL && stops(bus->active->ctx);
    grobo_i_unlock(robot);
    return does;
}

bool grobo_i_jobs_any(const grobo_robot *robot, bool (*is)(const grobo_robot_task *job))
{
    for (int i = 0; i < GROBO_ROBOT_JOBS; i++) {
        const grobo_robot_task *job = &robot->jobs[i];
        if (job->kind != GROBO_JOB_NONE && (is == NULL || is(job))) {
            return true;
        }
    }
    return false;
}

static int64_t age(int64_t read_us, int64_t now_us)
{
    return read_us == GROBO_NEVER_US ? GROBO_NEVER_US : now_us - read_us;
}

int grobo_robot_joint(const grobo_robot *robot, int joint, grobo_joint_info *info)
{
    if (robot == NULL || info == NULL || joint < 0 || joint >= robot->driver->model->n_joints) {
        return GROBO_ERR_ARG;
    }
    grobo_i_lock(robot);
    int64_t now_us = grobo_i_now(robot);
    const grobo_robot_axis *axis = &robot->axes[joint];
    info->state = axis->state;
    info->angle_age_us = age(axis->angle_us, now_us);
    info->full_age_us = age(axis->full_us, now_us);
    info->target_rad = grobo_i_axis_target(axis);
    info->status = axis->status;
    info->has_target = grobo_i_has_target(axis) || axis->next != 0;
    info->torque_known = axis->torque_known;
    info->stands = grobo_i_stands(robot, joint);
    grobo_i_unlock(robot);
    return GROBO_OK;
}

int grobo_robot_posture(const grobo_robot *robot, int64_t max_age_us, grobo_posture *posture)
{
    if (robot == NULL || posture == NULL) {
        return GROBO_ERR_ARG;
    }
    (void)grobo_posture_init(posture, robot->driver->model->n_joints);
    grobo_i_lock(robot);
    int64_t now_us = grobo_i_now(robot);
    for (int j = 0; j < posture->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        if (axis->angle_us != GROBO_NEVER_US && age(axis->angle_us, now_us) <= max_age_us) {
            posture->angle_rad[j] = axis->state.angle_rad;
            posture->set |= GROBO_JOINT_BIT(j);
        }
    }
    grobo_i_unlock(robot);
    return grobo_joints_count(posture->set);
}

int grobo_robot_target(const grobo_robot *robot, grobo_posture *posture)
{
    if (robot == NULL || posture == NULL) {
        return GROBO_ERR_ARG;
    }
    (void)grobo_posture_init(posture, robot->driver->model->n_joints);
    grobo_i_lock(robot);
    for (int j = 0; j < posture->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        if (grobo_i_has_target(axis) || axis->next != 0) {
            posture->angle_rad[j] = grobo_i_axis_target(axis);
            posture->set |= GROBO_JOINT_BIT(j);
        }
    }
    grobo_i_unlock(robot);
    return grobo_joints_count(posture->set);
}

bool grobo_robot_moving(const grobo_robot *robot)
{
    if (robot == NULL) {
        return false;
    }
    grobo_i_lock(robot);
    bool moving = grobo_i_in_motion(robot) || robot->job->kind == GROBO_JOB_PLAY ||
                  robot->halted_all != 0 || robot->halts_owed != 0 ||
                  grobo_i_moving(robot, grobo_i_now(robot));
    grobo_i_unlock(robot);
    return moving;
}

bool grobo_i_stops(const grobo_robot *robot, int line, int64_t now_us)
{
    const grobo_bus *bus = grobo_i_bus_read(robot, line);
    bool waits = false;
    grobo_i_lock(robot);
    for (int i = 0; i < robot->slots_end; i++) {
        const grobo_robot_slot *slot = &robot->slots[i];
        if (slot->use != GROBO_I_USE_FREE && grobo_txn_is_pending(&slot->txn) &&
            grobo_i_slot_line(slot) == line) {
            waits = waits || stops(slot);
        }
    }
    waits = waits && bus->active == NULL && grobo_bus_free_at(bus, now_us) <= now_us;
    grobo_i_unlock(robot);
    return waits;
}

bool grobo_robot_stops(const grobo_robot *robot, int64_t now_us)
{
    return robot != NULL && grobo_i_stops(robot, 0, now_us);
}

bool grobo_robot_settling(const grobo_robot *robot)
{
    if (robot == NULL) {
        return false;
    }
    grobo_i_lock(robot);
    bool settling = robot->link && (robot->settling || robot->job->kind == GROBO_JOB_SETTLE);
    grobo_i_unlock(robot);
    return settling;
}

grobo_job_kind grobo_robot_job(const grobo_robot *robot)
{
    if (robot == NULL) {
        return GROBO_JOB_NONE;
    }
    grobo_i_lock(robot);
    grobo_job_kind kind = robot->job->kind;
    grobo_i_unlock(robot);
    return kind == GROBO_JOB_SETTLE ? GROBO_JOB_NONE : kind;
}

bool grobo_i_has_to_tell(const grobo_robot *robot)
{
    grobo_i_lock(robot);
    bool has = robot->events_n > 0;
    grobo_i_unlock(robot);
    return has;
}

static bool is_pending(const grobo_robot *robot, int number)
{
    for (int i = 0; i < GROBO_ROBOT_JOBS; i++) {
        if (robot->jobs[i].kind != GROBO_JOB_NONE && robot->jobs[i].number == number) {
            return true;
        }
    }
    for (unsigned i = 0; i < robot->queued; i++) {
        if (robot->queue[i].number == number) {
            return true;
        }
    }
    for (unsigned i = 0; i < robot->events_n; i++) {
        const grobo_event *event = &robot->events[(robot->events_head + i) % GROBO_ROBOT_EVENTS];
        if (event->kind == GROBO_EVENT_JOB && event->u.job.number == number) {
            return true;
        }
    }
    return false;
}

bool grobo_robot_is_pending(const grobo_robot *robot, int number)
{
    if (robot == NULL || number <= 0) {
        return false;
    }
    grobo_i_lock(robot);
    bool pending = is_pending(robot, number);
    grobo_i_unlock(robot);
    return pending;
}

void grobo_robot_tripped(const grobo_robot *robot, grobo_trip_info *info)
{
    if (robot != NULL && info != NULL) {
        grobo_i_lock(robot);
        *info = robot->trip;
        grobo_i_unlock(robot);
    }
}

int grobo_robot_fault(const grobo_robot *robot, double *value_deg)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_lock(robot);
    int joint = robot->fault_joint;
    if (joint >= 0 && value_deg != NULL) {
        *value_deg = robot->fault_deg;
    }
    grobo_i_unlock(robot);
    return joint;
}

const grobo_robot_counters *grobo_robot_get_counters(const grobo_robot *robot)
{
    return robot == NULL ? NULL : &robot->counters;
}

const grobo_bus_stats *grobo_robot_get_bus_stats(const grobo_robot *robot)
{
    return robot == NULL ? NULL : &robot->bus.stats;
}

grobo_sequencer_state grobo_robot_play_state(const grobo_robot *robot)
{
    if (robot == NULL) {
        return GROBO_SEQUENCER_IDLE;
    }
    grobo_i_lock(robot);
    grobo_sequencer_state state = grobo_sequencer_get_state(&robot->sequencer);
    grobo_i_unlock(robot);
    return state;
}

bool grobo_robot_is_quiet(const grobo_robot *robot)
{
    if (robot == NULL) {
        return false;
    }
    grobo_i_lock(robot);
    bool quiet = true;
    for (int i = 0; i < grobo_i_lines(robot); i++) {
        quiet = quiet && grobo_bus_pending(grobo_i_bus_read(robot, i)) == 0;
    }
    grobo_i_unlock(robot);
    return quiet;
}

bool grobo_i_is_playing(const grobo_robot *robot)
{
    switch (robot->sequencer.state) {
    case GROBO_SEQUENCER_APPROACHING:
    case GROBO_SEQUENCER_PLAYING:
    case GROBO_SEQUENCER_PAUSED:
    case GROBO_SEQUENCER_STOPPING:
        return true;
    case GROBO_SEQUENCER_IDLE:
    case GROBO_SEQUENCER_FINISHED:
    case GROBO_SEQUENCER_FAILED:
        return false;
    }
    return false;
}

bool grobo_robot_is_playing(const grobo_robot *robot)
{
    if (robot == NULL) {
        return false;
    }
    grobo_i_lock(robot);
    bool playing = grobo_i_is_playing(robot);
    grobo_i_unlock(robot);
    return playing;
}

void grobo_robot_progress(const grobo_robot *robot, grobo_play_progress *progress)
{
    if (robot != NULL && progress != NULL) {
        grobo_i_lock(robot);
        grobo_sequencer_progress(&robot->sequencer, grobo_i_now(robot), progress);
        progress->ready = grobo_sequencer_is_ready(&robot->sequencer);
        grobo_i_unlock(robot);
    }
}

const grobo_driver *grobo_robot_driver(const grobo_robot *robot)
{
    return robot == NULL ? NULL : robot->driver;
}

static bool is_move(const grobo_robot_task *job)
{
    return job->kind == GROBO_JOB_MOVE;
}

bool grobo_i_in_motion(const grobo_robot *robot)
{
    return grobo_i_jobs_any(robot, is_move) || grobo_i_is_playing(robot);
}
