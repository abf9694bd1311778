/* SPDX-License-Identifier: MIT */
/* Several replies to one frame, replies of whoever is there, and what the frames of DYNAMIXEL and
 * Feetech are answered by, in virtual time. */
#include <stdint.h>
#include <string.h>

#include <grobo/core/dxl2.h>
#include <grobo/core/feetech.h>

#include "tests/support/bus_peer.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { MS = 1000, S = 1000000, POSITION = 132, BYTES = 4, BAUD = 1000000 };

static const grobo_bus_config line = {
    .protocol = &grobo_i_dxl2_protocol, .baud_bps = BAUD, .margin_us = 5 * MS};
static const uint8_t ids[] = {3, 1, 7};

/* What `each` was given. */
static grobo_packet got[8];
static uint8_t first[8];
static int n_got;
static peer p;
static request r;

static void each(void *ctx, grobo_txn *txn, const grobo_packet *reply)
{
    assert_ptr_equal(ctx, &p);
    assert_true(grobo_txn_is_pending(txn));
    assert_true(n_got < 8);
    first[n_got] = reply->data_bytes > 0 ? reply->data[0] : 0;
    got[n_got++] = *reply;
}

static void submit(const grobo_dxl2_packet *packet)
{
    int n = grobo_dxl2_build(packet, r.frame, sizeof r.frame);
    peer_txn(&p, &r.txn, r.frame, n, GROBO_PRIORITY_USER);
    r.txn.each = each;
    r.txn.retries = 0;
    n_got = 0;
    assert_int_equal(grobo_bus_submit(&p.bus, &r.txn), GROBO_OK);
}

static void submit_sync_read(uint8_t code)
{
    peer_init(&p, &line);
    submit(&(grobo_dxl2_packet){.id = GROBO_DXL2_ID_ALL,
                                .instruction = code,
                                .address = POSITION,
                                .length = BYTES,
                                .data = ids,
                                .data_bytes = sizeof ids});
}

static void status_at(int64_t at_us, uint8_t id, uint8_t error, const uint8_t *data, size_t n)
{
    uint8_t b[64];
    const grobo_dxl2_packet status = {
        .id = id, .instruction = GROBO_DXL2_STATUS, .error = error, .data = data, .data_bytes = n};
    int size = grobo_dxl2_build(&status, b, sizeof b);
    assert_true(size > 0);
    peer_bytes_at(&p, at_us, b, (size_t)size);
}

static void position_at(int64_t at_us, uint8_t id)
{
    const uint8_t data[BYTES] = {id, 0, 0, 0};
    status_at(at_us, id, 0, data, sizeof data);
}

static void ended(int64_t at_us, int result)
{
    assert_int_equal(p.ended_count, 1);
    assert_int_equal(p.ended[0].result, result);
    assert_int_equal(p.ended[0].at_us, at_us);
}

/* 17 bytes of request; three times 500 us and 15 bytes. */
TEST(all_answer_and_the_time_is_that_of_all)
{
    grobo_bus_cost cost;
    submit_sync_read(GROBO_DXL2_SYNC_READ);
    grobo_bus_cost_of(&p.bus, &r.txn, &cost);
    assert_int_equal(cost.request_us, 170);
    assert_int_equal(cost.reply_us, 3 * (500 + 150));
    position_at(820, 3);
    position_at(1470, 1);
    position_at(2120, 7);
    peer_run(&p, S);
    ended(2120, GROBO_OK);
    assert_false(p.ended[0].has_reply);
    assert_int_equal(n_got, 3);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(got[i].id, ids[i]);
        assert_int_equal(got[i].address, POSITION);
        assert_int_equal(got[i].data_bytes, BYTES);
        assert_int_equal(first[i], ids[i]);
    }
    assert_int_equal(p.bus.stats.replies, 1);
    assert_int_equal(p.bus.stats.late_bytes, 0);
}

/* The last one ends it: nobody is waited for who comes before it in the list. */
TEST(one_that_is_silent_costs_the_others_nothing)
{
    submit_sync_read(GROBO_DXL2_SYNC_READ);
    position_at(820, 3);
    position_at(2120, 7);
    peer_run(&p, S);
    ended(2120, GROBO_ERR_SHORT);
    assert_int_equal(n_got, 2);
    submit_sync_read(GROBO_DXL2_SYNC_READ);
    position_at(820, 3);
    position_at(1470, 1);
    peer_run(&p, S);
    ended(2120 + 5 * MS, GROBO_ERR_SHORT);
    submit_sync_read(GROBO_DXL2_SYNC_READ);
    peer_run(&p, S);
    ended(2120 + 5 * MS, GROBO_ERR_TIMEOUT);
    assert_int_equal(n_got, 0);
}

/* A packet of who was not asked, of another length, and one that came before: none is a reply. */
TEST(what_was_not_asked_is_no_reply)
{
    submit_sync_read(GROBO_DXL2_SYNC_READ);
    position_at(500, 2);
    status_at(600, 1, 0, (const uint8_t *)"ab", 2);
    position_at(820, 3);
    position_at(900, 3);
    position_at(1470, 1);
    position_at(2120, 7);
    peer_run(&p, S);
    ended(2120, GROBO_OK);
    assert_int_equal(n_got, 3);
    assert_int_equal(p.bus.stats.late_frames, 3);
}

/* A servo that refuses says so in a status without data. */
TEST(a_refusal_is_one_of_the_replies)
{
    submit_sync_read(GROBO_DXL2_SYNC_READ);
    position_at(820, 3);
    status_at(1400, 1, GROBO_DXL2_NO_ACCESS, NULL, 0);
    position_at(2120, 7);
    peer_run(&p, S);
    ended(2120, GROBO_OK);
    assert_int_equal(n_got, 3);
    assert_true(got[1].refused);
    assert_int_equal(got[1].flags, GROBO_DXL2_NO_ACCESS);
}

static void cancel_in_each(void *ctx, grobo_txn *txn, const grobo_packet *reply)
{
    each(ctx, txn, reply);
    assert_int_equal(grobo_bus_cancel(&p.bus, txn), GROBO_OK);
}

TEST(a_callback_may_cancel)
{
    submit_sync_read(GROBO_DXL2_SYNC_READ);
    r.txn.each = cancel_in_each;
    position_at(820, 3);
    position_at(1470, 1);
    position_at(2120, 7);
    peer_run(&p, S);
    ended(820, GROBO_ERR_CANCELED);
    assert_int_equal(n_got, 1);
}

/* A retry asks all again, and may be answered by who was late; what is owed is waited for before
 * anything is asked that it would answer. */
TEST(a_late_status_is_no_answer_to_another_question)
{
    submit_sync_read(GROBO_DXL2_SYNC_READ);
    position_at(820, 3);
    position_at(2120, 7);
    peer_run(&p, 2500);
    ended(2120, GROBO_ERR_SHORT);
    position_at(9 * MS, 1); /* late; then the goal of the same servo is asked, as long */
    submit(&(grobo_dxl2_packet){
        .id = 1, .instruction = GROBO_DXL2_READ, .address = 116, .length = BYTES});
    status_at(200 * MS, 1, 0, (const uint8_t *)"goal", 4);
    peer_run(&p, S);
    assert_int_equal(p.ended_count, 2);
    assert_true(r.txn.sent_us >= 9 * MS);
    assert_true(p.ended[1].at_us != 9 * MS);
}

/* 26 bytes: three blocks of 8 behind a head of 8, and one return delay. */
TEST(a_fast_read_is_one_packet_of_all)
{
    grobo_reply reply;
    uint8_t data[3 * (4 + BYTES) - 2] = {0, 3, 42};
    grobo_bus_cost cost;
    submit_sync_read(GROBO_DXL2_FAST_SYNC_READ);
    reply = r.txn.reply;
    assert_int_equal(reply.count, 1);
    assert_int_equal(reply.id, GROBO_DXL2_ID_ALL);
    assert_int_equal(reply.length, sizeof data);
    grobo_bus_cost_of(&p.bus, &r.txn, &cost);
    assert_int_equal(cost.reply_us, 500 + 10 * (8 + 3 * (4 + BYTES)));
    status_at(1000, GROBO_DXL2_ID_ALL, 0, data, sizeof data);
    peer_run(&p, S);
    ended(1000, GROBO_OK);
    assert_true(p.ended[0].has_reply);
    assert_int_equal(p.ended[0].value, 3 << 8);
}

static void submit_call(void)
{
    peer_init(&p, &line);
    submit(&(grobo_dxl2_packet){.id = GROBO_DXL2_ID_ALL, .instruction = GROBO_DXL2_PING});
}

TEST(whoever_is_there_answers_a_call)
{
    submit_call();
    assert_int_equal(r.txn.reply.kind, GROBO_REPLY_ANY);
    status_at(3 * MS, 1, 0, (const uint8_t *)"\x24\x04\x2D", 3);
    peer_bytes_at(&p, 50 * MS, (const uint8_t *)"\xFF\xFF\xFD\x00\x02\x07 collided", 16);
    status_at(600 * MS, 200, GROBO_DXL2_ALERT, (const uint8_t *)"\xFC\x03\x2D", 3);
    peer_run(&p, 2 * S);
    ended(772 * MS, GROBO_OK);
    assert_int_equal(n_got, 2);
    assert_int_equal(got[0].id, 1);
    assert_int_equal(got[1].id, 200);
    assert_false(got[1].refused); /* an alert tells of the servo, not of the request */
    submit_call();
    peer_run(&p, 2 * S);
    ended(772 * MS, GROBO_OK); /* nobody */
}

TEST(a_stop_does_not_wait_for_a_call)
{
    static request stop;
    submit_call();
    peer_run(&p, 100 * MS);
    int n = grobo_dxl2_build(&(grobo_dxl2_packet){.id = GROBO_DXL2_ID_ALL,
                                                  .instruction = GROBO_DXL2_SYNC_WRITE,
                                                  .address = 64,
                                                  .length = 1,
                                                  .data = (const uint8_t *)"\x01\x00",
                                                  .data_bytes = 2},
                             stop.frame, sizeof stop.frame);
    peer_txn(&p, &stop.txn, stop.frame, n, GROBO_PRIORITY_STOP);
    assert_int_equal(stop.txn.reply.kind, GROBO_REPLY_NONE);
    assert_int_equal(grobo_bus_submit(&p.bus, &stop.txn), GROBO_OK);
    peer_run(&p, S);
    assert_int_equal(p.ended_count, 2);
    assert_int_equal(stop.txn.sent_us, 100 * MS);
}

/* The servo received rubbish: it is asked again. What it refuses is not. */
TEST(a_broken_request_is_repeated_and_a_refused_one_is_not)
{
    const grobo_dxl2_packet write = {.id = 1,
                                     .instruction = GROBO_DXL2_WRITE,
                                     .address = 65,
                                     .data = (const uint8_t *)"\x01",
                                     .data_bytes = 1};
    peer_init(&p, &line);
    submit(&write);
    r.txn.retries = 1;
    status_at(700, 1, GROBO_DXL2_BAD_CRC, NULL, 0);
    status_at(8 * MS, 1, 0, NULL, 0);
    peer_run(&p, S);
    ended(8 * MS, GROBO_OK);
    assert_int_equal(p.sent_count, 2);
    peer_init(&p, &line);
    submit(&write);
    r.txn.retries = 1;
    status_at(700, 1, GROBO_DXL2_BAD_LIMIT, NULL, 0);
    peer_run(&p, S);
    ended(700, GROBO_ERR_NACK);
    assert_int_equal(p.sent_count, 1);
}

TEST(stuffing_is_taken_out_of_what_is_read)
{
    peer_init(&p, &line);
    submit(
        &(grobo_dxl2_packet){.id = 1, .instruction = GROBO_DXL2_READ, .address = 126, .length = 6});
    status_at(900, 1, 0, (const uint8_t *)"\xFF\xFF\xFD\x01\x02\x03", 6);
    peer_run(&p, S);
    ended(900, GROBO_OK);
    assert_int_equal(p.ended[0].value, -1);
}

/* ---- Protocol 1.0 ---------------------------------------------------------------------------- */

static void submit_old(const grobo_protocol *protocol, bool echo, const grobo_dxl1_packet *packet)
{
    grobo_bus_config config = line;
    config.protocol = protocol;
    config.echo = echo;
    peer_init(&p, &config);
    int n = grobo_dxl1_build(packet, r.frame, sizeof r.frame);
    peer_txn(&p, &r.txn, r.frame, n, GROBO_PRIORITY_USER);
    r.txn.each = each;
    r.txn.retries = 0;
    n_got = 0;
    assert_int_equal(grobo_bus_submit(&p.bus, &r.txn), GROBO_OK);
}

/* FF FF 01 02 01 FB is a ping of servo 1, and its status that tells a low voltage. */
TEST(an_echo_that_looks_like_a_status_is_an_echo)
{
    const uint8_t ping[] = {0xFF, 0xFF, 1, 2, 1, 0xFB};
    submit_old(&grobo_i_feetech_protocol, true, &(grobo_dxl1_packet){.id = 1, .instruction = 1});
    peer_bytes_at(&p, 100, ping, sizeof ping);
    peer_run(&p, S);
    ended(6 * 10 + 6 * 10 + 5 * MS, GROBO_ERR_TIMEOUT);
    submit_old(&grobo_i_feetech_protocol, true, &(grobo_dxl1_packet){.id = 1, .instruction = 1});
    peer_bytes_at(&p, 100, ping, sizeof ping);
    peer_bytes_at(&p, 200, ping, sizeof ping);
    peer_run(&p, S);
    ended(200, GROBO_OK);
}

/* An adapter returns what is sent and nobody reckons with it; or there is another host. What was
 * sent has the form of a status, in part of one that refuses. */
TEST(what_a_host_sends_is_no_answer)
{
    static const uint8_t goal[] = {0x00, 0x08, 0x64, 0x00};
    static const struct {
        const grobo_protocol *protocol;
        grobo_dxl1_packet asked;
        size_t answer_bytes;
    } rows[] = {
        {&grobo_i_feetech_protocol,
         {.instruction = GROBO_DXL1_READ, .address = 56, .length = 2},
         2},
        {&grobo_i_dxl1_protocol, {.instruction = GROBO_DXL1_READ, .address = 36, .length = 2}, 2},
        {&grobo_i_dxl1_protocol, {.instruction = GROBO_DXL1_READ, .address = 36, .length = 8}, 8},
        {&grobo_i_dxl1_protocol,
         {.instruction = GROBO_DXL1_WRITE, .address = 30, .data = goal, .data_bytes = 4},
         0},
        {&grobo_i_dxl1_protocol,
         {.instruction = GROBO_DXL1_WRITE, .address = 25, .data = goal, .data_bytes = 1},
         0},
    };
    static const uint8_t values[] = {0xE8, 0x03, 0, 0, 0, 0, 0, 0};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        uint8_t b[16];
        grobo_dxl1_packet asked = rows[i].asked;
        asked.id = 9;
        submit_old(rows[i].protocol, false, &asked);
        peer_bytes_at(&p, 100, r.frame, r.txn.frame_bytes);
        peer_run(&p, 150);
        assert_int_equal(p.ended_count, 0);
        const grobo_dxl1_packet status = {
            .status = true, .id = 9, .data = values, .data_bytes = rows[i].answer_bytes};
        int n = grobo_dxl1_build(&status, b, sizeof b);
        peer_bytes_at(&p, 700, b, (size_t)n);
        peer_run(&p, S);
        ended(700, GROBO_OK);
        assert_int_equal(p.ended[0].value, rows[i].answer_bytes > 0 ? 1000 : 0);
    }
}

TEST(feetech_answers_a_sync_read_one_by_one)
{
    submit_old(&grobo_i_feetech_protocol, false,
               &(grobo_dxl1_packet){.id = GROBO_DXL1_ID_ALL,
                                    .instruction = GROBO_DXL1_SYNC_READ,
                                    .address = 56,
                                    .length = 2,
                                    .data = ids,
                                    .data_bytes = sizeof ids});
    for (int i = 0; i < 3; i++) {
        uint8_t b[16];
        int n = grobo_dxl1_build(&(grobo_dxl1_packet){.status = true,
                                                      .id = ids[i],
                                                      .error = GROBO_FEETECH_OVERLOAD,
                                                      .data = (const uint8_t *)"\x00\x08",
                                                      .data_bytes = 2},
                                 b, sizeof b);
        peer_bytes_at(&p, 110 + 80 * (i + 1), b, (size_t)n);
    }
    peer_run(&p, S);
    ended(350, GROBO_OK);
    assert_int_equal(n_got, 3);
    assert_int_equal(got[2].id, 7);
    assert_int_equal(got[2].flags, GROBO_FEETECH_OVERLOAD);
    assert_false(got[2].refused);
}

/* Sends a sync read that two of three answer too late, and tells when they do; then another one. */
static int64_t late_status(const uint8_t *late, int n_late)
{
    const grobo_bus_config config = {
        .protocol = &grobo_i_feetech_protocol, .baud_bps = BAUD, .margin_us = MS};
    const grobo_dxl1_packet packet = {.id = GROBO_DXL1_ID_ALL,
                                      .instruction = GROBO_DXL1_SYNC_READ,
                                      .address = 56,
                                      .length = 2,
                                      .data = ids,
                                      .data_bytes = sizeof ids};
    static request again;
    int64_t last_us = 0;
    peer_init(&p, &config);
    for (int k = 0; k < 2; k++) {
        request *which = k == 0 ? &r : &again;
        int n = grobo_dxl1_build(&packet, which->frame, sizeof which->frame);
        peer_txn(&p, &which->txn, which->frame, n, GROBO_PRIORITY_SENSE);
        which->txn.retries = 0;
        n_got = 0;
        assert_int_equal(grobo_bus_submit(&p.bus, &which->txn), GROBO_OK);
    }
    for (int i = 0; i < n_late; i++) {
        uint8_t b[16];
        int n = grobo_dxl1_build(&(grobo_dxl1_packet){.status = true,
                                                      .id = late[i],
                                                      .data = (const uint8_t *)"\x00\x08",
                                                      .data_bytes = 2},
                                 b, sizeof b);
        last_us = 5 * MS + 100 * (i + 1);
        peer_bytes_at(&p, last_us, b, (size_t)n);
    }
    peer_run(&p, S);
    assert_int_equal(p.sent_count, 2);
    return p.sent[1].at_us - last_us;
}

/* Once all that were owed have come, however late, nothing keeps the next one waiting; before that
 * it would take them for its own. */
TEST(late_replies_of_several_hold_the_next_until_the_last)
{
    static const uint8_t two[] = {3, 1}, other[] = {3, 1, 9}, twice[] = {3, 1, 3};
    assert_in_range(late_status(ids, 3), 0, 2 * MS);
    assert_in_range(late_status(two, 2), 50 * MS, GROBO_BUS_HOLD_US);
    assert_in_range(late_status(other, 3), 50 * MS, GROBO_BUS_HOLD_US);
    assert_in_range(late_status(twice, 3), 50 * MS, GROBO_BUS_HOLD_US);
}

/* One that is owed to a question before is no answer to a frame that has just left, so soon that
 * the line cannot have carried it; where nothing is owed, a line may be faster than its rate. */
TEST(a_late_reply_is_no_answer_to_a_frame_that_has_just_left)
{
    static request single;
    const grobo_bus_config config = {
        .protocol = &grobo_i_dxl2_protocol, .baud_bps = BAUD, .margin_us = MS};
    for (int late = 0; late < 2; late++) {
        peer_init(&p, &config);
        if (late) { /* asked twice, answered late, and once more */
            const grobo_dxl2_packet read = {
                .id = 3, .instruction = GROBO_DXL2_READ, .address = POSITION, .length = BYTES};
            int n = grobo_dxl2_build(&read, single.frame, sizeof single.frame);
            assert_true(n > 0);
            peer_txn(&p, &single.txn, single.frame, n, GROBO_PRIORITY_USER);
            single.txn.retries = 1;
            assert_int_equal(grobo_bus_submit(&p.bus, &single.txn), GROBO_OK);
            position_at(3 * MS, 3);
            peer_run(&p, 3 * MS + 10);
            assert_int_equal(p.ended_count, 1);
        }
        int64_t from_us = 3 * MS + 10;
        peer_run(&p, from_us);
        submit(&(grobo_dxl2_packet){.id = GROBO_DXL2_ID_ALL,
                                    .instruction = GROBO_DXL2_SYNC_READ,
                                    .address = POSITION,
                                    .length = BYTES,
                                    .data = ids,
                                    .data_bytes = sizeof ids});
        while (p.sent_count < (late ? 3 : 1)) {
            from_us += 10;
            peer_run(&p, from_us);
        }
        position_at(from_us + 200, 3);
        peer_run(&p, from_us + 250);
        assert_int_equal(n_got, late ? 0 : 1);
    }
}

/* Of DYNAMIXEL's errors some tell how the servo is, and some what became of the request. */
TEST(errors_of_old_dynamixels_are_told_apart)
{
    static const struct {
        uint8_t error;
        int result;
    } rows[] = {{GROBO_DXL1_OVERLOAD, GROBO_OK},
                {GROBO_DXL1_ANGLE_LIMIT, GROBO_ERR_NACK},
                {GROBO_DXL1_BAD_RANGE | GROBO_DXL1_VOLTAGE, GROBO_ERR_NACK},
                {GROBO_DXL1_BAD_SUM, GROBO_ERR_TIMEOUT}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        uint8_t b[16];
        submit_old(&grobo_i_dxl1_protocol, false,
                   &(grobo_dxl1_packet){.id = 9,
                                        .instruction = GROBO_DXL1_WRITE,
                                        .address = 30,
                                        .data = (const uint8_t *)"\x00\x02",
                                        .data_bytes = 2});
        int n = grobo_dxl1_build(
            &(grobo_dxl1_packet){.status = true, .id = 9, .error = rows[i].error}, b, sizeof b);
        peer_bytes_at(&p, 700, b, (size_t)n);
        peer_run(&p, S);
        assert_int_equal(p.ended[0].result, rows[i].result);
    }
}

/* ---- time ------------------------------------------------------------------------------------ */

/* A byte with parity has 11 bits. The longest frames at the slowest rate fit the numbers. */
TEST(parity_and_length_count)
{
    static grobo_protocol odd;
    grobo_bus bus;
    grobo_bus_cost cost;
    odd = grobo_i_dxl2_protocol;
    odd.parity = GROBO_PARITY_EVEN;
    const grobo_bus_config config = {.protocol = &odd, .baud_bps = 115200};
    assert_int_equal(grobo_bus_init(&bus, &config), GROBO_OK);
    static const uint8_t frame[GROBO_FRAME_MAX_BYTES];
    grobo_txn txn = {.frame = frame, .frame_bytes = 6};
    grobo_bus_cost_of(&bus, &txn, &cost);
    assert_int_equal(cost.request_us, 573); /* 66 bits */
    txn.frame_bytes = GROBO_FRAME_MAX_BYTES;
    txn.reply = (grobo_reply){.kind = GROBO_REPLY_RETURN, .count = 64, .bytes = 64 * 128};
    grobo_bus_cost_of(&bus, &txn, &cost);
    assert_int_equal(cost.request_us, 97778);
    assert_int_equal(cost.reply_us, 782223 + 64 * 500);
    const grobo_bus_config slow = {.protocol = &odd, .baud_bps = 1200};
    assert_int_equal(grobo_bus_init(&bus, &slow), GROBO_OK);
    grobo_bus_cost_of(&bus, &txn, &cost);
    assert_int_equal(cost.request_us, 9386667);
}
