/* SPDX-License-Identifier: MIT */
/* Transactions on the bus: order, retries, ends, cancelling, in virtual time. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/bus.h>

#include "tests/support/bus_peer.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { MS = 1000, S = 1000000, FRAME = GROBO_FRAME_MAX_BYTES };

static void submit_read(peer *p, request *r, uint8_t id, grobo_priority priority)
{
    peer_read(p, r, id, 2, priority);
    assert_int_equal(grobo_bus_submit(&p->bus, &r->txn), GROBO_OK);
}

TEST(a_read_is_answered)
{
    peer p;
    request r;
    peer_init(&p, NULL);
    p.obliging = true;
    submit_read(&p, &r, 7, GROBO_PRIORITY_USER);
    assert_true(grobo_txn_is_pending(&r.txn));
    assert_int_equal(grobo_bus_pending(&p.bus), 1);
    peer_run(&p, S);
    assert_int_equal(p.ended_count, 1);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.ended[0].value, 700);
    assert_int_equal(p.ended[0].at_us, 3488);
    assert_int_equal(r.txn.sent_us, 0);
    assert_int_equal(grobo_bus_pending(&p.bus), 0);
    assert_int_equal(p.bus.stats.tx_frames, 1);
    assert_int_equal(p.bus.stats.tx_bytes, 11);
    assert_int_equal(p.bus.stats.rx_bytes, 10);
    assert_int_equal(p.bus.stats.replies, 1);
    assert_int_equal(grobo_bus_deadline(&p.bus, p.now_us), GROBO_NEVER_US);
}

/* Submitted in the opposite order of their priority, and two of each. */
TEST(the_urgent_goes_first_and_the_early_within_a_priority)
{
    peer p;
    request r[8];
    peer_init(&p, NULL);
    p.obliging = true;
    for (int i = 0; i < 8; i++) {
        grobo_priority priority = (grobo_priority)(3 - i / 2);
        submit_read(&p, &r[i], (uint8_t)(i + 1), priority);
    }
    peer_run(&p, S);
    static const uint8_t order[] = {7, 8, 5, 6, 3, 4, 1, 2};
    assert_int_equal(p.sent_count, 8);
    assert_int_equal(p.ended_count, 8);
    for (int i = 0; i < 8; i++) {
        assert_int_equal(p.sent[i].id, order[i]);
        assert_int_equal(p.ended[i].value, 100 * order[i]);
    }
}

TEST(only_one_is_on_the_wire)
{
    peer p;
    request a, b;
    uint8_t buf[FRAME];
    peer_init(&p, NULL);
    submit_read(&p, &a, 1, GROBO_PRIORITY_USER);
    peer_submit_goal(&p, &b, 2, GROBO_PRIORITY_STOP);
    assert_int_equal(grobo_bus_tx(&p.bus, buf, 13, 0), GROBO_ERR_SPACE); /* nothing lost by it */
    assert_int_equal(grobo_bus_tx(&p.bus, buf, FRAME, 0), 14);
    assert_int_equal(buf[4], 2);
    assert_int_equal(grobo_bus_tx(&p.bus, buf, FRAME, 0), 0);
    assert_int_equal(grobo_bus_tx(&p.bus, buf, FRAME, 100 * MS), 0);
    grobo_bus_step(&p.bus, 100 * MS);
    assert_int_equal(grobo_bus_tx(&p.bus, buf, FRAME, 100 * MS), 11);
}

TEST(a_silent_servo_costs_its_attempts_and_no_more)
{
    peer p;
    request a, b;
    const grobo_bus_config config = {.margin_us = 2 * MS};
    peer_init(&p, &config);
    p.obliging = true;
    p.silent_id = 1;
    submit_read(&p, &a, 1, GROBO_PRIORITY_USER);
    submit_read(&p, &b, 2, GROBO_PRIORITY_USER);
    a.txn.retries = 1;
    peer_run(&p, S);
    /* 3488 + 2000 to the end of an attempt, 1000 of quiet before the next. */
    static const int64_t sent_us[] = {0, 6488, 12976};
    assert_int_equal(p.sent_count, 3);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(p.sent[i].at_us, sent_us[i]);
    }
    assert_int_equal(p.ended[0].result, GROBO_ERR_TIMEOUT);
    assert_int_equal(p.ended[0].at_us, 6488 + 5488);
    assert_false(p.ended[0].has_reply);
    assert_int_equal(p.ended[1].result, GROBO_OK);
    assert_int_equal(p.bus.stats.timeouts, 2);
    assert_int_equal(p.bus.stats.retries, 1);
    assert_int_equal(p.bus.stats.failed, 1);
}

TEST(a_cut_reply_is_short_and_retried)
{
    peer p;
    request r;
    static const uint8_t stump[] = {0xFD, 0xDF, 0x01, 0x00, 0x2A, 0x02, 0x01, 0x64};
    peer_init(&p, NULL);
    submit_read(&p, &r, 1, GROBO_PRIORITY_USER);
    r.txn.retries = 0;
    peer_bytes_at(&p, 3 * MS, stump, sizeof stump);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_ERR_SHORT);
    assert_int_equal(p.bus.stats.timeouts, 1);
}

/* All bytes there and the sum wrong: known at once, not after a time-out. */
TEST(a_wrong_sum_is_retried_at_once_and_never_believed)
{
    peer p;
    request r;
    static const uint8_t bad[] = {0xFD, 0xDF, 0x01, 0x00, 0x2A, 0x02, 0x01, 0x64, 0x00, 0x4D};
    peer_init(&p, NULL);
    submit_read(&p, &r, 1, GROBO_PRIORITY_USER);
    peer_bytes_at(&p, 3488, bad, sizeof bad);
    peer_position_at(&p, 2 * 3488 + MS, 1, 123);
    peer_run(&p, S);
    assert_int_equal(p.sent[1].at_us, 3488 + MS);
    assert_int_equal(p.ended_count, 1);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.ended[0].value, 123);
    assert_int_equal(p.bus.stats.bad_sums, 1);
    assert_int_equal(p.bus.stats.timeouts, 0);
    assert_int_equal(p.bus.stats.resync_bytes, sizeof bad);

    submit_read(&p, &r, 1, GROBO_PRIORITY_USER);
    r.txn.retries = 0;
    peer_bytes_at(&p, S + 3 * MS, bad, sizeof bad);
    peer_run(&p, 2 * S);
    assert_int_equal(p.ended[1].result, GROBO_ERR_CHECKSUM);
}

static void submit_torque(peer *p, request *r, uint8_t retries)
{
    uint8_t b[FRAME];
    int n = grobo_rs30x_write_u8(3, GROBO_RS30X_WANT_ACK, GROBO_RS30X_TORQUE, 1, b, FRAME);
    n = grobo_frame_wrap(&grobo_i_board_protocol, b, (size_t)n, r->frame, FRAME);
    peer_txn(p, &r->txn, r->frame, n, GROBO_PRIORITY_USER);
    r->txn.retries = retries;
    assert_int_equal(grobo_bus_submit(&p->bus, &r->txn), GROBO_OK);
}

TEST(a_refusal_is_never_retried)
{
    peer p;
    request r;
    uint8_t b[FRAME];
    peer_init(&p, NULL);
    const grobo_rs30x_packet refused = {
        GROBO_RS30X_RETURN, 3, GROBO_RS30X_STATUS_REFUSED, 42, 0, 1, b, 0};
    submit_read(&p, &r, 3, GROBO_PRIORITY_USER);
    int n = grobo_rs30x_build(&refused, b, FRAME);
    peer_bytes_at(&p, 3 * MS, b, (size_t)n);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_ERR_NACK);
    assert_true(p.ended[0].has_reply);
    assert_int_equal(p.sent_count, 1);
    assert_int_equal(p.bus.stats.refusals, 1);
}

/* 08 may be the id in a reply that the line still owed to the program before this one. */
TEST(a_byte_that_refuses_is_asked_for_again)
{
    peer p;
    request r;
    static const uint8_t ack = GROBO_RS30X_ACK, nack = GROBO_RS30X_NACK;
    static const uint8_t owed[] = {0x08, 0x00, 0x2A, 0x02, 0x01, 0x06, 0x00, 0x27};
    peer_init(&p, NULL);
    submit_torque(&p, &r, 2);
    peer_bytes_at(&p, 2 * MS, owed, sizeof owed);
    peer_bytes_at(&p, 15 * MS, &ack, 1);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.sent_count, 2);

    submit_torque(&p, &r, 1);
    peer_bytes_at(&p, S + 3 * MS, &nack, 1);
    peer_bytes_at(&p, S + 15 * MS, &nack, 1);
    peer_run(&p, 2 * S);
    assert_int_equal(p.ended[1].result, GROBO_ERR_NACK);
    assert_true(p.ended[1].has_reply);
    assert_int_equal(p.sent_count, 4);
    assert_int_equal(p.bus.stats.refusals, 1);
}

TEST(a_stale_request_is_not_sent)
{
    peer p;
    request a, b;
    peer_init(&p, NULL);
    p.obliging = true;
    submit_read(&p, &a, 1, GROBO_PRIORITY_USER);
    peer_read(&p, &b, 2, 2, GROBO_PRIORITY_SENSE);
    b.txn.start_by_us = 3 * MS;
    assert_int_equal(grobo_bus_submit(&p.bus, &b.txn), GROBO_OK);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].txn == &b.txn, 1);
    assert_int_equal(p.ended[0].result, GROBO_ERR_STALE);
    assert_int_equal(p.ended[0].at_us, 3 * MS + 1);
    assert_int_equal(b.txn.sent_us, -1);
    assert_int_equal(p.sent_count, 1);
}

/* A stop waits for the reply that is on its way, but not for one that is overdue. */
TEST(a_stop_cuts_an_overdue_read_short)
{
    peer p;
    request read, stop;
    peer_init(&p, NULL);
    submit_read(&p, &read, 1, GROBO_PRIORITY_SENSE);
    peer_run(&p, 2 * MS);
    peer_submit_goal(&p, &stop, 2, GROBO_PRIORITY_STOP);
    peer_run(&p, 3487);
    assert_int_equal(p.sent_count, 1);
    peer_run(&p, 4 * MS);
    assert_int_equal(p.sent_count, 2);
    assert_int_equal(p.sent[1].id, 2);
    assert_int_equal(p.sent[1].at_us, 3488);
    assert_int_equal(p.ended_count, 0); /* the read has attempts left, and comes after */
    peer_run(&p, 10 * MS);
    assert_int_equal(p.sent[2].id, 1);
}

TEST(queues_have_a_cap_that_a_stop_ignores)
{
    static request r[GROBO_BUS_QUEUE_MAX + 2];
    peer p;
    peer_init(&p, NULL);
    for (int i = 0; i < GROBO_BUS_QUEUE_MAX; i++) {
        submit_read(&p, &r[i], 1, GROBO_PRIORITY_SENSE);
    }
    request *more = &r[GROBO_BUS_QUEUE_MAX];
    peer_read(&p, more, 1, 2, GROBO_PRIORITY_MOTION);
    assert_int_equal(grobo_bus_submit(&p.bus, &more->txn), GROBO_ERR_FULL);
    assert_false(grobo_txn_is_pending(&more->txn));
    more->txn.priority = GROBO_PRIORITY_STOP;
    assert_int_equal(grobo_bus_submit(&p.bus, &more->txn), GROBO_OK);
    assert_int_equal(grobo_bus_pending(&p.bus), GROBO_BUS_QUEUE_MAX + 1);
    assert_int_equal(grobo_bus_cancel_all(&p.bus, GROBO_PRIORITY_ALL, GROBO_ERR_UNPLUGGED),
                     GROBO_BUS_QUEUE_MAX + 1);
    assert_int_equal(p.ended_count, GROBO_BUS_QUEUE_MAX + 1);
    assert_ptr_equal(p.ended[0].txn, &more->txn);
    assert_int_equal(p.ended[0].result, GROBO_ERR_UNPLUGGED);
    assert_int_equal(grobo_bus_pending(&p.bus), 0);
}

TEST(nonsense_is_not_submitted)
{
    peer p;
    request r;
    peer_init(&p, NULL);
    peer_read(&p, &r, 1, 2, GROBO_PRIORITY_USER);
    grobo_txn bad = r.txn;
    bad.frame = NULL;
    assert_int_equal(grobo_bus_submit(&p.bus, &bad), GROBO_ERR_ARG);
    bad = r.txn;
    bad.frame_bytes = 0;
    assert_int_equal(grobo_bus_submit(&p.bus, &bad), GROBO_ERR_ARG);
    bad.frame_bytes = GROBO_FRAME_MAX_BYTES + 1;
    assert_int_equal(grobo_bus_submit(&p.bus, &bad), GROBO_ERR_ARG);
    bad = r.txn;
    bad.priority = (grobo_priority)4;
    assert_int_equal(grobo_bus_submit(&p.bus, &bad), GROBO_ERR_ARG);
    assert_int_equal(grobo_bus_submit(&p.bus, &r.txn), GROBO_OK);
    assert_int_equal(grobo_bus_submit(&p.bus, &r.txn), GROBO_ERR_BUSY);
    assert_int_equal(grobo_txn_init(&bad, &grobo_i_board_protocol, r.frame, 10), GROBO_ERR_FRAME);
    grobo_bus bus;
    const grobo_bus_config slow = {.protocol = &grobo_i_board_protocol, .baud_bps = 300};
    const grobo_bus_config echo = {.protocol = &grobo_i_board_protocol, .echo = true};
    const grobo_bus_config silent = {.baud_bps = 115200};
    assert_int_equal(grobo_bus_init(&bus, &silent), GROBO_ERR_ARG);
    assert_int_equal(grobo_bus_init(&bus, &slow), GROBO_ERR_ARG);
    assert_int_equal(grobo_bus_init(&bus, &echo), GROBO_ERR_ARG);
}

TEST(cancelling_takes_one_out_wherever_it_is)
{
    peer p;
    request r[4];
    peer_init(&p, NULL);
    p.obliging = true;
    for (int i = 0; i < 4; i++) {
        submit_read(&p, &r[i], (uint8_t)(i + 1), GROBO_PRIORITY_USER);
    }
    peer_run(&p, 0);
    assert_int_equal(grobo_bus_cancel(&p.bus, &r[3].txn), GROBO_OK); /* the last */
    assert_int_equal(grobo_bus_cancel(&p.bus, &r[0].txn), GROBO_OK); /* on the wire */
    assert_int_equal(grobo_bus_cancel(&p.bus, &r[0].txn), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_bus_cancel(&p.bus, &r[1].txn), GROBO_OK); /* the first waiting */
    assert_int_equal(p.ended_count, 3);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(p.ended[i].result, GROBO_ERR_CANCELED);
    }
    peer_run(&p, S);
    assert_int_equal(p.ended_count, 4);
    assert_ptr_equal(p.ended[3].txn, &r[2].txn);
    assert_int_equal(p.ended[3].value, 300);
    /* The line stayed occupied for the cancelled one, whose reply was expected, and nobody's. */
    assert_int_equal(p.sent[1].at_us, 3488);
    assert_int_equal(p.bus.stats.late_bytes, 10);
    assert_int_equal(p.bus.stats.canceled, 3);
    assert_int_equal(p.bus.stats.failed, 0);
}

TEST(a_raised_one_goes_behind_those_of_its_new_priority)
{
    peer p;
    request r[4];
    peer_init(&p, NULL);
    p.obliging = true;
    submit_read(&p, &r[0], 1, GROBO_PRIORITY_USER);
    peer_run(&p, 0); /* on the wire */
    submit_read(&p, &r[1], 2, GROBO_PRIORITY_SENSE);
    submit_read(&p, &r[2], 3, GROBO_PRIORITY_SENSE);
    submit_read(&p, &r[3], 4, GROBO_PRIORITY_MOTION);
    assert_int_equal(grobo_bus_raise(&p.bus, &r[0].txn, GROBO_PRIORITY_STOP), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_bus_raise(&p.bus, &r[2].txn, (grobo_priority)4), GROBO_ERR_ARG);
    assert_int_equal(grobo_bus_raise(&p.bus, &r[2].txn, GROBO_PRIORITY_MOTION), GROBO_OK);
    assert_int_equal(grobo_bus_pending(&p.bus), 4);
    peer_run(&p, S);
    static const uint8_t order[] = {1, 4, 3, 2};
    assert_int_equal(p.ended_count, 4);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(p.sent[i].id, order[i]);
        assert_int_equal(p.ended[i].value, 100 * order[i]);
    }
    assert_int_equal(grobo_bus_raise(&p.bus, &r[2].txn, GROBO_PRIORITY_STOP), GROBO_ERR_NOTFOUND);
}

static void submit_again(peer *p, grobo_txn *txn, int result)
{
    if (result == GROBO_ERR_CANCELED || p->ended_count < 3) {
        assert_int_equal(grobo_bus_submit(&p->bus, txn), GROBO_OK);
    }
}

TEST(a_callback_may_submit_again)
{
    peer p;
    request r[2];
    peer_init(&p, NULL);
    p.obliging = true;
    p.on_done = submit_again;
    submit_read(&p, &r[0], 1, GROBO_PRIORITY_SENSE);
    peer_run(&p, S);
    assert_int_equal(p.ended_count, 3);
    assert_int_equal(p.sent_count, 3);
    submit_read(&p, &r[0], 1, GROBO_PRIORITY_SENSE);
    submit_read(&p, &r[1], 2, GROBO_PRIORITY_SENSE);
    /* Ends those that were there, once each, though they come back. */
    assert_int_equal(grobo_bus_cancel_all(&p.bus, GROBO_PRIORITY_ALL, GROBO_ERR_CANCELED), 2);
    assert_int_equal(grobo_bus_pending(&p.bus), 2);
}

static request *others;

static void cancel_others(peer *p, grobo_txn *txn, int result)
{
    (void)txn;
    if (result == GROBO_OK) {
        assert_int_equal(grobo_bus_cancel(&p->bus, &others[1].txn), GROBO_OK);
        assert_int_equal(grobo_bus_cancel_all(&p->bus, GROBO_PRIORITY_BIT(GROBO_PRIORITY_SENSE),
                                              GROBO_ERR_LATCHED),
                         2);
    }
}

TEST(a_callback_may_cancel_others)
{
    peer p;
    request r[5];
    peer_init(&p, NULL);
    p.obliging = true;
    p.on_done = cancel_others;
    others = r;
    for (int i = 0; i < 4; i++) {
        submit_read(&p, &r[i], (uint8_t)(i + 1),
                    i < 2 ? GROBO_PRIORITY_USER : GROBO_PRIORITY_SENSE);
    }
    peer_run(&p, S);
    assert_int_equal(p.ended_count, 4);
    assert_int_equal(p.sent_count, 1);
    assert_int_equal(p.ended[1].result, GROBO_ERR_CANCELED);
    assert_int_equal(p.ended[2].result, GROBO_ERR_LATCHED);
    assert_int_equal(p.ended[3].result, GROBO_ERR_LATCHED);
    assert_int_equal(grobo_bus_deadline(&p.bus, p.now_us), GROBO_NEVER_US);
}

static void free_it(peer *p, grobo_txn *txn, int result)
{
    (void)p;
    (void)result;
    free(txn); /* the frame lies in the same block */
}

static request *new_read(peer *p, uint8_t id)
{
    request *r = malloc(sizeof *r);
    assert_non_null(r);
    submit_read(p, r, id, GROBO_PRIORITY_USER);
    return r;
}

/* By success, by failure, by cancelling; valgrind and ASan watch. */
TEST(a_callback_may_free_its_transaction)
{
    peer p;
    peer_init(&p, NULL);
    p.obliging = true;
    p.silent_id = 2;
    p.on_done = free_it;
    for (uint8_t id = 1; id <= 3; id++) {
        (void)new_read(&p, id);
    }
    peer_run(&p, S);
    assert_int_equal(p.ended_count, 3);
    request *active = new_read(&p, 1);
    request *waiting = new_read(&p, 2);
    (void)new_read(&p, 3);
    peer_run(&p, S);
    assert_int_equal(grobo_bus_cancel(&p.bus, &active->txn), GROBO_OK);
    assert_int_equal(grobo_bus_cancel(&p.bus, &waiting->txn), GROBO_OK);
    assert_int_equal(grobo_bus_cancel_all(&p.bus, GROBO_PRIORITY_ALL, GROBO_ERR_CLOSED), 1);
    assert_int_equal(p.ended_count, 6);
}

TEST(a_transaction_needs_no_callback)
{
    peer p;
    request r;
    peer_init(&p, NULL);
    peer_submit_goal(&p, &r, 1, GROBO_PRIORITY_MOTION);
    r.txn.done = NULL;
    peer_run(&p, S);
    assert_false(grobo_txn_is_pending(&r.txn));
    assert_int_equal(p.bus.stats.tx_frames, 1);
}
