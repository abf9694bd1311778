/* SPDX-License-Identifier: MIT */
/* Bytes that come when they should not: late replies, rubbish, ACKs without a name, echoes. */
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/bus.h>

#include "tests/support/bus_peer.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { MS = 1000, S = 1000000, FRAME = GROBO_FRAME_MAX_BYTES, MARGIN = 2 * MS };

/* When a first attempt that starts at 0 has failed: a position read, an ACK request. */
enum { READ_FAILED = 3488 + MARGIN, PING_FAILED = 955 + 695 + 100 + 87 + 87 + MARGIN };

static const uint8_t ack = GROBO_RS30X_ACK;

static void start(peer *p)
{
    const grobo_bus_config config = {.margin_us = MARGIN};
    peer_init(p, &config);
}

TEST(bytes_that_nobody_awaits_are_late)
{
    peer p;
    start(&p);
    peer_position_at(&p, MS, 1, 5);
    peer_run(&p, S);
    assert_int_equal(p.bus.stats.late_bytes, 10);
    assert_int_equal(p.bus.stats.rx_bytes, 10);
    assert_int_equal(p.bus.stats.resync_bytes, 0);
}

TEST(the_reply_of_a_dead_read_is_not_taken_for_another_motors)
{
    peer p;
    request a, b;
    start(&p);
    peer_submit_read(&p, &a, 1, 0);
    peer_submit_read(&p, &b, 2, 0);
    int64_t second_us = READ_FAILED + GROBO_BUS_QUIET_US;
    peer_position_at(&p, second_us + MS, 1, 11);
    peer_position_at(&p, second_us + 3488, 2, 22);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_ERR_TIMEOUT);
    assert_int_equal(p.ended[1].result, GROBO_OK);
    assert_int_equal(p.ended[1].value, 22);
    assert_int_equal(p.bus.stats.late_frames, 1);
    assert_int_equal(p.bus.stats.late_bytes, 10);
}

/* The same registers of the same motor: only time, or another reply, tells the two apart. */
TEST(the_same_read_again_waits_until_the_lost_reply_cannot_come)
{
    peer p;
    request a, b;
    start(&p);
    peer_submit_read(&p, &a, 1, 0);
    peer_submit_read(&p, &b, 1, 0);
    int64_t second_us = READ_FAILED + GROBO_BUS_HOLD_US;
    peer_position_at(&p, second_us + 3488, 1, 22);
    peer_run(&p, S);
    assert_int_equal(p.sent[1].at_us, second_us);
    assert_int_equal(p.ended[1].value, 22);
    assert_int_equal(p.bus.stats.late_bytes, 0);
}

TEST(the_same_read_again_waits_until_the_lost_reply_has_come)
{
    peer p;
    request a, b;
    start(&p);
    peer_submit_read(&p, &a, 1, 0);
    peer_submit_read(&p, &b, 1, 0);
    int64_t second_us = 60 * MS;
    peer_position_at(&p, second_us, 1, 11);
    peer_position_at(&p, second_us + 3488, 1, 22);
    peer_run(&p, S);
    assert_int_equal(p.sent[1].at_us, second_us);
    assert_int_equal(p.ended[1].value, 22);
    assert_int_equal(p.bus.stats.late_bytes, 10);
}

TEST(another_reply_proves_that_the_lost_one_is_lost)
{
    peer p;
    request a, b, c;
    start(&p);
    peer_submit_read(&p, &a, 1, 0);
    peer_submit_read(&p, &b, 2, 0);
    peer_submit_read(&p, &c, 1, 0);
    int64_t second_us = READ_FAILED + GROBO_BUS_QUIET_US;
    peer_position_at(&p, second_us + 3488, 2, 22);
    peer_position_at(&p, second_us + 2 * 3488, 1, 33);
    peer_run(&p, S);
    assert_int_equal(p.sent[2].at_us, second_us + 3488);
    assert_int_equal(p.ended[2].value, 33);
}

/* On a bus it proves that for the adapter only: a servo may answer after another one did. */
TEST(on_a_bus_a_servo_may_answer_after_another_one)
{
    const grobo_bus_config config = {.margin_us = MARGIN, .protocol = &grobo_i_rs30x_protocol};
    for (int comes = 0; comes <= 1; comes++) {
        peer p;
        request a, b, c;
        peer_init(&p, &config);
        peer_submit_read(&p, &a, 1, 0);
        peer_submit_read(&p, &b, 2, 0);
        peer_submit_read(&p, &c, 1, 0);
        int64_t failed_us = 695 + 868 + 100 + MARGIN; /* 8 bytes, 10 back, the return delay */
        int64_t second_us = failed_us + GROBO_BUS_QUIET_US;
        int64_t answered_us = second_us + 1663;
        int64_t third_us = answered_us + (comes ? 20 * MS : GROBO_BUS_MARGIN_MAX_US);
        peer_position_at(&p, answered_us, 2, 22);
        if (comes) {
            peer_position_at(&p, third_us, 1, 11); /* of the first question */
        }
        peer_position_at(&p, third_us + 1663, 1, 33);
        peer_run(&p, S);
        assert_int_equal(p.ended[1].value, 22);
        assert_int_equal(p.sent[2].at_us, third_us);
        assert_int_equal(p.ended[2].value, 33);
        assert_int_equal(p.bus.stats.late_bytes, comes ? 10 : 0);
    }
}

/* The first attempt's reply answers the second; the second's must not answer the next read. */
TEST(a_retry_that_succeeds_may_leave_a_reply_behind)
{
    peer p;
    request a, b;
    start(&p);
    peer_submit_read(&p, &a, 1, 1);
    peer_submit_read(&p, &b, 1, 0);
    int64_t second_us = READ_FAILED + GROBO_BUS_QUIET_US;
    int64_t third_us = second_us + 3488 + MS;
    peer_position_at(&p, second_us + MS, 1, 11);
    peer_position_at(&p, third_us, 1, 22);
    peer_position_at(&p, third_us + 3488, 1, 33);
    peer_run(&p, S);
    assert_int_equal(p.sent[2].at_us, third_us);
    assert_int_equal(p.ended[0].value, 11);
    assert_int_equal(p.ended[1].value, 33);
    assert_int_equal(p.bus.stats.late_bytes, 10);
}

/* Also where the line was quick so far, so that the wait for the first one was soon over. */
TEST(the_reply_behind_a_late_one_may_be_as_late)
{
    peer p;
    request a, b;
    start(&p);
    p.bus.worst_us = 100;
    peer_submit_read(&p, &a, 1, 1);
    peer_submit_read(&p, &b, 1, 0);
    int64_t first_us = READ_FAILED + GROBO_BUS_QUIET_US + 3488 + MS;
    int64_t second_us = first_us + MS + MS / 2;
    peer_position_at(&p, first_us, 1, 11);
    peer_position_at(&p, second_us, 1, 22);
    peer_position_at(&p, second_us + 3488, 1, 33);
    peer_run(&p, S);
    assert_int_equal(p.sent[2].at_us, second_us);
    assert_int_equal(p.ended[0].value, 11);
    assert_int_equal(p.ended[1].value, 33);
    assert_int_equal(p.bus.stats.late_bytes, 10);
}

TEST(a_late_ack_is_not_taken_for_another_motors)
{
    peer p;
    request a, b, c;
    start(&p);
    peer_submit_ping(&p, &a, 1, 0);
    peer_submit_ping(&p, &b, 2, 0);
    peer_bytes_at(&p, PING_FAILED + 20 * MS, &ack, 1); /* motor 1's, when motor 2 could be asked */
    peer_run(&p, PING_FAILED + GROBO_BUS_HOLD_US - 1);
    assert_int_equal(p.sent_count, 1);
    peer_run(&p, S);
    assert_int_equal(p.sent[1].at_us, PING_FAILED + GROBO_BUS_HOLD_US);
    assert_int_equal(p.ended[0].result, GROBO_ERR_TIMEOUT);
    assert_int_equal(p.ended[1].result, GROBO_ERR_TIMEOUT);
    assert_int_equal(p.bus.stats.late_bytes, 1);

    peer_submit_ping(&p, &a, 1, 0); /* 100 ms later an ACK is believed again */
    peer_bytes_at(&p, S + 2 * MS, &ack, 1);
    peer_submit_read(&p, &c, 3, 0);
    peer_run(&p, 2 * S);
    assert_int_equal(p.ended[2].result, GROBO_OK);
}

TEST(reads_go_on_while_an_ack_is_outstanding_and_clear_it)
{
    peer p;
    request a, b, c;
    start(&p);
    peer_submit_ping(&p, &a, 1, 0);
    peer_submit_ping(&p, &b, 2, 0);
    int n = grobo_frame_read(&grobo_i_board_protocol, 3, 42, 2, c.frame, FRAME);
    peer_txn(&p, &c.txn, c.frame, n, GROBO_PRIORITY_SENSE);
    assert_int_equal(grobo_bus_submit(&p.bus, &c.txn), GROBO_OK);
    int64_t read_us = PING_FAILED + GROBO_BUS_QUIET_US;
    peer_position_at(&p, read_us + 3488, 3, 33);
    peer_bytes_at(&p, read_us + 3488 + 1924, &ack, 1);
    peer_run(&p, S);
    assert_int_equal(p.sent[1].id, 3);
    assert_int_equal(p.sent[1].at_us, read_us);
    assert_int_equal(p.sent[2].id, 2);
    assert_int_equal(p.sent[2].at_us, read_us + 3488);
    assert_ptr_equal(p.ended[2].txn, &b.txn);
    assert_int_equal(p.ended[2].result, GROBO_OK);
}

TEST(an_ack_among_rubbish_is_not_believed)
{
    static const uint8_t rubbish[] = {0x55, GROBO_RS30X_ACK};
    peer p;
    request r;
    start(&p);
    peer_submit_ping(&p, &r, 1, 0);
    peer_bytes_at(&p, MS, rubbish, sizeof rubbish);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_ERR_MISMATCH);
    assert_int_equal(p.bus.stats.replies, 0);
}

/* 07 is an ACK byte, and the low byte of 7 mA, 7 deg... */
TEST(an_ack_inside_a_late_reply_is_not_believed)
{
    peer p;
    request r;
    start(&p);
    peer_submit_ping(&p, &r, 1, 0);
    peer_position_at(&p, MS, 9, 0x0707);
    peer_bytes_at(&p, 1924, &ack, 1);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.ended[0].at_us, 1924);
    assert_int_equal(p.bus.stats.late_frames, 1);
}

/* The stump announces 18 bytes of data: it must not swallow the reply of the next attempt. */
TEST(a_stump_does_not_swallow_the_next_reply)
{
    static const uint8_t stump[] = {0xFD, 0xDF, 0x01, 0x00, 0x2A, 0x12, 0x01};
    peer p;
    request r;
    start(&p);
    peer_submit_read(&p, &r, 1, 1);
    peer_bytes_at(&p, 3 * MS, stump, sizeof stump);
    int64_t second_us = READ_FAILED + GROBO_BUS_QUIET_US;
    peer_position_at(&p, second_us + 3488, 1, 22);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.ended[0].value, 22);
    assert_int_equal(p.ended[0].at_us, second_us + 3488);
    assert_int_equal(p.bus.stats.resync_bytes, sizeof stump);
}

TEST(an_ack_is_no_answer_to_a_read)
{
    peer p;
    request r;
    start(&p);
    peer_submit_read(&p, &r, 1, 0);
    peer_bytes_at(&p, MS, &ack, 1);
    peer_position_at(&p, 3488, 1, 11);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.bus.stats.resync_bytes, 1);
}

TEST(replies_that_fit_in_part_are_not_believed)
{
    static const struct {
        uint8_t id, address, length;
    } wrong[] = {{2, 42, 2}, {1, 44, 2}, {1, 42, 4}};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        static const uint8_t data[4] = {1, 1, 1, 1};
        uint8_t b[FRAME];
        peer p;
        request r;
        start(&p);
        peer_submit_read(&p, &r, 1, 0);
        const grobo_rs30x_packet packet = {GROBO_RS30X_RETURN, wrong[i].id, 0,    wrong[i].address,
                                           wrong[i].length,    1,           data, wrong[i].length};
        int n = grobo_rs30x_build(&packet, b, FRAME);
        peer_bytes_at(&p, 3488, b, (size_t)n);
        peer_run(&p, S);
        assert_int_equal(p.ended_count, 1);
        assert_int_equal(p.ended[0].result, GROBO_ERR_TIMEOUT);
        assert_int_equal(p.bus.stats.late_frames, 1);
    }
}

/* Every byte pushes the next request back, but not for ever. */
TEST(a_babbling_line_is_waited_for_with_patience_and_no_more)
{
    static const int64_t steps_us[] = {900, 500}; /* past the end of patience; at its end, too */
    for (int i = 0; i < 2; i++) {
        peer p;
        request r;
        start(&p);
        peer_submit_read(&p, &r, 1, 0);
        peer_run(&p, READ_FAILED);
        peer_submit_read(&p, &r, 2, 0);
        int64_t babble_us = READ_FAILED;
        while (babble_us < 2 * READ_FAILED + GROBO_BUS_QUIET_MAX_US && p.sent_count < 2) {
            static const uint8_t rubbish = 0x55;
            babble_us += steps_us[i];
            peer_bytes_at(&p, babble_us, &rubbish, 1);
            peer_run(&p, babble_us);
        }
        assert_int_equal(p.sent_count, 2);
        assert_int_equal(p.sent[1].at_us, READ_FAILED + GROBO_BUS_QUIET_MAX_US);
        request third; /* once something was sent, the line is waited for anew */
        peer_submit_read(&p, &third, 3, 0);
        peer_run(&p, S);
        assert_int_equal(p.sent_count, 3);
        assert_int_equal(p.sent[2].at_us, p.ended[1].at_us + GROBO_BUS_QUIET_US);
    }
}

/* It was quiet meanwhile: the patience with the first babble is no measure of the second. */
TEST(a_line_that_babbles_again_is_waited_for_again)
{
    static const uint8_t rubbish = 0x55;
    peer p;
    request r;
    start(&p);
    peer_bytes_at(&p, MS, &rubbish, 1);
    peer_run(&p, 200 * MS);
    peer_bytes_at(&p, 200 * MS, &rubbish, 1);
    peer_run(&p, 200 * MS);
    peer_submit_read(&p, &r, 1, 0);
    peer_run(&p, S);
    assert_int_equal(p.sent[0].at_us, 200 * MS + GROBO_BUS_QUIET_US);
}

TEST(motion_does_not_wait_for_quiet)
{
    peer p;
    request a, b;
    const grobo_rs30x_goal goal = {2, 0, 0};
    start(&p);
    peer_submit_read(&p, &a, 1, 0);
    int n = grobo_frame_goal(&grobo_i_board_protocol, &goal, b.frame, FRAME);
    peer_run(&p, 4 * MS);
    peer_txn(&p, &b.txn, b.frame, n, GROBO_PRIORITY_MOTION);
    assert_int_equal(grobo_bus_submit(&p.bus, &b.txn), GROBO_OK);
    peer_run(&p, S);
    assert_int_equal(p.sent[1].at_us, 4 * MS);
}

/* ---- echo ---- */

static void start_echo(peer *p)
{
    const grobo_bus_config config = {
        .protocol = &grobo_i_rs30x_protocol, .margin_us = MARGIN, .echo = true};
    peer_init(p, &config);
}

TEST(an_echo_is_removed)
{
    peer p;
    request a, b;
    start_echo(&p);
    peer_submit_ping(&p, &a, 7, 0); /* its frame holds a 07, which is no ACK */
    peer_bytes_at(&p, 300, a.frame, 4);
    peer_bytes_at(&p, 700, a.frame + 4, 4);
    peer_bytes_at(&p, MS, &ack, 1);
    peer_run(&p, 2 * MS);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.ended[0].at_us, MS);

    peer_submit_read(&p, &b, 1, 0);
    uint8_t all[18]; /* echo and reply in one piece */
    memcpy(all, b.frame, 8);
    memcpy(all + 8, "\xFD\xDF\x01\x00\x2A\x02\x01\x64\x00\x4C", 10);
    peer_bytes_at(&p, 4 * MS, all, sizeof all);
    peer_run(&p, S);
    assert_int_equal(p.ended[1].result, GROBO_OK);
    assert_int_equal(p.ended[1].value, 100);
    assert_int_equal(p.bus.stats.resync_bytes, 0);
    assert_int_equal(p.bus.stats.late_bytes, 0);
}

TEST(a_write_is_over_when_its_echo_is_there)
{
    peer p;
    request r;
    const grobo_rs30x_goal goal = {2, 0, 0};
    start_echo(&p);
    int n = grobo_frame_goal(&grobo_i_rs30x_protocol, &goal, r.frame, FRAME);
    peer_txn(&p, &r.txn, r.frame, n, GROBO_PRIORITY_MOTION);
    r.txn.retries = 1;
    assert_int_equal(grobo_bus_submit(&p.bus, &r.txn), GROBO_OK);
    uint8_t hit[FRAME];
    memcpy(hit, r.frame, (size_t)n);
    hit[8] ^= 0x40; /* another sender was on the line */
    peer_bytes_at(&p, 1100, hit, (size_t)n);
    peer_bytes_at(&p, 4 * MS, r.frame, (size_t)n);
    peer_run(&p, S);
    assert_int_equal(p.bus.stats.bad_echoes, 1);
    assert_int_equal(p.sent_count, 2);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.ended[0].at_us, 4 * MS);
}

TEST(an_adapter_without_echo_is_found_out)
{
    peer p;
    request r;
    start_echo(&p);
    peer_submit_read(&p, &r, 1, 0);
    peer_position_at(&p, 2 * MS, 1, 5);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_ERR_MISMATCH);
    peer_submit_read(&p, &r, 1, 0);
    peer_run(&p, 2 * S);
    assert_int_equal(p.ended[1].result, GROBO_ERR_TIMEOUT);
}
