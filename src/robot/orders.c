/* SPDX-License-Identifier: MIT */
/* Orders to motors: targets, halts, holds and torque, put into the frames that wait for the line.
 * Nothing is noted of them here but what waits; gate.c judges them again as they leave. */
#include "src/base/instant.h"
#include "src/robot/axis.h"
#include "src/robot/couple.h"
#include "src/robot/gate.h"
#include "src/robot/halted.h"
#include "src/robot/lines.h"
#include "src/robot/orders.h"
#include "src/robot/pace.h"
#include "src/robot/robot.h"
#include "src/robot/slot.h"
#include "src/robot/speed.h"
#include "src/robot/stand.h"
#include "src/robot/state.h"
#include "src/robot/trajectories.h"
#include "src/robot/wheel.h"

/* How the frames of an order go. */
typedef struct way_out {
    grobo_i_use use;
    grobo_priority priority;
    int64_t due_us;
} way_out;

/* 1: it waits for the line; 0: the driver has no frame for it; GROBO_ERR_CAP: one is too few. */
static int send_one(grobo_robot *robot, const grobo_robot_order *order, const way_out *out)
{
    grobo_robot_slot *slot = grobo_i_slot_take(robot, out->use);
    if (slot == NULL) {
        return GROBO_ERR_FULL;
    }
    slot->order = *order;
    slot->due_us = out->due_us;
    slot->job = out->due_us != GROBO_NEVER_US ? 0 : slot->job; /* the sequencer's, not a job's */
    int result = grobo_i_gate_build(robot, &slot->order, &robot->built);
    if (result <= 0) {
        grobo_i_slot_drop(slot);
        return result;
    }
    result = grobo_i_slot_send(slot, &robot->built, out->priority);
    if (result >= 0 && out->use == GROBO_I_USE_MOTION) {
        grobo_bus_cost cost;
        grobo_bus_cost_of(grobo_i_bus_of(slot), &slot->txn, &cost);
        robot->motion_us += cost.total_us;
    }
    return result < 0 ? result : 1;
}

/* A driver may need several frames for one joint. */
static int send_parts(grobo_robot *robot, grobo_robot_order order, const way_out *out)
{
    int more = 1;
    for (order.part = 0; more > 0 && order.part < UINT8_MAX; order.part++) {
        more = send_one(robot, &order, out);
    }
    if (order.part == 1) {
        grobo_i_gate_unwait(robot, &order); /* the driver has no frame for it */
    }
    return more;
}

/* The same, with joints that follow others in the frame of those, where several have room. */
static grobo_joint_mask take_together(const grobo_robot *robot, grobo_joint_mask *joints,
                                      grobo_i_chunk chunk)
{
    grobo_joint_mask taken = grobo_i_take_chunk(joints, chunk);
    if (chunk > 1) {
        taken |= grobo_i_coupled(robot, taken) & *joints;
    }
    *joints &= ~taken;
    return taken;
}

/* To joints of one line. Each frame has joints of its own, so that what is noted of it is about
 * these: as few frames as the driver can do with. */
static int send_on_line(grobo_robot *robot, grobo_robot_order order, const way_out *out)
{
    grobo_joint_mask left = order.joints;
    int count = grobo_joints_count(left);
    int frames = 1;
    int result = GROBO_OK;
    while (left != 0 && result >= 0) {
        int chunk = (count + frames - 1) / frames;
        grobo_joint_mask rest = left;
        order.joints = take_together(robot, &rest, (grobo_i_chunk)chunk);
        result = chunk > 1 ? send_one(robot, &order, out) : send_parts(robot, order, out);
        if (result == GROBO_ERR_CAP && chunk > 1) {
            frames++;
            result = GROBO_OK;
            continue;
        }
        result = result == GROBO_ERR_EMPTY ? 0 : result; /* nothing for these, but for others */
        left = rest;
        if (result == 0 && chunk > 1) {
            grobo_i_gate_unwait(robot, &order);
        }
    }
    return result < 0 ? result : GROBO_OK;
}

/* What one line does not take keeps no other line from stopping. */
static int send_order(grobo_robot *robot, grobo_robot_order order, const way_out *out)
{
    grobo_joint_mask all = order.joints;
    int result = GROBO_OK;
    for (int i = 0; i < grobo_i_lines(robot); i++) {
        order.joints = all & grobo_i_joints_on(robot, i);
        int sent = order.joints != 0 ? send_on_line(robot, order, out) : GROBO_OK;
        result = result < 0 ? result : sent;
    }
    return result;
}

grobo_joint_mask grobo_i_take_chunk(grobo_joint_mask *joints, grobo_i_chunk chunk)
{
    grobo_joint_mask taken = 0;
    int n = 0;
    for (int j = 0; j < GROBO_JOINTS_MAX && n < (int)chunk; j++) {
        if ((*joints & GROBO_JOINT_BIT(j)) != 0) {
            taken |= GROBO_JOINT_BIT(j);
            n++;
        }
    }
    *joints &= ~taken;
    return taken;
}

/* ---- targets --------------------------------------------------------------------------------- */

static int64_t time_asked(const grobo_robot *robot, int joint, int64_t time_us)
{
    const grobo_driver *driver = grobo_i_driver_of(robot, joint);
    int64_t step_us = driver->time_step_us;
    time_us = time_us > 0 ? time_us : robot->config.default_time_us;
    time_us = grobo_i_sooner(time_us, driver->time_max_us);
    return grobo_i_later((time_us + step_us / 2) / step_us, 1) * step_us;
}

#if GROBO_DRIVERS_PLAIN
static bool has_stabilize_by(const grobo_driver *driver)
{
    (void)driver;
    return false;
}
static int stabilize_by(const grobo_robot *robot, const grobo_posture *sensed,
                        const grobo_posture *target)
{
    (void)robot;
    (void)sensed;
    (void)target;
    return GROBO_OK;
}
#else
static bool has_stabilize_by(const grobo_driver *driver)
{
    return GROBO_I_MEMBER(driver, driver->size, stabilize_by) != NULL;
}

static int stabilize_by(const grobo_robot *robot, const grobo_posture *sensed,
                        grobo_posture *target)
{
    const grobo_driver *driver = robot->driver;
    if (!has_stabilize_by(driver)) {
        return GROBO_OK;
    }
    grobo_imu imu;
    int64_t age_us = 0;
    bool known = grobo_robot_imu(robot, &imu, &age_us) == GROBO_OK && age_us <= GROBO_IMU_AGE_US;
    return driver->stabilize_by(driver, robot->driver_ctx, known ? &imu : NULL, sensed, target);
}
#endif

static int stabilize(grobo_robot *robot, grobo_posture *target)
{
    const grobo_driver *driver = robot->driver;
    if (driver->stabilize == NULL && !has_stabilize_by(driver)) {
        return GROBO_OK;
    }
    grobo_posture sensed;
    (void)grobo_robot_posture(robot, GROBO_NEVER_US, &sensed);
    int result = driver->stabilize == NULL
                     ? GROBO_OK
                     : driver->stabilize(driver, robot->driver_ctx, &sensed, target);
    return result < 0 ? result : stabilize_by(robot, &sensed, target);
}

/* Times the target from where its joints are now, and has it wait. It is timed again when it
 * leaves. */
static int await_line(grobo_robot *robot, const grobo_robot_order *order, grobo_target *target,
                      const int32_t *joint_time_us)
{
    int64_t asked_us = time_asked(robot, 0, target->posture.time_us);
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        target->joint_time_us[j] = asked_us;
    }
    for (int j = 0; grobo_i_lines(robot) > 1 && j < robot->driver->model->n_joints; j++) {
        target->joint_time_us[j] = time_asked(robot, j, target->posture.time_us);
    }
    for (int j = 0; joint_time_us != NULL && j < robot->driver->model->n_joints; j++) {
        target->joint_time_us[j] = time_asked(robot, j, joint_time_us[j]);
    }
    int result = grobo_i_gate_time(robot, order, target);
    for (int j = 0; result >= 0 && j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(order->joints, j)) {
            grobo_robot_axis *axis = &robot->axes[j];
            axis->next = order->number;
            axis->next_rad = target->posture.angle_rad[j];
            axis->next_time_us = order->rests ? asked_us : target->joint_time_us[j];
        }
    }
    return result;
}

/* True if a joint is told its trajectory in segments. */
static bool is_long(const grobo_robot *robot, const grobo_robot_order *order,
                    const grobo_target *target)
{
    bool is = false;
    bool parts = grobo_i_goes_in_parts(robot, order);
    for (int j = 0; parts && !is && j < robot->driver->model->n_joints; j++) {
        is = grobo_i_has(order->joints, j) &&
             grobo_i_segments_wanted(robot, j, target->joint_time_us[j]);
    }
    return is;
}

int grobo_i_gate_send(grobo_robot *robot, const grobo_posture *wanted, const grobo_i_motion *how)
{
    grobo_target target;
    target.posture = *wanted;
    target.posture.set &= ~grobo_i_wheels(robot); /* a motion has a column for each joint */
    int result = how->as_is ? GROBO_OK : stabilize(robot, &target.posture);
    if (result >= 0) {
        result = grobo_i_gate_target(robot, &target.posture);
    }
    grobo_joint_mask joints = target.posture.set;
    if (result >= 0 && !grobo_i_all_sensed(robot, joints, &robot->fault_joint)) {
        result = GROBO_ERR_STALE;
    }
    robot->motion = robot->motion == UINT32_MAX ? 1 : robot->motion + 1;
    grobo_robot_order order = {.joints = joints,
                               .number = robot->motion,
                               .kind = GROBO_I_ORDER_GOAL,
                               .each = how->each,
                               .soft = robot->soft,
                               .single = how->single,
                               .moves = true,
                               .stops = how->stops,
                               .rests = how->rests};
    if (result >= 0) {
        result = await_line(robot, &order, &target, how->joint_time_us);
    }
    if (result >= 0 && is_long(robot, &order, &target) &&
        !grobo_i_pace(robot, joints | grobo_i_trajectories_renewed(robot))) {
        result = GROBO_ERR_UNWATCHED;
    }
    if (result >= 0) {
        robot->motion_us = 0;
        result =
            send_order(robot, order, &(way_out){GROBO_I_USE_MOTION, how->priority, how->due_us});
    }
    if (result < 0) {
        grobo_i_gate_unwait(robot, &order); /* all of it or nothing: its frames are stale by that */
    }
    return result;
}

void grobo_i_gate_renew(grobo_robot *robot, grobo_joint_mask joints)
{
    grobo_robot_order order = {
        .joints = joints, .kind = GROBO_I_ORDER_SEGMENT, .each = true, .moves = true};
    (void)send_order(robot, order,
                     &(way_out){GROBO_I_USE_SEGMENT, GROBO_PRIORITY_MOTION, GROBO_NEVER_US});
}

void grobo_i_gate_speeds(grobo_robot *robot, grobo_joint_mask wheels)
{
    grobo_robot_order order = {
        .joints = wheels, .kind = GROBO_I_ORDER_SPEED, .each = true, .moves = true};
    (void)send_order(robot, order,
                     &(way_out){GROBO_I_USE_SPEED, GROBO_PRIORITY_MOTION, GROBO_NEVER_US});
}

/* ---- halting --------------------------------------------------------------------------------- */

static void send_halt(grobo_robot *robot, grobo_joint_mask joints, bool owed)
{
    grobo_robot_order order = {.asked_us = robot->now_us,
                               .kind = GROBO_I_ORDER_HALT,
                               .each = true,
                               .stops = true,
                               .owed = owed};
    const way_out out = {GROBO_I_USE_HALT, GROBO_PRIORITY_STOP, GROBO_NEVER_US};
    order.joints = joints & grobo_i_wheels(robot); /* they turn on, others come to their goals */
    (void)send_order(robot, order, &out);
    order.joints = joints & ~grobo_i_wheels(robot);
    (void)send_order(robot, order, &out);
}

grobo_joint_mask grobo_i_unknown(const grobo_robot *robot)
{
    grobo_joint_mask found = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        found |= grobo_i_axis_is_unknown(robot, j) ? GROBO_JOINT_BIT(j) : 0;
    }
    return found;
}

/* True of a joint of an arm that has arrived by what it was told, and was not read since, or not to
 * be there and whether it turns: all of an arm is read in the time of a frame or two. */
static bool is_unread(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    return robot->driver->arm && grobo_i_has_target(axis) &&
           !grobo_i_axis_moves(axis, robot->now_us) &&
           (axis->angle_us < axis->told_us || grobo_i_axis_is_late(axis));
}

/* True of a joint with torque that was read, but neither to stand nor to leave its place, and whose
 * servo tells no speed, or so low a one that it may creep: where it stands in its load, a halt to
 * the angle read would let it sink. */
static bool may_stand(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool may = grobo_i_is_mute(robot, joint) || grobo_i_may_creep(robot, joint);
    if (!may || !grobo_i_axis_is_on(axis)) {
        return false;
    }
    bool leaves = axis->seen_dps != GROBO_I_NO_SPEED && grobo_i_stand_left(axis);
    return !leaves && !grobo_i_stands(robot, joint);
}

/* Such a joint is halted once it was read. By then a servo that has restarted would have said so:
 * one that is still silent may hear what it does not answer. Where a reading comes in parts, one
 * that tells torque does not tell yet where the joint is. */
static int64_t may_halt_at(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool parts = GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), sense_more) != NULL;
    bool known = !parts && !grobo_i_axis_is_unknown(robot, joint) && !is_unread(robot, joint);
    if (!may_stand(robot, joint) &&
        (known || (grobo_i_is_sensed(axis) && axis->angle_us >= robot->halt_us))) {
        return robot->now_us;
    }
    bool sleeps = grobo_i_is_sensed(axis) && grobo_i_may_sleep(robot, joint);
    return (sleeps ? axis->heard_us : robot->halt_us) + 3 * GROBO_I_RESTART_US;
}

void grobo_i_gate_halt(grobo_robot *robot, grobo_joint_mask joints)
{
    grobo_i_slots_cancel(robot, GROBO_I_USE_MOTION);
    grobo_i_slots_cancel(robot, GROBO_I_USE_SEGMENT);
    grobo_i_slots_cancel(robot, GROBO_I_USE_SPEED);
    grobo_i_wheels_forget(robot, joints);
    if (!grobo_i_may_halt(robot) || !robot->link) {
        return;
    }
    grobo_i_slots_hurry(robot);
    grobo_joint_mask unread = grobo_i_unknown(robot);
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        unread |= is_unread(robot, j) ? GROBO_JOINT_BIT(j) : 0;
    }
    grobo_i_halt_owe(robot, joints & unread & ~grobo_i_wheels(robot));
    joints &= ~robot->halts_owed;
    if (joints != 0) {
        if (!GROBO_DRIVERS_PLAIN) {
            grobo_i_halt_left(robot, joints & grobo_i_swinging(robot) & ~robot->halted, true);
        }
        send_halt(robot, joints, false);
    }
}

void grobo_i_gate_halt_again(grobo_robot *robot, grobo_joint_mask joints)
{
    send_halt(robot, joints, !grobo_i_may_halt(robot));
}

void grobo_i_gate_halt_owed(grobo_robot *robot)
{
    grobo_joint_mask joints = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        bool now = grobo_i_has(robot->halts_owed, j) && may_halt_at(robot, j) <= robot->now_us;
        joints |= now ? GROBO_JOINT_BIT(j) : 0;
    }
    robot->halts_owed &= ~joints;
    if (joints != 0) {
        send_halt(robot, joints, true);
    }
}

int64_t grobo_i_gate_halt_at(const grobo_robot *robot)
{
    int64_t at_us = GROBO_NEVER_US;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        bool owed = grobo_i_has(robot->halts_owed, j);
        at_us = owed ? grobo_i_sooner(at_us, may_halt_at(robot, j)) : at_us;
    }
    return at_us;
}

/* ---- torque ---------------------------------------------------------------------------------- */

static grobo_priority priority_of_job(const grobo_robot *robot)
{
    return robot->job->kind == GROBO_JOB_NONE ? GROBO_PRIORITY_USER : robot->job->priority;
}

int grobo_i_gate_hold(grobo_robot *robot, grobo_joint_mask joints, grobo_i_chunk chunk)
{
    grobo_robot_order order = {.kind = GROBO_I_ORDER_HOLD, .each = true};
    grobo_joint_mask wheels = joints & grobo_i_wheels(robot);
    int result = GROBO_OK;
    joints &= ~wheels;
    while ((joints | wheels) != 0 && result >= 0) {
        order.joints = take_together(robot, joints != 0 ? &joints : &wheels, chunk);
        result = send_order(robot, order,
                            &(way_out){GROBO_I_USE_PLAIN, GROBO_PRIORITY_USER, GROBO_NEVER_US});
    }
    return result;
}

int grobo_i_gate_torque(grobo_robot *robot, grobo_joint_mask joints, grobo_torque mode,
                        grobo_i_chunk chunk)
{
    grobo_robot_order order = {
        .asked_us = robot->now_us, .kind = GROBO_I_ORDER_TORQUE, .torque = (uint8_t)mode};
    if (robot->driver->torque == NULL) {
        return GROBO_ERR_UNSUPPORTED;
    }
    if (mode != GROBO_TORQUE_ON) {
        grobo_i_slots_keep_off(robot, joints);
        grobo_i_wheels_forget(robot, joints);
    }
    int result = GROBO_OK;
    while (joints != 0 && result >= 0) {
        order.joints = take_together(robot, &joints, chunk);
        result = send_order(robot, order,
                            &(way_out){GROBO_I_USE_PLAIN, priority_of_job(robot), GROBO_NEVER_US});
    }
    return result;
}

bool grobo_i_gate_ready(const grobo_robot *robot, grobo_joint_mask joints)
{
    int joint;
    return grobo_i_all_sensed(robot, joints, &joint) && grobo_i_all_on(robot, joints);
}
