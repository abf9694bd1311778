/* SPDX-License-Identifier: MIT */
/*
 * The steps of which the scripts of jobs are made. Commands of servos are not answered through
 * the board, so whatever was written is read back, and written again where it did not take; a
 * budget of rounds ends that.
 */
#include <math.h>
#include <stdlib.h>

#include <grobo/core/robot.h>

#include "src/base/instant.h"
#include "src/robot/astray.h"
#include "src/robot/axis.h"
#include "src/robot/couple.h"
#include "src/robot/gate.h"
#include "src/robot/halted.h"
#include "src/robot/job.h"
#include "src/robot/lines.h"
#include "src/robot/often.h"
#include "src/robot/orders.h"
#include "src/robot/play.h"
#include "src/robot/query.h"
#include "src/robot/reading.h"
#include "src/robot/robot.h"
#include "src/robot/slot.h"
#include "src/robot/speed.h"
#include "src/robot/stand.h"
#include "src/robot/state.h"
#include "src/robot/steps.h"
#include "src/robot/weight.h"
#include "src/robot/wheel.h"

/* Rounds of writing again; a line that loses a byte in a hundred needs some. */
#define ROUNDS 10
#define ROUNDS_ESTOP 20
/* A servo that writes its flash or restarts hears again after this time. */
#define DEAF_US 2500000
/* A servo starts when its frame has passed board and bus, and settles. */
#define ARRIVAL_US 40000
/* Between two looks at a joint lies a trajectory that shows whether it moves: a count of a
 * coarse servo that flickers is no speed yet. */
#define TWICE_US 80000
/* How often a quieting robot is looked at. */
#define QUIET_US 5000
static grobo_i_chunk chunk_of(const grobo_robot *robot)
{
    return robot->job->rounds == 0 ? GROBO_I_WHOLE : GROBO_I_SMALL;
}

/* Until when rounds do not count: who leaves waits for a servo that was deaf as it began, and an
 * emergency stop for one that was heard lately, within its bound: it may restart all the time. */
static int64_t patient_until(const grobo_robot *robot, grobo_joint_mask bad)
{
    int64_t from_us = robot->job->begun_us;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        bool heard = grobo_i_has(bad, j) && axis->angle_us != GROBO_NEVER_US;
        if (heard && robot->job->kind == GROBO_JOB_ESTOP) {
            from_us = grobo_i_later(from_us, axis->angle_us);
        }
    }
    return from_us + DEAF_US;
}

/* What did not take gets another round from `step` on; without rounds left it has failed. */
static int again(grobo_robot *robot, grobo_joint_mask bad, grobo_robot_step_fn step)
{
    grobo_robot_task *job = robot->job;
    bool ends = job->kind == GROBO_JOB_ESTOP || job->kind == GROBO_JOB_EXIT;
    int rounds = job->kind == GROBO_JOB_ESTOP ? ROUNDS_ESTOP : ROUNDS;
    if (bad == 0) {
        return GROBO_I_NEXT;
    }
    if (job->rounds++ < rounds || (ends && robot->now_us < patient_until(robot, bad))) {
        job->failed &= ~bad;
        job->result = job->failed == 0 ? GROBO_OK : job->result;
        grobo_i_job_goto(robot, step);
        return GROBO_I_NEXT;
    }
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(bad & ~job->failed, j)) {
            grobo_i_job_fail_joint(robot, j, GROBO_ERR_MISMATCH, 0);
        }
    }
    job->pending &= ~bad;
    return GROBO_I_NEXT;
}

/* ---- asking ---------------------------------------------------------------------------------- */

static int ask(grobo_robot *robot, grobo_robot_slot *slot, const grobo_exchange *exchange)
{
    slot->order = robot->job->order;
    slot->txn.start_by_us = robot->job->leave_by_us;
    int result = grobo_i_slot_send(slot, exchange, robot->job->priority);
    return result < 0 ? result : GROBO_I_ASK;
}

static int step_ask(grobo_robot *robot)
{
    bool own = robot->asked_by == robot->job->number;
    grobo_robot_slot *slot = own ? grobo_i_slot_take(robot, GROBO_I_USE_JOB) : NULL;
    if (slot == NULL) {
        return GROBO_ERR_FULL;
    }
#if GROBO_LINES_MAX > 1
    grobo_i_slot_on(slot, robot->asked_line);
#endif
    return ask(robot, slot, &robot->asked);
}

/* Flash and reboot need silence after them. */
static int step_settle(grobo_robot *robot)
{
    if (robot->job->result < 0 || robot->job->settle_us == 0) {
        return robot->job->result;
    }
    robot->job->until_us = robot->now_us + robot->job->settle_us;
    return GROBO_I_WAIT;
}

/* ---- reading --------------------------------------------------------------------------------- */

static int step_read(grobo_robot *robot)
{
    robot->job->todo = robot->job->joints;
    return GROBO_I_READ;
}

static int step_read_again(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    job->todo = job->failed;
    job->failed = 0;
    job->result = GROBO_OK;
    return GROBO_I_READ;
}

static int step_read_pending(grobo_robot *robot)
{
    robot->job->todo = robot->job->pending;
    robot->job->sense = GROBO_SENSE_GOAL;
    return GROBO_I_READ;
}

/* Who leaves sees a joint once at least that he has told to stand; an emergency stop asks anyhow
 * until all do. */
static int step_hear_all(grobo_robot *robot)
{
    return robot->job->kind == GROBO_JOB_EXIT ? step_read_again(robot) : GROBO_I_NEXT;
}

/* From here on every joint is needed, but of a move asked for joint by joint. */
static int step_require(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    if (job->failed != 0 && job->singly && (job->joints & ~job->failed) != 0) {
        grobo_i_job_give_up(robot, job->failed);
    }
    return job->failed == 0 ? GROBO_I_NEXT : job->result;
}

/* Servos that tell no speed are read twice before they are sent anywhere: another program may have
 * sent them on their trajectory. Who is to stand is read twice since he was told to. */
static grobo_joint_mask of_unknown_speed(const grobo_robot *robot)
{
    grobo_joint_mask found = 0;
    bool stand = robot->job->kind == GROBO_JOB_EXIT || robot->job->kind == GROBO_JOB_ESTOP;
    for (int j = 0;
         GROBO_I_EXTRA(robot->driver, tells_no_speed) && j < robot->driver->model->n_joints; j++) {
        bool is = grobo_i_has(robot->job->joints & ~robot->job->failed, j) &&
                  grobo_i_driver_of(robot, j)->tells_no_speed;
        bool known = stand ? robot->axes[j].seen_dps != GROBO_I_NO_SPEED
                           : (robot->axes[j].state.valid & GROBO_FIELD_SPEED) != 0;
        found |= is && !known ? GROBO_JOINT_BIT(j) : 0;
    }
    return found;
}

static int step_look_twice(grobo_robot *robot)
{
    robot->job->until_us = robot->now_us + TWICE_US;
    return of_unknown_speed(robot) == 0 ? GROBO_I_NEXT : GROBO_I_WAIT;
}

static int step_read_twice(grobo_robot *robot)
{
    robot->job->todo = of_unknown_speed(robot);
    return GROBO_I_READ;
}

/* Motions begin where the joints were just seen, not where they were told to be; those that were
 * seen on the trajectory that they were told, where they are on it by now, or at its end. */
static int step_from_here(grobo_robot *robot)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        grobo_robot_axis *axis = &robot->axes[j];
        bool on_trajectory = grobo_i_has_target(axis) && !grobo_i_is_stray(axis) &&
                             axis->trajectory.to_us > axis->angle_us;
        if (grobo_i_has(robot->job->joints & ~robot->job->failed, j) && !on_trajectory) {
            grobo_i_axis_here(axis, robot->now_us);
            grobo_i_begin_at_goal(robot, j);
        }
    }
    return GROBO_I_NEXT;
}

/* ---- torque ---------------------------------------------------------------------------------- */

static grobo_joint_mask joints_with(const grobo_robot *robot, grobo_joint_mask joints,
                                    grobo_torque mode)
{
    grobo_joint_mask found = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(joints, j) && robot->axes[j].state.torque == mode) {
            found |= GROBO_JOINT_BIT(j);
        }
    }
    return found;
}

/* Makes a frame that moves nothing. */
typedef int (*plain_build)(const grobo_driver *driver, void *ctx, grobo_joint_mask joints,
                           int64_t time_us, int part, grobo_exchange *exchange);

/* To joints of one line. A frame that finds no room is as one that is lost. */
static void tell_line(grobo_robot *robot, grobo_joint_mask joints, int64_t time_us,
                      plain_build build)
{
    int more = joints != 0;
    for (int part = 0; more > 0; part++) {
        grobo_robot_slot *slot = grobo_i_slot_take(robot, GROBO_I_USE_PLAIN);
        if (slot == NULL) {
            break;
        }
        grobo_i_slot_on(slot, grobo_i_line_of(robot, grobo_i_lowest(joints)));
        more = build(robot->driver, robot->driver_ctx, joints, time_us, part, &robot->built);
        if (more > 0) {
            more = grobo_i_slot_send(slot, &robot->built, robot->job->priority) < 0 ? 0 : 1;
        } else {
            grobo_i_slot_drop(slot);
        }
    }
}

/* Frames that move nothing, to these joints. */
static void tell_plain(grobo_robot *robot, grobo_joint_mask joints, int64_t time_us,
                       plain_build build)
{
    for (int i = 0; i < grobo_i_lines(robot); i++) {
        tell_line(robot, joints & grobo_i_joints_on(robot, i), time_us, build);
    }
}

/* The joints that are to get torque, or have it, without the limit of theirs. */
static grobo_joint_mask unlimited(const grobo_robot *robot)
{
    grobo_joint_mask found = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        bool is = grobo_i_has(robot->job->joints & ~robot->job->failed, j);
        found |= is && !grobo_i_torque_is_limited(robot, j) ? GROBO_JOINT_BIT(j) : 0;
    }
    return found;
}

static int build_limit(const grobo_driver *driver, void *ctx, grobo_joint_mask joints,
                       int64_t time_us, int part, grobo_exchange *exchange)
{
    (void)time_us;
    return driver->torque_limit(driver, ctx, joints, part, exchange);
}

static int step_limit(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    job->pending = unlimited(robot);
    tell_plain(robot, job->pending, 0, build_limit);
    return GROBO_I_DRAIN;
}

static int step_limit_check(grobo_robot *robot)
{
    return again(robot, (unlimited(robot) | robot->job->failed) & robot->job->pending, step_limit);
}

static int step_pick_off(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    /* Of two that move together none is switched on without the other. */
    grobo_joint_mask read = job->joints & ~grobo_i_coupled(robot, job->failed);
    job->pending = read & ~joints_with(robot, read, GROBO_TORQUE_ON);
    job->torque = GROBO_TORQUE_ON;
    job->rounds = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(job->pending, j)) {
            grobo_i_joint_to(&robot->axes[j], GROBO_I_JOINT_LOOSE);
        }
        if (grobo_i_has(read & ~job->pending, j)) {
            robot->axes[j].wants_torque = true;
        }
    }
    bool may = !robot->config.manual_torque || job->kind == GROBO_JOB_TORQUE;
    if (!may && job->singly && job->pending != 0 && (job->joints & ~job->pending) != 0) {
        job->result = GROBO_ERR_STATE;
        job->joint = grobo_i_lowest(job->pending);
        job->value = 0;
        grobo_i_job_give_up(robot, job->pending);
    }
    return job->pending == 0 || may ? GROBO_I_NEXT : GROBO_ERR_STATE;
}

/* The servos' own dead-man. What one of these frames does is not read back: a lost one costs the
 * dead-man of a motion, or has goals refused and so sent again from the begin of the script. */
static int build_watchdog(const grobo_driver *driver, void *ctx, grobo_joint_mask joints,
                          int64_t time_us, int part, grobo_exchange *exchange)
{
    return driver->watchdog(driver, ctx, joints, time_us, part, exchange);
}

static int tell_watchdog(grobo_robot *robot, int64_t time_us)
{
    const grobo_driver *driver = robot->driver;
    bool has_one = GROBO_I_EXTRA(driver, watchdog) != NULL && driver->watchdog_us > 0;
    tell_plain(robot, has_one ? robot->job->joints : 0, time_us, build_watchdog);
    return GROBO_I_DRAIN;
}

/* One that has gone off refuses goals until it is cleared. */
static int step_watchdog_clear(grobo_robot *robot)
{
    return tell_watchdog(robot, 0);
}

/* It must not go off between two readings: a whole goal is followed by nothing else. */
static int step_watchdog_set(grobo_robot *robot)
{
    int64_t interval_us = grobo_i_often_rest(robot, robot->config.sense_interval_us);
    if (interval_us == GROBO_SENSE_NEVER) {
        return GROBO_I_NEXT;
    }
    return tell_watchdog(robot, grobo_i_later(robot->driver->watchdog_us, 2 * interval_us));
}

static int step_hold(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    grobo_joint_mask loose = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(job->pending, j) && isnan(grobo_i_hold_rad(robot, j))) {
            grobo_i_job_fail_joint(robot, j, GROBO_ERR_LIMIT,
                                   grobo_deg_from_rad(robot->axes[j].state.angle_rad));
            job->pending &= ~grobo_i_coupled(robot, GROBO_JOINT_BIT(j));
            loose &= job->pending;
        } else if (grobo_i_has(job->pending, j) && !grobo_i_is_ready(&robot->axes[j])) {
            loose |= GROBO_JOINT_BIT(j);
        }
    }
    int result = grobo_i_gate_hold(robot, loose, chunk_of(robot));
    return result < 0 && result != GROBO_ERR_FULL ? result : GROBO_I_DRAIN;
}

static int step_hold_check(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    grobo_joint_mask bad = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(job->pending, j)) {
            grobo_robot_axis *axis = &robot->axes[j];
            /* A goal that switched it on was its angle as it left; it may have fallen since. */
            bool woken = GROBO_I_EXTRA(grobo_i_driver_of(robot, j), goal_energises) &&
                         grobo_i_axis_is_on(axis);
            bool holds = !grobo_i_has(job->failed, j) && grobo_i_goal_is_told(axis) &&
                         (woken || grobo_i_goal_holds(robot, j));
            grobo_i_joint_to(axis, holds ? GROBO_I_JOINT_HOLDS : GROBO_I_JOINT_LOOSE);
            bad |= holds ? 0 : GROBO_JOINT_BIT(j);
        }
    }
    return again(robot, bad, step_hold);
}

/* The emergency stop of a driver that does not switch torque: all stand, and hold. */
static int stop_by_halt(grobo_robot *robot)
{
    robot->holds_at_stop = true;
    robot->job->script = grobo_i_script_exit_hold;
    robot->job->at = 0;
    grobo_i_gate_halt(robot, grobo_i_all_joints(robot));
    return GROBO_I_NEXT;
}

static int step_torque(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    int result = grobo_i_gate_torque(robot, job->pending, job->torque, chunk_of(robot));
    if (result < 0 && result != GROBO_ERR_FULL) {
        return job->kind == GROBO_JOB_ESTOP ? stop_by_halt(robot) : result;
    }
    return GROBO_I_DRAIN;
}

static bool torque_taken(const grobo_robot *robot, int joint)
{
    grobo_torque has = robot->axes[joint].state.torque;
    return has == robot->job->torque ||
           (robot->job->kind == GROBO_JOB_ESTOP && has == GROBO_TORQUE_OFF);
}

/* A servo that is not set up for its joint tells its torque all the same. */
static void excuse_setup(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        if (grobo_i_has(job->failed & job->pending, j) && axis->status == GROBO_ERR_SETUP &&
            axis->torque_known && axis->torque_us >= axis->told_us) {
            job->failed &= ~GROBO_JOINT_BIT(j);
        }
    }
    job->result = job->failed == 0 ? GROBO_OK : job->result;
}

static int step_torque_check(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    grobo_joint_mask bad = 0;
    bool on = job->torque == GROBO_TORQUE_ON;
    if (!on) {
        excuse_setup(robot);
    }
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (!grobo_i_has(job->pending, j)) {
            continue;
        }
        if (grobo_i_has(job->failed, j) || !torque_taken(robot, j)) {
            bad |= GROBO_JOINT_BIT(j);
            grobo_i_joint_to(&robot->axes[j], GROBO_I_JOINT_LOOSE);
        } else {
            grobo_robot_axis *axis = &robot->axes[j];
            axis->wants_torque = on;
            if (!on ||
                !grobo_i_has_target(axis)) { /* or it was sent on its trajectory since it holds */
                grobo_i_axis_rest(axis, robot->now_us);
            }
            bool holds = on && !grobo_i_is_wheel(robot, j); /* a wheel is sent nowhere */
            grobo_i_joint_to(axis, holds ? GROBO_I_JOINT_ON : GROBO_I_JOINT_OFF);
        }
    }
    job->pending = bad;
    return again(robot, bad, on ? step_hold : step_torque);
}

static int step_pick_all(grobo_robot *robot)
{
    robot->job->pending = robot->job->joints;
    robot->job->rounds = 0;
    robot->job->failed = 0;
    robot->job->result = GROBO_OK;
    return GROBO_I_NEXT;
}

/* ---- moving ---------------------------------------------------------------------------------- */

static int step_aim(grobo_robot *robot)
{
    robot->job->pending = robot->job->target.set;
    robot->job->rounds = 0;
    return GROBO_I_NEXT;
}

/* The target of one joint cannot be sent: the others of a move asked for joint by joint go without
 * it. @return false where that ends the move. */
static bool send_without(grobo_robot *robot, grobo_joint_mask *left, int result)
{
    grobo_robot_task *job = robot->job;
    job->joint = robot->fault_joint;
    job->value = robot->fault_deg;
    grobo_joint_mask bad = job->joint >= 0 ? GROBO_JOINT_BIT(job->joint) & *left : 0;
    if (!job->singly || bad == 0 || job->joints == bad) {
        return false;
    }
    job->result = result;
    grobo_i_job_give_up(robot, bad);
    *left &= ~bad;
    return true;
}

static int step_send(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    grobo_i_motion how = {.priority = job->priority,
                          .due_us = GROBO_NEVER_US,
                          .each = job->singly,
                          .as_is = job->kind == GROBO_JOB_SETTLE, /* the stabilizer has seen it */
                          .stops = job->kind == GROBO_JOB_EXIT,
                          .joint_time_us = job->singly ? job->joint_time_us : NULL};
    grobo_joint_mask all = job->turned != 0 ? job->turned & job->pending : job->pending;
    grobo_joint_mask left = all;
    job->turned = 0;
    job->sent_us = robot->now_us;
    while (left != 0) {
        grobo_posture part = job->target;
        part.set = grobo_i_take_chunk(&left, chunk_of(robot));
        int result = grobo_i_gate_send(robot, &part, &how);
        if (result == GROBO_ERR_FULL && (left | part.set) != all) {
            break; /* the rest in the next round */
        }
        left |= result < 0 ? part.set : 0;
        if (result < 0 && !send_without(robot, &left, result)) {
            return result;
        }
    }
    return GROBO_I_DRAIN;
}

/* Until those that were sent are there: they got their time when their frames left. */
static int step_arrive(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    int64_t there_us = robot->now_us;
    if (job->pending == 0) {
        return GROBO_I_NEXT;
    }
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(job->pending, j)) {
            there_us = grobo_i_later(there_us, robot->axes[j].trajectory.to_us);
        }
    }
    job->until_us = there_us + ARRIVAL_US;
    return GROBO_I_WAIT;
}

/* What was sent is read back; a step of its own, to go back to. */
static int step_read_back(grobo_robot *robot)
{
    return step_read_pending(robot);
}

/* True of a joint that the frames of the target left out: a servo may have restarted, and gets no
 * goal before it was heard. By now it was. */
static bool is_unsent(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    return GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), goal_energises) &&
           robot->job->sent_us > 0 &&
           (!grobo_i_has_target(axis) || axis->trajectory.from_us < robot->job->sent_us ||
            axis->trajectory.to_us <= axis->trajectory.from_us);
}

/* Of the joints just read, those whose goal is not the one they were sent to, or that were not. */
static grobo_joint_mask not_taken(const grobo_robot *robot)
{
    grobo_joint_mask read = robot->job->pending & ~robot->job->failed;
    grobo_joint_mask bad = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(read, j) && (!grobo_i_goal_is_taken(robot, j) || is_unsent(robot, j))) {
            bad |= GROBO_JOINT_BIT(j);
        }
    }
    return bad;
}

/* Joints that are not on their trajectory begin anew from where they were read. One that could
 * not be read is left alone: it is on its trajectory or where it was, and nobody knows. */
static int step_missed(grobo_robot *robot)
{
    grobo_joint_mask bad = not_taken(robot);
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(bad, j)) {
            grobo_i_axis_here(&robot->axes[j], robot->now_us);
        }
    }
    robot->job->pending = bad;
    robot->job->failed = 0;
    robot->job->result = GROBO_OK;
    return GROBO_I_NEXT;
}

static int step_arrived(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    grobo_joint_mask lost = job->pending & job->failed;
    if (lost != 0) {
        job->pending = lost | not_taken(robot);
        return again(robot, lost, step_read_back);
    }
    (void)step_missed(robot);
    grobo_joint_mask bad = job->pending;
    int result = again(robot, bad, step_send);
    robot->soft = result == GROBO_I_NEXT && bad == 0 ? false : robot->soft;
    return result;
}

/* A joint that carries weight sags or swings behind its trajectory. It is read so often until it
 * rests, and no longer than that; then its move is over, and its event names how far it is from
 * its goal. */
#define RESTS_AGAIN_US 50000
#define RESTS_BY_US 1500000

static int step_rest(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    job->pending = 0;
    job->until_us = robot->now_us + RESTS_AGAIN_US;
    bool looks = !GROBO_DRIVERS_PLAIN && job->result == GROBO_OK;
    for (int j = 0; looks && j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        bool late = robot->now_us - axis->trajectory.to_us >= RESTS_BY_US;
        bool asked = grobo_i_has(job->joints, j) && grobo_i_has_target(axis);
        if (!asked || grobo_i_rests(robot, j)) {
            continue;
        }
        job->pending |= late ? 0 : GROBO_JOINT_BIT(j);
        if (late) {
            job->joint = j;
            job->value = grobo_deg_from_rad(axis->state.angle_rad - axis->trajectory.to_rad);
        }
    }
    return job->pending != 0 ? GROBO_I_WAIT : GROBO_I_NEXT;
}

/* That a reading of it is lost makes no move fail. */
static int step_rest_more(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    if (!GROBO_DRIVERS_PLAIN && job->pending != 0) {
        job->failed = 0;
        job->result = GROBO_OK;
        grobo_i_job_goto(robot, step_rest);
    }
    return GROBO_I_NEXT;
}

/* A joint that has so far to go to where playing begins is looked after. */
#define FAR_RAD (3 * 0.017453292519943295)

static int step_play(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    int result = grobo_i_play_start(robot);
    job->pending = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        double here_rad = grobo_i_axis_commanded(axis, robot->now_us);
        if (axis->next != 0 && !grobo_i_near_rad(here_rad, axis->next_rad, FAR_RAD)) {
            job->pending |= GROBO_JOINT_BIT(j);
        }
    }
    job->motion = robot->motion;
    job->rounds = 0;
    return result;
}

/* The approach is one frame, and all that follows relies on it: if it was lost, all over again.
 * Once another one was sent, what was read back says nothing any more. */
static int step_approached(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    bool approaching = grobo_robot_play_state(robot) == GROBO_SEQUENCER_APPROACHING &&
                       robot->motion == job->motion;
    grobo_joint_mask lost = approaching ? job->pending & job->failed : 0;
    grobo_joint_mask bad = approaching ? not_taken(robot) : 0;
    job->failed = 0;
    job->result = GROBO_OK;
    if (bad == 0 && (lost == 0 || job->rounds >= ROUNDS)) {
        return GROBO_I_NEXT;
    }
    if (bad == 0) {
        job->pending = lost;
        return again(robot, lost, step_read_back);
    }
    grobo_sequencer_reset(&robot->sequencer);
    if (job->restarts++ >= ROUNDS) {
        grobo_i_gate_halt(robot, grobo_i_all_joints(robot));
        return GROBO_ERR_MISMATCH;
    }
    grobo_i_gate_soften(robot);
    grobo_i_job_goto(robot, step_read);
    return GROBO_I_NEXT;
}

/* The last posture of a motion: what was lost of it is sent once more, softly. */
static int step_aim_last(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    (void)grobo_robot_target(robot, &job->target);
    job->target.set &= job->joints;
    grobo_i_gate_soften(robot);
    return step_aim(robot);
}

/* ---- leaving --------------------------------------------------------------------------------- */

/* Half of its time is for making the robot limp, whatever moves yet. */
static bool is_pressed(const grobo_robot *robot)
{
    const grobo_robot_task *job = robot->job;
    return job->lets_go && robot->now_us - job->begun_us >= (job->bound_us - job->begun_us) / 2;
}

static int step_quiet(grobo_robot *robot)
{
    bool still = !grobo_i_is_playing(robot) && !grobo_i_slots_busy(robot, GROBO_I_USE_HALT);
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        bool ends = !grobo_i_axis_moves(axis, robot->now_us) || !grobo_i_may_halt(robot);
        still = still && axis->next == 0 && ends;
    }
    if (still || is_pressed(robot)) {
        return GROBO_I_NEXT;
    }
    grobo_i_job_goto(robot, step_quiet);
    robot->job->until_us = robot->now_us + QUIET_US;
    return GROBO_I_WAIT;
}

/* Joints with torque that were not read to stand. */
static grobo_joint_mask doubtful(const grobo_robot *robot)
{
    grobo_joint_mask on =
        joints_with(robot, robot->job->joints & ~robot->job->failed, GROBO_TORQUE_ON);
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        on &= grobo_i_stands(robot, j) ? ~GROBO_JOINT_BIT(j) : on;
    }
    return on;
}

/* Those that go on are stopped anew, but for those that are arriving, and all are looked at again;
 * an emergency stop is not over before each joint was read to stand. */
static int stop_strays(grobo_robot *robot, grobo_joint_mask astray, grobo_joint_mask arriving)
{
    grobo_robot_task *job = robot->job;
    bool emergency = job->kind == GROBO_JOB_ESTOP;
    if (astray != 0 && (emergency || job->rounds < ROUNDS)) {
        grobo_i_gate_halt(robot, grobo_i_all_joints(robot) & ~arriving);
    }
    astray |= arriving;
    if (emergency) {
        astray |= job->failed;
        job->joints = astray | doubtful(robot);
    }
    return again(robot, astray, step_quiet);
}

/* Nothing goes on behind our back: a halt may be lost, or another program may have been killed. */
static int step_strays(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    grobo_joint_mask astray = 0, arriving = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        bool asked = grobo_i_has(job->joints & ~job->failed, j);
        if (asked && grobo_i_arrives(robot, j)) {
            arriving |= GROBO_JOINT_BIT(j);
        } else if (asked && grobo_i_goes_on(robot, j)) {
            astray |= GROBO_JOINT_BIT(j);
        }
    }
    return stop_strays(robot, astray, arriving);
}

/* A joint that was not read to stand is read again until that shows it, and meanwhile so often. */
#define DOUBT_US 100000

static int step_doubt(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    job->pending = doubtful(robot);
    job->until_us = robot->now_us;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        int64_t since_us = robot->axes[j].still_us;
        since_us = since_us == GROBO_NEVER_US ? robot->now_us : since_us;
        if (grobo_i_has(job->pending, j)) {
            job->until_us = grobo_i_later(job->until_us, since_us + grobo_i_stand_us(robot, j));
        }
    }
    job->until_us = grobo_i_sooner(job->until_us, robot->now_us + DOUBT_US);
    return job->pending != 0 ? GROBO_I_WAIT : GROBO_I_NEXT;
}

/* A joint that has left the place where it was read moves, however slowly, and whatever speed its
 * servo reports. */
static int step_moved(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    grobo_joint_mask doubt = job->pending & doubtful(robot), lost = job->pending & job->failed;
    grobo_joint_mask moved = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        bool sags = !GROBO_DRIVERS_PLAIN &&
                    (grobo_i_swings(robot, j) || grobo_i_may_sag(robot, j, job->begun_us));
        if (grobo_i_has(doubt, j) && grobo_i_stand_left(&robot->axes[j]) &&
            (!sags || grobo_i_creeps_to_its_goal(robot, j))) {
            grobo_i_astray(robot, j);
            moved |= GROBO_JOINT_BIT(j);
        }
    }
    if (moved == 0 && lost == 0 && doubt != 0) {
        grobo_i_job_goto(robot, step_doubt);
        return GROBO_I_NEXT;
    }
    job->pending = 0;
    return stop_strays(robot, moved, lost);
}

/* Sits down with the joints that hold; a robot that is limp stays so. Who could not be down in time
 * stands better than half way. */
static int step_aim_rest(grobo_robot *robot)
{
    const grobo_driver *driver = robot->driver;
    grobo_robot_task *job = robot->job;
    grobo_posture_init_pose(&job->target, driver->model);
    for (int j = 0; driver->rest_rad != NULL && j < driver->model->n_joints; j++) {
        job->target.angle_rad[j] = driver->rest_rad[j];
    }
    job->target.set = joints_with(robot, job->joints & ~grobo_i_wheels(robot), GROBO_TORQUE_ON);
    int64_t takes_us = grobo_i_gate_soft_us(robot, &job->target);
    if (takes_us != GROBO_NEVER_US && takes_us > job->bound_us - robot->now_us) {
        return GROBO_ERR_TIMEOUT;
    }
    job->sits = true;
    grobo_i_gate_soften(robot);
    return step_aim(robot);
}

/* It is down. */
static int step_let_go(grobo_robot *robot)
{
    robot->job->sits = false;
    robot->job->lets_go = true;
    return GROBO_I_NEXT;
}

/* ---- scripts --------------------------------------------------------------------------------- */

#define SWITCH_ON                                                                                  \
    step_limit, step_read_pending, step_limit_check, step_pick_off, step_watchdog_clear,           \
        step_hold, step_read_pending, step_hold_check, step_torque, step_read_pending,             \
        step_torque_check, step_watchdog_set
#define TWICE step_look_twice, step_read_twice
#define SWITCH step_pick_all, step_torque, step_read_pending, step_torque_check
#define MOVE step_send, step_arrive, step_read_back, step_arrived

const grobo_robot_step_fn grobo_i_script_sense[] = {step_read, NULL};
const grobo_robot_step_fn grobo_i_script_torque_on[] = {step_read, TWICE, SWITCH_ON, NULL};
const grobo_robot_step_fn grobo_i_script_torque_off[] = {SWITCH, NULL};
const grobo_robot_step_fn grobo_i_script_move[] = {
    step_read, TWICE,        step_read_again,   step_require,
    SWITCH_ON, step_require, step_from_here,    step_aim,
    MOVE,      step_rest,    step_read_pending, step_rest_more,
    NULL};
const grobo_robot_step_fn grobo_i_script_play[] = {
    step_read,      TWICE,     step_read_again, step_require,    SWITCH_ON, step_require,
    step_from_here, step_play, step_read_back,  step_approached, NULL};
const grobo_robot_step_fn grobo_i_script_settle[] = {step_aim_last, step_read_pending, step_missed,
                                                     MOVE, NULL};
const grobo_robot_step_fn grobo_i_script_ask[] = {step_ask, step_settle, NULL};
const grobo_robot_step_fn grobo_i_script_exit_off[] = {step_quiet, step_watchdog_clear, SWITCH,
                                                       NULL};
const grobo_robot_step_fn grobo_i_script_exit_hold[] = {
    step_quiet, step_read,         TWICE,      step_hear_all,       step_strays,
    step_doubt, step_read_pending, step_moved, step_watchdog_clear, NULL};
const grobo_robot_step_fn grobo_i_script_exit_sit[] = {
    step_quiet, step_read,    step_read_again, step_require,        step_from_here, step_aim_rest,
    MOVE,       step_require, step_let_go,     step_watchdog_clear, SWITCH,         NULL};

/* ---- another target -------------------------------------------------------------------------- */

bool grobo_i_move_settles(const grobo_robot_task *job)
{
    unsigned resting = 0;
    if (GROBO_DRIVERS_PLAIN || job->kind != GROBO_JOB_MOVE || job->script != grobo_i_script_move) {
        return false;
    }
    while (job->script[resting] != step_rest) {
        resting++;
    }
    return job->at > resting;
}

bool grobo_i_move_is_sent(const grobo_robot_task *job)
{
    unsigned sending = 0;
    while (job->script[sending] != step_send) {
        sending++;
    }
    return job->at > sending;
}

/* Of a move asked for joint by joint: the others are on their trajectories, or wait for the
 * line. */
static void retarget_some(grobo_robot *robot, const grobo_posture *target)
{
    grobo_robot_task *job = robot->job;
    grobo_i_slots_cancel_own(robot, target->set);
    for (int j = 0; j < target->n_joints; j++) {
        if (grobo_i_has(target->set, j)) {
            job->target.angle_rad[j] = target->angle_rad[j];
            job->joint_time_us[j] = (int32_t)grobo_i_sooner(target->time_us, INT32_MAX);
        }
    }
    job->joints |= target->set;
    job->target.set = job->pending = job->joints;
    job->turned |= target->set;
}

/* A reading on the wire comes to its end; whatever else the job waits for is over. */
void grobo_i_move_retarget(grobo_robot *robot, const grobo_posture *target)
{
    grobo_robot_task *job = robot->job;
    if ((job->joints & ~target->set) != 0) {
        retarget_some(robot, target);
    } else {
        grobo_i_slots_cancel_goals(robot, job->joints, false);
        job->target = *target;
        job->joints = job->pending = target->set;
        job->singly = false;
        job->turned = 0;
    }
    job->out &= ~target->set;
    job->superseded &= ~target->set; /* what another move had is its own again */
    job->rounds = 0;
    job->failed = job->todo = 0;
    job->result = GROBO_OK;
    job->until_us = robot->now_us;
    grobo_i_job_goto(robot, step_send);
    grobo_i_job_run(robot);
}
