/* SPDX-License-Identifier: MIT */
/*
 * What the bytes that come are: the echo of the frame on the wire, the reply to it, a late reply,
 * a late echo, rubbish. An echo is the whole packet that the frame is, whatever comes before it. A
 * return packet goes to the transaction that it is a reply to, whether that is on the wire or waits
 * for its next attempt. No byte is counted twice: those believed, late_bytes, resync_bytes, echoes
 * and what the parser holds are all that came.
 */
#include <string.h>

#include "src/base/assert.h"
#include "src/base/instant.h"
#include "src/bus/framer.h"
#include "src/bus/queue.h"
#include "src/bus/receive.h"
#include "src/bus/time.h"

static bool is_asked(const grobo_bus *bus)
{
    return bus->phase == GROBO_BUS_ECHOING || bus->phase == GROBO_BUS_AWAITING;
}

/* Bytes skipped since the frame was sent, or since its echo. */
static uint32_t rubbish(const grobo_bus *bus)
{
    return bus->framer.stats.dropped_bytes - bus->dropped_before;
}

static void start_count(grobo_bus *bus)
{
    bus->bad_sums_before = bus->framer.stats.bad_sums;
    bus->dropped_before = bus->framer.stats.dropped_bytes;
}

void grobo_i_bus_clear_line(grobo_bus *bus)
{
    bus->stats.resync_bytes += (uint32_t)grobo_i_framer_pending(&bus->framer);
    grobo_i_framer_reset(&bus->framer);
    start_count(bus);
}

/* ---- packets --------------------------------------------------------------------------------- */

/* The transaction that a return packet ends: the active one, or one that waits for its next
 * attempt, if a reply to an earlier one is still owed. */
static grobo_txn *find_asker(grobo_bus *bus, const grobo_packet *p, uint32_t key)
{
    grobo_txn *txn = bus->active;
    if (bus->phase == GROBO_BUS_AWAITING &&
        (grobo_i_bus_key(&txn->reply) == key ||
         (p->refused && txn->reply.kind == GROBO_REPLY_RETURN && txn->reply.id == p->id))) {
        return txn;
    }
    const grobo_bus_hold *hold = grobo_i_bus_owed(bus, key);
    for (int i = 0; hold != NULL && i < GROBO_PRIORITIES; i++) {
        txn = bus->head[i]; /* what waits again is the first; its owner may have changed it */
        if (txn == hold->owner && txn != NULL && txn->attempts_ > 0 &&
            grobo_i_bus_key(&txn->reply) == key) {
            return txn;
        }
    }
    return NULL;
}

/* Of a frame with several replies: one of them, or their time is over (NULL). */
static bool take_several(grobo_bus *bus, grobo_packet *p)
{
    grobo_several several = bus->config.protocol->several;
    return several != NULL && several(bus, p);
}

/* A reply to this transaction: a return packet or an ACK byte. */
static void take_reply(grobo_bus *bus, grobo_txn *txn, const grobo_packet *p, uint32_t key)
{
    if (txn->attempts_ > 1) {
        grobo_i_bus_hold_more(bus, txn, key); /* to its other attempts */
    } else if (txn != bus->active || p->refused) {
        (void)grobo_i_bus_settle(bus, key);
    } else { /* nothing was owed to it */
        grobo_i_bus_learn(bus);
        grobo_i_bus_release_holds(bus);
        bus->free_us = grobo_i_sooner(bus->free_us, bus->now_us); /* its last byte is here */
    }
    if (txn != bus->active) {
        (void)grobo_i_bus_take_out(bus, txn);
    }
    if (p->refused) {
        bus->stats.refusals++;
        bus->stats.failed++;
    } else {
        bus->stats.replies++;
    }
    grobo_i_bus_finish(bus, txn, p->refused ? GROBO_ERR_NACK : GROBO_OK, p);
}

/*
 * One byte without a name is believed only when no rubbish came before it. That it refuses is asked
 * again: it may be of a reply that the line still owed to the program before this one.
 */
static void take_ack(grobo_bus *bus, const grobo_packet *p)
{
    const grobo_txn *txn = bus->active;
    int error = rubbish(bus) != 0                              ? GROBO_ERR_MISMATCH
                : p->refused && txn->attempts_ <= txn->retries ? GROBO_ERR_NACK
                                                               : GROBO_OK;
    if (error == GROBO_OK) {
        take_reply(bus, bus->active, p, 0);
        return;
    }
    bus->stats.late_frames++;
    bus->stats.late_bytes++;
    grobo_i_bus_fail(bus, error);
}

/* The echo of the active frame has come. */
static void end_echo(grobo_bus *bus)
{
    grobo_txn *txn = bus->active;
    GROBO_ASSERT(bus->phase == GROBO_BUS_ECHOING && txn != NULL);
    if (txn->reply.kind == GROBO_REPLY_NONE) {
        grobo_i_bus_finish(bus, txn, GROBO_OK, NULL);
        return;
    }
    bus->phase = GROBO_BUS_AWAITING;
    start_count(bus);
    if (txn->reply.kind == GROBO_REPLY_ACK) {
        bus->accept |= GROBO_ACCEPT_ACKS;
    }
}

/* A whole packet that ends nothing. */
static void take_late(grobo_bus *bus, size_t size, uint32_t key)
{
    if (size > 1) {
        bus->stats.late_frames++;
    }
    bus->stats.late_bytes += (uint32_t)size;
    if (grobo_i_bus_settle(bus, key)) {
        return;
    }
    if (!is_asked(bus)) {
        grobo_i_bus_ask_for_quiet(bus);
    } else if (grobo_i_bus_key(&bus->active->reply) == key) {
        grobo_i_bus_fail(bus, GROBO_ERR_MISMATCH); /* no echo came before its reply */
    }
}

/* What the framer has found. An echo first: of some families it looks like a reply. */
static void take_packet(grobo_bus *bus)
{
    grobo_framer *framer = &bus->framer;
    const grobo_txn *active = bus->active;
    size_t size = framer->taken;
    grobo_packet packet;
    grobo_packet *p = &packet;
    if (bus->phase == GROBO_BUS_ECHOING && size == active->frame_bytes &&
        memcmp(framer->buf, active->frame, size) == 0) {
        end_echo(bus);
        return;
    }
    bus->config.protocol->unpack(framer->buf, size, p);
    bool returned = p->kind == GROBO_PACKET_RETURN;
    uint32_t key = returned ? grobo_i_bus_packet_key(p) : 0;
    grobo_txn *txn = returned ? find_asker(bus, p, key) : NULL;
    if (txn != NULL) {
        p->address = txn->reply.address;
        take_reply(bus, txn, p, key);
    } else if (p->kind == GROBO_PACKET_ACK && bus->phase == GROBO_BUS_AWAITING) {
        take_ack(bus, p);
    } else if (!returned || !take_several(bus, p)) {
        take_late(bus, size, key);
    }
}

/* ---- bytes ----------------------------------------------------------------------------------- */

/* As many bytes as the reply or the echo has were received and none of them can belong to it any
 * more. */
static void give_up_on_rubbish(grobo_bus *bus)
{
    bool echoing = bus->phase == GROBO_BUS_ECHOING;
    if (!is_asked(bus) || grobo_i_framer_pending(&bus->framer) > 0) {
        return;
    }
    /* Where nobody knows how many will answer the bytes are 0, and no rubbish is too much. */
    uint32_t bytes = echoing ? bus->active->frame_bytes : bus->active->reply.bytes;
    if (rubbish(bus) <= bytes - 1) {
        return;
    }
    bool bad_sum = bus->framer.stats.bad_sums != bus->bad_sums_before;
    grobo_i_bus_fail(bus, bad_sum && !echoing ? GROBO_ERR_CHECKSUM : GROBO_ERR_MISMATCH);
}

/* Bytes taken, at least one. */
static size_t take_bytes(grobo_bus *bus, const uint8_t *bytes, size_t n)
{
    const grobo_framer_stats *stats = &bus->framer.stats;
    const grobo_protocol *protocol = bus->config.protocol;
    uint32_t *counter = is_asked(bus) ? &bus->stats.resync_bytes : &bus->stats.late_bytes;
    uint32_t before = stats->dropped_bytes;
    size_t took = grobo_i_framer_feed(&bus->framer, bytes, n);
    while (grobo_i_framer_next(&bus->framer, protocol->measure, bus->accept) > 0) {
        bus->stats.rx_frames++;
        take_packet(bus);
    }
    give_up_on_rubbish(bus);
    uint32_t dropped = stats->dropped_bytes - before;
    *counter += dropped;
    bus->stats.bad_sums = stats->bad_sums;
    if (!is_asked(bus) && dropped + grobo_i_framer_pending(&bus->framer) > 0) {
        grobo_i_bus_ask_for_quiet(bus);
    }
    return took;
}

void grobo_bus_rx(grobo_bus *bus, const uint8_t *bytes, size_t n, int64_t now_us)
{
    if (bus == NULL || (bytes == NULL && n > 0)) {
        return;
    }
    bus->now_us = now_us;
    bus->stats.rx_bytes += (uint32_t)n;
    const uint8_t *end = bytes + n;
    while (bytes < end) {
        size_t took = take_bytes(bus, bytes, (size_t)(end - bytes));
        GROBO_ASSERT(took > 0 && bytes + took <= end);
        bytes += took;
    }
    grobo_i_bus_assert(bus);
}

void grobo_i_bus_end_silence(grobo_bus *bus)
{
    bool some = rubbish(bus) > 0;
    if (take_several(bus, NULL)) {
        return;
    }
    grobo_i_bus_fail(bus, some && bus->phase == GROBO_BUS_ECHOING            ? GROBO_ERR_MISMATCH
                          : some || grobo_i_framer_pending(&bus->framer) > 0 ? GROBO_ERR_SHORT
                                                                             : GROBO_ERR_TIMEOUT);
}
