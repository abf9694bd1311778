/* SPDX-License-Identifier: MIT */
/* Frames under way: from an exchange to a transaction of the bus and back. */
#include "core/robot.h"

#include <string.h>

grobo_robot_slot *grobo_i_slot_take(grobo_robot *robot, grobo_i_use use)
{
    for (int i = 0; i < GROBO_ROBOT_SLOTS; i++) {
        grobo_robot_slot *slot = &robot->slots[i];
        if (slot->use == GROBO_I_USE_FREE) {
            memset(slot, 0, sizeof *slot);
            slot->robot = robot;
            slot->due_us = GROBO_NEVER_US;
            slot->use = (uint8_t)use;
            slot->job = robot->job.number;
            return slot;
        }
    }
    return NULL;
}

void grobo_i_slot_drop(grobo_robot_slot *slot)
{
    slot->use = GROBO_I_USE_FREE;
}

static void on_done(void *ctx, grobo_txn *txn, int result, const grobo_rs30x_packet *reply)
{
    grobo_robot_slot slot = *(grobo_robot_slot *)ctx;
    slot.txn.sent_us = txn->sent_us;
    grobo_i_slot_drop(ctx);
    if (result < 0 && txn->sent_us < 0 && slot.motion != 0) {
        grobo_i_gate_unsent(slot.robot, slot.motion);
    }
    switch ((grobo_i_use)slot.use) {
    case GROBO_I_USE_FREE:
    case GROBO_I_USE_PLAIN:
        break;
    case GROBO_I_USE_JOB:
        grobo_i_job_done(&slot, result, reply);
        break;
    case GROBO_I_USE_SENSE:
        grobo_i_sense_done(&slot, result, reply);
        break;
    case GROBO_I_USE_MOTION:
        grobo_i_play_done(&slot, result);
        break;
    }
}

int grobo_i_slot_send(grobo_robot_slot *slot, grobo_priority priority)
{
    const grobo_robot_config *config = &slot->robot->config;
    bool had_its_chance = slot->reads && slot->robot->axes[slot->joint].lost > 0;
    bool once = had_its_chance && slot->use == GROBO_I_USE_SENSE;
    slot->txn.frame = slot->exchange.frame;
    slot->txn.frame_bytes = slot->exchange.frame_bytes;
    slot->txn.reply = slot->exchange.reply;
    slot->txn.priority = priority;
    slot->txn.retries = once ? 0 : (uint8_t)config->retries;
    slot->txn.patient = slot->txn.retries > 0 && !had_its_chance;
    slot->txn.timeout_us = config->timeout_us;
    slot->txn.sent_us = -1;
    slot->given_us = slot->robot->now_us;
    slot->txn.done = on_done;
    slot->txn.ctx = slot;
    int result = grobo_bus_submit(&slot->robot->bus, &slot->txn);
    if (result < 0) {
        grobo_i_slot_drop(slot);
    }
    return result;
}

void grobo_i_slots_cancel(grobo_robot *robot, grobo_i_use use)
{
    for (int i = 0; i < GROBO_ROBOT_SLOTS; i++) {
        if (robot->slots[i].use == use) {
            (void)grobo_bus_cancel(&robot->bus, &robot->slots[i].txn);
        }
    }
}

void grobo_i_slots_keep_off(grobo_robot *robot)
{
    for (int i = 0; i < GROBO_ROBOT_SLOTS; i++) {
        grobo_robot_slot *slot = &robot->slots[i];
        if (slot->use != GROBO_I_USE_FREE && slot->switches_on && slot->txn.sent_us < 0) {
            (void)grobo_bus_cancel(&robot->bus, &slot->txn);
        }
    }
}

void grobo_i_slots_sent(grobo_robot *robot)
{
    for (int i = 0; i < GROBO_ROBOT_SLOTS; i++) {
        grobo_robot_slot *slot = &robot->slots[i];
        bool moves = slot->use != GROBO_I_USE_FREE && slot->motion != 0;
        if (moves && !slot->out && slot->txn.sent_us >= 0) {
            slot->out = true;
            grobo_i_gate_sent(robot, slot->motion);
        }
    }
}

bool grobo_i_slots_busy(const grobo_robot *robot, grobo_i_use use)
{
    for (int i = 0; i < GROBO_ROBOT_SLOTS; i++) {
        if (robot->slots[i].use == use) {
            return true;
        }
    }
    return false;
}
