/* SPDX-License-Identifier: MIT */
#include "src/base/assert.h"
#include "src/base/instant.h"
#include "src/bus/queue.h"
#include "src/bus/time.h"

/* It is in no queue. */
static void assert_apart(const grobo_bus *bus, const grobo_txn *txn)
{
    for (int p = 0; GROBO_ASSERT_WALKS && p < GROBO_PRIORITIES; p++) {
        for (const grobo_txn *at = bus->head[p]; at != NULL; at = at->next_) {
            GROBO_ASSERT(at != txn);
        }
    }
}

void grobo_i_bus_assert(const grobo_bus *bus)
{
    unsigned queued = 0;
    if (!GROBO_ASSERT_WALKS) {
        return;
    }
    for (int p = 0; p < GROBO_PRIORITIES; p++) {
        for (const grobo_txn *at = bus->head[p]; at != NULL; at = at->next_) {
            GROBO_ASSERT(at->pending_ && (int)at->priority == p);
            queued++;
        }
    }
    GROBO_ASSERT(queued == bus->waiting);
    GROBO_ASSERT((bus->active == NULL) == (bus->phase == GROBO_BUS_IDLE));
    assert_apart(bus, bus->active);
    GROBO_ASSERT(bus->active == NULL || (bus->active->pending_ && bus->active->attempts_ > 0));
    GROBO_ASSERT(bus->phase != GROBO_BUS_GOING || bus->active->reply.kind == GROBO_REPLY_NONE);
    GROBO_ASSERT(bus->phase != GROBO_BUS_AWAITING || bus->active->reply.kind != GROBO_REPLY_NONE);
    GROBO_ASSERT(bus->overhead_us >= 0 && bus->deviation_us >= 0 && bus->worst_us >= 0);
    GROBO_ASSERT(bus->reserve_end_us == 0 || bus->reserve_end_us >= bus->reserve_us);
}

void grobo_i_bus_put_last(grobo_bus *bus, grobo_txn *txn)
{
    GROBO_ASSERT(txn->pending_);
    assert_apart(bus, txn);
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
    GROBO_ASSERT(txn->pending_);
    assert_apart(bus, txn);
    txn->next_ = bus->head[txn->priority];
    bus->head[txn->priority] = txn;
    bus->waiting++;
}

bool grobo_i_bus_take_out(grobo_bus *bus, grobo_txn *txn)
{
    grobo_txn **at = &bus->head[txn->priority];
    while (*at != NULL && *at != txn) {
        at = &(*at)->next_;
    }
    if (*at == NULL) {
        return false;
    }
    GROBO_ASSERT(bus->waiting > 0);
    *at = txn->next_;
    bus->waiting--;
    return true;
}

/* ---- ends of a transaction ----------------------------------------------------------------- */

void grobo_i_bus_finish(grobo_bus *bus, grobo_txn *txn, int result, const grobo_packet *reply)
{
    if (bus->active == txn) {
        bus->active = NULL;
        bus->phase = GROBO_BUS_IDLE;
    }
    GROBO_ASSERT(txn->pending_);
    assert_apart(bus, txn);
    txn->pending_ = false;
    if (txn->done != NULL) {
        txn->done(txn->ctx, txn, result, reply);
    }
}

void grobo_i_bus_ask_for_quiet(grobo_bus *bus)
{
    bool kept_quiet = bus->now_us >= bus->quiet_us && bus->quiet_us < bus->quiet_by_us;
    if (bus->quiet_by_us == 0 || kept_quiet) {
        bus->quiet_by_us = bus->now_us + GROBO_BUS_QUIET_MAX_US;
    }
    bus->quiet_us = grobo_i_sooner(bus->now_us + bus->config.quiet_us, bus->quiet_by_us);
}

void grobo_i_bus_fail(grobo_bus *bus, int error)
{
    grobo_txn *txn = bus->active;
    GROBO_ASSERT(txn != NULL && error < 0);
    if (error == GROBO_ERR_TIMEOUT || error == GROBO_ERR_SHORT) {
        bus->stats.timeouts++;
    }
    if (bus->phase == GROBO_BUS_ECHOING && error == GROBO_ERR_MISMATCH) {
        bus->stats.bad_echoes++;
    }
    /* After a wrong sum too: that may have been an older reply, and this one's is yet to come. */
    grobo_i_bus_hold(bus, txn, bus->now_us);
    grobo_i_bus_ask_for_quiet(bus);
    if (txn->attempts_ <= txn->retries) {
        bus->active = NULL;
        bus->phase = GROBO_BUS_IDLE;
        put_first(bus, txn);
    } else {
        bus->stats.failed++;
        grobo_i_bus_finish(bus, txn, error, NULL);
    }
}
