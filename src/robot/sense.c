/* SPDX-License-Identifier: MIT */
/* When the background reads which joint, and free mode. */
#include <math.h>
#include <stdlib.h>

#include "src/base/instant.h"
#include "src/bus/time.h"
#include "src/model/joint.h"
#include "src/robot/axis.h"
#include "src/robot/blocked.h"
#include "src/robot/budget.h"
#include "src/robot/gate.h"
#include "src/robot/halted.h"
#include "src/robot/lines.h"
#include "src/robot/often.h"
#include "src/robot/orders.h"
#include "src/robot/play.h"
#include "src/robot/query.h"
#include "src/robot/reading.h"
#include "src/robot/robot.h"
#include "src/robot/sense.h"
#include "src/robot/slot.h"
#include "src/robot/state.h"
#include "src/robot/trajectories.h"

/* In free mode a hand has so long to get a joint going, or to turn it back, before it holds. */
#define GRIP_US 100000

/* While a motion is played joints are read so often, and in free mode the others, also where
 * nothing is read else. */
#define WATCH_INTERVAL_US (GROBO_WATCH_US / 2)

/* A reading waits for this part of a joint's share of GROBO_WATCH_US before it goes first. A frame
 * on the wire, one that waits already, and the reading itself have the rest. */
#define HURRY_PART 4

/* ---- free mode ------------------------------------------------------------------------------- */

/* Unless that waits already: where the line is full, each reading would ask again. A servo that has
 * no brake gives way without torque. */
static void switch_once(grobo_robot *robot, grobo_joint_mask joint, grobo_torque mode)
{
    bool waits = grobo_i_slots_wait(robot, joint, GROBO_I_ORDER_TORQUE, mode);
    int result = waits ? GROBO_OK : grobo_i_gate_torque(robot, joint, mode, GROBO_I_WHOLE);
    if (result == GROBO_ERR_UNSUPPORTED && mode == GROBO_TORQUE_BRAKE) {
        switch_once(robot, joint, GROBO_TORQUE_OFF);
    }
}

/* True if something else than its servo turns a joint: it has torque, and moves farther from its
 * goal than it was when it was read last. A leg's current stays below its limit under a hand that
 * is not slow. A servo that tells no speed is taken to turn by its angle alone. */
static bool is_turned(grobo_robot *robot, int joint)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    const grobo_joint_state *state = &axis->state;
    double before_rad = axis->away_rad;
    axis->away_rad = fabs(state->angle_rad - state->goal_rad);
    bool turns =
        (state->valid & GROBO_FIELD_SPEED) == 0 || abs(state->speed_dps) >= GROBO_I_SLOW_DPS;
    return state->torque == GROBO_TORQUE_ON && turns && !grobo_i_goal_holds(robot, joint) &&
           axis->away_rad > before_rad;
}

/* After each reading (protocol 5): above the joint's current, or turned, brake; slow, hold. To
 * hold, the goal is set to the present angle first; the next reading shows that it took. */
static void free_joint(grobo_robot *robot, int joint)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    const grobo_joint_state *state = &axis->state;
    int limit_ma = grobo_i_joint(robot->driver->model, joint)->free_current_ma;
    grobo_joint_mask bit = GROBO_JOINT_BIT(joint);
    if (axis->goal_us != robot->now_us) {
        return; /* a reading from before, without the goal */
    }
    bool turned = is_turned(robot, joint);
    bool pushed = (limit_ma > 0 && state->current_ma > limit_ma) || turned;
    if (pushed || abs(state->speed_dps) >= GROBO_I_SLOW_DPS) {
        axis->gave_way_us = robot->now_us;
        grobo_i_slots_keep_off(robot, bit);
    }
    bool rests = robot->now_us >= axis->gave_way_us + GRIP_US;
    if (pushed) {
        if (state->torque != GROBO_TORQUE_BRAKE) {
            switch_once(robot, bit, GROBO_TORQUE_BRAKE);
        }
    } else if (state->torque != GROBO_TORQUE_ON && rests) {
        bool holds = grobo_i_goal_holds(robot, joint);
        grobo_i_joint_to(axis, holds ? GROBO_I_JOINT_HOLDS : GROBO_I_JOINT_LOOSE);
        if (holds) {
            switch_once(robot, bit, GROBO_TORQUE_ON);
        } else if (!grobo_i_slots_wait(robot, bit, GROBO_I_ORDER_HOLD, GROBO_TORQUE_OFF)) {
            (void)grobo_i_gate_hold(robot, bit, GROBO_I_WHOLE);
        }
    }
}

/* ---- servos that a goal wakes ---------------------------------------------------------------- */

/* Joints that hold are heard so often that none is taken to have restarted. */
#define HEAR_US (GROBO_I_RESTART_US / 2)
/* Who has not answered is asked again so late: some replies lost in a row are no short
 * disturbance. */
#define HEAR_AGAIN_US 40000
/* Of one that was heard and is to halt, two angles so far apart show whether it turns. */
#define TURNS_US 20000

static bool is_unheard(const grobo_robot_axis *axis, int64_t now_us)
{
    return grobo_i_axis_is_on(axis) && now_us - axis->heard_us >= HEAR_US;
}

/* Those that are to halt come first. */
static grobo_joint_mask unheard(const grobo_robot *robot)
{
    if (robot->now_us < robot->hear_us) {
        return 0;
    }
    bool wakes = GROBO_I_EXTRA(robot->driver, goal_energises);
    return robot->halts_owed != 0 ? robot->halts_owed
           : wakes                ? grobo_i_woken(robot, grobo_i_joints_that(robot, is_unheard))
                                  : 0;
}

/* When the first of them will be. */
static int64_t unheard_at(const grobo_robot *robot)
{
    int64_t at_us = robot->halts_owed != 0 ? robot->now_us : GROBO_NEVER_US;
    for (int j = 0;
         GROBO_I_EXTRA(robot->driver, goal_energises) && j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        bool waits = grobo_i_axis_is_on(axis) && grobo_i_driver_of(robot, j)->goal_energises;
        at_us = waits ? grobo_i_sooner(at_us, axis->heard_us + HEAR_US) : at_us;
    }
    return grobo_i_later(at_us, robot->hear_us);
}

/* ---- the background -------------------------------------------------------------------------- */

/* Not in the silence after a flash write or a restart. */
static bool background_wanted(const grobo_robot *robot)
{
    if (robot->job->kind == GROBO_JOB_COMMAND) {
        return false;
    }
    return robot->config.sense_interval_us != GROBO_SENSE_NEVER || robot->free_joints != 0 ||
           unheard_at(robot) != GROBO_NEVER_US || grobo_i_halted_at(robot) != GROBO_NEVER_US;
}

/* How often each joint is to be read. */
static int64_t interval_of(grobo_robot *robot)
{
    int64_t interval_us = robot->config.sense_interval_us;
    if (interval_us == GROBO_SENSE_NEVER) {
        return WATCH_INTERVAL_US; /* of those that are not free */
    }
    bool plays = grobo_i_is_playing(robot) && interval_us > WATCH_INTERVAL_US;
    return grobo_i_often_interval(robot, plays ? WATCH_INTERVAL_US : interval_us);
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

/* Where nothing is read in the background nothing is due but what was not heard for long. */
static bool is_due(const grobo_robot *robot)
{
    bool never = robot->config.sense_interval_us == GROBO_SENSE_NEVER;
    return robot->free_joints != 0 || (!never && robot->now_us >= robot->sense_us);
}

/* Joints that hold while others are free are watched in turn with them, and never twice. */
static bool is_turn_of_the_others(const grobo_robot *robot)
{
    bool all_free = (grobo_i_all_joints(robot) & ~robot->free_joints) == 0;
    return !all_free && robot->now_us >= robot->sense_us && !robot->other_read;
}

/* ---- a reading that waits -------------------------------------------------------------------- */

/* The index of the slot of the background reading that waits for the line, or -1. */
static inline int find_waiting(const grobo_robot *robot)
{
    for (int i = 0; i < robot->slots_end; i++) {
        const grobo_robot_slot *slot = &robot->slots[i];
        if (slot->use == GROBO_I_USE_SENSE && slot->txn.priority == GROBO_PRIORITY_SENSE &&
            !grobo_i_is_active(slot)) {
            return i;
        }
    }
    return -1;
}

/* When what it reads will be as old as it may be; readings may be asked for long before that. */
static int64_t is_old_at(const grobo_robot *robot, const grobo_robot_slot *slot)
{
    grobo_joint_mask asked = slot->many ? slot->unread : GROBO_JOINT_BIT(slot->joint);
    int64_t old_us = GROBO_NEVER_US;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        int64_t read_us = robot->axes[j].angle_us;
        int64_t at_us = read_us == GROBO_NEVER_US ? 0 : read_us + WATCH_INTERVAL_US;
        old_us = grobo_i_has(asked, j) ? grobo_i_sooner(old_us, at_us) : old_us;
    }
    return old_us == GROBO_NEVER_US ? 0 : old_us;
}

/*
 * When the waiting reading goes before the next motion frame; GROBO_NEVER_US: not at all. It does
 * not while it could not leave anyway, since a lost reply may yet come: in the queue of the motion
 * frames it would stand in their trajectory.
 */
static int64_t hurry_at(const grobo_robot *robot)
{
    int at = find_waiting(robot);
    if (at < 0 || grobo_i_play_unwatched(robot) ||
        !(grobo_i_in_motion(robot) || grobo_i_moving(robot, robot->now_us))) {
        return GROBO_NEVER_US;
    }
    const grobo_robot_slot *slot = &robot->slots[at];
    const grobo_bus *bus = grobo_i_bus_of(slot);
    grobo_txn first = slot->txn;
    first.priority = GROBO_PRIORITY_MOTION;
    int64_t since_us = slot->txn.sent_us > slot->given_us ? slot->txn.sent_us : slot->given_us;
    int readings = slot->many ? 1 : robot->driver->model->n_joints;
    bool quiet = unheard(robot) != 0;
    int64_t watch_us = quiet ? GROBO_I_RESTART_US : GROBO_WATCH_US;
    int64_t late_us = since_us + watch_us / HURRY_PART / readings;
    int64_t free_us = grobo_bus_free_at(bus, robot->now_us);
    int64_t may_us = grobo_i_bus_start_at(bus, &first, robot->now_us);
    bool needed = quiet || !grobo_i_often(robot);
    late_us = needed ? late_us : grobo_i_later(late_us, is_old_at(robot, slot));
    return may_us > free_us && may_us > late_us ? may_us : late_us;
}

/* A motion frame waits for it now, so it gets one attempt. That one has a little more time, since
 * the bus learns what replies need from first attempts only. */
static void hurry(grobo_robot *robot)
{
    if (hurry_at(robot) > robot->now_us) {
        return;
    }
    grobo_robot_slot *slot = &robot->slots[find_waiting(robot)];
    grobo_bus *bus = grobo_i_bus_of(slot);
    grobo_txn *txn = &slot->txn;
    if (txn->timeout_us == 0) {
        grobo_bus_cost cost;
        grobo_bus_cost_of(bus, txn, &cost);
        txn->timeout_us = cost.timeout_us + GROBO_BUS_MARGIN_MIN_US;
    }
    txn->retries = 0;
    (void)grobo_bus_raise(bus, txn, GROBO_PRIORITY_MOTION);
}

/* Of a joint in free mode everything, and of one that nothing is known of: it may be on a
 * trajectory. */
static grobo_sense_kind kind_of(const grobo_robot *robot, int joint)
{
    if (robot->heard_read && grobo_i_is_sensed(&robot->axes[joint]) &&
        !grobo_i_is_stray(&robot->axes[joint])) {
        bool halts = grobo_i_has(robot->halts_owed, joint); /* does it turn, and where to? */
        return halts || grobo_i_may_sleep(robot, joint) ? GROBO_SENSE_GOAL : GROBO_SENSE_POSITION;
    }
    if (grobo_i_has(robot->free_joints, joint)) {
        return GROBO_SENSE_ALL;
    }
    bool first = GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), keeps_setup) &&
                 !grobo_i_is_sensed(&robot->axes[joint]);
    if (robot->free_joints == 0 && robot->config.sense_position_only && !first) {
        return GROBO_SENSE_POSITION;
    }
    bool whole =
        !grobo_i_is_sensed(&robot->axes[joint]) || grobo_i_blocked_wants_goal(robot, joint);
    return whole ? GROBO_SENSE_ALL : GROBO_SENSE_FULL;
}

/* Which joint is read next; in turn with the others one that was not heard for long. */
static int next_reading(grobo_robot *robot)
{
    grobo_joint_mask all = grobo_i_all_joints(robot);
    grobo_joint_mask quiet = unheard(robot);
    bool in_turn = robot->heard_read && is_due(robot) && robot->halts_owed == 0;
    robot->heard_read = quiet != 0 && !in_turn;
    if (robot->heard_read) {
        return next_of(&robot->heard_round, quiet);
    }
    if (robot->free_joints == 0) {
        return next_in_time(robot, &robot->round, all);
    }
    robot->other_read = is_turn_of_the_others(robot);
    return robot->other_read ? next_in_time(robot, &robot->other_round, all & ~robot->free_joints)
                             : next_of(&robot->round, robot->free_joints);
}

/* So many in a row lost, and what servos tell of this is not believed until the line comes back. */
#define FAST_LOST_MOST 3

static bool is_slow(const grobo_robot_axis *axis, int64_t now_us)
{
    (void)now_us;
    return !axis->state.fast;
}

/* Whether all answer with one packet. */
static bool are_fast(const grobo_robot *robot)
{
    return GROBO_I_EXTRA(robot->driver, sense_fast) != NULL && robot->fast_lost < FAST_LOST_MOST &&
           grobo_i_joints_that(robot, is_slow) == 0;
}

/* Where one that does not answer so has taken the place of another, nobody does: all are asked anew
 * how they answer. */
static void note_fast(grobo_robot *robot, int result)
{
    robot->fast_lost = result < 0 ? (uint8_t)(robot->fast_lost + 1) : 0;
    robot->fast_forgotten = result < 0;
    for (int j = 0; result < 0 && j < robot->driver->model->n_joints; j++) {
        robot->axes[j].state.fast = false;
    }
}

/* A reading has the line for no longer than this where it can be parted: a stop may wait for it. A
 * slow line has no time for more than a few parts; a first reading, the longest, takes it. */
#define PART_US 10000
#define PARTS_MOST 4

/* The next joints of a round, as many as have the time. `stretch`: all of them, in place of too
 * many parts. */
static int ask_some_of(grobo_robot *robot, grobo_robot_slot *slot, grobo_sense_kind kind,
                       uint32_t most_us, bool stretch)
{
    const grobo_driver *driver = robot->driver;
    slot->kind = (uint8_t)kind;
    grobo_joint_mask left = robot->round != 0 ? robot->round : grobo_i_all_joints(robot);
    int result = driver->sense_many(driver, robot->driver_ctx, left, kind, &robot->built);
    uint32_t us = result >= 0 ? grobo_i_line_us(&robot->bus, &robot->built) : 0;
    most_us = stretch && us > PARTS_MOST * PART_US ? us : most_us;
    int n = grobo_joints_count(left), most = us > most_us ? (int)(most_us * (uint32_t)n / us) : n;
    slot->unread = 0;
    do {
        grobo_joint_mask next = GROBO_JOINT_BIT(grobo_i_lowest(left));
        slot->unread |= next;
        left &= ~next;
    } while (left != 0 && --most > 0);
    robot->round = left;
    return left == 0 && slot->unread == grobo_i_all_joints(robot) ? result
                                                                  : grobo_i_slot_ask_unread(slot);
}

/* All of them in one frame; while joints are told more of their trajectories, as many as have
 * the time. */
static int ask_each(grobo_robot *robot, grobo_robot_slot *slot, grobo_sense_kind kind)
{
    const grobo_driver *driver = robot->driver;
    slot->unread = grobo_i_all_joints(robot);
    slot->kind = (uint8_t)kind;
    slot->fast = robot->round == 0 && are_fast(robot) &&
                 driver->sense_fast(driver, robot->driver_ctx, kind, &robot->built) >= 0 &&
                 (!robot->in_segments ||
                  grobo_i_line_us(&robot->bus, &robot->built) <= (uint32_t)robot->read_us);
    if (slot->fast) {
        return GROBO_OK;
    }
    if (robot->in_segments) {
        return ask_some_of(robot, slot, kind, (uint32_t)robot->read_us, false);
    }
    return ask_some_of(robot, slot, kind, PART_US, true);
}

/* Any that nothing is known of is asked where it is going, too. */
static int ask_all(grobo_robot *robot, grobo_robot_slot *slot)
{
    int unknown;
    bool first = !grobo_i_all_sensed(robot, grobo_i_all_joints(robot), &unknown);
    first = first || robot->fast_forgotten;
    bool angles =
        robot->config.sense_position_only && !(first && GROBO_I_EXTRA(robot->driver, keeps_setup));
    slot->many = true;
    int result = first && !angles
                     ? ask_some_of(robot, slot, GROBO_SENSE_ALL, PART_US, false)
                     : ask_each(robot, slot, angles ? GROBO_SENSE_POSITION : GROBO_SENSE_FULL);
    if (robot->round == 0) {
        robot->fast_forgotten = false;
        int64_t interval_us = interval_of(robot); /* which may be never */
        int64_t last_us = grobo_i_sooner(robot->sense_us, INT64_MAX - interval_us);
        robot->sense_us = grobo_i_later(last_us + interval_us, robot->now_us);
    }
    return result;
}

static int ask_next(grobo_robot *robot, grobo_robot_slot *slot)
{
    const grobo_driver *driver = robot->driver;
    slot->joint = (uint8_t)next_reading(robot);
    slot->reads = true;
    slot->kind = (uint8_t)kind_of(robot, slot->joint);
    return driver->sense(driver, robot->driver_ctx, slot->joint, (grobo_sense_kind)slot->kind,
                         &robot->built);
}

/* What is read of joints that are to halt goes before everything but halts, and whatever else was
 * to be read gives way. */
static bool is_urgent(const grobo_robot *robot)
{
    return robot->halts_owed != 0 && robot->now_us >= robot->hear_us;
}

/* Where those that were halted go, in one frame if there is one. */
static int ask_halted(grobo_robot *robot, grobo_robot_slot *slot)
{
    const grobo_driver *driver = robot->driver;
    slot->kind = GROBO_SENSE_GOAL;
    if (GROBO_I_EXTRA(driver, sense_many) != NULL) {
        slot->many = true;
        slot->unread = grobo_i_halted_ask(robot);
        return grobo_i_slot_ask_unread(slot);
    }
    slot->joint = (uint8_t)grobo_i_halted_next(robot);
    slot->reads = true;
    return driver->sense(driver, robot->driver_ctx, slot->joint, GROBO_SENSE_GOAL, &robot->built);
}

/* Joints that hold and may have restarted. */
static grobo_joint_mask sleepers(const grobo_robot *robot)
{
    grobo_joint_mask joints = unheard(robot);
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        joints &= ~(grobo_i_may_sleep(robot, j) ? 0 : GROBO_JOINT_BIT(j));
    }
    return joints;
}

/* They are asked one by one, in turn with all of them: in one frame with others a reply that is
 * lost would keep others without a goal, too. */
static bool asks_sleepers(grobo_robot *robot)
{
    bool now = !is_urgent(robot) && sleepers(robot) != 0;
    robot->heard_read = now && !(robot->heard_read && is_due(robot));
    return robot->heard_read;
}

static int ask_sleeper(grobo_robot *robot, grobo_robot_slot *slot)
{
    slot->joint = (uint8_t)next_of(&robot->heard_round, sleepers(robot));
    slot->reads = true;
    slot->kind = GROBO_SENSE_GOAL;
    return robot->driver->sense(robot->driver, robot->driver_ctx, slot->joint, GROBO_SENSE_GOAL,
                                &robot->built);
}

/* True while joints whose first reading takes several exchanges wait for it: asked all at once,
 * they would be asked for the first part alone. */
static bool is_apart(const grobo_robot *robot)
{
    int unknown;
    return GROBO_I_EXTRA(robot->driver, sense_more) != NULL &&
           !grobo_i_all_sensed(robot, grobo_i_all_joints(robot), &unknown);
}

/* Joints that were halted in turn with all others: one that is silent hides none. */
static int ask_some(grobo_robot *robot, grobo_robot_slot *slot)
{
    bool many = GROBO_I_EXTRA(robot->driver, sense_many) != NULL && robot->free_joints == 0 &&
                !is_apart(robot);
    robot->halted_read =
        !is_urgent(robot) && grobo_i_halted_due(robot) && !(robot->halted_read && is_due(robot));
    if (robot->halted_read) {
        robot->heard_read = false;
        return ask_halted(robot, slot);
    }
    if (many && asks_sleepers(robot)) {
        return ask_sleeper(robot, slot);
    }
    return many ? ask_all(robot, slot) : ask_next(robot, slot);
}

static void give_way(grobo_robot *robot, grobo_robot_slot *waiting)
{
    grobo_joint_mask asked = waiting->many ? waiting->unread : GROBO_JOINT_BIT(waiting->joint);
    if ((asked & robot->halts_owed) != 0) {
        waiting->txn.urgent = true;
        (void)grobo_bus_raise(grobo_i_bus_of(waiting), &waiting->txn, GROBO_PRIORITY_MOTION);
    } else {
        (void)grobo_bus_cancel(grobo_i_bus_of(waiting), &waiting->txn);
    }
}

/* One that was asked for before joints began to be told their trajectories in parts, and would
 * have the line for too long, is asked for anew. */
static void ask_for_less(grobo_robot *robot)
{
    for (int i = 0; i < robot->slots_end; i++) {
        const grobo_robot_slot *slot = &robot->slots[i];
        bool waits = slot->use == GROBO_I_USE_SENSE && !grobo_i_is_active(slot);
        if (!waits || grobo_joints_count(slot->unread) < 2) {
            continue;
        }
        grobo_bus_cost cost;
        grobo_bus_cost_of(grobo_i_bus_of(slot), &slot->txn, &cost);
        if (cost.total_us > (uint32_t)robot->read_us) {
            robot->sense_us = robot->now_us;
            (void)grobo_bus_cancel(grobo_i_bus_of(slot), &robot->slots[i].txn);
            return;
        }
    }
}

void grobo_i_sense_step(grobo_robot *robot)
{
    int waiting = is_urgent(robot) ? find_waiting(robot) : -1;
    if (waiting >= 0) {
        give_way(robot, &robot->slots[waiting]);
    }
    if (robot->in_segments) {
        ask_for_less(robot);
    }
    hurry(robot);
    bool due = is_due(robot) || unheard(robot) != 0 || grobo_i_halted_due(robot);
    if (!due || !background_wanted(robot) || grobo_i_slots_busy(robot, GROBO_I_USE_SENSE)) {
        return;
    }
    grobo_robot_slot *slot = grobo_i_slot_take(robot, GROBO_I_USE_SENSE);
    if (slot == NULL) {
        return;
    }
    if (ask_some(robot, slot) < 0) {
        grobo_i_slot_drop(slot);
        return;
    }
    (void)grobo_i_slot_send(slot, &robot->built,
                            is_urgent(robot) ? GROBO_PRIORITY_MOTION : GROBO_PRIORITY_SENSE);
}

/* When those that were asked in a round of their own are asked again. What had the line as a stop
 * was asked for is no reading of what that halts. */
static void hear_again(grobo_robot *robot, const grobo_robot_slot *slot, int result)
{
    bool last = robot->halts_owed == 0 || (robot->heard_round & robot->halts_owed) == 0;
    bool turns = !GROBO_DRIVERS_PLAIN && robot->halts_owed != 0 &&
                 (slot->many || grobo_i_has(robot->halts_owed, slot->joint));
    if (robot->heard_read && last && (result < 0 || turns)) {
        robot->hear_us = robot->now_us + (result < 0 ? HEAR_AGAIN_US : TURNS_US);
    }
}

void grobo_i_sense_done(const grobo_robot_slot *slot, int result)
{
    grobo_robot *robot = slot->robot;
    int joint = slot->joint;
    bool is_free = !slot->many && grobo_i_has(robot->free_joints, joint);
    hear_again(robot, slot, result);
    if (result >= 0 && is_free) {
        free_joint(robot, joint);
    }
    if (slot->fast) {
        note_fast(robot, result);
    }
    if (!robot->halted_read && robot->round == 0 && (is_free || robot->free_joints == 0)) {
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
        return is_urgent(robot) && find_waiting(robot) >= 0 ? robot->now_us : hurry_at(robot);
    }
    if (grobo_i_slot_find(robot, GROBO_I_USE_SENSE) < 0) {
        return GROBO_NEVER_US; /* the end of one that waits for the line makes room */
    }
    bool never = robot->config.sense_interval_us == GROBO_SENSE_NEVER;
    int64_t due_us = robot->free_joints != 0 ? robot->now_us
                     : never                 ? GROBO_NEVER_US
                                             : robot->sense_us;
    due_us = grobo_i_sooner(due_us, grobo_i_halted_at(robot));
    return grobo_i_sooner(due_us, unheard_at(robot));
}
