/* SPDX-License-Identifier: MIT */
/*
 * The bus against a peer with every fault, for many seeds: a reply may be dropped, cut, flipped,
 * late, doubled, or come behind rubbish. The peer keeps the order of its replies, as a line does.
 *
 * Every transaction has a number, which its replies carry as data; of an ACK it is known in whose
 * bytes it came. Nobody may be ended well by another's reply.
 */
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/bus.h>

#include "src/bus/framer.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum {
    MS = 1000,
    FRAME = GROBO_FRAME_MAX_BYTES,
    SEEDS = 200,
    RUN_US = 20000000,
    MOTION_EVERY_US = 40 * MS,
    REQUESTS = 12,
    CHUNKS = 64,
    DELAY_MAX_US = GROBO_BUS_HOLD_US - 20 * MS
};

typedef struct chunk {
    int64_t at_us;
    uint32_t owner;
    uint8_t bytes[40];
    size_t n;
} chunk;

typedef struct request {
    grobo_txn txn;
    uint8_t frame[FRAME];
    uint32_t number;
} request;

typedef struct soak {
    grobo_bus bus;
    int64_t now_us, last_us; /* last_us: when the last chunk so far arrives */
    uint64_t random;
    chunk chunks[CHUNKS];
    int chunk_count;
    uint32_t owner; /* of the bytes being delivered, 0 nobody's */
    uint32_t numbers, submitted, ended;
    size_t believed_bytes;
    request requests[REQUESTS], pose;
    int64_t next_pose_us;
} soak;

static uint32_t draw(soak *s, uint32_t below)
{
    s->random ^= s->random << 13;
    s->random ^= s->random >> 7;
    s->random ^= s->random << 17;
    return (uint32_t)(s->random >> 32) % below;
}

static void put_chunk(soak *s, int64_t at_us, uint32_t owner, const uint8_t *bytes, size_t n)
{
    assert_true(s->chunk_count < CHUNKS && n <= sizeof s->chunks[0].bytes);
    s->last_us = at_us > s->last_us ? at_us : s->last_us;
    chunk *c = &s->chunks[s->chunk_count++];
    *c = (chunk){.at_us = s->last_us, .owner = owner, .n = n};
    memcpy(c->bytes, bytes, n);
}

static size_t make_reply(const request *r, uint8_t *b)
{
    const grobo_reply *want = &r->txn.reply;
    const uint8_t data[18] = {(uint8_t)(r->number & 0xFF), (uint8_t)(r->number >> 8), 7, 8, 0xFD};
    const uint8_t length = (uint8_t)want->length;
    grobo_rs30x_packet packet = {
        GROBO_RS30X_RETURN, want->id, 0, want->tag, length, 1, data, length};
    if (want->kind == GROBO_REPLY_ACK) {
        packet.kind = GROBO_RS30X_ACK_BYTE;
    }
    return (size_t)grobo_rs30x_build(&packet, b, 40);
}

/* The length stays: a wrong one splices packets, which 8 bits of sum miss once in 256 times. */
static void flip_a_bit(soak *s, uint8_t *b, size_t n)
{
    size_t at = draw(s, (uint32_t)n);
    b[at == 5 ? 4 : at] ^= (uint8_t)(1u << draw(s, 8));
}

static uint32_t late_below_us(const soak *s)
{
    uint32_t twice_us = 2 * (uint32_t)s->bus.worst_us;
    return twice_us < DELAY_MAX_US ? twice_us : DELAY_MAX_US;
}

static void answer(soak *s, const request *r)
{
    uint8_t b[40];
    int64_t at_us = s->bus.over_us + draw(s, 300);
    size_t n = make_reply(r, b);
    uint8_t rubbish = (uint8_t)(0x10 + draw(s, 0xA0)); /* no ACK, no header */
    switch (draw(s, 20)) {
    case 0: /* dropped */
        return;
    case 1: /* cut, by more than the byte of rubbish that might take the sum's place */
        n = n > 2 ? 1 + draw(s, (uint32_t)n - 2) : 0;
        break;
    case 2: /* one bit flipped */
        flip_a_bit(s, b, n);
        break;
    case 3: /* late, by no more than the bus waits for */
        at_us += draw(s, late_below_us(s));
        break;
    case 4: /* doubled; of a late reply the second could not be told from one that is owed */
        if (at_us >= s->last_us) {
            put_chunk(s, at_us, r->number, b, n);
        }
        break;
    case 5:
        put_chunk(s, at_us - 500, 0, &rubbish, 1);
        break;
    default:
        break;
    }
    put_chunk(s, at_us, r->number, b, n);
}

static void submit(soak *s, request *r)
{
    r->number = ++s->numbers;
    s->submitted++;
    assert_int_equal(grobo_bus_submit(&s->bus, &r->txn), GROBO_OK);
}

static void ended(void *ctx, grobo_txn *txn, int result, const grobo_packet *reply)
{
    soak *s = ctx;
    request *r = (request *)txn; /* its first member */
    s->ended++;
    assert_false(grobo_txn_is_pending(txn));
    if (reply != NULL) {
        assert_int_equal(result, GROBO_OK);
        if (txn->reply.kind == GROBO_REPLY_ACK) {
            assert_int_equal(s->owner, r->number);
        } else {
            assert_int_equal(reply->data[0] | reply->data[1] << 8, r->number & 0xFFFF);
        }
        s->believed_bytes += txn->reply.bytes;
    }
    if (r != &s->pose && draw(s, 8) != 0) {
        submit(s, r);
    }
}

static void make_request(soak *s, request *r)
{
    uint8_t id = (uint8_t)(1 + draw(s, 3)); /* 6 reads: never more lost than remembered */
    uint8_t packet[16];
    int n = draw(s, 4) == 0
                ? grobo_rs30x_ping(id, GROBO_RS30X_PING_0_0_0, packet, sizeof packet)
                : grobo_rs30x_read(id, 42, draw(s, 2) == 0 ? 2 : 18, packet, sizeof packet);
    n = grobo_frame_wrap(&grobo_i_board_protocol, packet, (size_t)n, r->frame, FRAME);
    assert_int_equal(grobo_txn_init(&r->txn, &grobo_i_board_protocol, r->frame, (size_t)n),
                     GROBO_OK);
    r->txn.retries = (uint8_t)draw(s, 3);
    r->txn.priority = draw(s, 2) == 0 ? GROBO_PRIORITY_USER : GROBO_PRIORITY_SENSE;
    r->txn.done = ended;
    r->txn.ctx = s;
}

static void make_pose(soak *s)
{
    const grobo_rs30x_goal goals[] = {{1, 0, 2}, {2, 0, 2}, {3, 0, 2}, {4, 0, 2}};
    int n = grobo_frame_goals(&grobo_i_board_protocol, goals, 4, s->pose.frame, FRAME);
    grobo_txn *txn = &s->pose.txn;
    assert_int_equal(grobo_txn_init(txn, &grobo_i_board_protocol, s->pose.frame, (size_t)n),
                     GROBO_OK);
    txn->priority = GROBO_PRIORITY_MOTION;
    txn->done = ended;
    txn->ctx = s;
}

static void submit_pose(soak *s)
{
    if (s->next_pose_us > 0) {
        assert_false(grobo_txn_is_pending(&s->pose.txn));
        assert_int_equal(s->pose.txn.sent_us, s->next_pose_us - MOTION_EVERY_US); /* on time */
    }
    submit(s, &s->pose);
    s->next_pose_us += MOTION_EVERY_US;
    grobo_bus_reserve(&s->bus, s->next_pose_us, 5 * MS);
}

static void deliver(soak *s)
{
    while (s->chunk_count > 0 && s->chunks[0].at_us <= s->now_us) {
        chunk c = s->chunks[0];
        memmove(s->chunks, s->chunks + 1, (size_t)--s->chunk_count * sizeof c);
        s->owner = c.owner;
        size_t first = draw(s, (uint32_t)c.n + 1);
        grobo_bus_rx(&s->bus, c.bytes, first, s->now_us);
        grobo_bus_rx(&s->bus, c.bytes + first, c.n - first, s->now_us);
        s->owner = 0;
    }
}

/* Where every byte and every transaction went. */
static void check_books(const soak *s)
{
    const grobo_bus_stats *b = &s->bus.stats;
    size_t pending = grobo_i_framer_pending(&s->bus.framer);
    assert_int_equal(b->rx_bytes, s->believed_bytes + b->late_bytes + b->resync_bytes + pending);
    assert_int_equal(s->submitted - s->ended, grobo_bus_pending(&s->bus));
    assert_true(b->tx_frames >= b->retries);
}

static void disturb(soak *s)
{
    request *r = &s->requests[draw(s, REQUESTS)];
    switch (draw(s, 60)) {
    case 0:
        (void)grobo_bus_cancel(&s->bus, &r->txn);
        break;
    case 1:
        (void)grobo_bus_cancel_all(&s->bus, GROBO_PRIORITY_BIT(GROBO_PRIORITY_SENSE),
                                   GROBO_ERR_CANCELED);
        break;
    default:
        if (!grobo_txn_is_pending(&r->txn)) {
            make_request(s, r);
            submit(s, r);
        }
        break;
    }
}

static void run(soak *s)
{
    uint8_t buf[FRAME];
    while (s->now_us < RUN_US) {
        deliver(s);
        if (s->now_us >= s->next_pose_us) {
            submit_pose(s);
        }
        grobo_bus_step(&s->bus, s->now_us);
        if (grobo_bus_tx(&s->bus, buf, sizeof buf, s->now_us) > 0) {
            if (s->bus.active != &s->pose.txn) {
                answer(s, (const request *)s->bus.active);
            }
            disturb(s);
        }
        check_books(s);
        int64_t next_us = grobo_bus_deadline(&s->bus, s->now_us);
        next_us = s->next_pose_us < next_us ? s->next_pose_us : next_us;
        if (s->chunk_count > 0 && s->chunks[0].at_us < next_us) {
            next_us = s->chunks[0].at_us;
        }
        s->now_us = next_us > s->now_us ? next_us : s->now_us + 1;
    }
}

TEST(no_fault_breaks_the_bus)
{
    static soak s;
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        memset(&s, 0, sizeof s);
        s.random = seed * 0x9E3779B97F4A7C15u;
        const grobo_bus_config line = {.protocol = &grobo_i_board_protocol};
        assert_int_equal(grobo_bus_init(&s.bus, &line), GROBO_OK);
        make_pose(&s);
        for (int i = 0; i < REQUESTS; i++) {
            make_request(&s, &s.requests[i]);
            submit(&s, &s.requests[i]);
        }
        run(&s);
        /* It was a soak and not a stall. */
        assert_true(s.bus.stats.replies > 500);
        assert_true(s.bus.stats.timeouts > 50);
        assert_true(s.bus.stats.bad_sums > 5);
        assert_true(s.bus.stats.late_bytes > 100);
        assert_true(s.bus.stats.canceled > 5);
    }
}
