/* SPDX-License-Identifier: MIT */
/*
 * Transactions on a half-duplex line. One is active at a time, in one of three phases; it leaves
 * by grobo_i_bus_finish(), which hands it back, or by grobo_i_bus_fail(), which may put it in front
 * of its queue again. What the bytes that come mean is in receive.c.
 * An attempt becomes active only where the owner's `leave` agrees at that moment.
 */
#include <string.h>

#include <grobo/core/bus.h>

#include "src/base/assert.h"
#include "src/base/instant.h"
#include "src/base/sized.h"
#include "src/bus/framer.h"
#include "src/bus/queue.h"
#include "src/bus/receive.h"
#include "src/bus/time.h"

enum { BAUD_DEFAULT_BPS = 115200, BAUD_MIN_BPS = 1200, RETRIES_DEFAULT = 2 };

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
            grobo_i_bus_take_out(bus, txn);
            bus->stats.failed++;
            grobo_i_bus_finish(bus, txn, GROBO_ERR_STALE, NULL);
            txn = bus->head[p];
        }
    }
}

void grobo_bus_step(grobo_bus *bus, int64_t now_us)
{
    if (bus == NULL) {
        return;
    }
    bus->now_us = now_us;
    if (now_us >= limit_of_active(bus)) {
        if (bus->phase == GROBO_BUS_GOING) {
            grobo_i_bus_finish(bus, bus->active, GROBO_OK, NULL);
        } else {
            grobo_i_bus_end_silence(bus);
        }
    }
    end_stale(bus, now_us);
    grobo_i_bus_assert(bus);
}

int64_t grobo_bus_deadline(const grobo_bus *bus, int64_t now_us)
{
    if (bus == NULL) {
        return GROBO_NEVER_US;
    }
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
    if (passing) {
        bus->servo_us = grobo_i_later(bus->servo_us, bus->over_us);
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
    GROBO_ASSERT(bus->active == NULL && txn->pending_);
    bool wants_reply = txn->reply.kind != GROBO_REPLY_NONE;
    /* What is no packet is not known again: its echo is rubbish. */
    bool echoes = bus->config.echo && bus->config.protocol->measure(txn->frame, txn->frame_bytes,
                                                                    GROBO_ACCEPT_COMMANDS) > 0;
    bus->active = txn;
    bus->phase = echoes ? GROBO_BUS_ECHOING : wants_reply ? GROBO_BUS_AWAITING : GROBO_BUS_GOING;
    if (txn->attempts_ > 0) {
        bus->stats.retries++;
    }
    txn->attempts_++;
    txn->sent_us = now_us;
    grobo_i_bus_clear_line(bus);
    bus->accept = GROBO_ACCEPT_RETURNS;
    if (echoes) {
        bus->accept |= GROBO_ACCEPT_COMMANDS;
    } else if (txn->reply.kind == GROBO_REPLY_ACK) {
        bus->accept |= GROBO_ACCEPT_ACKS;
    }
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

/* Asks the owner of a transaction just taken out. A refusal ends it. */
static bool may_leave(grobo_bus *bus, grobo_txn *txn)
{
    int result = txn->leave == NULL ? GROBO_OK : txn->leave(txn->ctx, txn);
    if (result < 0) {
        bus->stats.failed++;
        grobo_i_bus_finish(bus, txn, result, NULL);
    }
    return result >= 0;
}

int grobo_bus_tx(grobo_bus *bus, uint8_t *buf, size_t cap, int64_t now_us)
{
    if (bus == NULL || buf == NULL) {
        return GROBO_ERR_ARG;
    }
    /* Bounded by what waits now: a callback may submit again what is refused again. */
    for (unsigned left = bus->waiting; left > 0 && bus->phase == GROBO_BUS_IDLE; left--) {
        grobo_txn *txn = choose(bus, now_us);
        if (txn == NULL) {
            break;
        }
        size_t size = txn->frame_bytes;
        if (size > cap) {
            return GROBO_ERR_SPACE;
        }
        grobo_i_bus_take_out(bus, txn);
        if (may_leave(bus, txn)) {
            GROBO_ASSERT(txn->frame_bytes > 0 && txn->frame_bytes <= size);
            memcpy(buf, txn->frame, txn->frame_bytes);
            start(bus, txn, now_us);
            grobo_i_bus_assert(bus);
            return txn->frame_bytes;
        }
    }
    return 0;
}

/* ---- the caller's side --------------------------------------------------------------------- */

static bool is_too_slow(uint32_t baud_bps)
{
    return baud_bps - 1 < BAUD_MIN_BPS - 1u; /* 0: the default */
}

static void fill(uint32_t *value, uint32_t fallback)
{
    if (*value == 0) {
        *value = fallback;
    }
}

int grobo_bus_init(grobo_bus *bus, const grobo_bus_config *config)
{
    if (bus == NULL || config == NULL || config->protocol == NULL ||
        !GROBO_I_FITS(config->protocol, relay) || is_too_slow(config->baud_bps) ||
        is_too_slow(config->servo_baud_bps) || (config->echo && config->protocol->relay != NULL)) {
        return GROBO_ERR_ARG;
    }
    memset(bus, 0, sizeof *bus);
    bus->config = *config;
    fill(&bus->config.baud_bps, BAUD_DEFAULT_BPS);
    fill(&bus->config.servo_baud_bps, BAUD_DEFAULT_BPS);
    fill(&bus->config.return_delay_us, config->protocol->return_delay_us);
    fill(&bus->config.quiet_us, GROBO_BUS_QUIET_US);
    fill(&bus->config.hold_us, GROBO_BUS_HOLD_US);
    bus->worst_us = (int32_t)(bus->config.hold_us / 2);
    grobo_i_framer_init(&bus->framer);
    return GROBO_OK;
}

int grobo_txn_init(grobo_txn *txn, const grobo_protocol *protocol, const uint8_t *frame, size_t n)
{
    if (txn == NULL || protocol == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_reply reply;
    int result = protocol->reply_to(frame, n, &reply);
    if (result < 0) {
        return result;
    }
    memset(txn, 0, sizeof *txn);
    txn->frame = frame;
    txn->frame_bytes = (uint16_t)n;
    txn->retries = RETRIES_DEFAULT;
    txn->priority = GROBO_PRIORITY_USER;
    txn->reply = reply;
    txn->sent_us = -1;
    return GROBO_OK;
}

int grobo_bus_submit(grobo_bus *bus, grobo_txn *txn)
{
    if (bus == NULL || txn == NULL) {
        return GROBO_ERR_ARG;
    }
    if (txn->pending_) {
        return GROBO_ERR_BUSY;
    }
    if (txn->frame == NULL || txn->frame_bytes == 0 || txn->frame_bytes > GROBO_FRAME_MAX_BYTES ||
        (unsigned)txn->priority >= GROBO_PRIORITIES) {
        return GROBO_ERR_ARG;
    }
    if (bus->waiting >= GROBO_BUS_QUEUE_MAX && txn->priority != GROBO_PRIORITY_STOP) {
        return GROBO_ERR_FULL;
    }
    txn->pending_ = true;
    txn->attempts_ = 0;
    txn->sent_us = -1;
    grobo_i_bus_put_last(bus, txn);
    return GROBO_OK;
}

bool grobo_txn_is_pending(const grobo_txn *txn)
{
    return txn != NULL && txn->pending_;
}

/* Takes a transaction away; the reply of the active one may come and must find nobody. */
static int take_back(grobo_bus *bus, grobo_txn *txn, int result)
{
    if (bus->active == txn) {
        grobo_i_bus_hold(bus, txn, bus->over_us);
    } else if (!txn->pending_ || !grobo_i_bus_take_out(bus, txn)) {
        return GROBO_ERR_NOTFOUND;
    }
    bus->stats.canceled++;
    grobo_i_bus_finish(bus, txn, result, NULL);
    return GROBO_OK;
}

int grobo_bus_raise(grobo_bus *bus, grobo_txn *txn, grobo_priority priority)
{
    if (bus == NULL || txn == NULL || (unsigned)priority >= GROBO_PRIORITIES) {
        return GROBO_ERR_ARG;
    }
    if (!txn->pending_ || bus->active == txn || !grobo_i_bus_take_out(bus, txn)) {
        return GROBO_ERR_NOTFOUND;
    }
    txn->priority = priority;
    grobo_i_bus_put_last(bus, txn);
    return GROBO_OK;
}

int grobo_bus_cancel(grobo_bus *bus, grobo_txn *txn)
{
    return bus == NULL || txn == NULL ? GROBO_ERR_ARG : take_back(bus, txn, GROBO_ERR_CANCELED);
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
    if (bus == NULL) {
        return GROBO_ERR_ARG;
    }
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
    if (bus == NULL) {
        return GROBO_ERR_ARG;
    }
    return bus->waiting + (bus->active != NULL ? 1 : 0);
}
