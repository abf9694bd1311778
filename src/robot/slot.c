/* SPDX-License-Identifier: MIT */
/* Frames under way: from an exchange to a transaction of the bus and back. */
#include <string.h>

#include "src/base/assert.h"
#include "src/base/instant.h"
#include "src/robot/lines.h"
#include "src/robot/robot.h"
#include "src/robot/slot.h"

/* Slots that only a halt may take: there is always room for what stops the robot. */
#define SLOTS_TO_HALT 3

/* On a line whose worst lateness is below this a reading is given so much time above that of the
 * wire, each time it is asked for. */
enum { QUICK_LATENCY_US = 1000, QUICK_MARGIN_US = 4000 };

int grobo_i_slot_find(const grobo_robot *robot, grobo_i_use use)
{
    int to_leave = use == GROBO_I_USE_HALT ? 0 : SLOTS_TO_HALT;
    int found = -1;
    int end = robot->slots_end;
    for (int i = 0; i < end; i++) {
        const grobo_robot_slot *slot = &robot->slots[i];
        if (slot->use == GROBO_I_USE_FREE && found < 0) {
            found = i;
        } else if (slot->use == GROBO_I_USE_FREE || slot->use == GROBO_I_USE_HALT) {
            to_leave--;
        }
    }
    if (found < 0 && end < GROBO_ROBOT_SLOTS) {
        found = end++;
    }
    to_leave -= GROBO_ROBOT_SLOTS - end;
    return to_leave > 0 ? -1 : found;
}

grobo_robot_slot *grobo_i_slot_take(grobo_robot *robot, grobo_i_use use)
{
    int at = grobo_i_slot_find(robot, use);
    if (at < 0) {
        return NULL;
    }
    grobo_robot_slot *found = &robot->slots[at];
    GROBO_ASSERT(use != GROBO_I_USE_FREE && !grobo_txn_is_pending(&found->txn));
    memset(found, 0, sizeof *found);
    memset(&robot->built, 0, offsetof(grobo_exchange, frame));
    found->robot = robot;
    found->due_us = GROBO_NEVER_US;
    found->use = (uint8_t)use;
    found->job = use == GROBO_I_USE_HALT ? 0 : robot->acting; /* a halt outlives its job */
    robot->slots_end = at < robot->slots_end ? robot->slots_end : at + 1;
    return found;
}

/* ---- their bytes ----------------------------------------------------------------------------- */

/* A frame has as many bytes as it needs when it is given; when it leaves, never more. They lie one
 * behind the other: who gives some back moves what is behind them. The bus finds a frame by its
 * transaction, each time that it needs it. */
static uint8_t *bytes_of(const grobo_robot_slot *slot)
{
    return slot->robot->frames + (slot->txn.frame - slot->robot->frames);
}

_Static_assert(GROBO_ROBOT_SLOTS <= GROBO_BUS_QUEUE_MAX, "the bus takes all that are under way");
_Static_assert(GROBO_ROBOT_FRAMES_BYTES > SLOTS_TO_HALT * GROBO_FRAME_MAX_BYTES,
               "frames that are no halts need room, too");

/* Room for SLOTS_TO_HALT frames of any length is kept for halts: there is always some. */
static bool has_room(const grobo_robot *robot, grobo_i_use use, size_t bytes)
{
    size_t kept = use == GROBO_I_USE_HALT ? 0 : (size_t)SLOTS_TO_HALT * GROBO_FRAME_MAX_BYTES;
    for (int i = 0; i < robot->slots_end; i++) {
        const grobo_robot_slot *slot = &robot->slots[i];
        size_t had = slot->use == GROBO_I_USE_HALT ? slot->room : 0;
        kept -= had < kept ? had : kept;
    }
    return bytes + kept <= sizeof robot->frames - robot->frames_used;
}

static void take_bytes(grobo_robot_slot *slot, const grobo_exchange *exchange)
{
    grobo_robot *robot = slot->robot;
    slot->txn.frame = robot->frames + robot->frames_used;
    slot->room = exchange->frame_bytes;
    robot->frames_used += slot->room;
    memcpy(bytes_of(slot), exchange->frame, slot->room);
    slot->txn.frame_bytes = exchange->frame_bytes;
    slot->txn.reply = exchange->reply;
}

static void give_bytes_back(grobo_robot_slot *slot)
{
    grobo_robot *robot = slot->robot;
    uint8_t *gone = bytes_of(slot), *behind = gone + slot->room;
    size_t n = robot->frames_used - (size_t)(behind - robot->frames);
    GROBO_ASSERT(gone >= robot->frames && behind <= robot->frames + robot->frames_used);
    robot->frames_used -= slot->room;
    for (int i = 0; n > 0 && i < robot->slots_end; i++) {
        grobo_robot_slot *other = &robot->slots[i];
        if (other->room > 0 && other->txn.frame >= behind) {
            other->txn.frame -= slot->room;
        }
    }
    memmove(gone, behind, n);
    slot->room = 0;
}

int grobo_i_slot_renew(grobo_robot_slot *slot)
{
    const grobo_exchange *next = &slot->robot->built;
    if (next->frame_bytes > slot->room) {
        return GROBO_ERR_SPACE;
    }
    memcpy(bytes_of(slot), next->frame, next->frame_bytes);
    slot->txn.frame_bytes = next->frame_bytes;
    slot->txn.reply = next->reply;
    return GROBO_OK;
}

/* ---- to the bus and back --------------------------------------------------------------------- */

void grobo_i_slot_drop(grobo_robot_slot *slot)
{
    GROBO_ASSERT(!grobo_txn_is_pending(&slot->txn));
    grobo_robot *robot = slot->robot;
    slot->use = GROBO_I_USE_FREE;
    if (slot->room > 0) {
        give_bytes_back(slot);
    }
    while (robot->slots_end > 0 && robot->slots[robot->slots_end - 1].use == GROBO_I_USE_FREE) {
        robot->slots_end--;
    }
}

/* The bus takes a thousand replies to believe that of a line, and one that was late to forget it.
 * Who is silent there does not answer. Elsewhere an adapter, or the other end, may hold bytes back:
 * the margin grows with each attempt. */
static uint32_t margin_of(const grobo_robot_slot *slot)
{
    const grobo_robot *robot = slot->robot;
    uint32_t margin_us = robot->config.bus.margin_us;
    bool quick = (slot->reads || slot->many) && grobo_i_bus_of(slot)->worst_us < QUICK_LATENCY_US;
    return margin_us == 0 && quick ? QUICK_MARGIN_US : margin_us;
}

int grobo_i_slot_ask_unread(grobo_robot_slot *slot)
{
    grobo_robot *robot = slot->robot;
    memset(&robot->built, 0, offsetof(grobo_exchange, frame));
    return robot->driver->sense_many(robot->driver, robot->driver_ctx, slot->unread,
                                     (grobo_sense_kind)slot->kind, &robot->built);
}

/* Those that have answered are not asked again: a stop may wait for the others. */
static int ask_again(grobo_robot_slot *slot)
{
    int result = grobo_i_slot_ask_unread(slot);
    return result < 0 ? result : grobo_i_slot_renew(slot);
}

static int on_leave(void *ctx, grobo_txn *txn)
{
    grobo_robot_slot *slot = ctx;
    int result = slot->robot->leave(slot);
    if (!GROBO_DRIVERS_PLAIN && result >= 0 && txn->sent_us >= 0 && slot->many && !slot->fast) {
        result = ask_again(slot);
    }
    slot->refused = result < 0;
    if (result >= 0) {
        grobo_i_bus_of(slot)->config.margin_us = margin_of(slot); /* of this frame: it leaves now */
        slot->asked_us = txn->sent_us < 0 ? slot->robot->now_us : slot->asked_us;
    }
    return result;
}

/* A reply with a name, to the first attempt: not to one that may have been asked twice. */
static void note_answer(const grobo_robot_slot *slot, const grobo_txn *txn, int result,
                        const grobo_packet *reply)
{
    int line = grobo_i_slot_line(slot);
    bool *answered = grobo_i_answered(slot->robot, line);
    *answered =
        *answered || (result >= 0 && reply != NULL && reply->kind == GROBO_PACKET_RETURN &&
                      txn->attempts_ == 1 && txn->sent_us == *grobo_i_left_us(slot->robot, line));
}

static void on_each(void *ctx, grobo_txn *txn, const grobo_packet *reply)
{
    grobo_robot_slot *slot = ctx;
    GROBO_ASSERT(slot->use != GROBO_I_USE_FREE && txn == &slot->txn);
    note_answer(slot, txn, reply->refused ? GROBO_ERR_NACK : GROBO_OK, reply);
    slot->robot->each(slot, reply);
}

static void on_done(void *ctx, grobo_txn *txn, int result, const grobo_packet *reply)
{
    grobo_robot_slot slot = *(const grobo_robot_slot *)ctx;
    GROBO_ASSERT(slot.use != GROBO_I_USE_FREE && txn == &((grobo_robot_slot *)ctx)->txn);
    grobo_i_slot_drop(ctx);
    note_answer(&slot, txn, result, reply);
    slot.robot->over(&slot, result, reply);
}

/* Each of several servos that answer one after another may take so much of its own, whatever the
 * line has learnt from fewer of them. */
#define EACH_US 100

static uint32_t time_of_several(const grobo_robot_slot *slot)
{
    grobo_bus_cost cost;
    grobo_bus_cost_of(grobo_i_bus_of(slot), &slot->txn, &cost);
    return cost.timeout_us + EACH_US * slot->txn.reply.count;
}

int grobo_i_slot_send(grobo_robot_slot *slot, const grobo_exchange *exchange,
                      grobo_priority priority)
{
    const grobo_robot_config *config = &slot->robot->config;
    GROBO_ASSERT(slot->use != GROBO_I_USE_FREE && !grobo_txn_is_pending(&slot->txn));
    bool had_its_chance = slot->reads && slot->robot->axes[slot->joint].lost > 0;
    bool in_turn = slot->use == GROBO_I_USE_SENSE && priority == GROBO_PRIORITY_SENSE;
    /* Where several are asked the next round asks again, but for joints that are to halt. */
    bool once = in_turn && (slot->many || had_its_chance);
    if (!has_room(slot->robot, (grobo_i_use)slot->use, exchange->frame_bytes)) {
        grobo_i_slot_drop(slot);
        return GROBO_ERR_FULL;
    }
    grobo_i_slot_aim(slot);
    take_bytes(slot, exchange);
    slot->txn.priority = priority;
    slot->txn.urgent = slot->use == GROBO_I_USE_SENSE && priority == GROBO_PRIORITY_MOTION;
    slot->txn.retries = once ? 0 : (uint8_t)config->retries;
    slot->txn.patient = slot->txn.retries > 0 && !had_its_chance;
    slot->txn.timeout_us = config->timeout_us;
    if (!GROBO_DRIVERS_PLAIN && once && slot->many && config->timeout_us == 0) {
        slot->txn.timeout_us = time_of_several(slot);
    }
    slot->txn.sent_us = -1;
    slot->given_us = slot->robot->now_us;
    slot->txn.leave = on_leave;
    slot->txn.each = on_each;
    slot->txn.done = on_done;
    slot->txn.ctx = slot;
    int result = grobo_bus_submit(grobo_i_bus_of(slot), &slot->txn);
    if (result < 0) {
        grobo_i_slot_drop(slot);
    }
    return result;
}

static bool waits(const grobo_robot_slot *slot)
{
    return slot->use != GROBO_I_USE_FREE && slot->txn.sent_us < 0;
}

/* What awaits its reply has left: it is not tried again. The bus would hold back whatever is
 * answered alike, a halt of the same servo too, for a reply that nobody awaits. */
static void cancel(grobo_robot_slot *slot)
{
    if (!grobo_i_is_active(slot) || slot->txn.reply.kind == GROBO_REPLY_NONE) {
        (void)grobo_bus_cancel(grobo_i_bus_of(slot), &slot->txn);
        return;
    }
    slot->txn.retries = 0;
    slot->job = 0;
    if (slot->use == GROBO_I_USE_JOB) {
        slot->use = slot->reads ? GROBO_I_USE_SENSE : GROBO_I_USE_PLAIN;
    }
}

void grobo_i_slots_cancel_all(grobo_robot *robot)
{
    for (int i = 0; i < robot->slots_end; i++) {
        if (robot->slots[i].use != GROBO_I_USE_FREE) {
            cancel(&robot->slots[i]);
        }
    }
}

/* Nothing comes behind what brings a motion to rest: it leaves, but for joints of later targets. */
static bool brings_rest(const grobo_robot_slot *slot)
{
    return slot->order.rests && waits(slot);
}

void grobo_i_slots_hurry(grobo_robot *robot)
{
    for (int i = 0; i < grobo_i_lines(robot); i++) {
        grobo_bus *bus = grobo_i_bus(robot, i);
        if (bus->active != NULL) {
            int64_t over_us = grobo_i_later(bus->over_us, robot->now_us);
            bus->limit_us = grobo_i_sooner(bus->limit_us, over_us + GROBO_BUS_MARGIN_MIN_US);
        }
    }
}

void grobo_i_slots_cancel(grobo_robot *robot, grobo_i_use use)
{
    for (int i = 0; i < robot->slots_end; i++) {
        if (robot->slots[i].use == use && !brings_rest(&robot->slots[i])) {
            cancel(&robot->slots[i]);
        }
    }
}

void grobo_i_slots_cancel_job(grobo_robot *robot, int number)
{
    for (int i = 0; i < robot->slots_end; i++) {
        grobo_robot_slot *slot = &robot->slots[i];
        if (slot->use != GROBO_I_USE_FREE && slot->job == number) {
            cancel(slot);
        }
    }
}

grobo_joint_mask grobo_i_slots_take_back(grobo_robot *robot, int number)
{
    grobo_joint_mask joints = 0;
    for (int i = 0; i < robot->slots_end; i++) {
        grobo_robot_slot *slot = &robot->slots[i];
        if (slot->job == number && waits(slot)) {
            joints |= slot->order.joints;
            cancel(slot);
        }
    }
    return joints;
}

bool grobo_i_slots_read(const grobo_robot *robot, int number, grobo_joint_mask joints)
{
    for (int i = 0; i < robot->slots_end; i++) {
        const grobo_robot_slot *slot = &robot->slots[i];
        bool its = slot->use == GROBO_I_USE_JOB && slot->reads && slot->job == number;
        if (its && (slot->part > 0 || !waits(slot)) && grobo_i_has(joints, slot->joint)) {
            return true;
        }
    }
    return false;
}

void grobo_i_slots_cancel_goals(grobo_robot *robot, grobo_joint_mask joints, bool played)
{
    for (int i = 0; i < robot->slots_end; i++) {
        grobo_robot_slot *slot = &robot->slots[i];
        bool goal = slot->use == GROBO_I_USE_MOTION || slot->use == GROBO_I_USE_SEGMENT ||
                    (!GROBO_DRIVERS_PLAIN && slot->use == GROBO_I_USE_SPEED);
        bool meant =
            (slot->order.joints & joints) != 0 || (played && slot->due_us != GROBO_NEVER_US);
        if (goal && meant && waits(slot) && !brings_rest(slot)) {
            cancel(slot);
        }
    }
}

void grobo_i_slots_cancel_own(grobo_robot *robot, grobo_joint_mask joints)
{
    for (int i = 0; i < robot->slots_end; i++) {
        grobo_robot_slot *slot = &robot->slots[i];
        if (slot->use == GROBO_I_USE_MOTION && (slot->order.joints & ~joints) == 0 && waits(slot) &&
            !brings_rest(slot)) {
            cancel(slot);
        }
    }
}

void grobo_i_slots_cancel_rest(const grobo_robot_slot *before)
{
    const grobo_robot_order *order = &before->order;
    for (int i = 0; i < before->robot->slots_end; i++) {
        grobo_robot_slot *slot = &before->robot->slots[i];
        if (slot->use == before->use && waits(slot) && slot->given_us == before->given_us &&
            slot->order.joints == order->joints && slot->order.part > order->part) {
            cancel(slot);
        }
    }
}

void grobo_i_slots_keep_off(grobo_robot *robot, grobo_joint_mask joints)
{
    for (int i = 0; i < robot->slots_end; i++) {
        grobo_robot_slot *slot = &robot->slots[i];
        bool on = slot->order.kind == GROBO_I_ORDER_TORQUE && slot->order.torque == GROBO_TORQUE_ON;
        if (on && waits(slot) && (slot->order.joints & joints) != 0) {
            cancel(slot);
        }
    }
}

bool grobo_i_slots_wait(const grobo_robot *robot, grobo_joint_mask joint, grobo_i_order_kind kind,
                        grobo_torque torque)
{
    for (int i = 0; i < robot->slots_end; i++) {
        const grobo_robot_slot *slot = &robot->slots[i];
        const grobo_robot_order *order = &slot->order;
        if (waits(slot) && order->kind == kind && order->torque == torque &&
            (order->joints & joint) != 0) {
            return true;
        }
    }
    return false;
}

bool grobo_i_slots_busy(const grobo_robot *robot, grobo_i_use use)
{
    for (int i = 0; i < robot->slots_end; i++) {
        if (robot->slots[i].use == use) {
            return true;
        }
    }
    return false;
}
