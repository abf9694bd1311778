/* SPDX-License-Identifier: MIT */
/* The bus at its bounds: what is learnt, who waits for whom, what is remembered. */
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/bus.h>

#include "src/bus/time.h"
#include "tests/support/bus_peer.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { MS = 1000, S = 1000000, FRAME = GROBO_FRAME_MAX_BYTES, READ_US = 3488 };

static const uint8_t ack = GROBO_RS30X_ACK;

static void submit_read(peer *p, request *r, uint8_t id, uint8_t retries, grobo_priority priority)
{
    peer_read(p, r, id, 2, priority);
    r->txn.retries = retries;
    assert_int_equal(grobo_bus_submit(&p->bus, &r->txn), GROBO_OK);
}

/* ---- beginning ------------------------------------------------------------------------------- */

TEST(what_stood_in_the_memory_before_means_nothing)
{
    static grobo_bus a, b;
    uint8_t frame[FRAME];
    grobo_txn x, y;
    int n = grobo_frame_read(&grobo_i_board_protocol, 1, 42, 2, frame, FRAME);
    memset(&a, 0, sizeof a);
    memset(&b, 0xA5, sizeof b);
    assert_int_equal(grobo_bus_init(&a, &board_line), GROBO_OK);
    assert_int_equal(grobo_bus_init(&b, &board_line), GROBO_OK);
    assert_memory_equal(&a, &b, sizeof a);
    assert_int_equal(a.config.baud_bps, 115200);
    assert_int_equal(a.config.servo_baud_bps, 115200);
    memset(&x, 0, sizeof x);
    memset(&y, 0xA5, sizeof y);
    assert_int_equal(grobo_txn_init(&x, &grobo_i_board_protocol, frame, (size_t)n), GROBO_OK);
    assert_int_equal(grobo_txn_init(&y, &grobo_i_board_protocol, frame, (size_t)n), GROBO_OK);
    assert_int_equal(x.reply.kind, y.reply.kind);
    assert_int_equal(x.reply.bytes, y.reply.bytes);
    memset(&x.reply, 0, sizeof x.reply); /* what lies between its fields is nobody's */
    memset(&y.reply, 0, sizeof y.reply);
    assert_memory_equal(&x, &y, sizeof x);
    assert_int_equal(x.priority, GROBO_PRIORITY_USER);
    assert_int_equal(x.retries, 2);
    assert_int_equal(x.sent_us, -1);
}

TEST(a_line_may_be_as_slow_as_1200_bps)
{
    grobo_bus bus;
    for (uint32_t bps = 1199; bps <= 1200; bps++) {
        const grobo_bus_config line = {.protocol = &grobo_i_board_protocol, .baud_bps = bps};
        const grobo_bus_config servos = {.protocol = &grobo_i_board_protocol,
                                         .servo_baud_bps = bps};
        int result = bps < 1200 ? GROBO_ERR_ARG : GROBO_OK;
        assert_int_equal(grobo_bus_init(&bus, &line), result);
        assert_int_equal(grobo_bus_init(&bus, &servos), result);
    }
}

TEST(a_frame_may_fill_the_buffer)
{
    peer p;
    request r;
    uint8_t buf[FRAME];
    static uint8_t longest[GROBO_FRAME_MAX_BYTES];
    peer_init(&p, NULL);
    submit_read(&p, &r, 1, 0, GROBO_PRIORITY_USER);
    assert_int_equal(grobo_bus_tx(&p.bus, buf, 10, 0), GROBO_ERR_SPACE);
    assert_int_equal(grobo_bus_tx(&p.bus, buf, 11, 0), 11);
    peer_init(&p, NULL);
    peer_read(&p, &r, 1, 2, GROBO_PRIORITY_USER);
    r.txn.frame = longest;
    r.txn.frame_bytes = sizeof longest;
    assert_int_equal(grobo_bus_submit(&p.bus, &r.txn), GROBO_OK);
}

TEST(asked_again_it_was_not_sent_yet)
{
    peer p;
    request r;
    peer_init(&p, NULL);
    p.obliging = true;
    p.now_us = 5 * MS;
    submit_read(&p, &r, 1, 0, GROBO_PRIORITY_USER);
    peer_run(&p, S);
    assert_int_equal(r.txn.sent_us, 5 * MS);
    r.txn.priority = GROBO_PRIORITY_SENSE;
    assert_int_equal(grobo_bus_submit(&p.bus, &r.txn), GROBO_OK);
    assert_int_equal(r.txn.sent_us, -1);
}

/* ---- what is learnt -------------------------------------------------------------------------- */

/* One reply that comes so long after the computed time; the margin after it. */
static uint32_t margin_after(peer *p, int64_t late_us)
{
    request r;
    grobo_bus_cost cost;
    p->ended_count = p->sent_count = 0;
    submit_read(p, &r, 1, 0, GROBO_PRIORITY_USER);
    peer_position_at(p, p->now_us + READ_US + late_us, 1, 7);
    peer_run(p, p->now_us + S);
    assert_int_equal(p->ended[0].result, GROBO_OK);
    grobo_bus_cost_of(&p->bus, &r.txn, &cost);
    return cost.timeout_us - cost.total_us;
}

/* Mean with weight 1/8 and four times the deviation with weight 1/4, as TCP reckons. */
TEST(the_margin_is_the_mean_and_four_deviations)
{
    peer p;
    peer_init(&p, NULL);
    p.now_us = S;
    assert_int_equal(margin_after(&p, 8000), 8000 + 4 * 4000);
    assert_int_equal(margin_after(&p, 4000), 7500 + 4 * 4000);
    assert_int_equal(margin_after(&p, 12000), 8062 + 4 * 4125);
    assert_int_equal(margin_after(&p, 0), 7054 + 4 * 5109);
    /* Sooner than computed is not late; what is below the least is the least. */
    peer_init(&p, NULL);
    assert_int_equal(margin_after(&p, 2000), 2000 + 4 * 1000);
    assert_int_equal(margin_after(&p, -1000), 1750 + 4 * 1250);
    assert_int_equal(margin_after(&p, -3000), 1531 + 4 * 1375);
    peer_init(&p, NULL);
    assert_int_equal(margin_after(&p, 900), GROBO_BUS_MARGIN_MIN_US);
    peer_init(&p, NULL);
    assert_int_equal(margin_after(&p, 1001), 1001 + 4 * 500);
    peer_init(&p, NULL);
    assert_int_equal(margin_after(&p, 19000), GROBO_BUS_MARGIN_MAX_US);
}

/* Nobody knows which of its attempts was answered. */
TEST(a_retried_read_teaches_nothing)
{
    peer p;
    request r;
    grobo_bus_cost cost;
    peer_init(&p, NULL);
    submit_read(&p, &r, 1, 1, GROBO_PRIORITY_USER);
    peer_position_at(&p, READ_US + GROBO_BUS_MARGIN_FIRST_US + GROBO_BUS_QUIET_US + 5 * MS, 1, 7);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    grobo_bus_cost_of(&p.bus, &r.txn, &cost);
    assert_int_equal(cost.timeout_us - cost.total_us, GROBO_BUS_MARGIN_FIRST_US);
}

/* Its last byte is there: the line is free, sooner than it was computed. */
TEST(a_reply_that_comes_early_frees_the_line)
{
    peer p;
    request a, b;
    peer_init(&p, NULL);
    p.now_us = S;
    submit_read(&p, &a, 1, 0, GROBO_PRIORITY_USER);
    submit_read(&p, &b, 2, 0, GROBO_PRIORITY_USER);
    peer_position_at(&p, S + 2 * MS, 1, 7);
    peer_run(&p, 2 * S);
    assert_int_equal(p.sent[1].at_us, S + 2 * MS);
}

/* ---- who waits for whom ---------------------------------------------------------------------- */

/* A read that nobody answers, and what comes 2 ms later; when that leaves, after the read did. */
static int64_t left_after(grobo_priority read, grobo_priority urgent, uint32_t timeout_us)
{
    peer p;
    request a, b;
    peer_init(&p, NULL);
    p.now_us = S;
    peer_read(&p, &a, 1, 2, read);
    a.txn.timeout_us = timeout_us;
    a.txn.retries = 0;
    assert_int_equal(grobo_bus_submit(&p.bus, &a.txn), GROBO_OK);
    peer_run(&p, S + 2 * MS);
    peer_submit_goal(&p, &b, 2, urgent);
    peer_run(&p, 2 * S);
    assert_int_equal(p.sent_count, 2);
    return p.sent[1].at_us - S;
}

/* It waits for a reply that may come in time, and longer only for its equals. */
TEST(the_urgent_waits_for_no_overdue_reply_but_of_its_equals)
{
    const int64_t whole_us = READ_US + GROBO_BUS_MARGIN_FIRST_US;
    for (int read = 0; read < GROBO_PRIORITIES; read++) {
        for (int urgent = 0; urgent < GROBO_PRIORITIES; urgent++) {
            bool cuts = urgent < read && urgent <= GROBO_PRIORITY_MOTION;
            assert_int_equal(left_after((grobo_priority)read, (grobo_priority)urgent, 0),
                             cuts ? READ_US : whole_us);
        }
    }
    /* One that is over sooner than that is not given more time for it. */
    assert_int_equal(left_after(GROBO_PRIORITY_SENSE, GROBO_PRIORITY_STOP, 3 * MS), READ_US);
}

TEST(a_short_time_out_is_not_made_longer_by_what_waits)
{
    peer p;
    request a, b;
    peer_init(&p, NULL);
    p.now_us = S;
    peer_read(&p, &a, 1, 2, GROBO_PRIORITY_SENSE);
    a.txn.timeout_us = 3 * MS;
    a.txn.retries = 0;
    assert_int_equal(grobo_bus_submit(&p.bus, &a.txn), GROBO_OK);
    peer_run(&p, S + 1 * MS);
    peer_submit_goal(&p, &b, 2, GROBO_PRIORITY_STOP);
    peer_run(&p, 2 * S);
    assert_ptr_equal(p.ended[0].txn, &a.txn);
    assert_int_equal(p.ended[0].at_us, S + 3 * MS);
}

/* Stale ones end in every queue, each as soon as it is, and never are sent. */
TEST(what_is_stale_ends_in_every_queue)
{
    peer p;
    request busy, r[2 * GROBO_PRIORITIES];
    peer_init(&p, NULL);
    p.now_us = S;
    peer_read(&p, &busy, 1, 2, GROBO_PRIORITY_STOP);
    busy.txn.timeout_us = 20 * MS;
    busy.txn.retries = 0;
    assert_int_equal(grobo_bus_submit(&p.bus, &busy.txn), GROBO_OK);
    peer_run(&p, S);
    for (int i = 0; i < 2 * GROBO_PRIORITIES; i++) {
        peer_read(&p, &r[i], (uint8_t)(i + 2), 2, (grobo_priority)(i % GROBO_PRIORITIES));
        r[i].txn.start_by_us = S + (1 + i) * MS;
        assert_int_equal(grobo_bus_submit(&p.bus, &r[i].txn), GROBO_OK);
    }
    peer_run(&p, S + 15 * MS);
    assert_int_equal(p.ended_count, 2 * GROBO_PRIORITIES);
    for (int i = 0; i < 2 * GROBO_PRIORITIES; i++) {
        assert_ptr_equal(p.ended[i].txn, &r[i].txn);
        assert_int_equal(p.ended[i].result, GROBO_ERR_STALE);
        assert_int_equal(p.ended[i].at_us, S + (1 + i) * MS + 1);
    }
    assert_int_equal(p.sent_count, 1);
    assert_int_equal(p.bus.stats.failed, 2 * GROBO_PRIORITIES);
}

TEST(all_that_are_too_late_end_at_once)
{
    for (int priority = 0; priority < GROBO_PRIORITIES; priority++) {
        peer p;
        request r[3];
        peer_init(&p, NULL);
        for (int i = 0; i < 3; i++) {
            peer_read(&p, &r[i], (uint8_t)(i + 1), 2, (grobo_priority)priority);
            r[i].txn.start_by_us = MS;
            assert_int_equal(grobo_bus_submit(&p.bus, &r[i].txn), GROBO_OK);
        }
        grobo_bus_step(&p.bus, MS + 1);
        assert_int_equal(p.bus.stats.failed, 3);
        assert_int_equal(grobo_bus_pending(&p.bus), 0);
    }
}

TEST(what_may_start_by_now_starts)
{
    peer p;
    request r;
    uint8_t buf[FRAME];
    peer_init(&p, NULL);
    peer_read(&p, &r, 1, 2, GROBO_PRIORITY_USER);
    r.txn.start_by_us = S;
    assert_int_equal(grobo_bus_submit(&p.bus, &r.txn), GROBO_OK);
    grobo_bus_step(&p.bus, S);
    assert_int_equal(p.ended_count, 0);
    assert_int_equal(grobo_bus_tx(&p.bus, buf, FRAME, S), 11);
}

/* The last attempt of a patient read beside a span kept for motion; how long it was given. */
static int64_t patience(int64_t reserve_us, int64_t length_us)
{
    peer p;
    request r;
    peer_init(&p, NULL);
    p.now_us = S;
    peer_read(&p, &r, 1, 2, GROBO_PRIORITY_SENSE);
    r.txn.patient = true;
    r.txn.retries = 0;
    grobo_bus_reserve(&p.bus, S + reserve_us, (uint32_t)length_us);
    assert_int_equal(grobo_bus_submit(&p.bus, &r.txn), GROBO_OK);
    peer_run(&p, 2 * S);
    assert_int_equal(p.sent[0].at_us, S);
    return p.ended[0].at_us - S - READ_US;
}

TEST(patience_ends_before_the_span_and_not_sooner_than_usual)
{
    assert_int_equal(patience(300 * MS, 10 * MS), GROBO_BUS_MARGIN_MAX_US);
    assert_int_equal(patience(READ_US + 31 * MS, 10 * MS), 30 * MS);
    assert_int_equal(patience(READ_US + 5 * MS, 10 * MS), GROBO_BUS_MARGIN_FIRST_US);
    assert_int_equal(patience(-20 * MS, 10 * MS), GROBO_BUS_MARGIN_MAX_US); /* it is over */
}

/* ---- what is remembered ---------------------------------------------------------------------- */

/* Reads of the servos 1..n that nobody answers, one after the other, long remembered. */
static void lose_reads(peer *p, int n)
{
    const grobo_bus_config config = {.margin_us = MS, .hold_us = 10 * S};
    static request lost[16];
    peer_init(p, &config);
    p->now_us = S;
    for (int i = 0; i < n; i++) {
        submit_read(p, &lost[i], (uint8_t)(i + 1), 0, GROBO_PRIORITY_USER);
        peer_run(p, p->now_us + 10 * MS);
    }
    assert_int_equal(p->ended_count, n);
    p->ended_count = p->sent_count = 0;
}

/* True if the servo may be asked at once: its lost reply was forgotten. */
static bool may_ask(peer *p, uint8_t id)
{
    request r;
    p->ended_count = p->sent_count = 0;
    submit_read(p, &r, id, 0, GROBO_PRIORITY_USER);
    peer_run(p, p->now_us + 5 * MS);
    bool asked = p->sent_count > 0;
    (void)grobo_bus_cancel(&p->bus, &r.txn);
    return asked;
}

TEST(the_latest_lost_replies_are_remembered)
{
    peer p;
    for (uint8_t id = 1; id < GROBO_BUS_HOLDS; id++) { /* one place is for the ACKs */
        lose_reads(&p, GROBO_BUS_HOLDS - 1);
        assert_false(may_ask(&p, id));
        lose_reads(&p, GROBO_BUS_HOLDS - 1);
        request r;
        peer_submit_ping(&p, &r, 9, 0); /* and its ACK, too, takes no other's place */
        peer_run(&p, p.now_us + 10 * MS);
        assert_int_equal(p.ended[0].result, GROBO_ERR_TIMEOUT);
        assert_false(may_ask(&p, id));
    }
    for (uint8_t id = 1; id <= GROBO_BUS_HOLDS; id++) {
        lose_reads(&p, GROBO_BUS_HOLDS);
        assert_int_equal(may_ask(&p, id), id == 1); /* the oldest made room */
    }
    /* Lost once more it has a place already. */
    lose_reads(&p, GROBO_BUS_HOLDS - 1);
    p.now_us += 11 * S;
    request r;
    submit_read(&p, &r, 3, 0, GROBO_PRIORITY_USER);
    peer_run(&p, p.now_us + 10 * MS);
    assert_false(may_ask(&p, 3));
}

/* What stands in memory behind the last lost reply is none of them. */
TEST(nothing_is_remembered_behind_the_last)
{
    static struct {
        grobo_bus bus;
        grobo_bus_hold behind;
    } memory;
    static uint8_t frame[FRAME];
    grobo_txn txn;
    assert_int_equal(grobo_bus_init(&memory.bus, &board_line), GROBO_OK);
    int n = grobo_frame_read(&grobo_i_board_protocol, 1, 42, 2, frame, FRAME);
    assert_int_equal(grobo_txn_init(&txn, &grobo_i_board_protocol, frame, (size_t)n), GROBO_OK);
    txn.retries = 0;
    const grobo_bus_hold stranger = {
        .until_us = 60LL * S, .key = grobo_i_bus_key(&txn.reply), .owed = 1};
    memory.behind = stranger;
    assert_int_equal(grobo_bus_submit(&memory.bus, &txn), GROBO_OK);
    assert_int_equal(grobo_bus_tx(&memory.bus, (uint8_t[FRAME]){0}, FRAME, 0), n);
    grobo_bus_step(&memory.bus, S);
    assert_false(grobo_txn_is_pending(&txn)); /* its reply is lost, and remembered */
    assert_memory_equal(&memory.behind, &stranger, sizeof stranger);
}

/* After a refusal of a second attempt the first one's answer may yet come. */
TEST(a_refusal_of_a_retry_may_have_a_reply_behind_it)
{
    for (int attempts = 1; attempts <= 2; attempts++) {
        peer p;
        request a, b;
        uint8_t bytes[16];
        const grobo_bus_config config = {.margin_us = 2 * MS};
        const grobo_rs30x_packet refused = {
            GROBO_RS30X_RETURN, 3, GROBO_RS30X_STATUS_REFUSED, 42, 0, 1, bytes, 0};
        peer_init(&p, &config);
        p.now_us = S;
        submit_read(&p, &a, 3, 2, GROBO_PRIORITY_USER);
        submit_read(&p, &b, 3, 0, GROBO_PRIORITY_USER);
        int n = grobo_rs30x_build(&refused, bytes, sizeof bytes);
        int64_t at_us = S + 3 * MS + (attempts - 1) * (READ_US + 3 * MS);
        peer_bytes_at(&p, at_us, bytes, (size_t)n);
        peer_run(&p, 2 * S);
        assert_int_equal(p.ended[0].result, GROBO_ERR_NACK);
        assert_int_equal(p.bus.stats.refusals, 1);
        assert_int_equal(p.bus.stats.failed, 2); /* nobody answered the other */
        int64_t waited_us = p.sent[attempts].at_us - at_us;
        if (attempts == 1) {
            assert_true(waited_us <= READ_US);
        } else {
            assert_int_equal(waited_us, READ_US - 3 * MS + GROBO_BUS_HOLD_US); /* when it is due */
        }
    }
}

/* Flags tell of heat and of flash; one alone says that the servo did not take the request. */
TEST(only_the_flag_for_it_refuses)
{
    for (int flag = 0x01; flag <= 0x80; flag <<= 1) {
        peer p;
        request r;
        uint8_t bytes[16];
        const uint8_t data[2] = {1, 2};
        const grobo_rs30x_packet reply = {GROBO_RS30X_RETURN, 3, (uint8_t)flag, 42, 2, 1, data, 2};
        peer_init(&p, NULL);
        submit_read(&p, &r, 3, 0, GROBO_PRIORITY_USER);
        int n = grobo_rs30x_build(&reply, bytes, sizeof bytes);
        peer_bytes_at(&p, 3 * MS, bytes, (size_t)n);
        peer_run(&p, S);
        assert_int_equal(p.ended[0].result,
                         flag == GROBO_RS30X_STATUS_REFUSED ? GROBO_ERR_NACK : GROBO_OK);
        assert_int_equal(p.bus.stats.rx_frames, 1);
    }
}

/* ---- what is wrong with a reply -------------------------------------------------------------- */

static int result_of(peer *p, const uint8_t *bytes, size_t n)
{
    request r;
    p->ended_count = 0;
    submit_read(p, &r, 3, 0, GROBO_PRIORITY_USER);
    peer_bytes_at(p, p->now_us + 3 * MS, bytes, n);
    peer_run(p, p->now_us + S);
    assert_int_equal(p->ended_count, 1);
    return p->ended[0].result;
}

/* Each exchange is judged by its own bytes. */
TEST(the_end_says_what_was_wrong_this_time)
{
    static const uint8_t good[] = {0xFD, 0xDF, 3, 0, 42, 2, 1, 5, 0, 3 ^ 42 ^ 2 ^ 1 ^ 5};
    static const uint8_t bad_sum[] = {0xFD, 0xDF, 3, 0, 42, 2, 1, 5, 0, 0x99};
    static const uint8_t rubbish[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
    peer p;
    peer_init(&p, NULL);
    assert_int_equal(result_of(&p, good, sizeof good), GROBO_OK);
    assert_int_equal(result_of(&p, bad_sum, sizeof bad_sum), GROBO_ERR_CHECKSUM);
    assert_int_equal(result_of(&p, rubbish, sizeof rubbish), GROBO_ERR_MISMATCH);
    assert_int_equal(result_of(&p, good, 9), GROBO_ERR_SHORT);
    assert_int_equal(result_of(&p, good, sizeof good), GROBO_OK);
    assert_int_equal(p.bus.stats.failed, 3);
}

/* A head that is not complete may still become the reply. */
TEST(rubbish_with_a_head_in_it_is_waited_for)
{
    static const uint8_t head[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 0xFD};
    static const uint8_t rest[] = {0xDF, 3, 0, 42, 2, 1, 5, 0, 3 ^ 42 ^ 2 ^ 1 ^ 5};
    peer p;
    request r;
    peer_init(&p, NULL);
    submit_read(&p, &r, 3, 0, GROBO_PRIORITY_USER);
    peer_bytes_at(&p, 3 * MS, head, sizeof head);
    peer_bytes_at(&p, 5 * MS, rest, sizeof rest);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.ended[0].value, 5);
}

/* An ACK among other bytes is late, and counted so. */
TEST(an_ack_that_is_not_believed_is_late)
{
    static const uint8_t among[] = {0x55, GROBO_RS30X_ACK};
    peer p;
    request r;
    peer_init(&p, NULL);
    peer_submit_ping(&p, &r, 1, 0);
    peer_bytes_at(&p, 2 * MS, among, sizeof among);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_ERR_MISMATCH);
    assert_int_equal(p.bus.stats.late_frames, 1);
    assert_true(p.bus.stats.late_bytes >= 1);
    /* And one byte that refuses is no last word as long as it may be asked again. */
    static const uint8_t nack = GROBO_RS30X_NACK;
    peer_init(&p, NULL);
    peer_submit_ping(&p, &r, 1, 1);
    peer_bytes_at(&p, 2 * MS, &nack, 1);
    peer_bytes_at(&p, 10 * MS, &ack, 1);
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.bus.stats.late_frames, 1);
}

/* The echo came in part, then nothing: something was there. */
TEST(a_stump_of_the_echo_is_short)
{
    for (int some = 0; some < 2; some++) {
        peer p;
        request r;
        const grobo_bus_config config = {.protocol = &grobo_i_rs30x_protocol, .echo = true};
        peer_init(&p, &config);
        submit_read(&p, &r, 3, 0, GROBO_PRIORITY_USER);
        if (some) {
            peer_bytes_at(&p, 500, r.frame, 4);
        }
        peer_run(&p, S);
        assert_int_equal(p.ended[0].result, some ? GROBO_ERR_SHORT : GROBO_ERR_TIMEOUT);
    }
}

/* Something came before the silence, but nothing of what was waited for. */
TEST(rubbish_and_then_silence_is_told_from_silence)
{
    static const uint8_t noise[] = {0x11, 0x22, 0x33, 0x44};
    for (int some = 0; some < 2; some++) {
        for (int echo = 0; echo < 2; echo++) {
            peer p;
            request r;
            const grobo_bus_config config = {.protocol = &grobo_i_rs30x_protocol, .echo = echo};
            peer_init(&p, &config);
            submit_read(&p, &r, 3, 0, GROBO_PRIORITY_USER);
            if (some) {
                peer_bytes_at(&p, 500, noise, sizeof noise);
            }
            peer_run(&p, S);
            assert_int_equal(p.ended[0].result, !some  ? GROBO_ERR_TIMEOUT
                                                : echo ? GROBO_ERR_MISMATCH
                                                       : GROBO_ERR_SHORT);
        }
    }
}

/* ---- taking back ----------------------------------------------------------------------------- */

TEST(only_the_priorities_named_are_taken_back)
{
    for (unsigned bits = 0; bits <= GROBO_PRIORITY_ALL; bits++) {
        for (int active = 0; active < GROBO_PRIORITIES; active++) {
            peer p;
            request busy, r[2 * GROBO_PRIORITIES];
            peer_init(&p, NULL);
            submit_read(&p, &busy, 1, 0, (grobo_priority)active);
            peer_run(&p, 0);
            int expected = (bits & GROBO_PRIORITY_BIT(active)) != 0;
            int left = GROBO_PRIORITIES * 2 + 1 - expected;
            for (int i = 0; i < 2 * GROBO_PRIORITIES; i++) {
                int priority = i % GROBO_PRIORITIES;
                submit_read(&p, &r[i], 2, 0, (grobo_priority)priority);
                expected += (bits & GROBO_PRIORITY_BIT(priority)) != 0;
                left -= (bits & GROBO_PRIORITY_BIT(priority)) != 0;
            }
            assert_int_equal(grobo_bus_cancel_all(&p.bus, bits, GROBO_ERR_UNPLUGGED), expected);
            assert_int_equal(p.ended_count, expected);
            for (int i = 0; i < p.ended_count; i++) {
                assert_int_equal(p.ended[i].result, GROBO_ERR_UNPLUGGED);
            }
            assert_int_equal(grobo_bus_pending(&p.bus), left);
        }
    }
}

TEST(what_was_never_submitted_is_not_taken_back)
{
    peer p;
    request a, b;
    peer_init(&p, NULL);
    submit_read(&p, &a, 1, 0, GROBO_PRIORITY_USER);
    peer_read(&p, &b, 2, 2, GROBO_PRIORITY_USER);
    assert_int_equal(grobo_bus_cancel(&p.bus, &b.txn), GROBO_ERR_NOTFOUND);
    b.txn.pending_ = true; /* of another bus */
    assert_int_equal(grobo_bus_cancel(&p.bus, &b.txn), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_bus_pending(&p.bus), 1);
    assert_int_equal(p.bus.stats.canceled, 0);
}
