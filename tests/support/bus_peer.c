/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tests/support/bus_peer.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

const grobo_bus_config board_line = {.protocol = &grobo_i_board_protocol};

void peer_init(peer *p, const grobo_bus_config *config)
{
    grobo_bus_config line = config != NULL ? *config : board_line;
    if (line.protocol == NULL) {
        line.protocol = board_line.protocol;
    }
    memset(p, 0, sizeof *p);
    assert_int_equal(grobo_bus_init(&p->bus, &line), GROBO_OK);
}

static void written_down(void *ctx, grobo_txn *txn, int result, const grobo_packet *reply)
{
    peer *p = ctx;
    assert_true(p->ended_count < PEER_LOG_MAX);
    assert_false(grobo_txn_is_pending(txn));
    peer_ended *e = &p->ended[p->ended_count++];
    *e = (peer_ended){p->now_us, txn, result, 0, reply != NULL};
    if (reply != NULL && reply->data_bytes >= 2) {
        e->value = (int16_t)(reply->data[0] | reply->data[1] << 8);
    }
    if (p->on_done != NULL) {
        p->on_done(p, txn, result);
    }
}

void peer_txn(peer *p, grobo_txn *txn, const uint8_t *frame, int n, grobo_priority priority)
{
    assert_true(n > 0);
    const grobo_protocol *protocol = p->bus.config.protocol;
    assert_int_equal(grobo_txn_init(txn, protocol, frame, (size_t)n), GROBO_OK);
    txn->priority = priority;
    txn->done = written_down;
    txn->ctx = p;
}

void peer_read(peer *p, request *r, uint8_t id, uint8_t bytes, grobo_priority priority)
{
    int n = grobo_frame_read(p->bus.config.protocol, id, 42, bytes, r->frame, sizeof r->frame);
    peer_txn(p, &r->txn, r->frame, n, priority);
}

void peer_submit_ping(peer *p, request *r, uint8_t id, uint8_t retries)
{
    uint8_t packet[16];
    int n = grobo_rs30x_ping(id, GROBO_RS30X_PING_FF_0_0, packet, sizeof packet);
    n = grobo_frame_wrap(p->bus.config.protocol, packet, (size_t)n, r->frame, sizeof r->frame);
    peer_txn(p, &r->txn, r->frame, n, GROBO_PRIORITY_USER);
    r->txn.retries = retries;
    assert_int_equal(grobo_bus_submit(&p->bus, &r->txn), GROBO_OK);
}

void peer_submit_read(peer *p, request *r, uint8_t id, uint8_t retries)
{
    peer_read(p, r, id, 2, GROBO_PRIORITY_USER);
    r->txn.retries = retries;
    assert_int_equal(grobo_bus_submit(&p->bus, &r->txn), GROBO_OK);
}

void peer_submit_goal(peer *p, request *r, uint8_t id, grobo_priority priority)
{
    const grobo_rs30x_goal goal = {id, 0, 0};
    int n = grobo_frame_goal(p->bus.config.protocol, &goal, r->frame, sizeof r->frame);
    peer_txn(p, &r->txn, r->frame, n, priority);
    assert_int_equal(grobo_bus_submit(&p->bus, &r->txn), GROBO_OK);
}

void peer_bytes_at(peer *p, int64_t at_us, const uint8_t *bytes, size_t n)
{
    int i = p->chunk_count++;
    assert_true(i < PEER_CHUNKS_MAX && n <= PEER_CHUNK_BYTES);
    for (; i > 0 && p->chunks[i - 1].at_us > at_us; i--) {
        p->chunks[i] = p->chunks[i - 1];
    }
    p->chunks[i].at_us = at_us;
    p->chunks[i].n = n;
    memcpy(p->chunks[i].bytes, bytes, n);
}

void peer_position_at(peer *p, int64_t at_us, uint8_t id, int16_t value)
{
    uint8_t data[2] = {(uint8_t)(value & 0xFF), (uint8_t)(value >> 8 & 0xFF)};
    uint8_t b[16];
    const grobo_rs30x_packet packet = {GROBO_RS30X_RETURN, id, 0, 42, 2, 1, data, 2};
    int n = grobo_rs30x_build(&packet, b, sizeof b);
    peer_bytes_at(p, at_us, b, (size_t)n);
}

static void answer(peer *p, uint8_t id)
{
    if (!p->obliging || id == p->silent_id || p->bus.phase != GROBO_BUS_AWAITING) {
        return;
    }
    peer_position_at(p, p->bus.over_us + p->reply_after_us, id, (int16_t)(100 * id));
}

static void send_next(peer *p)
{
    uint8_t b[GROBO_RS30X_PACKET_MAX_BYTES];
    int n = grobo_bus_tx(&p->bus, b, sizeof b, p->now_us);
    assert_true(n >= 0);
    if (n == 0) {
        return;
    }
    assert_true(p->sent_count < PEER_LOG_MAX);
    bool board = p->bus.config.protocol == &grobo_i_board_protocol;
    uint8_t id = board ? (n > 4 ? b[4] : 0) : b[2];
    p->sent[p->sent_count++] = (peer_sent){p->now_us, id, b[0]};
    answer(p, id);
}

static void receive(peer *p)
{
    while (p->chunk_count > 0 && p->chunks[0].at_us <= p->now_us) {
        peer_chunk chunk = p->chunks[0];
        p->chunk_count--;
        memmove(p->chunks, p->chunks + 1, (size_t)p->chunk_count * sizeof chunk);
        grobo_bus_rx(&p->bus, chunk.bytes, chunk.n, p->now_us);
    }
}

void peer_run(peer *p, int64_t until_us)
{
    for (int spins = 0; p->now_us <= until_us; spins++) {
        assert_true(spins < 100000); /* a deadline that stays in the past would spin for ever */
        receive(p);
        grobo_bus_step(&p->bus, p->now_us);
        send_next(p);
        int64_t next_us = grobo_bus_deadline(&p->bus, p->now_us);
        if (p->chunk_count > 0 && p->chunks[0].at_us < next_us) {
            next_us = p->chunks[0].at_us;
        }
        if (next_us > until_us) {
            p->now_us = until_us;
            return;
        }
        if (next_us > p->now_us) {
            p->now_us = next_us;
        }
    }
}
