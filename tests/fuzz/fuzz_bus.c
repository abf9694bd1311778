/* SPDX-License-Identifier: MIT */
/*
 * Any sequence of submits, bytes, waits, cancels and reservations against the bus.
 *
 * Input: byte 0 the configuration (bit 0 servo bus, bit 1 echo, bit 2 overlap), then operations of
 * two bytes each: what, and with which number.
 */
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/bus.h>

#include "src/bus/framer.h"
#include "tests/fuzz/target.h"
#include "tests/support/tables.h"

enum { REQUESTS = 8, FRAME = GROBO_RS30X_PACKET_MAX_BYTES, PUMP_MAX = 1000 };

typedef struct request {
    grobo_txn txn;
    uint8_t frame[FRAME];
} request;

typedef struct run {
    grobo_bus bus;
    const grobo_protocol *protocol;
    int64_t now_us;
    request requests[REQUESTS];
    uint32_t submitted, ended;
    size_t believed_bytes;
} run;

static void ended(void *ctx, grobo_txn *txn, int result, const grobo_packet *reply)
{
    run *r = ctx;
    r->ended++;
    MUST(!grobo_txn_is_pending(txn));
    MUST(result <= 0);
    if (reply != NULL) {
        size_t size =
            reply->kind == GROBO_PACKET_RETURN ? reply->data_bytes + GROBO_RS30X_OVERHEAD_BYTES : 1;
        MUST(result == GROBO_ERR_NACK || size == txn->reply.bytes);
        r->believed_bytes += size;
    }
    if (result == GROBO_ERR_TIMEOUT && txn->retries == 2) { /* once more, from the callback */
        txn->retries = 1;
        MUST(grobo_bus_submit(&r->bus, txn) == GROBO_OK);
        r->submitted++;
    }
}

static void submit(run *r, uint8_t number)
{
    request *q = &r->requests[number % REQUESTS];
    uint8_t id = (uint8_t)(1 + number % 5);
    const grobo_rs30x_goal goal = {id, 0, 1};
    uint8_t packet[16];
    int n;
    if (grobo_txn_is_pending(&q->txn)) {
        MUST(grobo_bus_submit(&r->bus, &q->txn) == GROBO_ERR_BUSY);
        return;
    }
    switch (number >> 6) {
    case 0:
        n = grobo_rs30x_write_goal(&goal, packet, sizeof packet);
        break;
    case 1:
        n = grobo_rs30x_ping(id, GROBO_RS30X_PING_FF_0_0, packet, sizeof packet);
        break;
    default:
        n = grobo_rs30x_read(id, 42, 2, packet, sizeof packet);
        break;
    }
    n = grobo_frame_wrap(r->protocol, packet, (size_t)n, q->frame, FRAME);
    MUST(grobo_txn_init(&q->txn, r->protocol, q->frame, (size_t)n) == GROBO_OK);
    q->txn.priority = (grobo_priority)(number >> 3 & 3);
    q->txn.start_by_us = number % 11 == 0 ? r->now_us + 5000 : 0;
    q->txn.done = ended;
    q->txn.ctx = r;
    MUST(grobo_bus_submit(&r->bus, &q->txn) == GROBO_OK);
    r->submitted++;
}

/* What the active transaction waits for, as far as it may be known; n bytes of it. */
static void answer(run *r, size_t n)
{
    uint8_t b[2 * FRAME];
    static const uint8_t data[2] = {0xFD, 0x07};
    const grobo_txn *txn = r->bus.active;
    if (txn == NULL) {
        return;
    }
    size_t size = 0;
    if (r->bus.phase == GROBO_BUS_ECHOING) {
        size_t had = grobo_i_framer_pending(&r->bus.framer) % txn->frame_bytes;
        size = txn->frame_bytes - had;
        memcpy(b, txn->frame + had, size);
    }
    const grobo_rs30x_packet packet = {txn->reply.kind == GROBO_REPLY_ACK ? GROBO_RS30X_ACK_BYTE
                                                                          : GROBO_RS30X_RETURN,
                                       txn->reply.kind == GROBO_REPLY_RETURN ? txn->reply.id : 1,
                                       0,
                                       42,
                                       2,
                                       1,
                                       data,
                                       2};
    int built = grobo_rs30x_build(&packet, b + size, sizeof b - size);
    size += (size_t)built;
    grobo_bus_rx(&r->bus, b, n < size ? n : size, r->now_us);
}

static void check_books(const run *r)
{
    const grobo_bus_stats *s = &r->bus.stats;
    size_t pending = grobo_i_framer_pending(&r->bus.framer);
    size_t known = r->believed_bytes + s->late_bytes + s->resync_bytes + pending;
    MUST(r->bus.config.echo ? known <= s->rx_bytes : known == s->rx_bytes);
    MUST(r->submitted - r->ended == (uint32_t)grobo_bus_pending(&r->bus));
    MUST((r->bus.active == NULL) == (r->bus.phase == GROBO_BUS_IDLE));
}

/* Until the bus wants to be called later, which it must at some time. */
static void pump(run *r)
{
    uint8_t buf[FRAME];
    int i = 0;
    do {
        grobo_bus_step(&r->bus, r->now_us);
        int n = grobo_bus_tx(&r->bus, buf, sizeof buf, r->now_us);
        MUST(n >= 0);
        check_books(r);
        MUST(i++ < PUMP_MAX);
    } while (grobo_bus_deadline(&r->bus, r->now_us) <= r->now_us);
}

static void operate(run *r, uint8_t what, uint8_t number)
{
    grobo_txn *txn = &r->requests[number % REQUESTS].txn;
    switch (what & 7) {
    case 0:
        submit(r, number);
        break;
    case 1:
        grobo_bus_rx(&r->bus, &number, 1, r->now_us);
        break;
    case 2:
        answer(r, number);
        break;
    case 3:
        r->now_us += (int64_t)number * 100;
        break;
    case 4: {
        int64_t next_us = grobo_bus_deadline(&r->bus, r->now_us);
        r->now_us = next_us == GROBO_NEVER_US ? r->now_us + number : next_us;
        break;
    }
    case 5:
        (void)grobo_bus_cancel(&r->bus, txn);
        break;
    case 6:
        (void)grobo_bus_cancel_all(&r->bus, number & GROBO_PRIORITY_ALL, GROBO_ERR_CANCELED);
        break;
    default:
        grobo_bus_reserve(&r->bus, r->now_us + (int64_t)number * 100, 1000);
        break;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static run r;
    if (size == 0) {
        return 0;
    }
    memset(&r, 0, sizeof r);
    r.protocol = (data[0] & 1) != 0 ? &grobo_i_rs30x_protocol : &grobo_i_board_protocol;
    const grobo_bus_config config = {
        .protocol = r.protocol, .echo = (data[0] & 3) == 3, .overlap = (data[0] & 4) != 0};
    MUST(grobo_bus_init(&r.bus, &config) == GROBO_OK);
    for (size_t i = 1; i + 1 < size; i += 2) {
        operate(&r, data[i], data[i + 1]);
        pump(&r);
    }
    (void)grobo_bus_cancel_all(&r.bus, GROBO_PRIORITY_ALL, GROBO_ERR_CLOSED);
    MUST(grobo_bus_pending(&r.bus) == 0);
    MUST(grobo_bus_deadline(&r.bus, r.now_us) == GROBO_NEVER_US);
    return 0;
}
