/* SPDX-License-Identifier: MIT */
/* What always holds of the engine, when nobody is inside of it (docs/design.md). */
#include <math.h>

#include "src/base/assert.h"
#include "src/model/joint.h"
#include "src/robot/axis.h"
#include "src/robot/job.h"
#include "src/robot/lines.h"
#include "src/robot/query.h"
#include "src/robot/robot.h"
#include "src/robot/slot.h"
#include "src/robot/state.h"
#include "src/robot/turn.h"

/* True if a frame waits that carries the joint's next target. */
static bool next_waits(const grobo_robot *robot, int joint)
{
    for (int i = 0; i < GROBO_ROBOT_SLOTS; i++) {
        const grobo_robot_slot *slot = &robot->slots[i];
        if (slot->use == GROBO_I_USE_MOTION && slot->txn.sent_us < 0 &&
            slot->order.number == robot->axes[joint].next &&
            grobo_i_has(slot->order.joints, joint)) {
            return true;
        }
    }
    return false;
}

/* A target is never outside the limits by a unit of the wire, which is what the gate compares. */
static bool is_inside(const grobo_robot *robot, int joint, double angle_rad)
{
    const grobo_joint *limits = grobo_i_joint(robot->driver->model, joint);
    const int ddeg = grobo_ddeg_from_rad(angle_rad);
    return ddeg >= grobo_ddeg_from_rad(limits->min_rad) &&
           ddeg <= grobo_ddeg_from_rad(limits->max_rad);
}

static void assert_axis(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    GROBO_ASSERT(axis->trajectory.from_us <= axis->trajectory.to_us);
    /* A trajectory that its servo told of is another program's; where it was read to turn is no
     * target. */
    bool on_trajectory =
        grobo_i_has_target(axis) && axis->trajectory.from_us < axis->trajectory.to_us &&
        axis->trajectory.from_rad != axis->trajectory.to_rad && axis->own_until_us == 0;
    GROBO_ASSERT(!on_trajectory || is_inside(robot, joint, axis->trajectory.to_rad));
    GROBO_ASSERT(axis->next == 0 || is_inside(robot, joint, axis->next_rad));
    GROBO_ASSERT(axis->next == 0 || next_waits(robot, joint));
    GROBO_ASSERT(!grobo_i_is_sensed(axis) || isfinite(axis->state.angle_rad));
    GROBO_ASSERT(!grobo_i_is_sensed(axis) || axis->angle_us != GROBO_NEVER_US);
    GROBO_ASSERT(!axis->torque_known || (axis->state.valid & GROBO_FIELD_TORQUE) != 0);
    GROBO_ASSERT(!grobo_i_trajectory_is_short(axis) || axis->told_to_us > axis->trajectory.from_us);
    GROBO_ASSERT(!grobo_i_is_in_segments(axis) || robot->in_segments);
}

static void assert_slot(const grobo_robot *robot, const grobo_robot_slot *slot)
{
    const bool used = slot->use != GROBO_I_USE_FREE;
    GROBO_ASSERT(used == grobo_txn_is_pending(&slot->txn));
    if (!used) {
        return;
    }
    GROBO_ASSERT(robot->link);
    GROBO_ASSERT(slot->robot == robot);
    GROBO_ASSERT(slot->txn.frame_bytes > 0 && slot->txn.frame_bytes <= slot->room);
    GROBO_ASSERT(slot->txn.frame >= robot->frames &&
                 slot->txn.frame + slot->room <= robot->frames + robot->frames_used);
    GROBO_ASSERT(!slot->reads || slot->joint < robot->driver->model->n_joints);
    GROBO_ASSERT(slot->use != GROBO_I_USE_JOB || grobo_i_job_has(slot));
    GROBO_ASSERT((slot->order.joints & ~grobo_i_all_joints(robot)) == 0);
    /* What waits to move a joint ends with the stop; what brings a motion to rest may leave. */
    bool goal = slot->order.kind == GROBO_I_ORDER_GOAL || slot->order.kind == GROBO_I_ORDER_SEGMENT;
    GROBO_ASSERT(!robot->trip.latched || !goal || slot->order.stops || slot->txn.sent_us >= 0);
}

static void assert_job(const grobo_robot *robot, const grobo_robot_task *job)
{
    if (job->kind == GROBO_JOB_NONE) {
        return;
    }
    GROBO_ASSERT(robot->link);
    GROBO_ASSERT(job->script != NULL && job->number > 0);
    GROBO_ASSERT((job->todo & ~grobo_i_all_joints(robot)) == 0);
    GROBO_ASSERT((job->failed & ~grobo_i_all_joints(robot)) == 0);
    GROBO_ASSERT((job->joints & job->superseded) == 0);
    GROBO_ASSERT(job == robot->jobs || grobo_i_job_is_shared(job->kind));
    for (const grobo_robot_task *other = robot->jobs; other < job; other++) {
        GROBO_ASSERT(other->kind == GROBO_JOB_NONE || other->number != job->number);
        GROBO_ASSERT(other->kind != GROBO_JOB_MOVE || job->kind != GROBO_JOB_MOVE ||
                     (other->joints & job->joints) == 0);
    }
}

static void assert_stop(const grobo_robot *robot)
{
    const grobo_trip_info *trip = &robot->trip;
    GROBO_ASSERT(trip->latched == (trip->trip != GROBO_TRIP_NONE));
    GROBO_ASSERT(!trip->latched || robot->free_joints == 0);
    GROBO_ASSERT(!robot->stop_owed || trip->trip == GROBO_TRIP_ESTOP);
    GROBO_ASSERT(robot->job->kind != GROBO_JOB_ESTOP || trip->trip == GROBO_TRIP_ESTOP);
    GROBO_ASSERT(trip->trip != GROBO_TRIP_ESTOP || !grobo_i_is_playing(robot));
}

void grobo_i_robot_assert(const grobo_robot *robot)
{
    int used = 0;
    size_t bytes = 0;
    if (!GROBO_ASSERT_WALKS) {
        return;
    }
    for (int i = 0; i < GROBO_ROBOT_SLOTS; i++) {
        assert_slot(robot, &robot->slots[i]);
        used += robot->slots[i].use != GROBO_I_USE_FREE;
        bytes += robot->slots[i].use != GROBO_I_USE_FREE ? robot->slots[i].room : 0;
        GROBO_ASSERT(robot->slots[i].use == GROBO_I_USE_FREE || i < robot->slots_end);
    }
    for (int i = 0; i < grobo_i_lines(robot); i++) {
        used -= grobo_bus_pending(grobo_i_bus_read(robot, i));
    }
    GROBO_ASSERT(used == 0);
    GROBO_ASSERT(bytes == robot->frames_used && bytes <= sizeof robot->frames);
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        assert_axis(robot, j);
    }
    for (int i = 0; i < GROBO_ROBOT_JOBS; i++) {
        assert_job(robot, &robot->jobs[i]);
    }
    GROBO_ASSERT(robot->job == robot->jobs);
    GROBO_ASSERT(robot->queued <= GROBO_ROBOT_QUEUE);
    GROBO_ASSERT(robot->queued == 0 || robot->link);
    for (unsigned i = 0; i < robot->queued; i++) {
        GROBO_ASSERT(robot->queue[i].kind == GROBO_JOB_SENSE || !robot->trip.latched);
    }
    assert_stop(robot);
    GROBO_ASSERT(robot->acting == 0);
    GROBO_ASSERT(robot->link || !grobo_i_is_playing(robot));
    GROBO_ASSERT(robot->events_head < GROBO_ROBOT_EVENTS && robot->events_n <= GROBO_ROBOT_EVENTS);
    grobo_joint_mask told =
        robot->round | robot->other_round | robot->heard_round | robot->free_joints;
    GROBO_ASSERT(((told | robot->played_joints) & ~grobo_i_all_joints(robot)) == 0);
}
