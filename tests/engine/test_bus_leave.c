/* SPDX-License-Identifier: MIT */
/* Transactions whose owner is asked at the moment they would leave. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/bus.h>

#include "tests/support/bus_peer.h"
#include "tests/support/test.h"

enum { MS = 1000, S = 1000000, FRAME = GROBO_FRAME_MAX_BYTES };

static void submit_read(peer *p, request *r, uint8_t id, grobo_priority priority)
{
    peer_read(p, r, id, 2, priority);
    assert_int_equal(grobo_bus_submit(&p->bus, &r->txn), GROBO_OK);
}

/* How often an owner was asked, and what it says from which time on. */
static struct {
    int asked;
    int refuse_from; /* which time, 0: never */
    int64_t sent_us; /* as it was when asked last */
} leave;

static int on_leave(void *ctx, grobo_txn *txn)
{
    (void)ctx;
    leave.asked++;
    leave.sent_us = txn->sent_us;
    return leave.refuse_from > 0 && leave.asked >= leave.refuse_from ? GROBO_ERR_SPEED : 1;
}

TEST(a_frame_that_must_not_leave_delays_nothing)
{
    peer p;
    request r[2];
    peer_init(&p, NULL);
    p.obliging = true;
    leave.asked = 0;
    leave.refuse_from = 1;
    peer_submit_goal(&p, &r[0], 3, GROBO_PRIORITY_USER);
    submit_read(&p, &r[1], 4, GROBO_PRIORITY_USER);
    r[0].txn.leave = on_leave;
    peer_run(&p, S);
    assert_int_equal(leave.asked, 1);
    assert_int_equal(p.ended[0].result, GROBO_ERR_SPEED);
    assert_int_equal(p.ended[0].at_us, 0);
    assert_int_equal(p.ended[1].result, GROBO_OK);
    assert_int_equal(p.sent_count, 1);
    assert_int_equal(p.sent[0].at_us, 0);
    assert_int_equal(p.sent[0].id, 4);
    assert_int_equal(r[0].txn.sent_us, -1);
    assert_int_equal(p.bus.stats.tx_frames, 1);
    assert_int_equal(p.bus.stats.failed, 1);
}

TEST(every_attempt_is_asked_for)
{
    for (int refuse_from = 0; refuse_from < 4; refuse_from++) {
        peer p;
        request r;
        peer_init(&p, NULL);
        leave.asked = 0;
        leave.refuse_from = refuse_from;
        submit_read(&p, &r, 7, GROBO_PRIORITY_USER);
        r.txn.leave = on_leave;
        peer_run(&p, S);
        bool never = refuse_from == 0;
        assert_int_equal(leave.asked, never ? 3 : refuse_from);
        assert_int_equal(p.sent_count, never ? 3 : refuse_from - 1);
        assert_int_equal(p.ended_count, 1);
        assert_int_equal(p.ended[0].result, never ? GROBO_ERR_TIMEOUT : GROBO_ERR_SPEED);
        assert_int_equal(leave.sent_us >= 0, leave.asked > 1);
    }
}

/* What leaves is what `leave` wrote, with the reply that it calls for. */
static int write_anew(void *ctx, grobo_txn *txn)
{
    (void)ctx;
    request *r = (request *)(void *)txn;
    int n = grobo_board_check(r->frame, FRAME);
    txn->frame_bytes = (uint8_t)n;
    txn->reply = (grobo_reply){.kind = GROBO_REPLY_NONE};
    return 0;
}

TEST(a_frame_may_be_written_as_it_leaves)
{
    peer p;
    request r;
    peer_init(&p, NULL);
    submit_read(&p, &r, 7, GROBO_PRIORITY_USER);
    r.txn.leave = write_anew;
    peer_run(&p, S);
    assert_int_equal(p.sent[0].first, 'A');
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.ended[0].at_us, 174); /* two bytes, nothing awaited */
}

/* It would be refused for ever: the pump gets on, and is wanted again. */
static void resubmit(peer *p, grobo_txn *txn, int result)
{
    if (result == GROBO_ERR_SPEED) {
        assert_int_equal(grobo_bus_submit(&p->bus, txn), GROBO_OK);
    }
}

TEST(one_that_is_submitted_again_and_again_does_not_spin)
{
    peer p;
    request r;
    uint8_t buf[FRAME];
    peer_init(&p, NULL);
    p.on_done = resubmit;
    leave.asked = 0;
    leave.refuse_from = 1;
    peer_submit_goal(&p, &r, 3, GROBO_PRIORITY_USER);
    r.txn.leave = on_leave;
    assert_int_equal(grobo_bus_tx(&p.bus, buf, sizeof buf, 0), 0);
    assert_int_equal(leave.asked, 1);
    assert_int_equal(grobo_bus_deadline(&p.bus, 0), 0);
    assert_int_equal(grobo_bus_cancel(&p.bus, &r.txn), GROBO_OK);
}
