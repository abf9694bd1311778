/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "src/base/assert.h"
#include "src/base/instant.h"
#include "src/bus/time.h"

enum {
    BITS_PER_BYTE = 10, /* 8N1 */
    US_PER_MS = 1000,
    MS_PER_S = 1000,
    /* A stop waits so much longer than a reply needs for one that is owed to the same question,
     * however late they come here: its first frame is not to be late, and what it halts is read
     * back. */
    STOP_HOLD_US = 5000
};

/* In two steps, so that products fit 32 bits: no 64-bit division on small machines. */
static uint32_t wire_us(const grobo_bus *bus, size_t bytes, uint32_t baud_bps)
{
    bool parity = bus->config.protocol->parity != GROBO_PARITY_NONE;
    uint32_t kbits = (uint32_t)bytes * (BITS_PER_BYTE + parity) * MS_PER_S;
    uint32_t rest = kbits % baud_bps * US_PER_MS;
    return kbits / baud_bps * US_PER_MS + (rest + baud_bps - 1) / baud_bps;
}

void grobo_bus_cost_of(const grobo_bus *bus, const grobo_txn *txn, grobo_bus_cost *cost)
{
    if (bus == NULL || txn == NULL || cost == NULL) {
        return;
    }
    const grobo_bus_config *c = &bus->config;
    const grobo_relay *relay = c->protocol->relay;
    size_t reply = txn->reply.bytes;
    uint32_t delay_us = c->return_delay_us * txn->reply.count;
    cost->request_us = wire_us(bus, txn->frame_bytes, c->baud_bps);
    cost->servo_us = 0;
    cost->reply_us = wire_us(bus, reply, c->baud_bps);
    if (relay == NULL) {
        cost->reply_us += delay_us;
    } else {
        size_t forwarded = relay->forwarded(txn->frame, txn->frame_bytes);
        if (forwarded > 0) {
            cost->servo_us = wire_us(bus, forwarded, c->servo_baud_bps) + delay_us +
                             wire_us(bus, reply, c->servo_baud_bps);
        }
    }
    cost->total_us = cost->request_us + cost->servo_us + cost->reply_us;
    if (txn->timeout_us != 0) {
        cost->timeout_us = txn->timeout_us;
    } else {
        cost->timeout_us = cost->total_us + grobo_i_bus_margin_us(bus, 1);
    }
}

int64_t grobo_i_bus_over_at(const grobo_bus *bus, const grobo_bus_cost *cost, int64_t start_us)
{
    int64_t at_us = start_us + cost->request_us;
    if (cost->servo_us > 0) {
        at_us = grobo_i_later(at_us, bus->servo_us) + cost->servo_us;
    }
    return at_us + cost->reply_us;
}

uint32_t grobo_i_bus_margin_us(const grobo_bus *bus, unsigned attempts)
{
    if (bus->config.margin_us != 0) {
        return bus->config.margin_us;
    }
    int32_t margin_us = GROBO_BUS_MARGIN_FIRST_US; /* 32 bits hold twice the most */
    if (bus->learnt) {
        margin_us = bus->overhead_us + 4 * bus->deviation_us;
    }
    margin_us = margin_us < GROBO_BUS_MARGIN_MIN_US ? GROBO_BUS_MARGIN_MIN_US : margin_us;
    for (; attempts > 1 && margin_us < GROBO_BUS_MARGIN_MAX_US; attempts--) {
        margin_us *= 2;
    }
    return (uint32_t)(margin_us < GROBO_BUS_MARGIN_MAX_US ? margin_us : GROBO_BUS_MARGIN_MAX_US);
}

static int32_t clip(int64_t late_us, int32_t most_us)
{
    return late_us < 0 ? 0 : late_us > most_us ? most_us : (int32_t)late_us;
}

/* As TCP does it: mean with weight 1/8, deviation with weight 1/4. A retried request teaches
 * nothing, since nobody knows which of its attempts was answered. */
void grobo_i_bus_learn(grobo_bus *bus)
{
    GROBO_ASSERT(bus->active != NULL && bus->active->attempts_ == 1);
    int32_t sample_us = clip(bus->now_us - bus->over_us, GROBO_BUS_MARGIN_MAX_US);
    bus->worst_us = (int32_t)grobo_i_later(bus->worst_us, sample_us);
    bus->worst_us -= (bus->worst_us - sample_us) >> 8; /* slowly forgotten */
    if (!bus->learnt) {
        bus->learnt = true;
        bus->overhead_us = sample_us;
        bus->deviation_us = sample_us >> 1;
        return;
    }
    int32_t error_us = sample_us - bus->overhead_us;
    bus->overhead_us += error_us >> 3;
    bus->deviation_us += ((error_us < 0 ? -error_us : error_us) - bus->deviation_us) / 4;
}

static uint32_t key_of(uint32_t length, uint32_t tag, uint32_t id)
{
    return UINT32_C(1) << 31 | length << 16 | tag << 8 | id;
}

uint32_t grobo_i_bus_key(const grobo_reply *reply)
{
    return reply->kind < GROBO_REPLY_RETURN ? reply->kind
                                            : key_of(reply->length, reply->tag, reply->id);
}

uint32_t grobo_i_bus_packet_key(const grobo_packet *packet)
{
    return key_of((uint32_t)packet->data_bytes, packet->address, packet->id);
}

/* The hold for replies that would be taken for this one, though none may be owed; or NULL. */
static grobo_bus_hold *find_hold(const grobo_bus *bus, uint32_t key)
{
    for (const grobo_bus_hold *hold = bus->hold; hold < bus->hold + GROBO_BUS_HOLDS; hold++) {
        if (hold->key == key) {
            return (grobo_bus_hold *)hold; /* as writable as its bus is to the caller */
        }
    }
    return NULL;
}

void grobo_i_bus_hold(grobo_bus *bus, const grobo_txn *txn, int64_t from_us)
{
    uint32_t key = grobo_i_bus_key(&txn->reply);
    grobo_bus_hold *hold = find_hold(bus, key);
    uint32_t span_us = 2 * (uint32_t)bus->worst_us;
    if (txn->reply.kind == GROBO_REPLY_NONE) {
        return;
    }
    /* An ACK has no name, so that none is known to be the one that is owed: only time tells. The
     * first hold is theirs: theirs is the confusion that could name a wrong motor. */
    if (txn->reply.kind == GROBO_REPLY_ACK) {
        hold = bus->hold;
        span_us = bus->config.hold_us;
    }
    if (hold == NULL) {
        bus->next_hold = bus->next_hold == GROBO_BUS_HOLDS - 1 ? 1 : (uint8_t)(bus->next_hold + 1);
        hold = &bus->hold[bus->next_hold];
        hold->owed = 0;
    }
    if (hold->owed == 0 || hold->until_us < bus->now_us) {
        hold->owed = 0;
        hold->due_us = bus->over_us;
    }
    hold->owed++;
    hold->key = key;
    hold->owner = txn;
    hold->until_us = from_us + span_us;
}

/* The return delay of a servo is an assumption: it may answer at once. Of a hold that is
 * older than half an hour either answer will do. */
grobo_bus_hold *grobo_i_bus_owed(grobo_bus *bus, uint32_t key)
{
    grobo_bus_hold *hold = find_hold(bus, key);
    return hold != NULL && hold->owed > 0 &&
                   (int32_t)(hold->due_us - bus->now_us) <= (int32_t)bus->config.return_delay_us
               ? hold
               : NULL;
}

static void learn_late(grobo_bus *bus, int64_t due_us)
{
    int32_t late_us = clip(bus->now_us - due_us, (int32_t)(bus->config.hold_us / 2));
    bus->worst_us = (int32_t)grobo_i_later(bus->worst_us, late_us);
}

bool grobo_i_bus_settle(grobo_bus *bus, uint32_t key)
{
    grobo_bus_hold *hold = grobo_i_bus_owed(bus, key);
    if (hold == NULL) {
        return false;
    }
    learn_late(bus, hold->due_us);
    GROBO_ASSERT(hold->owed > 0);
    hold->due_us = bus->over_us; /* the rest are to later attempts */
    hold->owed--;
    return true;
}

void grobo_i_bus_hold_more(grobo_bus *bus, const grobo_txn *txn, uint32_t key)
{
    const grobo_bus_hold *hold = grobo_i_bus_owed(bus, key);
    if (hold != NULL && hold->until_us >= bus->now_us) {
        (void)grobo_i_bus_settle(bus, key);
    } else if (key != 0) {
        learn_late(bus, bus->over_us);
    }
    grobo_i_bus_hold(bus, txn, grobo_i_later(bus->now_us, bus->over_us));
}

void grobo_i_bus_release_holds(grobo_bus *bus)
{
    if (bus->config.protocol->relay != NULL) {
        memset(bus->hold, 0, sizeof bus->hold);
        return;
    }
    for (int i = 0; i < GROBO_BUS_HOLDS; i++) {
        int64_t *until_us = &bus->hold[i].until_us;
        *until_us = grobo_i_sooner(*until_us, bus->now_us + GROBO_BUS_MARGIN_MAX_US);
    }
}

static int64_t held_until(const grobo_bus *bus, const grobo_txn *txn)
{
    const grobo_bus_hold *hold = find_hold(bus, grobo_i_bus_key(&txn->reply));
    if (hold == NULL || hold->owed == 0 || (hold->owner == txn && txn->attempts_ != 0)) {
        return 0;
    }
    return txn->priority == GROBO_PRIORITY_STOP || txn->urgent ? hold->due_us + STOP_HOLD_US
                                                               : hold->until_us;
}

bool grobo_bus_fits(const grobo_bus *bus, int64_t now_us, const grobo_txn *txn)
{
    if (bus == NULL || txn == NULL) {
        return false;
    }
    grobo_bus_cost cost;
    if (now_us >= bus->reserve_end_us) {
        return true;
    }
    grobo_bus_cost_of(bus, txn, &cost);
    uint32_t overhead_us = txn->reply.kind != GROBO_REPLY_NONE ? (uint32_t)bus->overhead_us : 0;
    return grobo_i_bus_over_at(bus, &cost, now_us) + overhead_us <= bus->reserve_us;
}

int64_t grobo_i_bus_start_at(const grobo_bus *bus, const grobo_txn *txn, int64_t now_us)
{
    int64_t at_us = grobo_i_later(now_us, bus->free_us);
    if (txn->reply.kind != GROBO_REPLY_NONE || bus->config.protocol->relay == NULL) {
        at_us = grobo_i_later(at_us, bus->quiet_us);
        at_us = grobo_i_later(at_us, held_until(bus, txn));
    }
    if (txn->priority >= GROBO_PRIORITY_USER && !grobo_bus_fits(bus, at_us, txn)) {
        at_us = bus->reserve_end_us;
    }
    return at_us;
}

void grobo_bus_reserve(grobo_bus *bus, int64_t at_us, uint32_t duration_us)
{
    if (bus == NULL) {
        return;
    }
    bus->reserve_us = at_us;
    bus->reserve_end_us = at_us == GROBO_NEVER_US ? 0 : at_us + duration_us;
}

int64_t grobo_bus_free_at(const grobo_bus *bus, int64_t now_us)
{
    return bus == NULL ? GROBO_NEVER_US : grobo_i_later(now_us, bus->free_us);
}
