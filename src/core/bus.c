/* SPDX-License-Identifier: MIT */
/*
 * Transactions on a half-duplex line. One is active at a time, in one of three phases; it leaves
 * by finish(), which hands it back, or by fail(), which may put it in front of its queue again.
 */
#include <grobo/bus.h>

#include <string.h>

#include "core/bus_time.h"
#include "core/instant.h"

enum {
    BAUD_DEFAULT_BPS = 115200,
    BAUD_MIN_BPS = 1200,
    RETURN_DELAY_US = GROBO_RS30X_DELAY_US(0),
    RETRIES_DEFAULT = 2
};

/* ---- queues -------------------------------------------------------------------------------- */

static void put_last(grobo_bus *bus, grobo_txn *txn)
{
    grobo_txn **at = &bus->head[txn->priority];
    while (*at != NULL) {
        at = &(*at)->next_;
    }
    *at = txn;
    txn->next_ = NULL;
    bus->waiting++;
}

static void put_first(grobo_bus *bus, grobo_txn *txn)
{
    txn->next_ = bus->head[txn->priority];
    bus->head[txn->priority] = txn;
    bus->waiting++;
}

/* True if it was there. */
static bool take_out(grobo_bus *bus, grobo_txn *txn)
{
    grobo_txn **at = &bus->head[txn->priority];
    while (*at != NULL && *at != txn) {
        at = &(*at)->next_;
    }
    if (*at == NULL) {
        return false;
    }
    *at = txn->next_;
    bus->waiting--;
    return true;
}

/* ---- ends of a transaction ----------------------------------------------------------------- */

/* The last touch: after the callback the transaction may not exist any more. */
static void finish(grobo_bus *bus, grobo_txn *txn, int result, const grobo_rs30x_packet *reply)
{
    if (bus->active == txn) {
        bus->active = NULL;
        bus->phase = GROBO_BUS_IDLE;
    }
    txn->pending_ = false;
    if (txn->done != NULL) {
        txn->done(txn->ctx, txn, result, reply);
    }
}

/*
 * The line has talked out of turn, or has failed: it must be quiet before it is asked again. Where
 * it babbles on, a request goes out all the same when the longest silence asked for is over.
 */
static void ask_for_quiet(grobo_bus *bus)
{
    bool kept_quiet = bus->now_us >= bus->quiet_us && bus->quiet_us < bus->quiet_by_us;
    if (bus->quiet_by_us == 0 || kept_quiet) {
        bus->quiet_by_us = bus->now_us + GROBO_BUS_QUIET_MAX_US;
    }
    bus->quiet_us = grobo_i_sooner(bus->now_us + bus->config.quiet_us, bus->quiet_by_us);
}

/* An attempt of the active transaction has failed. */
static void fail(grobo_bus *bus, int error)
{
    grobo_txn *txn = bus->active;
    if (error == GROBO_ERR_TIMEOUT || error == GROBO_ERR_SHORT) {
        bus->stats.timeouts++;
    }
    /* After a wrong sum too: that may have been an older reply, and this one's is yet to come. */
    grobo_i_bus_hold(bus, txn, bus->now_us);
    ask_for_quiet(bus);
    if (txn->attempts_ <= txn->retries) {
        bus->active = NULL;
        bus->phase = GROBO_BUS_IDLE;
        put_first(bus, txn);
    } else {
        bus->stats.failed++;
        finish(bus, txn, error, NULL);
    }
}

/* ---- receiving ----------------------------------------------------------------------------- */

static void count_late(grobo_bus *bus, size_t n)
{
    bus->stats.late_bytes += (uint32_t)n;
    ask_for_quiet(bus);
}

static void succeed(grobo_bus *bus, const grobo_rs30x_packet *reply)
{
    grobo_txn *txn = bus->active;
    bus->stats.replies++;
    if (txn->attempts_ == 1) {
        grobo_i_bus_learn(bus);
        grobo_i_bus_release_holds(bus);
        bus->free_us = grobo_i_sooner(bus->free_us, bus->now_us); /* its last byte is here */
    } else {
        /* This may have been the late reply to an earlier attempt: one more may come. */
        grobo_i_bus_hold(bus, txn, bus->now_us);
    }
    finish(bus, txn, GROBO_OK, reply);
}

static void refuse(grobo_bus *bus, const grobo_rs30x_packet *reply)
{
    grobo_txn *txn = bus->active;
    bus->stats.refusals++;
    bus->stats.failed++;
    if (txn->attempts_ > 1) {
        grobo_i_bus_hold(bus, txn, bus->now_us);
    }
    finish(bus, txn, GROBO_ERR_NACK, reply);
}

static void take_return(grobo_bus *bus, const grobo_rs30x_packet *p)
{
    const grobo_reply *want = &bus->active->reply;
    bool from_whom = want->kind == GROBO_REPLY_RETURN && p->id == want->id;
    if (from_whom && (p->flags & GROBO_RS30X_STATUS_REFUSED) != 0) {
        refuse(bus, p);
    } else if (from_whom && p->address == want->address && p->length == want->length) {
        succeed(bus, p);
    } else {
        size_t size = p->data_bytes + GROBO_RS30X_OVERHEAD_BYTES;
        bus->stats.late_frames++;
        bus->stats.late_bytes += (uint32_t)size;
        bus->got_bytes = (uint16_t)(bus->got_bytes - size);
    }
}

/*
 * One byte without a name is believed only when no rubbish came before it. That it refuses is asked
 * again: it may be of a reply that the line still owed to the program before this one.
 */
static void take_ack(grobo_bus *bus, const grobo_rs30x_packet *p)
{
    bool among_rubbish = bus->parser.framer.stats.dropped_bytes != bus->dropped_before;
    bool refuses = p->kind != GROBO_RS30X_ACK_BYTE;
    if (among_rubbish || (refuses && bus->active->attempts_ <= bus->active->retries)) {
        bus->stats.late_frames++;
        bus->stats.late_bytes++;
        fail(bus, among_rubbish ? GROBO_ERR_MISMATCH : GROBO_ERR_NACK);
    } else if (refuses) {
        refuse(bus, p);
    } else {
        succeed(bus, p);
    }
}

/* As many bytes as the reply has were received and none of them can belong to it any more. */
static void give_up_on_rubbish(grobo_bus *bus)
{
    if (bus->got_bytes < grobo_reply_bytes(&bus->active->reply) ||
        grobo_rs30x_parser_pending(&bus->parser) > 0) {
        return;
    }
    bool bad_sum = bus->parser.framer.stats.bad_sums != bus->bad_sums_before;
    fail(bus, bad_sum ? GROBO_ERR_CHECKSUM : GROBO_ERR_MISMATCH);
}

static void copy_counters(grobo_bus *bus)
{
    bus->stats.bad_sums = bus->parser.framer.stats.bad_sums;
    bus->stats.resync_bytes = bus->parser.framer.stats.dropped_bytes;
}

/* Bytes taken: all, or those up to the end of the transaction. */
static size_t take_reply(grobo_bus *bus, const uint8_t *bytes, size_t n)
{
    grobo_rs30x_packet p;
    size_t took = grobo_rs30x_parser_feed(&bus->parser, bytes, n);
    bus->got_bytes = (uint16_t)(bus->got_bytes + took);
    while (bus->phase == GROBO_BUS_AWAITING && grobo_rs30x_parser_next(&bus->parser, &p) > 0) {
        bus->stats.rx_frames++;
        if (p.kind == GROBO_RS30X_RETURN) {
            take_return(bus, &p);
        } else {
            take_ack(bus, &p);
        }
    }
    if (bus->phase == GROBO_BUS_AWAITING) {
        give_up_on_rubbish(bus);
    }
    if (bus->phase != GROBO_BUS_AWAITING) {
        grobo_rs30x_parser_reset(&bus->parser);
    }
    copy_counters(bus);
    return took;
}

static size_t take_echo(grobo_bus *bus, const uint8_t *bytes, size_t n)
{
    grobo_txn *txn = bus->active;
    size_t left = (size_t)(txn->frame_bytes - bus->echo_bytes);
    size_t took = n < left ? n : left;
    if (memcmp(bytes, txn->frame + bus->echo_bytes, took) != 0) {
        bus->stats.bad_echoes++;
        fail(bus, GROBO_ERR_MISMATCH);
        return 0;
    }
    bus->echo_bytes = (uint8_t)(bus->echo_bytes + took);
    if (bus->echo_bytes == txn->frame_bytes) {
        if (txn->reply.kind == GROBO_REPLY_NONE) {
            finish(bus, txn, GROBO_OK, NULL);
        } else {
            bus->phase = GROBO_BUS_AWAITING;
        }
    }
    return took;
}

void grobo_bus_rx(grobo_bus *bus, int64_t now_us, const uint8_t *bytes, size_t n)
{
    bus->now_us = now_us;
    bus->stats.rx_bytes += (uint32_t)n;
    while (n > 0) {
        size_t took = n;
        switch (bus->phase) {
        case GROBO_BUS_IDLE:
        case GROBO_BUS_GOING:
            count_late(bus, n);
            break;
        case GROBO_BUS_ECHOING:
            took = take_echo(bus, bytes, n);
            break;
        case GROBO_BUS_AWAITING:
            took = take_reply(bus, bytes, n);
            break;
        }
        bytes += took;
        n -= took;
    }
}

/* ---- time ---------------------------------------------------------------------------------- */

/* While something urgent waits, the active one gets no more time than its reply needs. */
static int64_t limit_of_active(const grobo_bus *bus)
{
    if (bus->active == NULL) {
        return GROBO_NEVER_US;
    }
    for (int p = GROBO_PRIORITY_STOP; p <= GROBO_PRIORITY_MOTION; p++) {
        if (bus->head[p] != NULL && (int)bus->active->priority > p) {
            return grobo_i_sooner(bus->limit_us, bus->over_us + bus->overhead_us);
        }
    }
    return bus->limit_us;
}

static bool is_stale(const grobo_txn *txn, int64_t now_us)
{
    return txn->start_by_us != 0 && now_us > txn->start_by_us;
}

static void end_stale(grobo_bus *bus, int64_t now_us)
{
    for (int p = 0; p < GROBO_PRIORITIES; p++) {
        grobo_txn *txn = bus->head[p];
        while (txn != NULL && is_stale(txn, now_us)) {
            take_out(bus, txn);
            bus->stats.failed++;
            finish(bus, txn, GROBO_ERR_STALE, NULL);
            txn = bus->head[p];
        }
    }
}

void grobo_bus_step(grobo_bus *bus, int64_t now_us)
{
    bus->now_us = now_us;
    if (now_us >= limit_of_active(bus)) {
        if (bus->phase == GROBO_BUS_GOING) {
            finish(bus, bus->active, GROBO_OK, NULL);
        } else {
            bool some = bus->got_bytes > 0 || bus->echo_bytes > 0;
            fail(bus, some ? GROBO_ERR_SHORT : GROBO_ERR_TIMEOUT);
        }
    }
    end_stale(bus, now_us);
}

int64_t grobo_bus_deadline(const grobo_bus *bus, int64_t now_us)
{
    int64_t at_us = limit_of_active(bus);
    for (int p = 0; p < GROBO_PRIORITIES; p++) {
        const grobo_txn *txn = bus->head[p];
        if (txn == NULL) {
            continue;
        }
        if (txn->start_by_us != 0) {
            at_us = grobo_i_sooner(at_us, txn->start_by_us + 1);
        }
        if (bus->phase == GROBO_BUS_IDLE) {
            at_us = grobo_i_sooner(at_us, grobo_i_bus_start_at(bus, txn, now_us));
        }
    }
    return at_us;
}

/* ---- sending ------------------------------------------------------------------------------- */

/* A patient one is over a moment before the span: after a failure a servo bus keeps quiet. */
static int64_t limit_of_attempt(const grobo_bus *bus, const grobo_txn *txn)
{
    int64_t limit_us = bus->over_us + grobo_i_bus_margin_us(bus, txn->attempts_);
    if (!txn->patient || txn->attempts_ <= txn->retries || txn->priority < GROBO_PRIORITY_USER ||
        bus->config.margin_us != 0) {
        return limit_us;
    }
    int64_t patient_us = bus->over_us + GROBO_BUS_MARGIN_MAX_US;
    if (bus->over_us < bus->reserve_end_us) {
        patient_us = grobo_i_sooner(patient_us, bus->reserve_us - bus->config.quiet_us);
    }
    return grobo_i_later(limit_us, patient_us);
}

static void start_clock(grobo_bus *bus, const grobo_txn *txn, int64_t now_us)
{
    grobo_bus_cost cost;
    grobo_bus_cost_of(bus, txn, &cost);
    bus->over_us = grobo_i_bus_over_at(bus, &cost, now_us);
    bool passing = txn->reply.kind == GROBO_REPLY_NONE && bus->config.overlap;
    bus->free_us = passing ? now_us + cost.request_us : bus->over_us;
    if (cost.servo_us > 0) {
        bus->servo_us = bus->over_us - cost.reply_us;
    }
    if (bus->phase == GROBO_BUS_GOING) {
        bus->limit_us = bus->free_us;
    } else if (txn->timeout_us != 0) {
        bus->limit_us = now_us + txn->timeout_us;
    } else {
        bus->limit_us = limit_of_attempt(bus, txn);
    }
}

static void start(grobo_bus *bus, grobo_txn *txn, int64_t now_us)
{
    bool wants_reply = txn->reply.kind != GROBO_REPLY_NONE;
    bus->active = txn;
    bus->phase = bus->config.echo ? GROBO_BUS_ECHOING
                 : wants_reply    ? GROBO_BUS_AWAITING
                                  : GROBO_BUS_GOING;
    if (txn->attempts_ > 0) {
        bus->stats.retries++;
    }
    txn->attempts_++;
    txn->sent_us = now_us;
    /* The stump of an earlier reply must not become the head of this one. */
    grobo_rs30x_parser_reset(&bus->parser);
    copy_counters(bus);
    bus->parser.accept = GROBO_RS30X_ACCEPT_RETURNS;
    if (txn->reply.kind == GROBO_REPLY_ACK) {
        bus->parser.accept |= GROBO_RS30X_ACCEPT_ACKS;
    }
    bus->bad_sums_before = bus->parser.framer.stats.bad_sums;
    bus->dropped_before = bus->parser.framer.stats.dropped_bytes;
    bus->got_bytes = 0;
    bus->echo_bytes = 0;
    bus->quiet_by_us = 0;
    bus->stats.tx_frames++;
    bus->stats.tx_bytes += txn->frame_bytes;
    start_clock(bus, txn, now_us);
}

/* The first of the highest priority that may start now. */
static grobo_txn *choose(const grobo_bus *bus, int64_t now_us)
{
    for (int p = 0; p < GROBO_PRIORITIES; p++) {
        grobo_txn *txn = bus->head[p];
        if (txn != NULL && !is_stale(txn, now_us) &&
            grobo_i_bus_start_at(bus, txn, now_us) <= now_us) {
            return txn;
        }
    }
    return NULL;
}

int grobo_bus_tx(grobo_bus *bus, int64_t now_us, uint8_t *buf, size_t cap)
{
    grobo_txn *txn = bus->phase == GROBO_BUS_IDLE ? choose(bus, now_us) : NULL;
    if (txn == NULL) {
        return 0;
    }
    if (txn->frame_bytes > cap) {
        return GROBO_ERR_SPACE;
    }
    take_out(bus, txn);
    memcpy(buf, txn->frame, txn->frame_bytes);
    start(bus, txn, now_us);
    return txn->frame_bytes;
}

/* ---- the caller's side --------------------------------------------------------------------- */

static bool is_too_slow(uint32_t baud_bps)
{
    return baud_bps != 0 && baud_bps < BAUD_MIN_BPS;
}

static void fill(uint32_t *value, uint32_t fallback)
{
    if (*value == 0) {
        *value = fallback;
    }
}

int grobo_bus_init(grobo_bus *bus, const grobo_bus_config *config)
{
    if (config != NULL && (is_too_slow(config->baud_bps) || is_too_slow(config->servo_baud_bps) ||
                           (config->echo && config->wiring == GROBO_WIRING_BOARD))) {
        return GROBO_ERR_ARG;
    }
    memset(bus, 0, sizeof *bus);
    if (config != NULL) {
        bus->config = *config;
    }
    fill(&bus->config.baud_bps, BAUD_DEFAULT_BPS);
    fill(&bus->config.servo_baud_bps, BAUD_DEFAULT_BPS);
    fill(&bus->config.return_delay_us, RETURN_DELAY_US);
    fill(&bus->config.quiet_us, GROBO_BUS_QUIET_US);
    fill(&bus->config.hold_us, GROBO_BUS_HOLD_US);
    grobo_rs30x_parser_init(&bus->parser, 0);
    return GROBO_OK;
}

int grobo_txn_init(grobo_txn *txn, grobo_wiring wiring, const uint8_t *frame, size_t n)
{
    grobo_reply reply;
    int result = grobo_frame_reply(wiring, frame, n, &reply);
    if (result < 0) {
        return result;
    }
    memset(txn, 0, sizeof *txn);
    txn->frame = frame;
    txn->frame_bytes = (uint8_t)n;
    txn->retries = RETRIES_DEFAULT;
    txn->priority = GROBO_PRIORITY_USER;
    txn->reply = reply;
    txn->sent_us = -1;
    return GROBO_OK;
}

int grobo_bus_submit(grobo_bus *bus, grobo_txn *txn)
{
    if (txn->pending_) {
        return GROBO_ERR_BUSY;
    }
    if (txn->frame == NULL || txn->frame_bytes == 0 ||
        txn->frame_bytes > GROBO_RS30X_PACKET_MAX_BYTES ||
        (unsigned)txn->priority >= GROBO_PRIORITIES) {
        return GROBO_ERR_ARG;
    }
    if (bus->waiting >= GROBO_BUS_QUEUE_MAX && txn->priority != GROBO_PRIORITY_STOP) {
        return GROBO_ERR_FULL;
    }
    txn->pending_ = true;
    txn->attempts_ = 0;
    txn->sent_us = -1;
    put_last(bus, txn);
    return GROBO_OK;
}

bool grobo_txn_is_pending(const grobo_txn *txn)
{
    return txn->pending_;
}

/* Takes a transaction away; the reply of the active one may come and must find nobody. */
static int take_back(grobo_bus *bus, grobo_txn *txn, int result)
{
    if (bus->active == txn) {
        grobo_i_bus_hold(bus, txn, bus->over_us);
    } else if (!txn->pending_ || !take_out(bus, txn)) {
        return GROBO_ERR_NOTFOUND;
    }
    bus->stats.canceled++;
    finish(bus, txn, result, NULL);
    return GROBO_OK;
}

int grobo_bus_cancel(grobo_bus *bus, grobo_txn *txn)
{
    return take_back(bus, txn, GROBO_ERR_CANCELED);
}

static int length_of(const grobo_txn *txn)
{
    int n = 0;
    for (; txn != NULL; txn = txn->next_) {
        n++;
    }
    return n;
}

int grobo_bus_cancel_all(grobo_bus *bus, unsigned priority_bits, int result)
{
    int ended = 0;
    if (bus->active != NULL && (priority_bits & GROBO_PRIORITY_BIT(bus->active->priority)) != 0) {
        (void)take_back(bus, bus->active, result);
        ended++;
    }
    for (int p = 0; p < GROBO_PRIORITIES; p++) {
        /* Counted first: what a callback submits again goes to the end, and stays. */
        int n = (priority_bits & GROBO_PRIORITY_BIT(p)) != 0 ? length_of(bus->head[p]) : 0;
        for (; n > 0 && bus->head[p] != NULL; n--) {
            (void)take_back(bus, bus->head[p], result);
            ended++;
        }
    }
    return ended;
}

int grobo_bus_pending(const grobo_bus *bus)
{
    return bus->waiting + (bus->active != NULL ? 1 : 0);
}
