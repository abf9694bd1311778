/* SPDX-License-Identifier: MIT */
/* Several replies to one frame. A file of its own: only protocols that have such frames name it. */
#include <grobo/core/bus.h>

#include "src/base/assert.h"
#include "src/base/instant.h"
#include "src/bus/queue.h"
#include "src/bus/time.h"

/* Whom a frame asks that several answer. */
#define ID_ALL 0xFE

static bool has_come(const grobo_bus *bus, unsigned k)
{
    return (bus->came >> k & 1u) != 0;
}

/* The reply that comes as number k. */
static grobo_reply reply_of(const grobo_bus *bus, const grobo_txn *txn, unsigned k)
{
    grobo_reply one = {.kind = GROBO_REPLY_RETURN, .count = 1};
    bus->config.protocol->reply_at(txn->frame, txn->frame_bytes, k, &one);
    return one;
}

/* The place of a packet among those that have not come, or -1. One that refuses may have another
 * length. */
static int place_of(const grobo_bus *bus, const grobo_txn *txn, const grobo_packet *packet)
{
    for (unsigned k = 0; k < txn->reply.count; k++) {
        grobo_reply one = reply_of(bus, txn, k);
        bool fits = one.tag == packet->address && one.length == packet->data_bytes;
        if (!has_come(bus, k) && one.id == packet->id && (fits || packet->refused)) {
            return (int)k;
        }
    }
    return -1;
}

static uint64_t all_of(const grobo_txn *txn)
{
    return UINT64_MAX >> (GROBO_REPLIES_MAX - txn->reply.count);
}

/* Those that did not come may come late: nothing that they would answer is asked meanwhile. To the
 * whole frame as many are owed; its last one is counted by grobo_i_bus_fail(). */
static void hold_missing(grobo_bus *bus, grobo_txn *txn)
{
    grobo_reply whole = txn->reply;
    unsigned missing = 0;
    for (unsigned k = 0; k < whole.count; k++) {
        if (!has_come(bus, k)) {
            txn->reply = reply_of(bus, txn, k);
            grobo_i_bus_hold(bus, txn, bus->now_us);
            missing++;
        }
    }
    txn->reply = whole;
    for (; missing > 1; missing--) {
        grobo_i_bus_hold(bus, txn, bus->now_us);
    }
}

/* A late reply that is owed is one less that the whole frame waits for. */
static void settle_whole(grobo_bus *bus, const grobo_packet *packet)
{
    grobo_packet whole = *packet;
    whole.id = ID_ALL;
    grobo_bus_hold *hold = grobo_i_bus_owed(bus, grobo_i_bus_packet_key(&whole));
    if (hold != NULL && packet->id != ID_ALL &&
        grobo_i_bus_owed(bus, grobo_i_bus_packet_key(packet)) != NULL) {
        hold->owed--;
    }
}

/* Who is there may take longer than a frame that does not say whom it asks: not where something
 * urgent waits, which ends this before its limit. */
static bool goes_on(grobo_bus *bus, const grobo_txn *txn)
{
    int64_t until_us = txn->sent_us + bus->config.protocol->call_us;
    bool more = txn->reply.kind == GROBO_REPLY_ANY && txn->timeout_us == 0 &&
                bus->now_us >= bus->limit_us && bus->now_us < until_us;
    bus->limit_us = more ? until_us : bus->limit_us;
    return more;
}

static void end(grobo_bus *bus, grobo_txn *txn)
{
    bool any = txn->reply.kind == GROBO_REPLY_ANY;
    if (!any && bus->came != all_of(txn)) {
        hold_missing(bus, txn);
        grobo_i_bus_fail(bus, bus->came == 0 ? GROBO_ERR_TIMEOUT : GROBO_ERR_SHORT);
        return;
    }
    if (!any && txn->attempts_ == 1) {
        grobo_i_bus_learn(bus);
    }
    bus->free_us = grobo_i_sooner(bus->free_us, bus->now_us);
    bus->stats.replies++;
    grobo_i_bus_finish(bus, txn, GROBO_OK, NULL);
}

/* A reply that is owed to a question before, and comes sooner than the line can carry this frame
 * and one of its replies, is that one. */
static bool is_older(grobo_bus *bus, const grobo_txn *txn, const grobo_packet *packet)
{
    grobo_bus_cost cost;
    grobo_bus_cost_of(bus, txn, &cost);
    uint32_t delays_us = bus->config.return_delay_us * txn->reply.count;
    uint32_t one_us = (cost.reply_us - delays_us) / txn->reply.count;
    return bus->now_us < txn->sent_us + cost.request_us + one_us &&
           grobo_i_bus_owed(bus, grobo_i_bus_packet_key(packet)) != NULL;
}

static bool take(grobo_bus *bus, grobo_txn *txn, const grobo_packet *packet)
{
    bool any = txn->reply.kind == GROBO_REPLY_ANY;
    int place = any ? 0 : place_of(bus, txn, packet);
    if (place < 0 || (!any && is_older(bus, txn, packet))) {
        return false;
    }
    grobo_packet reply = *packet;
    reply.address = txn->reply.address;
    bus->came |= (uint64_t)1 << place;
    if (txn->each != NULL) {
        txn->each(txn->ctx, txn, &reply);
    }
    bool over = !any && (place == txn->reply.count - 1 || bus->came == all_of(txn));
    if (over && bus->active == txn) { /* nobody has cancelled it */
        end(bus, txn);
    }
    return true;
}

/* True if the frame on the wire has several replies. */
static bool awaits_several(const grobo_bus *bus)
{
    return bus->phase == GROBO_BUS_AWAITING &&
           (bus->active->reply.kind == GROBO_REPLY_ANY || bus->active->reply.count > 1);
}

bool grobo_bus_several(grobo_bus *bus, const grobo_packet *packet)
{
    if (bus == NULL) {
        return false;
    }
    bool asked = awaits_several(bus);
    if (asked && bus->came_to != bus->stats.tx_frames) {
        bus->came_to = bus->stats.tx_frames;
        bus->came = 0;
    }
    if (packet != NULL) {
        bool taken = asked && take(bus, bus->active, packet);
        if (!taken) {
            settle_whole(bus, packet);
        }
        return taken;
    }
    if (asked && !goes_on(bus, bus->active)) {
        end(bus, bus->active);
    }
    return asked;
}
