/* SPDX-License-Identifier: MIT */
/* What may be asked of the engine. */
#include "src/robot/robot.h"

static int64_t age(int64_t read_us, int64_t now_us)
{
    return read_us == GROBO_NEVER_US ? GROBO_NEVER_US : now_us - read_us;
}

int grobo_robot_joint(const grobo_robot *robot, int joint, int64_t now_us, grobo_joint_info *info)
{
    if (robot == NULL || info == NULL || joint < 0 || joint >= robot->driver->model->n_joints) {
        return GROBO_ERR_ARG;
    }
    const grobo_robot_axis *axis = &robot->axes[joint];
    info->state = axis->state;
    info->angle_age_us = age(axis->angle_us, now_us);
    info->full_age_us = age(axis->full_us, now_us);
    info->target_rad = grobo_i_axis_target(axis);
    info->status = axis->status;
    info->has_target = axis->has_target || axis->next != 0;
    info->torque_known = axis->torque_known;
    return GROBO_OK;
}

int grobo_robot_posture(const grobo_robot *robot, int64_t now_us, int64_t max_age_us,
                        grobo_posture *posture)
{
    if (robot == NULL || posture == NULL) {
        return GROBO_ERR_ARG;
    }
    (void)grobo_posture_init(posture, robot->driver->model->n_joints);
    for (int j = 0; j < posture->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        if (axis->angle_us != GROBO_NEVER_US && age(axis->angle_us, now_us) <= max_age_us) {
            posture->angle_rad[j] = axis->state.angle_rad;
            posture->set |= GROBO_JOINT_BIT(j);
        }
    }
    return grobo_joints_count(posture->set);
}

int grobo_robot_target(const grobo_robot *robot, grobo_posture *posture)
{
    if (robot == NULL || posture == NULL) {
        return GROBO_ERR_ARG;
    }
    (void)grobo_posture_init(posture, robot->driver->model->n_joints);
    for (int j = 0; j < posture->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        if (axis->has_target || axis->next != 0) {
            posture->angle_rad[j] = grobo_i_axis_target(axis);
            posture->set |= GROBO_JOINT_BIT(j);
        }
    }
    return grobo_joints_count(posture->set);
}

bool grobo_robot_moving(const grobo_robot *robot, int64_t now_us)
{
    return robot != NULL && (grobo_i_in_motion(robot) || robot->job.kind == GROBO_JOB_PLAY ||
                             grobo_i_moving(robot, now_us));
}

bool grobo_robot_stops(const grobo_robot *robot, int64_t now_us)
{
    if (robot == NULL) {
        return false;
    }
    bool waits = false;
    for (int i = 0; i < GROBO_ROBOT_SLOTS; i++) {
        const grobo_robot_slot *slot = &robot->slots[i];
        bool stops = slot->order.stops || (slot->txn.priority == GROBO_PRIORITY_STOP &&
                                           slot->order.deed != GROBO_I_DEED_NONE);
        waits =
            waits || (slot->use != GROBO_I_USE_FREE && grobo_txn_is_pending(&slot->txn) && stops);
    }
    return waits && robot->bus.active == NULL && grobo_bus_free_at(&robot->bus, now_us) <= now_us;
}

bool grobo_robot_settling(const grobo_robot *robot)
{
    return robot != NULL && robot->link && (robot->settling || robot->job.kind == GROBO_JOB_SETTLE);
}

grobo_job_kind grobo_robot_job(const grobo_robot *robot)
{
    if (robot == NULL) {
        return GROBO_JOB_NONE;
    }
    return robot->job.kind == GROBO_JOB_SETTLE ? GROBO_JOB_NONE : robot->job.kind;
}

void grobo_robot_tripped(const grobo_robot *robot, grobo_trip_info *info)
{
    if (robot != NULL && info != NULL) {
        *info = robot->trip;
    }
}

int grobo_robot_fault(const grobo_robot *robot, double *value_deg)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    if (robot->fault_joint >= 0 && value_deg != NULL) {
        *value_deg = robot->fault_deg;
    }
    return robot->fault_joint;
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
    return robot == NULL ? GROBO_SEQUENCER_IDLE : grobo_sequencer_get_state(&robot->sequencer);
}

bool grobo_robot_is_quiet(const grobo_robot *robot)
{
    return robot != NULL && grobo_bus_pending(&robot->bus) == 0;
}

bool grobo_robot_is_playing(const grobo_robot *robot)
{
    if (robot == NULL) {
        return false;
    }
    switch (grobo_sequencer_get_state(&robot->sequencer)) {
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

void grobo_robot_progress(const grobo_robot *robot, int64_t now_us, grobo_play_progress *progress)
{
    if (robot != NULL) {
        grobo_sequencer_progress(&robot->sequencer, now_us, progress);
    }
}

const grobo_driver *grobo_robot_driver(const grobo_robot *robot)
{
    return robot == NULL ? NULL : robot->driver;
}

bool grobo_i_in_motion(const grobo_robot *robot)
{
    return robot->job.kind == GROBO_JOB_MOVE || grobo_robot_is_playing(robot);
}
