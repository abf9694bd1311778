/* SPDX-License-Identifier: MIT */
/*
 * The only way to motors. Every target goes through grobo_i_gate_send() or grobo_i_gate_hold(),
 * every torque through grobo_i_gate_torque(): these three call the driver's functions that build
 * motor frames, and nothing else does. A user's raw frame is read and judged by the same rules.
 */
#include "core/robot.h"

#include <math.h>

/* ---- where a joint is ------------------------------------------------------------------------ */

static double along(const grobo_robot_way *way, int64_t now_us)
{
    if (now_us >= way->to_us || way->to_us <= way->from_us) {
        return way->to_rad;
    }
    if (now_us <= way->from_us) {
        return way->from_rad;
    }
    double part = (double)(now_us - way->from_us) / (double)(way->to_us - way->from_us);
    return way->from_rad + (way->to_rad - way->from_rad) * part;
}

double grobo_i_axis_commanded(const grobo_robot_axis *axis, int64_t now_us)
{
    return along(&axis->way, now_us);
}

void grobo_i_axis_rest(grobo_robot_axis *axis, int64_t now_us)
{
    double angle_rad = axis->state.angle_rad;
    axis->way = axis->way_before = (grobo_robot_way){angle_rad, angle_rad, now_us, now_us};
}

void grobo_i_axis_here(grobo_robot_axis *axis, int64_t now_us)
{
    grobo_i_axis_rest(axis, now_us);
    if (axis->own_until_us > axis->angle_us) { /* by now it may have arrived */
        axis->way = (grobo_robot_way){axis->state.angle_rad, axis->state.goal_rad, axis->angle_us,
                                      axis->own_until_us};
        axis->way_before = axis->way;
    }
}

bool grobo_i_gate_moving(const grobo_robot *robot)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (robot->axes[j].has_target && robot->axes[j].way.to_us > robot->now_us) {
            return true;
        }
    }
    return false;
}

bool grobo_i_adrift(const grobo_robot *robot, grobo_joint_mask joints)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if ((joints & GROBO_JOINT_BIT(j)) != 0 && robot->axes[j].adrift) {
            return true;
        }
    }
    return false;
}

void grobo_i_gate_forget(grobo_robot *robot, grobo_joint_mask joints)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if ((joints & GROBO_JOINT_BIT(j)) != 0) {
            robot->axes[j].sensed = robot->axes[j].has_target = robot->axes[j].held = false;
            robot->axes[j].own_until_us = 0;
        }
    }
    grobo_i_gate_soften(robot);
}

/* Notes where the joints of a target are on their way to. */
static void note_way(grobo_robot *robot, const grobo_target *target)
{
    int64_t now_us = robot->now_us;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if ((target->posture.set & GROBO_JOINT_BIT(j)) != 0) {
            grobo_robot_axis *axis = &robot->axes[j];
            double from_rad = grobo_i_axis_commanded(axis, now_us);
            axis->way_before = axis->way;
            axis->way = (grobo_robot_way){from_rad, target->posture.angle_rad[j], now_us,
                                          now_us + target->joint_time_us[j]};
            axis->motion = robot->motion;
            axis->own_until_us = 0;
            axis->has_target = true;
            axis->adrift = false;
        }
    }
}

void grobo_i_gate_sent(grobo_robot *robot, uint32_t motion)
{
    int64_t now_us = robot->now_us;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        grobo_robot_axis *axis = &robot->axes[j];
        if (axis->has_target && axis->motion == motion) {
            axis->way.from_rad = along(&axis->way_before, now_us);
            axis->way.to_us += now_us - axis->way.from_us;
            axis->way.from_us = now_us;
        }
    }
}

void grobo_i_gate_unsent(grobo_robot *robot, uint32_t motion)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        grobo_robot_axis *axis = &robot->axes[j];
        if (axis->has_target && axis->motion == motion) {
            axis->way = axis->way_before;
        }
    }
}

/* ---- numbers and limits ---------------------------------------------------------------------- */

int grobo_i_gate_target(grobo_robot *robot, grobo_posture *target)
{
    const grobo_model *model = robot->driver->model;
    int joint = -1;
    int result = grobo_posture_check(target, model, &joint);
    if (result == GROBO_ERR_LIMIT && robot->config.limit_policy == GROBO_LIMIT_CLAMP) {
        int clamped = grobo_posture_clamp(target, model);
        if (clamped >= 0) {
            robot->counters.clamped += (unsigned)clamped;
            return GROBO_OK;
        }
        result = clamped; /* a joint behind the first one has no number at all */
        joint = -1;
    }
    robot->fault_joint = result < 0 ? joint : -1;
    robot->fault_deg = joint >= 0 ? grobo_deg_from_rad(target->angle_rad[joint]) : 0;
    return result;
}

/* ---- speed ----------------------------------------------------------------------------------- */

void grobo_i_gate_soften(grobo_robot *robot)
{
    robot->soft = true;
    robot->soft_us = GROBO_NEVER_US;
}

/* Who times targets of his own may be early by this. */
#define EARLY_US 10000

void grobo_i_gate_single(grobo_robot *robot)
{
    if (robot->now_us >= robot->soft_us - EARLY_US) {
        robot->soft = false; /* where the first target was, it is by now */
    }
}

void grobo_i_gate_single_sent(grobo_robot *robot, int64_t time_us)
{
    if (robot->soft && robot->soft_us == GROBO_NEVER_US) {
        robot->soft_us = robot->now_us + time_us;
    }
}

static double speed_limit(const grobo_robot *robot, int joint)
{
    double most = robot->driver->model->joints[joint].max_speed_rad_s;
    double limit_rad_s = most * robot->config.speed_limit_pct / 100;
    double approach_rad_s = grobo_rad_from_deg(robot->config.approach_dps);
    return robot->soft && approach_rad_s < limit_rad_s ? approach_rad_s : limit_rad_s;
}

/* A halt: goes on for this long at half the speed, so that no joint is thrown back. */
#define HALT_AHEAD_US 50000
#define HALT_TIME_US 100000
/* Angles are rounded to 0.1 degree on the wire: that much further is not faster. */
#define ROUNDING_RAD (0.1 * 0.017453292519943295)

/* For a target that leaves at at_us. */
static int64_t time_needed(const grobo_robot *robot, int joint, double to_rad, int64_t at_us)
{
    int64_t step_us = robot->driver->time_step_us;
    const grobo_robot_axis *axis = &robot->axes[joint];
    double from_rad = grobo_i_axis_commanded(axis, at_us);
    double way_rad = fmax(fabs(to_rad - from_rad) - ROUNDING_RAD, 0);
    double needed_us = way_rad / speed_limit(robot, joint) * 1e6;
    if (robot->soft && axis->way.to_us > at_us) {
        needed_us = fmax(needed_us, HALT_TIME_US); /* it goes on until the frame is there */
    }
    double steps = fmax(ceil(needed_us / (double)step_us), 1);
    double most = (double)(GROBO_PLAY_TIME_MAX_US / step_us);
    return steps > most ? GROBO_NEVER_US : (int64_t)steps * step_us;
}

static int64_t time_asked(const grobo_robot *robot, const grobo_posture *posture)
{
    int64_t step_us = robot->driver->time_step_us;
    int64_t time_us = posture->time_us > 0 ? posture->time_us : robot->config.default_time_us;
    time_us = time_us < GROBO_PLAY_TIME_MAX_US ? time_us : GROBO_PLAY_TIME_MAX_US;
    int64_t steps = (time_us + step_us / 2) / step_us;
    return (steps < 1 ? 1 : steps) * step_us;
}

/* For a target that may wait for the line, whose joint goes on meanwhile. */
static int64_t time_to_give(const grobo_robot *robot, int joint, double to_rad)
{
    int64_t leaves_us = grobo_bus_free_at(&robot->bus, robot->now_us);
    int64_t now_us = time_needed(robot, joint, to_rad, robot->now_us);
    int64_t then_us = time_needed(robot, joint, to_rad, leaves_us);
    return then_us > now_us ? then_us : now_us;
}

/* Gives every joint its time; returns the longest, or GROBO_ERR_SPEED where no time on the wire is
 * long enough. */
static int64_t give_time(grobo_robot *robot, grobo_target *target, bool each)
{
    int64_t asked_us = time_asked(robot, &target->posture);
    int64_t longest_us = asked_us;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        target->joint_time_us[j] = asked_us;
        if ((target->posture.set & GROBO_JOINT_BIT(j)) != 0) {
            int64_t needed_us = time_to_give(robot, j, target->posture.angle_rad[j]);
            if (needed_us == GROBO_NEVER_US) {
                robot->fault_joint = j;
                return GROBO_ERR_SPEED;
            }
            target->joint_time_us[j] = needed_us > asked_us ? needed_us : asked_us;
            longest_us = needed_us > longest_us ? needed_us : longest_us;
        }
    }
    if (longest_us > asked_us) {
        robot->counters.stretched++;
    }
    for (int j = 0; !each && j < robot->driver->model->n_joints; j++) {
        target->joint_time_us[j] = longest_us;
    }
    return longest_us;
}

/* ---- frames ---------------------------------------------------------------------------------- */

static int send_frames(grobo_robot *robot, const grobo_target *target, grobo_i_use use,
                       grobo_priority priority, int64_t due_us)
{
    const grobo_driver *driver = robot->driver;
    for (int part = 0;; part++) {
        grobo_robot_slot *slot = grobo_i_slot_take(robot, use);
        if (slot == NULL) {
            return GROBO_ERR_FULL;
        }
        int more = driver->posture(driver, robot->driver_ctx, target, part, &slot->exchange);
        if (more <= 0) {
            grobo_i_slot_drop(slot);
            return more;
        }
        slot->due_us = due_us;
        slot->motion = use == GROBO_I_USE_MOTION ? robot->motion : 0;
        int result = grobo_i_slot_send(slot, priority);
        if (result < 0) {
            return result;
        }
        grobo_bus_cost cost;
        grobo_bus_cost_of(&robot->bus, &slot->txn, &cost);
        robot->motion_us = part == 0 ? cost.total_us : robot->motion_us + cost.total_us;
    }
}

static bool all_sensed(const grobo_robot *robot, grobo_joint_mask joints, int *joint)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if ((joints & GROBO_JOINT_BIT(j)) != 0 && !robot->axes[j].sensed) {
            *joint = j;
            return false;
        }
    }
    return true;
}

static int stabilize(grobo_robot *robot, grobo_posture *target)
{
    const grobo_driver *driver = robot->driver;
    if (driver->stabilize == NULL) {
        return GROBO_OK;
    }
    grobo_posture sensed;
    (void)grobo_robot_posture(robot, robot->now_us, GROBO_NEVER_US, &sensed);
    return driver->stabilize(driver, robot->driver_ctx, &sensed, target);
}

int grobo_i_gate_send(grobo_robot *robot, const grobo_posture *wanted, const grobo_i_motion *how,
                      int64_t *time_us)
{
    grobo_target target = {.posture = *wanted};
    int result = how->as_is ? GROBO_OK : stabilize(robot, &target.posture);
    if (result >= 0) {
        result = grobo_i_gate_target(robot, &target.posture);
    }
    if (result >= 0 && !all_sensed(robot, target.posture.set, &robot->fault_joint)) {
        result = GROBO_ERR_STALE;
    }
    if (result < 0) {
        return result;
    }
    int64_t longest_us = give_time(robot, &target, how->each);
    if (longest_us < 0) {
        return (int)longest_us;
    }
    robot->motion++;
    result = send_frames(robot, &target, GROBO_I_USE_MOTION, how->priority, how->due_us);
    if (result < 0) {
        return result;
    }
    note_way(robot, &target);
    if (time_us != NULL) {
        *time_us = longest_us;
    }
    return GROBO_OK;
}

/* ---- halting --------------------------------------------------------------------------------- */

void grobo_i_gate_halt(grobo_robot *robot)
{
    grobo_posture target;
    (void)grobo_posture_init(&target, robot->driver->model->n_joints);
    grobo_i_slots_cancel(robot, GROBO_I_USE_MOTION);
    for (int j = 0; j < target.n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        if (axis->has_target && axis->way.to_us > robot->now_us) {
            target.angle_rad[j] = grobo_i_axis_commanded(axis, robot->now_us + HALT_AHEAD_US);
            target.set |= GROBO_JOINT_BIT(j);
        }
    }
    if (target.set != 0) {
        (void)grobo_posture_clamp(&target, robot->driver->model); /* one may stand outside */
        target.time_us = HALT_TIME_US;
        grobo_i_motion how = {GROBO_PRIORITY_STOP, GROBO_NEVER_US, true, true};
        (void)grobo_i_gate_send(robot, &target, &how, NULL);
    }
}

/* ---- torque ---------------------------------------------------------------------------------- */

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

bool grobo_i_goal_holds(const grobo_robot *robot, int joint)
{
    double near_rad = grobo_rad_from_deg(GROBO_I_HOLD_NEAR_DEG);
    double goal_rad = robot->axes[joint].state.goal_rad;
    return fabs(goal_rad - grobo_i_hold_rad(robot, joint)) <= near_rad; /* not of NaN */
}

int grobo_i_gate_hold(grobo_robot *robot, grobo_joint_mask joints, grobo_i_chunk chunk)
{
    int result = GROBO_OK;
    while (joints != 0 && result >= 0) {
        grobo_target target;
        (void)grobo_posture_init(&target.posture, robot->driver->model->n_joints);
        grobo_joint_mask taken = grobo_i_take_chunk(&joints, chunk);
        for (int j = 0; j < target.posture.n_joints; j++) {
            grobo_robot_axis *axis = &robot->axes[j];
            double hold_rad = grobo_i_hold_rad(robot, j);
            target.joint_time_us[j] = robot->driver->time_step_us;
            if ((taken & GROBO_JOINT_BIT(j)) != 0 && axis->sensed && !isnan(hold_rad)) {
                target.posture.angle_rad[j] = hold_rad;
                target.posture.set |= GROBO_JOINT_BIT(j);
                grobo_i_axis_rest(axis, robot->now_us);
                axis->own_until_us = 0;
                axis->held = false;
            }
        }
        if (target.posture.set != 0) {
            result =
                send_frames(robot, &target, GROBO_I_USE_PLAIN, GROBO_PRIORITY_USER, GROBO_NEVER_US);
        }
    }
    return result;
}

static bool is_on(const grobo_robot_axis *axis)
{
    return axis->torque_known && axis->state.torque == GROBO_TORQUE_ON;
}

static bool may_switch_on(const grobo_robot *robot, grobo_joint_mask joints)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        if ((joints & GROBO_JOINT_BIT(j)) != 0 && !axis->held && !is_on(axis)) {
            return false;
        }
    }
    return true;
}

static int send_torque(grobo_robot *robot, grobo_joint_mask joints, grobo_torque mode)
{
    const grobo_driver *driver = robot->driver;
    grobo_priority priority =
        robot->job.kind == GROBO_JOB_NONE ? GROBO_PRIORITY_USER : robot->job.priority;
    for (int part = 0;; part++) {
        grobo_robot_slot *slot = grobo_i_slot_take(robot, GROBO_I_USE_PLAIN);
        if (slot == NULL) {
            return GROBO_ERR_FULL;
        }
        int more = driver->torque(driver, robot->driver_ctx, joints, mode, part, &slot->exchange);
        if (more <= 0) {
            grobo_i_slot_drop(slot);
            return more;
        }
        slot->switches_on = mode == GROBO_TORQUE_ON;
        int result = grobo_i_slot_send(slot, priority);
        if (result < 0) {
            return result;
        }
    }
}

int grobo_i_gate_torque(grobo_robot *robot, grobo_joint_mask joints, grobo_torque mode,
                        grobo_i_chunk chunk)
{
    if (mode == GROBO_TORQUE_ON && !may_switch_on(robot, joints)) {
        return GROBO_ERR_STATE;
    }
    if (robot->driver->torque == NULL) {
        return GROBO_ERR_UNSUPPORTED;
    }
    if (mode == GROBO_TORQUE_ON && joints != 0) {
        grobo_i_gate_soften(robot); /* a hand may have moved them as long as it was off */
    }
    int result = GROBO_OK;
    while (joints != 0 && result >= 0) {
        grobo_joint_mask taken = grobo_i_take_chunk(&joints, chunk);
        for (int j = 0; mode != GROBO_TORQUE_ON && j < robot->driver->model->n_joints; j++) {
            if ((taken & GROBO_JOINT_BIT(j)) != 0) {
                robot->axes[j].wants_torque = robot->axes[j].held = false;
            }
        }
        result = send_torque(robot, taken, mode);
    }
    return result;
}

/* ---- raw frames ------------------------------------------------------------------------------ */

/* What a frame says of torque is taken for done; a later reading shows. */
static void note_torque(grobo_robot *robot, grobo_joint_mask off)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if ((off & GROBO_JOINT_BIT(j)) != 0) {
            grobo_robot_axis *axis = &robot->axes[j];
            axis->wants_torque = axis->held = axis->has_target = axis->torque_known = false;
        }
    }
}

static bool all_on(const grobo_robot *robot, grobo_joint_mask joints)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if ((joints & GROBO_JOINT_BIT(j)) != 0 && !is_on(&robot->axes[j])) {
            return false;
        }
    }
    return true;
}

static int64_t longest_time(const grobo_robot *robot, const grobo_target *target)
{
    int64_t longest_us = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        bool moves = (target->posture.set & GROBO_JOINT_BIT(j)) != 0;
        int64_t time_us = moves ? target->joint_time_us[j] : 0;
        longest_us = time_us > longest_us ? time_us : longest_us;
    }
    return longest_us;
}

bool grobo_i_gate_ready(const grobo_robot *robot, grobo_joint_mask joints)
{
    int joint;
    return all_sensed(robot, joints, &joint) && all_on(robot, joints);
}

/* Nobody knows what it does: not after a latched stop, and then joints are looked for anew. */
static int take_unknown(grobo_robot *robot)
{
    if (robot->trip.latched) {
        return GROBO_ERR_LATCHED;
    }
    grobo_i_gate_forget(robot, grobo_i_all_joints(robot));
    return GROBO_OK;
}

static bool in_time(const grobo_robot *robot, const grobo_target *target, int joint)
{
    double to_rad = target->posture.angle_rad[joint];
    int64_t time_us = target->joint_time_us[joint];
    return time_us >= time_needed(robot, joint, to_rad, robot->now_us) ||
           time_us >= time_needed(robot, joint, to_rad, robot->now_us + EARLY_US);
}

static int judge_raw(grobo_robot *robot, const grobo_target *target, grobo_joint_mask on)
{
    const grobo_model *model = robot->driver->model;
    int result = grobo_posture_check(&target->posture, model, &robot->fault_joint);
    if (result < 0) {
        return result;
    }
    if ((target->posture.set | on) != 0 && robot->trip.latched) {
        return GROBO_ERR_LATCHED;
    }
    if (!all_sensed(robot, target->posture.set | on, &robot->fault_joint)) {
        return GROBO_ERR_STALE;
    }
    if (!all_on(robot, on) || grobo_i_adrift(robot, target->posture.set)) {
        return GROBO_ERR_STATE; /* a torque job does it safely; somebody else moves it */
    }
    for (int j = 0; j < model->n_joints; j++) {
        if ((target->posture.set & GROBO_JOINT_BIT(j)) != 0 && !in_time(robot, target, j)) {
            robot->fault_joint = j;
            return GROBO_ERR_SPEED;
        }
    }
    return GROBO_OK;
}

int grobo_i_gate_raw(grobo_robot *robot, const uint8_t *frame, size_t size)
{
    const grobo_driver *driver = robot->driver;
    grobo_target target;
    grobo_joint_mask torqued[GROBO_TORQUE_BRAKE + 1] = {0};
    (void)grobo_posture_init(&target.posture, driver->model->n_joints);
    robot->motion++;
    int result = driver->inspect == NULL
                     ? GROBO_ERR_UNSUPPORTED
                     : driver->inspect(driver, robot->driver_ctx, frame, size, &target, torqued);
    if (result == GROBO_ERR_UNSUPPORTED && robot->config.accept_unknown_raw) {
        return take_unknown(robot);
    }
    grobo_i_gate_single(robot);
    if (result >= 0) {
        result = judge_raw(robot, &target, torqued[GROBO_TORQUE_ON]);
    }
    if (result >= 0) {
        if (target.posture.set != 0) {
            grobo_i_gate_single_sent(robot, longest_time(robot, &target));
        }
        note_torque(robot, torqued[GROBO_TORQUE_OFF] | torqued[GROBO_TORQUE_BRAKE]);
        note_way(robot, &target);
    }
    return result;
}
