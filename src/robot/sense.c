/* SPDX-License-Identifier: MIT */
/* Readings: what they tell of a joint, when the background takes them, and free mode. */
#include "src/bus/time.h"
#include "src/robot/robot.h"

#include <math.h>
#include <stdlib.h>

/* Free mode: a joint slower than this holds again (protocol 5). Else: it is at rest. */
#define SLOW_DPS 8

/* In free mode a hand has so long to get a joint going, or to turn it back, before it holds. */
#define GRIP_US 100000

/* While a motion is played joints are read so often, and in free mode the others, also where
 * nothing is read else. */
#define WATCH_INTERVAL_US (GROBO_WATCH_US / 2)

/* A reading waits for this part of a joint's share of GROBO_WATCH_US before it goes first. A frame
 * on the wire, one that waits already, and the reading itself have the rest. */
#define HURRY_PART 4

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

/* Where a servo is going, if it told. One that has time left creeps there, however slowly. A host
 * that was away, or another one, may have sent it. */
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
        double way_rad = fabs(got->goal_rad - got->angle_rad);
        int64_t least_us = (int64_t)(way_rad / most_rad_s * 1e6);
        int64_t left_us = got->goal_time_us - got->time_us;
        bool creeps = got->torque == GROBO_TORQUE_ON && got->speed_dps != 0 && left_us > 0;
        left_us = left_us > least_us ? left_us : least_us;
        axis->own_until_us = robot->now_us + (moves || creeps ? left_us : 0);
    }
    axis->adrift = moves && !axis->has_target && axis->own_until_us <= robot->now_us;
}

/* A reading this far from the way that a joint was sent on is not of a joint on that way: more than
 * what the fastest one does while a frame is on its way. */
#define OFF_WAY_RAD (12 * 0.017453292519943295)

/* The goals of a way are on the wire's grid. */
#define SAME_GOAL_RAD (0.06 * 0.017453292519943295)

/* True if the servo has told since the last frame that its goal is another one; or did so before
 * this reading, and does not move but on the way it told of then. */
static bool has_not_taken(const grobo_robot *robot, const grobo_robot_axis *axis,
                          const grobo_joint_state *got)
{
    bool as_told = abs(got->speed_dps) < SLOW_DPS || axis->own_until_us > robot->now_us;
    bool before = axis->goal_us != GROBO_NEVER_US && axis->goal_us >= axis->told_us && as_told;
    bool told = (got->valid & GROBO_FIELD_GOAL) != 0 || before;
    return told && fabs(axis->state.goal_rad - axis->way.to_rad) > SAME_GOAL_RAD;
}

/* A joint that stands still, or creeps, beside its way has lost the frame, and so has one whose
 * goal is another. Until the next one it is where it was read, or on the way that its servo told
 * of: a stop would throw it to where it should be by then. The angle alone tells nothing of it. */
static bool is_off_way(const grobo_robot *robot, int joint, int64_t asked_us,
                       const grobo_joint_state *got)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    if ((got->valid & GROBO_FIELD_SPEED) == 0) {
        return axis->off_way;
    }
    if (axis->has_target && !axis->in_segments && has_not_taken(robot, axis, got)) {
        return true;
    }
    double then_rad = grobo_i_way_at(&axis->way, asked_us);
    double now_rad = grobo_i_way_at(&axis->way, robot->now_us);
    double beside_rad = fmin(fabs(got->angle_rad - then_rad), fabs(got->angle_rad - now_rad));
    return axis->has_target && !axis->in_segments && abs(got->speed_dps) < SLOW_DPS &&
           beside_rad > OFF_WAY_RAD;
}

/* What a reading tells of where the joint is by now. */
static void take_place(grobo_robot *robot, int joint, int64_t asked_us,
                       const grobo_joint_state *got)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    if ((got->valid & GROBO_FIELD_ANGLE) != 0) {
        axis->sensed = true;
        take_move(robot, joint, got);
        axis->off_way = is_off_way(robot, joint, asked_us, got);
        if (!axis->has_target) {
            grobo_i_axis_here(axis, robot->now_us);
        }
    }
    if ((got->valid & GROBO_FIELD_GOAL) != 0) {
        axis->goal_us = robot->now_us;
    }
    if ((got->valid & GROBO_FIELD_TORQUE) != 0) {
        axis->torque_known = true;
    }
}

/* asked_us: when the joint was asked first. A late answer may be of before a frame that has left
 * meanwhile: it restores nothing of what that frame has made unknown. */
static void take_reading(grobo_robot *robot, int joint, int64_t asked_us, grobo_joint_state *got)
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
    }
    if ((got->valid & GROBO_FIELD_CURRENT) != 0) {
        axis->full_us = robot->now_us;
    }
    if (asked_us >= axis->told_us) {
        take_place(robot, joint, asked_us, got);
    }
    grobo_i_watch_reading(robot, joint, got);
}

static bool is_loss(int result)
{
    return result == GROBO_ERR_TIMEOUT || result == GROBO_ERR_SHORT ||
           result == GROBO_ERR_CHECKSUM || result == GROBO_ERR_MISMATCH;
}

int grobo_i_sense_take(const grobo_robot_slot *slot, int result, const grobo_packet *reply)
{
    grobo_robot *robot = slot->robot;
    const grobo_driver *driver = robot->driver;
    int joint = slot->joint;
    grobo_joint_state got = {0};
    if (result >= 0 && reply == NULL) {
        result = GROBO_ERR_MISMATCH;
    }
    if (result >= 0) {
        result = driver->parse(driver, robot->driver_ctx, joint, reply, &got);
    }
    if (result >= 0) {
        result = GROBO_OK;
        take_reading(robot, joint, slot->asked_us, &got);
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

/* Unless that waits already: where the line is full, each reading would ask again. */
static void switch_once(grobo_robot *robot, grobo_joint_mask joint, grobo_torque mode)
{
    if (!grobo_i_slots_wait(robot, joint, GROBO_I_DEED_TORQUE, mode)) {
        (void)grobo_i_gate_torque(robot, joint, mode, GROBO_I_WHOLE);
    }
}

/* After each reading (protocol 5): above the joint's current, brake; slow, hold. To hold, the goal
 * is set to the present angle first; the next reading shows that it took. */
static void free_joint(grobo_robot *robot, int joint)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    const grobo_joint_state *state = &axis->state;
    int limit_ma = robot->driver->model->joints[joint].free_current_ma;
    bool pushed = limit_ma > 0 && state->current_ma > limit_ma;
    grobo_joint_mask bit = GROBO_JOINT_BIT(joint);
    if (axis->goal_us != robot->now_us) {
        return; /* a reading from before, without the goal */
    }
    if (pushed || abs(state->speed_dps) >= SLOW_DPS) {
        axis->gave_way_us = robot->now_us;
        grobo_i_slots_keep_off(robot, bit);
    }
    bool rests = robot->now_us >= axis->gave_way_us + GRIP_US;
    if (pushed) {
        if (state->torque != GROBO_TORQUE_BRAKE) {
            switch_once(robot, bit, GROBO_TORQUE_BRAKE);
        }
    } else if (state->torque != GROBO_TORQUE_ON && rests) {
        axis->held = grobo_i_goal_holds(robot, joint);
        if (axis->held) {
            switch_once(robot, bit, GROBO_TORQUE_ON);
        } else if (!grobo_i_slots_wait(robot, bit, GROBO_I_DEED_HOLD, GROBO_TORQUE_OFF)) {
            (void)grobo_i_gate_hold(robot, bit, GROBO_I_WHOLE);
        }
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

/* How often each joint is to be read. */
static int64_t interval_of(const grobo_robot *robot)
{
    int64_t interval_us = robot->config.sense_interval_us;
    if (interval_us == GROBO_SENSE_NEVER) {
        return WATCH_INTERVAL_US; /* of those that are not free */
    }
    return grobo_robot_is_playing(robot) && interval_us > WATCH_INTERVAL_US ? WATCH_INTERVAL_US
                                                                            : interval_us;
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
    robot->sense_us += interval_of(robot) / grobo_joints_count(all);
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

/* ---- a reading that waits -------------------------------------------------------------------- */

/* The index of the slot of the background reading that waits for the line, or -1. */
static int find_waiting(const grobo_robot *robot)
{
    for (int i = 0; i < GROBO_ROBOT_SLOTS; i++) {
        const grobo_robot_slot *slot = &robot->slots[i];
        if (slot->use == GROBO_I_USE_SENSE && robot->bus.active != &slot->txn &&
            slot->txn.priority == GROBO_PRIORITY_SENSE) {
            return i;
        }
    }
    return -1;
}

/*
 * When the waiting reading goes before the next motion frame; GROBO_NEVER_US: not at all. It does
 * not while it could not leave anyway, since a lost reply may yet come: in the queue of the motion
 * frames it would stand in their way.
 */
static int64_t hurry_at(const grobo_robot *robot)
{
    int at = find_waiting(robot);
    bool moves = grobo_i_in_motion(robot) || grobo_i_moving(robot, robot->now_us);
    if (at < 0 || !moves || grobo_i_play_unwatched(robot)) {
        return GROBO_NEVER_US;
    }
    const grobo_robot_slot *slot = &robot->slots[at];
    grobo_txn first = slot->txn;
    first.priority = GROBO_PRIORITY_MOTION;
    int64_t since_us = slot->txn.sent_us > slot->given_us ? slot->txn.sent_us : slot->given_us;
    int64_t late_us = since_us + GROBO_WATCH_US / HURRY_PART / robot->driver->model->n_joints;
    int64_t free_us = grobo_bus_free_at(&robot->bus, robot->now_us);
    int64_t may_us = grobo_i_bus_start_at(&robot->bus, &first, robot->now_us);
    return may_us > free_us && may_us > late_us ? may_us : late_us;
}

/* A motion frame waits for it now, so it gets one attempt. That one has a little more time, since
 * the bus learns what replies need from first attempts only. */
static void hurry(grobo_robot *robot)
{
    if (hurry_at(robot) > robot->now_us) {
        return;
    }
    grobo_txn *txn = &robot->slots[find_waiting(robot)].txn;
    if (txn->timeout_us == 0) {
        grobo_bus_cost cost;
        grobo_bus_cost_of(&robot->bus, txn, &cost);
        txn->timeout_us = cost.timeout_us + GROBO_BUS_MARGIN_MIN_US;
    }
    txn->retries = 0;
    (void)grobo_bus_raise(&robot->bus, txn, GROBO_PRIORITY_MOTION);
}

/* Of a joint in free mode everything, and of one that nothing is known of: it may be on a way. */
static grobo_sense_kind kind_of(const grobo_robot *robot, int joint)
{
    if ((robot->free_joints & GROBO_JOINT_BIT(joint)) != 0) {
        return GROBO_SENSE_ALL;
    }
    if (robot->free_joints == 0 && robot->config.sense_position_only) {
        return GROBO_SENSE_POSITION;
    }
    return robot->axes[joint].sensed ? GROBO_SENSE_FULL : GROBO_SENSE_ALL;
}

/* Which joint is read next. */
static int next_reading(grobo_robot *robot)
{
    grobo_joint_mask all = grobo_i_all_joints(robot);
    if (robot->free_joints == 0) {
        return next_in_time(robot, &robot->round, all);
    }
    robot->other_read = is_turn_of_the_others(robot);
    return robot->other_read ? next_in_time(robot, &robot->other_round, all & ~robot->free_joints)
                             : next_of(&robot->round, robot->free_joints);
}

void grobo_i_sense_step(grobo_robot *robot)
{
    const grobo_driver *driver = robot->driver;
    bool due = robot->free_joints != 0 || robot->now_us >= robot->sense_us;
    hurry(robot);
    if (!due || !background_wanted(robot) || grobo_i_slots_busy(robot, GROBO_I_USE_SENSE)) {
        return;
    }
    grobo_robot_slot *slot = grobo_i_slot_take(robot, GROBO_I_USE_SENSE);
    if (slot == NULL) {
        return;
    }
    slot->joint = (uint8_t)next_reading(robot);
    slot->reads = true;
    grobo_sense_kind kind = kind_of(robot, slot->joint);
    if (driver->sense(driver, robot->driver_ctx, slot->joint, kind, &slot->exchange) < 0) {
        grobo_i_slot_drop(slot);
        return;
    }
    (void)grobo_i_slot_send(slot, GROBO_PRIORITY_SENSE);
}

void grobo_i_sense_done(grobo_robot_slot *slot, int result, const grobo_packet *reply)
{
    grobo_robot *robot = slot->robot;
    int joint = slot->joint;
    if (result == GROBO_ERR_CANCELED || result == GROBO_ERR_UNPLUGGED) {
        return;
    }
    result = grobo_i_sense_take(slot, result, reply);
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
    if (!background_wanted(robot)) {
        return GROBO_NEVER_US;
    }
    if (grobo_i_slots_busy(robot, GROBO_I_USE_SENSE)) {
        return hurry_at(robot);
    }
    if (grobo_i_slot_find(robot, GROBO_I_USE_SENSE) < 0) {
        return GROBO_NEVER_US; /* the end of one that waits for the line makes room */
    }
    return robot->free_joints != 0 ? robot->now_us : robot->sense_us;
}
