/* SPDX-License-Identifier: MIT */
/* Readings: what they tell of a joint, when the background takes them, and free mode. */
#include "core/robot.h"

#include <math.h>
#include <stdlib.h>

/* Free mode: a joint slower than this holds again (protocol 5). Else: it is at rest. */
#define SLOW_DPS 8

/* In free mode a hand has so long to get a joint going, or to turn it back, before it holds. */
#define GRIP_US 100000

/* In free mode the other joints are read so often, also where nothing is read else. */
#define WATCH_INTERVAL_US 1000000

/* ---- taking a reading ------------------------------------------------------------------------ */

static void merge(grobo_robot_axis *axis, const grobo_joint_state *got)
{
    grobo_joint_state *state = &axis->state;
    uint16_t valid = (uint16_t)(state->valid | got->valid);
    grobo_joint_state old = *state;
    *state = *got;
    state->valid = valid;
#define KEEP(bit, field)                                                                           \
    if ((got->valid & (bit)) == 0) {                                                               \
        state->field = old.field;                                                                  \
    }
    KEEP(GROBO_FIELD_ANGLE, angle_rad)
    KEEP(GROBO_FIELD_GOAL, goal_rad)
    KEEP(GROBO_FIELD_GOAL, goal_time_us)
    KEEP(GROBO_FIELD_TIME, time_us)
    KEEP(GROBO_FIELD_SPEED, speed_dps)
    KEEP(GROBO_FIELD_CURRENT, current_ma)
    KEEP(GROBO_FIELD_TEMPERATURE, temperature_c)
    KEEP(GROBO_FIELD_VOLTAGE, voltage_mv)
    KEEP(GROBO_FIELD_TORQUE, torque)
#undef KEEP
}

static double correction(const grobo_robot *robot, int joint)
{
    const grobo_driver *driver = robot->driver;
    double add_rad = 0;
    for (int i = 0; robot->config.readback_correction && i < driver->n_readback; i++) {
        add_rad += driver->readback[i].joint == joint ? driver->readback[i].add_rad : 0;
    }
    return add_rad;
}

double grobo_i_hold_rad(const grobo_robot *robot, int joint)
{
    const grobo_joint *limits = &robot->driver->model->joints[joint];
    double angle_rad = robot->axes[joint].state.angle_rad - correction(robot, joint);
    double outside_rad = grobo_rad_from_deg(GROBO_I_HOLD_OUTSIDE_DEG);
    bool near =
        angle_rad >= limits->min_rad - outside_rad && angle_rad <= limits->max_rad + outside_rad;
    return near ? fmin(fmax(angle_rad, limits->min_rad), limits->max_rad) : (double)NAN;
}

/* Where a servo is going, if it told. A host that was away, or another one, may have sent it. */
static void take_move(grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    const unsigned move = GROBO_FIELD_ANGLE | GROBO_FIELD_GOAL | GROBO_FIELD_TIME;
    const unsigned pace = GROBO_FIELD_SPEED | GROBO_FIELD_TORQUE;
    grobo_robot_axis *axis = &robot->axes[joint];
    if ((got->valid & pace) != pace) {
        return;
    }
    bool moves = got->torque == GROBO_TORQUE_ON && abs(got->speed_dps) >= SLOW_DPS;
    if ((got->valid & move) == move) {
        double most_rad_s = robot->driver->model->joints[joint].max_speed_rad_s;
        int64_t least_us = (int64_t)(fabs(got->goal_rad - got->angle_rad) / most_rad_s * 1e6);
        int64_t left_us = got->goal_time_us - got->time_us;
        left_us = left_us > least_us ? left_us : least_us;
        axis->own_until_us = robot->now_us + (moves ? left_us : 0);
    }
    axis->adrift = moves && !axis->has_target && axis->own_until_us <= robot->now_us;
}

static void take_reading(grobo_robot *robot, int joint, grobo_joint_state *got)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    if ((got->valid & GROBO_FIELD_ANGLE) != 0) {
        got->angle_rad += correction(robot, joint);
    }
    merge(axis, got);
    axis->status = GROBO_OK;
    axis->lost = 0;
    if ((got->valid & GROBO_FIELD_ANGLE) != 0) {
        axis->angle_us = robot->now_us;
        axis->sensed = true;
        take_move(robot, joint, got);
        if (!axis->has_target) {
            grobo_i_axis_here(axis, robot->now_us);
        }
    }
    if ((got->valid & GROBO_FIELD_CURRENT) != 0) {
        axis->full_us = robot->now_us;
    }
    if ((got->valid & GROBO_FIELD_GOAL) != 0) {
        axis->goal_us = robot->now_us;
    }
    if ((got->valid & GROBO_FIELD_TORQUE) != 0) {
        axis->torque_known = true;
    }
    grobo_i_watch_reading(robot, joint, got);
}

static bool is_loss(int result)
{
    return result == GROBO_ERR_TIMEOUT || result == GROBO_ERR_SHORT ||
           result == GROBO_ERR_CHECKSUM || result == GROBO_ERR_MISMATCH;
}

int grobo_i_sense_take(grobo_robot *robot, int joint, int result, const grobo_rs30x_packet *reply)
{
    const grobo_driver *driver = robot->driver;
    grobo_joint_state got = {0};
    if (result >= 0 && reply == NULL) {
        result = GROBO_ERR_MISMATCH;
    }
    if (result >= 0) {
        result = driver->parse(driver, robot->driver_ctx, joint, reply, &got);
    }
    if (result >= 0) {
        result = GROBO_OK;
        take_reading(robot, joint, &got);
    } else {
        robot->axes[joint].status = result;
        if (is_loss(result)) {
            robot->axes[joint].lost++;
            grobo_i_watch_lost(robot, joint);
        }
    }
    grobo_event event = {.kind = GROBO_EVENT_JOINT};
    event.u.joint.joint = joint;
    event.u.joint.result = result;
    grobo_i_tell(robot, &event);
    return result;
}

/* ---- free mode ------------------------------------------------------------------------------- */

/* After each reading (protocol 5): above the joint's current, brake; slow, hold. To hold, the goal
 * is set to the present angle first; the next reading shows that it took. */
static void free_joint(grobo_robot *robot, int joint)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    const grobo_joint_state *state = &axis->state;
    int limit_ma = robot->driver->model->joints[joint].free_current_ma;
    bool pushed = limit_ma > 0 && state->current_ma > limit_ma;
    if (axis->goal_us != robot->now_us) {
        return; /* a reading from before, without the goal */
    }
    if (pushed || abs(state->speed_dps) >= SLOW_DPS) {
        axis->gave_way_us = robot->now_us;
    }
    if (pushed) {
        if (state->torque != GROBO_TORQUE_BRAKE) {
            (void)grobo_i_gate_torque(robot, GROBO_JOINT_BIT(joint), GROBO_TORQUE_BRAKE,
                                      GROBO_I_WHOLE);
        }
    } else if (state->torque != GROBO_TORQUE_ON && robot->now_us >= axis->gave_way_us + GRIP_US) {
        axis->held = grobo_i_goal_holds(robot, joint);
        (void)(axis->held ? grobo_i_gate_torque(robot, GROBO_JOINT_BIT(joint), GROBO_TORQUE_ON,
                                                GROBO_I_WHOLE)
                          : grobo_i_gate_hold(robot, GROBO_JOINT_BIT(joint), GROBO_I_WHOLE));
    }
}

/* ---- the background -------------------------------------------------------------------------- */

/* Not in the silence after a flash write or a restart. */
static bool background_wanted(const grobo_robot *robot)
{
    if (robot->job.kind == GROBO_JOB_COMMAND) {
        return false;
    }
    return robot->config.sense_interval_us != GROBO_SENSE_NEVER || robot->free_joints != 0;
}

/* Takes the next joint of a round through `all`, which begins again at its end. */
static int next_of(grobo_joint_mask *round, grobo_joint_mask all)
{
    *round &= all;
    if (*round == 0) {
        *round = all;
    }
    int joint = grobo_i_lowest(*round);
    *round &= ~GROBO_JOINT_BIT(joint);
    return joint;
}

/* The next joint of a round that takes the interval. */
static int next_in_time(grobo_robot *robot, grobo_joint_mask *round, grobo_joint_mask all)
{
    int64_t interval_us = robot->config.sense_interval_us;
    robot->sense_us += (interval_us == GROBO_SENSE_NEVER ? WATCH_INTERVAL_US : interval_us) /
                       grobo_joints_count(all);
    if (robot->sense_us < robot->now_us) {
        robot->sense_us = robot->now_us; /* the wire was too slow: no burst to catch up */
    }
    return next_of(round, all);
}

/* Joints that hold while others are free are watched in turn with them, and never twice. */
static bool is_turn_of_the_others(const grobo_robot *robot)
{
    bool all_free = (grobo_i_all_joints(robot) & ~robot->free_joints) == 0;
    return !all_free && robot->now_us >= robot->sense_us && !robot->other_read;
}

/* Which joint is read next, and what of it. */
static int next_reading(grobo_robot *robot, grobo_sense_kind *kind)
{
    grobo_joint_mask all = grobo_i_all_joints(robot);
    if (robot->free_joints == 0) {
        *kind = robot->config.sense_position_only ? GROBO_SENSE_POSITION : GROBO_SENSE_FULL;
        return next_in_time(robot, &robot->round, all);
    }
    robot->other_read = is_turn_of_the_others(robot);
    *kind = robot->other_read ? GROBO_SENSE_FULL : GROBO_SENSE_ALL;
    return robot->other_read ? next_in_time(robot, &robot->other_round, all & ~robot->free_joints)
                             : next_of(&robot->round, robot->free_joints);
}

void grobo_i_sense_step(grobo_robot *robot)
{
    const grobo_driver *driver = robot->driver;
    bool due = robot->free_joints != 0 || robot->now_us >= robot->sense_us;
    grobo_sense_kind kind;
    if (!due || !background_wanted(robot) || grobo_i_slots_busy(robot, GROBO_I_USE_SENSE)) {
        return;
    }
    grobo_robot_slot *slot = grobo_i_slot_take(robot, GROBO_I_USE_SENSE);
    if (slot == NULL) {
        return;
    }
    slot->joint = (uint8_t)next_reading(robot, &kind);
    slot->reads = true;
    if (driver->sense(driver, robot->driver_ctx, slot->joint, kind, &slot->exchange) < 0) {
        grobo_i_slot_drop(slot);
        return;
    }
    (void)grobo_i_slot_send(slot, GROBO_PRIORITY_SENSE);
}

void grobo_i_sense_done(grobo_robot_slot *slot, int result, const grobo_rs30x_packet *reply)
{
    grobo_robot *robot = slot->robot;
    int joint = slot->joint;
    if (result == GROBO_ERR_CANCELED || result == GROBO_ERR_UNPLUGGED) {
        return;
    }
    result = grobo_i_sense_take(robot, joint, result, reply);
    bool is_free = (robot->free_joints & GROBO_JOINT_BIT(joint)) != 0;
    if (result >= 0 && is_free) {
        free_joint(robot, joint);
    }
    if (robot->round == 0 && (is_free || robot->free_joints == 0)) {
        grobo_event event = {.kind = GROBO_EVENT_ROUND};
        grobo_i_tell(robot, &event);
    }
    grobo_i_sense_step(robot);
}

int64_t grobo_i_sense_deadline(const grobo_robot *robot)
{
    bool waits = background_wanted(robot) && !grobo_i_slots_busy(robot, GROBO_I_USE_SENSE);
    if (!waits) {
        return GROBO_NEVER_US;
    }
    return robot->free_joints != 0 ? robot->now_us : robot->sense_us;
}
