/* SPDX-License-Identifier: MIT */
/*
 * The end of a call, and of a frame: what was read is judged, what waited for it goes on, a motion
 * that is over is settled, and events are told.
 */
#include <string.h>

#include "src/base/assert.h"
#include "src/robot/axis.h"
#include "src/robot/gate.h"
#include "src/robot/halted.h"
#include "src/robot/job.h"
#include "src/robot/lines.h"
#include "src/robot/play.h"
#include "src/robot/query.h"
#include "src/robot/reading.h"
#include "src/robot/robot.h"
#include "src/robot/sense.h"
#include "src/robot/slot.h"
#include "src/robot/steps.h"
#include "src/robot/turn.h"
#include "src/robot/watch.h"

/* A reading that takes several exchanges asks for its next part. @return 1 if there is one. */
static int read_on(const grobo_robot_slot *before)
{
    grobo_robot *robot = before->robot;
    const grobo_driver *driver = robot->driver;
    if (GROBO_I_EXTRA(driver, sense_more) == NULL || !before->reads ||
        (before->use == GROBO_I_USE_JOB && !grobo_i_job_has(before))) {
        return 0;
    }
    grobo_robot_slot *slot = grobo_i_slot_take(robot, (grobo_i_use)before->use);
    if (slot == NULL) {
        return GROBO_ERR_FULL;
    }
    slot->reads = true;
    slot->joint = before->joint;
    slot->job = before->job;
    slot->kind = before->kind;
    slot->part = (uint8_t)(before->part + 1);
    int more = driver->sense_more(driver, robot->driver_ctx, slot->joint,
                                  (grobo_sense_kind)slot->kind, slot->part, &robot->built);
    if (more <= 0) {
        grobo_i_slot_drop(slot);
        return more;
    }
    more = grobo_i_slot_send(slot, &robot->built, before->txn.priority);
    return more < 0 ? more : 1;
}

/* Takes what a slot has read of its joint, or the reason why there is nothing, and judges it. A
 * servo that is not set up for its joint is read to the end: its torque may be in a later part.
 * @return 1 where the reading goes on. */
static int take_reading(const grobo_robot_slot *slot, int result, const grobo_packet *reply)
{
    GROBO_ASSERT(slot->joint < slot->robot->driver->model->n_joints);
    grobo_robot *robot = slot->robot;
    grobo_joint_state got;
    int taken = grobo_i_reading_take(slot, result, reply, &got);
    if (taken >= 0) {
        grobo_i_watch_reading(robot, slot->joint, &got);
        grobo_i_halted_look(robot, slot->joint);
    } else if (grobo_i_is_loss(taken)) {
        grobo_i_watch_lost(robot, slot->joint);
    }
    int more = taken >= 0 || taken == GROBO_ERR_SETUP ? read_on(slot) : taken;
    if (more > 0) {
        return more;
    }
    taken = more < 0 ? more : taken;
    grobo_event event = {.kind = GROBO_EVENT_JOINT};
    event.u.joint.joint = slot->joint;
    event.u.joint.result = taken;
    grobo_i_tell(robot, &event);
    return taken;
}

void grobo_i_reply_came(grobo_robot_slot *slot, const grobo_packet *reply)
{
    int joint = grobo_i_joint_on(slot->robot, grobo_i_slot_line(slot), reply->id);
    if (joint < 0 || !grobo_i_has(slot->unread, joint)) {
        return;
    }
    slot->unread &= ~GROBO_JOINT_BIT(joint);
    grobo_robot_slot one = *slot; /* what is read may end the frame */
    one.joint = (uint8_t)joint;
    (void)take_reading(&one, reply->refused ? GROBO_ERR_NACK : GROBO_OK, reply);
}

/* Joints that have not answered; or the packet that answers for all. */
static void take_unread(grobo_robot_slot *slot, int result, const grobo_packet *reply)
{
    for (int j = 0; j < slot->robot->driver->model->n_joints; j++) {
        if (grobo_i_has(slot->unread, j)) {
            slot->joint = (uint8_t)j;
            (void)take_reading(slot, result, reply);
        }
    }
}

/* Of a frame that moves or switches one joint: some servos answer it with where they are. Where it
 * is lost, what its order has for that joint besides is not sent: a goal without its speed. */
static void take_told(grobo_robot_slot *slot, int result, const grobo_packet *reply)
{
    if (slot->reads || slot->many || slot->use == GROBO_I_USE_JOB ||
        grobo_joints_count(slot->order.joints) != 1) {
        return;
    }
    if (result < 0) {
        grobo_i_slots_cancel_rest(slot);
    } else if (reply != NULL && reply->data_bytes > 0) {
        slot->joint = (uint8_t)grobo_i_lowest(slot->order.joints);
        (void)take_reading(slot, result, reply);
    }
}

void grobo_i_frame_over(grobo_robot_slot *slot, int result, const grobo_packet *reply)
{
    if (slot->txn.sent_us < 0) {
        grobo_i_gate_unwait(slot->robot, &slot->order);
    }
    take_told(slot, result, reply);
    switch ((grobo_i_use)slot->use) {
    case GROBO_I_USE_FREE:
    case GROBO_I_USE_PLAIN:
    case GROBO_I_USE_HALT:
        break;
    case GROBO_I_USE_JOB:
        if (grobo_i_job_has(slot)) {
            result = slot->reads ? take_reading(slot, result, reply) : result;
            if (result <= 0) {
                grobo_i_job_done(slot, result, reply);
            }
        }
        break;
    case GROBO_I_USE_SENSE:
        if (result != GROBO_ERR_CANCELED && result != GROBO_ERR_UNPLUGGED) {
            if (!GROBO_DRIVERS_PLAIN && slot->many) {
                take_unread(slot, result, reply);
            } else {
                result = take_reading(slot, result, reply);
            }
            if (result <= 0) {
                grobo_i_sense_done(slot, result);
            }
        }
        break;
    case GROBO_I_USE_SEGMENT:
    case GROBO_I_USE_SPEED:
        slot->robot->counters.motion_frames += result >= 0;
        break;
    case GROBO_I_USE_MOTION:
        grobo_i_play_done(slot, result);
        break;
    }
}

void grobo_i_enter(grobo_robot *robot, int64_t now_us)
{
    GROBO_ASSERT(robot->driver != NULL); /* initialised */
    grobo_i_lock(robot);
    robot->depth++;
    if (now_us > robot->now_us) {
        robot->now_us = now_us;
    }
}

/* After a motion, unless somebody asked for something else: its last posture is read back. */
static void settle(grobo_robot *robot)
{
    if (!robot->settling || robot->job->kind != GROBO_JOB_NONE || !robot->link) {
        return;
    }
    robot->settling = false;
    (void)grobo_i_job_start(robot, GROBO_JOB_SETTLE, grobo_i_script_settle, 0);
    robot->job->joints = grobo_i_all_joints(robot);
    grobo_i_job_run(robot);
}

void grobo_i_leave(grobo_robot *robot)
{
    GROBO_ASSERT(robot->depth > 0);
    grobo_i_jobs_close_up(robot); /* before a callback asks for what runs */
    if (robot->depth == 1) {
        grobo_i_play_tell(robot);
        while (robot->events_n > 0) {
            grobo_event event = robot->events[robot->events_head];
            robot->events_head = (robot->events_head + 1) % GROBO_ROBOT_EVENTS;
            robot->events_n--;
            if (robot->on_event != NULL) {
                grobo_i_unlock(robot);
                robot->on_event(robot->event_ctx, &event);
                grobo_i_lock(robot);
            }
            grobo_i_play_tell(robot);
        }
        settle(robot);
    }
    robot->depth--;
    if (robot->depth == 0) {
        grobo_i_robot_assert(robot);
    }
    grobo_i_unlock(robot);
}

void grobo_i_begin(grobo_robot *robot)
{
    grobo_i_lock(robot);
    grobo_i_enter(robot, grobo_i_now(robot));
    grobo_i_unlock(robot); /* taken twice: it is held until the end */
}

void grobo_i_end(grobo_robot *robot)
{
    if (robot->host.wake == NULL) {
        grobo_i_leave(robot);
        return;
    }
    GROBO_ASSERT(robot->depth > 0);
    grobo_i_jobs_close_up(robot);
    robot->depth--;
    if (robot->depth == 0) {
        grobo_i_robot_assert(robot);
    }
    grobo_i_unlock(robot);
    robot->host.wake(robot->host.ctx);
}
