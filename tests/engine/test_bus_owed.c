/* SPDX-License-Identifier: MIT */
/* Replies that are late and still owed: whom they are credited to, and what they cost. */
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/bus.h>

#include "tests/support/bus_peer.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { MS = 1000, S = 1000000, MARGIN = 2 * MS, READ_US = 3488, READ_FAILED = READ_US + MARGIN };
enum { BUS_READ_US = 695 + 100 + 869 }; /* 8 bytes, the return delay, 10 bytes */

static void start(peer *p, bool echo)
{
    const grobo_bus_config config = {.protocol =
                                         echo ? &grobo_i_rs30x_protocol : &grobo_i_board_protocol,
                                     .margin_us = MARGIN,
                                     .echo = echo};
    peer_init(p, &config);
}

/* ---- credit ---------------------------------------------------------------------------------- */

TEST(a_late_reply_takes_the_place_of_the_next_attempt)
{
    peer p;
    request a, b;
    start(&p, false);
    peer_submit_read(&p, &a, 1, 1);
    peer_submit_read(&p, &b, 1, 0);
    int64_t at_us = READ_FAILED + GROBO_BUS_QUIET_US / 2; /* the line is kept quiet */
    peer_position_at(&p, at_us, 1, 11);
    peer_position_at(&p, at_us + READ_US + MS, 1, 22);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.ended[0].at_us, at_us);
    assert_int_equal(p.ended[0].value, 11);
    assert_ptr_equal(p.ended[1].txn, &b.txn); /* nothing more is owed: it did not wait */
    assert_int_equal(p.ended[1].value, 22);
    assert_int_equal(p.sent_count, 2);
    assert_in_range(p.sent[1].at_us, at_us, at_us + GROBO_BUS_QUIET_US);
    assert_int_equal(p.bus.stats.replies, 2);
    assert_int_equal(p.bus.stats.late_bytes, 0);
}

TEST(a_late_reply_is_credited_while_another_is_awaited)
{
    peer p;
    request a, b;
    start(&p, false);
    peer_submit_read(&p, &a, 1, 1);
    peer_run(&p, READ_FAILED);
    peer_read(&p, &b, 2, 2, GROBO_PRIORITY_MOTION); /* goes before the next attempt */
    assert_int_equal(grobo_bus_submit(&p.bus, &b.txn), GROBO_OK);
    int64_t at_us = READ_FAILED + GROBO_BUS_QUIET_US;
    peer_position_at(&p, at_us + MS, 1, 11);
    peer_position_at(&p, at_us + READ_US, 2, 22);
    peer_run(&p, S);
    assert_int_equal(p.sent[1].id, 2);
    assert_ptr_equal(p.ended[0].txn, &a.txn);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.ended[0].value, 11);
    assert_int_equal(p.ended[1].value, 22);
    assert_int_equal(p.sent_count, 2);
}

TEST(a_late_refusal_is_credited_too)
{
    uint8_t bytes[16];
    const uint8_t data[2] = {0};
    const grobo_rs30x_packet refused = {
        GROBO_RS30X_RETURN, 1, GROBO_RS30X_STATUS_REFUSED, 42, 2, 1, data, 2};
    peer p;
    request a;
    start(&p, false);
    peer_submit_read(&p, &a, 1, 1);
    int n = grobo_rs30x_build(&refused, bytes, sizeof bytes);
    peer_bytes_at(&p, READ_FAILED + 100, bytes, (size_t)n);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_ERR_NACK);
    assert_int_equal(p.sent_count, 1);
    assert_int_equal(p.bus.stats.refusals, 1);
    assert_int_equal(p.bus.stats.failed, 1);
}

/* The line keeps the order: what comes after a later reply is not the one that was lost. */
TEST(what_is_not_owed_any_more_is_credited_to_nobody)
{
    peer p;
    request a, b;
    start(&p, false);
    peer_submit_read(&p, &a, 1, 1);
    peer_run(&p, READ_FAILED);
    peer_read(&p, &b, 2, 2, GROBO_PRIORITY_MOTION);
    assert_int_equal(grobo_bus_submit(&p.bus, &b.txn), GROBO_OK);
    int64_t at_us = READ_FAILED + GROBO_BUS_QUIET_US + READ_US;
    peer_position_at(&p, at_us, 2, 22);
    peer_run(&p, at_us - 1);
    p.now_us = at_us;
    uint8_t both[20] = "\xFD\xDF\x02\x00\x2A\x02\x01\x16\x00\x3D"  /* 22 */
                       "\xFD\xDF\x01\x00\x2A\x02\x01\x0B\x00\x23"; /* 11 */
    p.chunk_count = 0;
    grobo_bus_rx(&p.bus, both, sizeof both, at_us);
    assert_int_equal(p.ended_count, 1);
    assert_ptr_equal(p.ended[0].txn, &b.txn);
    peer_position_at(&p, at_us + GROBO_BUS_QUIET_US + READ_US, 1, 33);
    peer_run(&p, S);
    assert_int_equal(p.ended[1].value, 33);
}

/* Nothing can come before its time is over: a doubled reply settles nothing. */
TEST(a_doubled_reply_is_not_taken_for_the_one_that_is_owed)
{
    peer p;
    request a, b;
    start(&p, false);
    peer_submit_read(&p, &a, 1, 1);
    peer_submit_read(&p, &b, 1, 0);
    int64_t second_us = READ_FAILED + GROBO_BUS_QUIET_US;
    peer_position_at(&p, second_us + MS, 1, 11);
    peer_position_at(&p, second_us + MS + 100, 1, 11);
    peer_position_at(&p, second_us + READ_US + 200, 1, 22);
    peer_position_at(&p, second_us + READ_US + 200 + READ_US, 1, 33);
    peer_run(&p, S);
    assert_int_equal(p.ended[1].value, 33);
    assert_int_equal(p.sent[2].at_us, second_us + READ_US + 200);
}

/* A question that fails twice, whose replies come so much later than that, and the same question
 * again with its own. @return when the second of the late ones comes */
static int64_t late_twice(peer *p, request *a, request *b, int64_t first_us, int64_t second_us)
{
    int64_t failed_us = 2 * READ_FAILED + GROBO_BUS_QUIET_US;
    peer_submit_read(p, a, 1, 1);
    peer_submit_read(p, b, 1, 0);
    peer_position_at(p, failed_us + first_us, 1, 11);
    peer_position_at(p, failed_us + second_us, 1, 12);
    peer_position_at(p, failed_us + second_us + READ_US + MS, 1, 22);
    peer_run(p, S);
    return failed_us + second_us;
}

/* Every attempt that failed is owed a reply: the same question waits for all of them. */
TEST(two_owed_replies_are_both_waited_for)
{
    peer p;
    request a, b;
    start(&p, false);
    int64_t late_us = late_twice(&p, &a, &b, 5 * MS, 10 * MS);
    assert_int_equal(p.ended[0].result, GROBO_ERR_TIMEOUT);
    assert_ptr_equal(p.ended[1].txn, &b.txn);
    assert_int_equal(p.ended[1].value, 22);
    assert_int_equal(p.sent_count, 3);
    assert_in_range(p.sent[2].at_us, late_us, late_us + MS);
}

/* A reply so late that it was no longer expected comes while its question waits for a third
 * attempt: that to the second is owed still. */
TEST(a_reply_that_was_given_up_settles_no_later_one)
{
    peer p;
    request a, b;
    start(&p, false);
    p.bus.worst_us = 100;
    int64_t first_us = 2 * READ_FAILED + GROBO_BUS_QUIET_US + GROBO_BUS_QUIET_US / 2;
    peer_submit_read(&p, &a, 1, 2);
    peer_submit_read(&p, &b, 1, 0);
    peer_position_at(&p, first_us, 1, 11);
    peer_position_at(&p, first_us + 2 * MS, 1, 12);
    peer_position_at(&p, first_us + 2 * MS + READ_US + MS, 1, 22);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].value, 11);
    assert_ptr_equal(p.ended[1].txn, &b.txn);
    assert_int_equal(p.ended[1].value, 22);
    assert_int_equal(p.sent_count, 3);
}

/* One more question than there is room for is failed, and takes the place of the oldest: what was
 * owed to that one is not owed to it. */
TEST(a_hold_that_is_used_again_owes_nothing_from_before)
{
    peer p;
    request lost[GROBO_BUS_HOLDS], again;
    start(&p, false);
    for (int i = 0; i < GROBO_BUS_HOLDS; i++) { /* the first hold is for an ACK: one too few */
        peer_submit_read(&p, &lost[i], (uint8_t)(1 + i), 0);
    }
    peer_submit_read(&p, &again, GROBO_BUS_HOLDS, 0);
    int64_t failed_us = GROBO_BUS_HOLDS * (READ_FAILED + GROBO_BUS_QUIET_US) - GROBO_BUS_QUIET_US;
    peer_position_at(&p, failed_us + 5 * MS, GROBO_BUS_HOLDS, 11);
    peer_position_at(&p, failed_us + 5 * MS + READ_US + MS, GROBO_BUS_HOLDS, 22);
    peer_run(&p, S);
    assert_int_equal(p.ended_count, GROBO_BUS_HOLDS + 1);
    assert_int_equal(p.ended[GROBO_BUS_HOLDS - 1].result, GROBO_ERR_TIMEOUT);
    assert_int_equal(p.ended[GROBO_BUS_HOLDS].value, 22);
    assert_in_range(p.sent[GROBO_BUS_HOLDS].at_us, failed_us + 5 * MS, failed_us + 6 * MS);
}

/* The second attempt fails at the very microsecond until which the first one's reply is waited for:
 * both are owed. */
TEST(a_reply_is_owed_to_the_last_microsecond)
{
    peer p;
    request a, b;
    start(&p, false);
    p.bus.worst_us = (READ_FAILED + GROBO_BUS_QUIET_US) / 2;
    int64_t late_us = late_twice(&p, &a, &b, 2 * MS, 4 * MS);
    assert_ptr_equal(p.ended[1].txn, &b.txn);
    assert_int_equal(p.ended[1].value, 22);
    assert_in_range(p.sent[2].at_us, late_us, late_us + MS);
}

/* No servo answers a goal: one that was canceled is owed nothing, and the next need not wait. */
TEST(a_canceled_goal_keeps_no_other_waiting)
{
    const grobo_bus_config config = {.protocol = &grobo_i_rs30x_protocol};
    peer p;
    request a, b;
    peer_init(&p, &config);
    peer_submit_goal(&p, &a, 1, GROBO_PRIORITY_MOTION);
    peer_run(&p, 100);
    assert_int_equal(grobo_bus_cancel(&p.bus, &a.txn), GROBO_OK);
    peer_submit_goal(&p, &b, 1, GROBO_PRIORITY_MOTION);
    peer_run(&p, S);
    assert_int_equal(p.sent_count, 2);
    assert_in_range(p.sent[1].at_us, 100, 5 * MS); /* a reply would be waited for 100 ms */
}

/* Makes a question, takes it back while it is on the wire, and asks the same again. */
static void ask_again_after_a_cancel(peer *p, request *a, request *b, grobo_priority priority,
                                     bool urgent)
{
    peer_submit_read(p, a, 1, 0);
    peer_run(p, 300);
    assert_int_equal(grobo_bus_cancel(&p->bus, &a->txn), GROBO_OK);
    peer_read(p, b, 1, 2, priority);
    b->txn.retries = 0;
    b->txn.urgent = urgent;
    assert_int_equal(grobo_bus_submit(&p->bus, &b->txn), GROBO_OK);
}

/* A servo may answer sooner than after its return delay, which is an assumption: that is its reply
 * all the same, and nothing is owed behind it. */
TEST(a_reply_that_comes_soon_is_owed_no_more)
{
    enum { DELAY_US = 500, OVER_US = BUS_READ_US - 100 + DELAY_US };
    const grobo_bus_config config = {.protocol = &grobo_i_rs30x_protocol,
                                     .return_delay_us = DELAY_US};
    peer p;
    request a, b;
    peer_init(&p, &config);
    ask_again_after_a_cancel(&p, &a, &b, GROBO_PRIORITY_USER, false);
    peer_position_at(&p, OVER_US - DELAY_US + 100, 1, 11);
    peer_position_at(&p, 2 * OVER_US + GROBO_BUS_QUIET_US, 1, 22);
    peer_run(&p, S);
    assert_int_equal(p.sent_count, 2);
    assert_in_range(p.sent[1].at_us, OVER_US, OVER_US + GROBO_BUS_QUIET_US);
    assert_int_equal(p.ended[1].value, 22);
}

/* Nor does what a stop waits for. Anything else would wait for what may come yet, 100 ms here. */
TEST(a_stop_waits_for_no_reply_that_is_late)
{
    static const struct {
        grobo_priority priority;
        bool urgent;
    } rows[] = {{GROBO_PRIORITY_STOP, false},
                {GROBO_PRIORITY_MOTION, true},
                {GROBO_PRIORITY_MOTION, false},
                {GROBO_PRIORITY_USER, false}};
    const grobo_bus_config config = {.protocol = &grobo_i_rs30x_protocol};
    for (int i = 0; i < 4; i++) {
        bool stop = i < 2;
        peer p;
        request a, b;
        peer_init(&p, &config);
        ask_again_after_a_cancel(&p, &a, &b, rows[i].priority, rows[i].urgent);
        peer_run(&p, S);
        assert_int_equal(p.sent_count, 2);
        int64_t least_us = BUS_READ_US + (stop ? 0 : GROBO_BUS_HOLD_US / 2);
        int64_t most_us = BUS_READ_US + (stop ? 6 * MS : 2 * GROBO_BUS_HOLD_US);
        assert_in_range(p.sent[1].at_us, least_us, most_us);
    }
}

/* An ACK has no name: however soon replies have come, the next one is not asked for before. */
TEST(an_ack_that_is_owed_holds_the_next_for_all_of_the_time)
{
    enum { READS = 200 };
    peer p;
    request read, a, b;
    start(&p, false);
    p.obliging = true;
    for (int i = 0; i < READS; i++) {
        peer_submit_read(&p, &read, 1, 0);
        peer_run(&p, p.now_us + 20 * MS);
    }
    peer_submit_ping(&p, &a, 1, 0);
    peer_submit_ping(&p, &b, 1, 0);
    peer_run(&p, p.now_us + S);
    assert_ptr_equal(p.ended[READS].txn, &a.txn);
    assert_int_equal(p.ended[READS].result, GROBO_ERR_TIMEOUT);
    int64_t held_us = p.sent[READS + 1].at_us - p.ended[READS].at_us;
    assert_in_range(held_us, GROBO_BUS_HOLD_US, GROBO_BUS_HOLD_US + MS);
}

/* A byte that begins no packet is less than a reply, and more than silence. */
TEST(one_wrong_byte_is_a_short_reply)
{
    for (int echo = 0; echo < 2; echo++) {
        static const uint8_t wrong = 0;
        peer p;
        request a;
        start(&p, echo == 1);
        peer_submit_read(&p, &a, 1, 0);
        peer_bytes_at(&p, 300, &wrong, 1);
        peer_run(&p, S);
        assert_int_equal(p.ended[0].result, echo ? GROBO_ERR_MISMATCH : GROBO_ERR_SHORT);
    }
}

/* ---- echo ------------------------------------------------------------------------------------ */

/* What the adapter hands over late, all of it: the echo and the reply of the request before. */
TEST(an_echo_is_found_behind_a_late_echo_and_a_late_reply)
{
    peer p;
    request a, b;
    start(&p, true);
    peer_submit_read(&p, &a, 1, 0);
    peer_submit_read(&p, &b, 2, 0);
    int64_t second_us = BUS_READ_US + MARGIN + GROBO_BUS_QUIET_US;
    peer_bytes_at(&p, second_us + 100, a.frame, 3);
    peer_bytes_at(&p, second_us + 200, a.frame + 3, 5);
    peer_position_at(&p, second_us + 300, 1, 11);
    peer_bytes_at(&p, second_us + MS, b.frame, 8);
    peer_position_at(&p, second_us + BUS_READ_US, 2, 22);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_ERR_TIMEOUT);
    assert_int_equal(p.ended[1].result, GROBO_OK);
    assert_int_equal(p.ended[1].value, 22);
    assert_int_equal(p.sent_count, 2);
    assert_int_equal(p.bus.stats.bad_echoes, 0);
    assert_int_equal(p.bus.stats.resync_bytes, 0);
    assert_int_equal(p.bus.stats.late_frames, 2);
}

/* With nothing but late bytes before its time is over it was silent, not wrong. */
TEST(late_packets_are_no_broken_echo)
{
    peer p;
    request a, b;
    start(&p, true);
    peer_submit_read(&p, &a, 1, 0);
    peer_submit_read(&p, &b, 2, 0);
    int64_t second_us = BUS_READ_US + MARGIN + GROBO_BUS_QUIET_US;
    peer_bytes_at(&p, second_us + 100, a.frame, 8);
    peer_position_at(&p, second_us + 300, 1, 11);
    peer_run(&p, S);
    assert_int_equal(p.ended[1].result, GROBO_ERR_TIMEOUT);
    assert_int_equal(p.bus.stats.bad_echoes, 0);
}

TEST(a_late_reply_before_the_echo_of_the_next_attempt_is_believed)
{
    peer p;
    request a;
    start(&p, true);
    peer_submit_read(&p, &a, 1, 1);
    int64_t second_us = BUS_READ_US + MARGIN + GROBO_BUS_QUIET_US;
    peer_bytes_at(&p, second_us + 100, a.frame, 8); /* cannot be told from its own */
    peer_position_at(&p, second_us + 300, 1, 11);
    peer_bytes_at(&p, second_us + 700, a.frame, 8);
    peer_position_at(&p, second_us + BUS_READ_US, 1, 22);
    peer_run(&p, S);
    assert_int_equal(p.ended_count, 1);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.ended[0].value, 11);
    assert_int_equal(p.bus.stats.resync_bytes, 0);
}

/* The sum FA looks like the head of an echo: the packet is whole all the same. */
TEST(a_reply_that_ends_as_an_echo_begins_is_credited)
{
    peer p;
    request a, b;
    start(&p, true);
    peer_submit_read(&p, &a, 1, 1);
    peer_run(&p, BUS_READ_US + MARGIN);
    peer_read(&p, &b, 2, 2, GROBO_PRIORITY_MOTION);
    b.txn.retries = 0;
    assert_int_equal(grobo_bus_submit(&p.bus, &b.txn), GROBO_OK);
    int64_t second_us = BUS_READ_US + MARGIN + GROBO_BUS_QUIET_US;
    const int16_t value = 0xFA ^ (1 ^ 0x2A ^ 2 ^ 1); /* what makes the sum FA */
    peer_position_at(&p, second_us + 300, 1, value);
    peer_run(&p, S);
    assert_ptr_equal(p.ended[0].txn, &a.txn);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.ended[0].value, value);
    assert_int_equal(p.ended[1].result, GROBO_ERR_TIMEOUT);
    assert_int_equal(p.sent_count, 2);
}

/* A frame that begins with a part of itself: each place where it may begin is tried. */
TEST(an_echo_is_found_behind_a_part_of_itself)
{
    peer p;
    request r;
    start(&p, true);
    peer_submit_read(&p, &r, 1, 0);
    uint8_t line[2 + 5 + 8] = {0xFA, 0xFA};
    memcpy(line + 2, r.frame, 5);
    memcpy(line + 7, r.frame, 8);
    peer_bytes_at(&p, 700, line, sizeof line);
    peer_position_at(&p, BUS_READ_US, 1, 11);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.ended[0].value, 11);
    assert_int_equal(p.bus.stats.bad_echoes, 0);
}

TEST(a_broken_echo_is_known_by_its_length)
{
    peer p;
    request r;
    uint8_t hit[8];
    start(&p, true);
    peer_submit_read(&p, &r, 1, 0);
    memcpy(hit, r.frame, sizeof hit);
    hit[6] ^= 0x10;
    peer_bytes_at(&p, 700, hit, sizeof hit);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_ERR_MISMATCH);
    assert_int_equal(p.ended[0].at_us, 700);
    assert_int_equal(p.bus.stats.bad_echoes, 1);
}

/* ---- what a late reply costs ----------------------------------------------------------------- */

enum { POLLS = 2000, LATE_EVERY = 100, WARM_UP = 1000 };

typedef struct polling {
    grobo_bus bus;
    request r;
    int64_t now_us, line_us; /* line_us: when the last reply so far has come */
    int64_t arrives_us[8];   /* replies under way */
    int under_way, ended, asked;
    int64_t bare_us; /* of a loop that waits for each reply, whenever it comes */
} polling;

static void polled(void *ctx, grobo_txn *txn, int result, const grobo_packet *reply)
{
    polling *p = ctx;
    (void)reply;
    assert_int_equal(result, GROBO_OK);
    if (++p->ended < WARM_UP + POLLS) {
        p->asked = 0;
        assert_int_equal(grobo_bus_submit(&p->bus, txn), GROBO_OK);
    }
}

/* A request leaves: its reply comes in time, but for the first to each LATE_EVERYth query. */
static void answer(polling *p, uint32_t late_us, bool lose)
{
    bool hit = p->asked++ == 0 && p->ended >= WARM_UP && p->ended % LATE_EVERY == 0;
    int64_t at_us = p->bus.over_us + (hit ? late_us : 0);
    if (p->asked == 1) {
        p->bare_us += at_us - p->now_us;
    }
    if (hit && lose) {
        return;
    }
    assert_true(p->under_way < 8);
    p->line_us = at_us > p->line_us ? at_us : p->line_us;
    p->arrives_us[p->under_way++] = p->line_us;
}

static void receive(polling *p)
{
    static const uint8_t reply[] = {0xFD, 0xDF, 1, 0, 42, 2, 1, 100, 0, 0x4C};
    while (p->under_way > 0 && p->arrives_us[0] <= p->now_us) {
        memmove(p->arrives_us, p->arrives_us + 1, sizeof p->arrives_us - sizeof p->arrives_us[0]);
        p->under_way--;
        grobo_bus_rx(&p->bus, reply, sizeof reply, p->now_us);
    }
}

/* Polls one register of one servo; how fast that is, as part of a bare loop. */
static double poll(const grobo_bus_config *config, uint32_t late_us, bool lose)
{
    static polling p;
    uint8_t buf[GROBO_RS30X_PACKET_MAX_BYTES];
    int64_t begun_us = 0;
    memset(&p, 0, sizeof p);
    assert_int_equal(grobo_bus_init(&p.bus, config), GROBO_OK);
    int n = grobo_frame_read(config->protocol, 1, 42, 2, p.r.frame, sizeof p.r.frame);
    assert_int_equal(grobo_txn_init(&p.r.txn, config->protocol, p.r.frame, (size_t)n), GROBO_OK);
    p.r.txn.done = polled;
    p.r.txn.ctx = &p;
    assert_int_equal(grobo_bus_submit(&p.bus, &p.r.txn), GROBO_OK);
    while (p.ended < WARM_UP + POLLS) {
        receive(&p);
        grobo_bus_step(&p.bus, p.now_us);
        if (grobo_bus_tx(&p.bus, buf, sizeof buf, p.now_us) > 0) {
            answer(&p, late_us, lose);
        }
        if (p.ended < WARM_UP) {
            begun_us = p.now_us;
            p.bare_us = 0;
        }
        int64_t next_us = grobo_bus_deadline(&p.bus, p.now_us);
        next_us = p.under_way > 0 && p.arrives_us[0] < next_us ? p.arrives_us[0] : next_us;
        p.now_us = p.ended < WARM_UP + POLLS && next_us > p.now_us ? next_us : p.now_us;
    }
    return (double)p.bare_us / (double)(p.now_us - begun_us);
}

TEST(polling_keeps_up_with_a_bare_loop_where_replies_are_late)
{
    static const grobo_bus_config lines[] = {
        {.protocol = &grobo_i_board_protocol},
        {.protocol = &grobo_i_rs30x_protocol},
        {.protocol = &grobo_i_rs30x_protocol, .baud_bps = 460800},
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        static const uint32_t late_us[] = {3 * MS, 3200, 5 * MS, 10 * MS, 20 * MS};
        for (size_t k = 0; k < sizeof late_us / sizeof late_us[0]; k++) {
            double part = poll(&lines[i], late_us[k], false);
            print_message("# line %zu, 1 reply of %d %.1f ms late: %.3f of a bare loop\n", i,
                          LATE_EVERY, late_us[k] / 1e3, part);
            assert_true(part > 0.95);
        }
    }
}

/* Nothing comes that would end the hold: it is as long as the line has shown that it must be. */
TEST(a_lost_reply_costs_what_the_line_has_taught)
{
    const grobo_bus_config line = {.protocol = &grobo_i_rs30x_protocol, .baud_bps = 460800};
    double part = poll(&line, 0, true);
    print_message("# 1 reply of %d lost: %.3f of a bare loop\n", LATE_EVERY, part);
    assert_true(part > 0.6);
}
