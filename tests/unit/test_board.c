/* SPDX-License-Identifier: MIT */
/* Frames of the controller board, both ends, and the frames that GR001 uses. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/board.h>

#include "tests/support/tables.h"
#include "tests/support/test.h"
#include "tests/support/vectors.h"

enum { MAX = GROBO_FRAME_MAX_BYTES, MS = 1000, JOINTS = 20 };

TEST(frames_for_the_board_itself)
{
    uint8_t b[MAX];
    vector_expect(grobo_board_check(b, MAX), b, "41 00");
    vector_expect(grobo_board_slot(7, b, MAX), b, "50 4D 07");
    vector_expect(grobo_board_scenario(0, b, MAX), b, "50 53 00");
    assert_int_equal(grobo_board_check(b, 1), GROBO_ERR_SPACE);
    assert_int_equal(grobo_board_slot(0, b, 2), GROBO_ERR_SPACE);
}

TEST(single_joint_frames)
{
    uint8_t b[MAX];
    const grobo_rs30x_goal down = {3, -10, 0};
    const grobo_rs30x_goal right_angle = {3, 900, 10};
    const grobo_rs30x_goal slow = {1, 900, 500};
    vector_expect(grobo_frame_goal(&grobo_i_board_protocol, &down, b, MAX), b,
                  "53 0C FA AF 03 00 1E 04 01 F6 FF 00 00 11");
    vector_expect(grobo_frame_goal(&grobo_i_board_protocol, &right_angle, b, MAX), b,
                  "53 0C FA AF 03 00 1E 04 01 84 03 0A 00 95");
    vector_expect(grobo_frame_goal(&grobo_i_board_protocol, &slow, b, MAX), b,
                  "53 0C FA AF 01 00 1E 04 01 84 03 F4 01 68");
    vector_expect(grobo_frame_goal(&grobo_i_rs30x_protocol, &down, b, MAX), b,
                  "FA AF 03 00 1E 04 01 F6 FF 00 00 11");
}

TEST(all_joints_in_one_frame)
{
    static const int16_t init_ddeg[JOINTS] = {0, 0,    200,  0, -200, -200, 0, 200, 0,   200,
                                              0, -400, -200, 0, 0,    -200, 0, 400, 200, 0};
    uint8_t b[MAX];
    grobo_rs30x_goal goals[JOINTS];
    for (int i = 0; i < JOINTS; i++) {
        goals[i] = (grobo_rs30x_goal){(uint8_t)(i + 1), 0, 100};
    }
    assert_int_equal(grobo_frame_goals(&grobo_i_board_protocol, goals, JOINTS, b, MAX), 110);
    static const uint8_t head[] = {0x53, 0x6C, 0xFA, 0xAF, 0, 0, 0x1E, 5, 0x14, 1, 0, 0, 0x64, 0};
    assert_memory_equal(b, head, sizeof head);
    assert_int_equal(b[109], 0x1B);
    for (int i = 0; i < JOINTS; i++) {
        goals[i] = (grobo_rs30x_goal){(uint8_t)(i + 1), init_ddeg[i], 25};
    }
    assert_int_equal(grobo_frame_goals(&grobo_i_board_protocol, goals, JOINTS, b, MAX), 110);
    for (int i = 0; i < JOINTS; i++) {
        assert_int_equal(b[5 * i + 9], i + 1);
        assert_int_equal(b[5 * i + 10], init_ddeg[i] & 0xFF);
        assert_int_equal(b[5 * i + 11], init_ddeg[i] >> 8 & 0xFF);
    }
    assert_int_equal(b[109], 0x04);
}

TEST(torque_frames)
{
    uint8_t b[MAX];
    const grobo_wiring board = GROBO_WIRING_BOARD;
    vector_expect(grobo_frame_torque(grobo_wiring_protocol(board), 1, GROBO_TORQUE_ON, b, MAX), b,
                  "53 09 FA AF 01 00 24 01 01 01 24");
    vector_expect(grobo_frame_torque(grobo_wiring_protocol(board), 1, GROBO_TORQUE_OFF, b, MAX), b,
                  "53 09 FA AF 01 00 24 01 01 00 25");
    vector_expect(grobo_frame_torque(grobo_wiring_protocol(board), 1, GROBO_TORQUE_BRAKE, b, MAX),
                  b, "53 09 FA AF 01 00 24 01 01 02 27");
    vector_expect(grobo_frame_torque(grobo_wiring_protocol(board), 20, GROBO_TORQUE_ON, b, MAX), b,
                  "53 09 FA AF 14 00 24 01 01 01 31");
    vector_expect(grobo_frame_torque(grobo_wiring_protocol(board), 255, GROBO_TORQUE_OFF, b, MAX),
                  b, "53 09 FA AF FF 00 24 01 01 00 DB");
    grobo_rs30x_byte all[JOINTS];
    for (uint8_t i = 0; i < JOINTS; i++) {
        all[i] = (grobo_rs30x_byte){(uint8_t)(i + 1), GROBO_TORQUE_ON};
    }
    vector_expect(
        grobo_frame_torques(grobo_wiring_protocol(board), all, JOINTS, b, MAX), b,
        "53 30 FA AF 00 00 24 02 14 01 01 02 01 03 01 04 01 05 01 06 01 07 01 08 01 09 01 "
        "0A 01 0B 01 0C 01 0D 01 0E 01 0F 01 10 01 11 01 12 01 13 01 14 01 26");
    all[19].value = 3;
    assert_int_equal(grobo_frame_torques(grobo_wiring_protocol(board), all, JOINTS, b, MAX),
                     GROBO_ERR_ARG);
    assert_int_equal(grobo_frame_torque(grobo_wiring_protocol(board), 1, (grobo_torque)3, b, MAX),
                     GROBO_ERR_ARG);
}

TEST(read_frames)
{
    uint8_t b[MAX];
    const grobo_wiring board = GROBO_WIRING_BOARD;
    vector_expect(grobo_frame_read(grobo_wiring_protocol(board), 1, GROBO_STATE_ADDRESS,
                                   GROBO_STATE_BYTES, b, MAX),
                  b, "54 09 FA AF 01 0F 24 12 00 38 1A");
    vector_expect(grobo_frame_read(grobo_wiring_protocol(board), 2, GROBO_STATE_ADDRESS,
                                   GROBO_STATE_BYTES, b, MAX),
                  b, "54 09 FA AF 02 0F 24 12 00 3B 1A");
    vector_expect(grobo_frame_read(grobo_wiring_protocol(board), 1, GROBO_RS30X_CURRENT, 2, b, MAX),
                  b, "54 09 FA AF 01 0F 30 02 00 3C 0A");
    vector_expect(
        grobo_frame_read(grobo_wiring_protocol(board), 1, GROBO_RS30X_POSITION, 2, b, MAX), b,
        "54 09 FA AF 01 0F 2A 02 00 26 0A");
    vector_expect(grobo_frame_read(&grobo_i_rs30x_protocol, 1, GROBO_RS30X_POSITION, 2, b, MAX), b,
                  "FA AF 01 0F 2A 02 00 26");
}

TEST(any_packet_is_wrapped_by_what_it_asks_for)
{
    uint8_t b[MAX];
    int n = grobo_rs30x_write_u8(1, GROBO_RS30X_WANT_ACK, GROBO_RS30X_TORQUE, 1, b, MAX);
    vector_expect(grobo_frame_wrap(&grobo_i_board_protocol, b, (size_t)n, b, MAX), b,
                  "54 0A FA AF 01 01 24 01 01 01 25 01");
    n = grobo_rs30x_control(1, GROBO_RS30X_REBOOT, b, MAX);
    vector_expect(grobo_frame_wrap(&grobo_i_board_protocol, b, (size_t)n, b, MAX), b,
                  "53 08 FA AF 01 20 FF 00 00 DE");
    n = grobo_rs30x_read_block(5, GROBO_RS30X_WANT_42_59, b, MAX);
    vector_expect(grobo_frame_wrap(&grobo_i_board_protocol, b, (size_t)n, b, MAX), b,
                  "54 09 FA AF 05 09 00 00 01 0D 1A");
    b[3] ^= 1;
    assert_int_equal(grobo_frame_wrap(&grobo_i_rs30x_protocol, b, (size_t)n, b, MAX),
                     GROBO_ERR_FRAME);
}

TEST(relays_know_their_bounds)
{
    uint8_t b[MAX];
    static const uint8_t packet[GROBO_RELAY_MAX_BYTES + 1] = {0xFA, 0xAF};
    assert_int_equal(grobo_board_send(packet, 127, b, MAX), 129);
    assert_int_equal(grobo_board_send(packet, 128, b, MAX), GROBO_ERR_CAP);
    assert_int_equal(grobo_board_ask(packet, 126, 9, b, MAX), 129);
    assert_int_equal(grobo_board_ask(packet, 127, 9, b, MAX), GROBO_ERR_CAP);
    assert_int_equal(grobo_board_send(packet, 0, b, MAX), GROBO_ERR_ARG);
    assert_int_equal(grobo_board_ask(packet, 8, 0, b, MAX), GROBO_ERR_ARG);
    assert_int_equal(grobo_board_send(packet, 8, b, 9), GROBO_ERR_SPACE);
    assert_int_equal(grobo_board_ask(packet, 8, 9, b, 10), GROBO_ERR_SPACE);
    uint8_t roomy[2 * MAX];
    grobo_rs30x_goal goals[24];
    for (int i = 0; i < 24; i++) {
        goals[i] = (grobo_rs30x_goal){(uint8_t)(i + 1), 0, 0};
    }
    const grobo_wiring board = GROBO_WIRING_BOARD;
    assert_int_equal(
        grobo_frame_goals(grobo_wiring_protocol(board), goals, 23, roomy, sizeof roomy), 125);
    assert_int_equal(
        grobo_frame_goals(grobo_wiring_protocol(board), goals, 24, roomy, sizeof roomy),
        GROBO_ERR_CAP);
    assert_int_equal(grobo_frame_goals(grobo_wiring_protocol(board), goals, 20, roomy, 109),
                     GROBO_ERR_SPACE);
    for (size_t cap = 0; cap < 11; cap++) {
        int n = grobo_frame_read(&grobo_i_board_protocol, 1, 42, 2, b, cap);
        assert_int_equal(n, GROBO_ERR_SPACE);
    }
}

TEST(hosts_know_what_a_frame_is_answered_by)
{
    static const struct {
        const char *frame;
        grobo_reply_kind kind;
        int bytes;
    } rows[] = {
        {"41 00", GROBO_REPLY_ACK, 1},
        {"50 4D 01", GROBO_REPLY_NONE, 0},
        {"50 53 01", GROBO_REPLY_NONE, 0},
        {"53 09 FA AF 01 00 24 01 01 01 24", GROBO_REPLY_NONE, 0},
        {"53 08 FA AF 01 0F 24 12 00 38", GROBO_REPLY_NONE, 0}, /* the board swallows it */
        {"54 09 FA AF 01 0F 24 12 00 38 1A", GROBO_REPLY_RETURN, 26},
        {"54 0A FA AF 01 01 24 01 01 01 25 01", GROBO_REPLY_ACK, 1},
        {"54 09 FA AF 01 0F 24 12 00 38 1B", GROBO_REPLY_NONE, GROBO_ERR_FRAME},
        {"54 09 FA AF 01 0F 24 12 00 26 1A", GROBO_REPLY_NONE, GROBO_ERR_CHECKSUM},
        {"54 09 FA AF 01 0F 24 12 00 38", GROBO_REPLY_NONE, GROBO_ERR_FRAME},
        {"41", GROBO_REPLY_NONE, GROBO_ERR_FRAME},
        {"41 00 00", GROBO_REPLY_NONE, GROBO_ERR_FRAME},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        uint8_t b[MAX];
        grobo_reply reply = {.kind = GROBO_REPLY_NONE, .id = 99};
        int n = vector_from_hex(rows[i].frame, b, MAX);
        int bytes = grobo_i_board_protocol.reply_to(b, (size_t)n, &reply);
        assert_int_equal(bytes, rows[i].bytes);
        assert_int_equal(reply.kind, rows[i].kind);
        if (bytes < 0 || reply.kind == GROBO_REPLY_RETURN) {
            assert_int_equal(reply.id, bytes < 0 ? 99 : 1);
        }
    }
}

/* ---- device side ---- */

typedef struct heard {
    grobo_board_frame frame; /* the last one */
    uint8_t packet[MAX];
    int frames;
} heard;

static void hear(grobo_board_parser *parser, int64_t now_us, heard *h)
{
    while (grobo_board_parser_next(parser, now_us, &h->frame) > 0) {
        h->frames++;
        if (h->frame.packet_bytes > 0) {
            memcpy(h->packet, h->frame.packet, h->frame.packet_bytes);
        }
    }
}

static void push(grobo_board_parser *parser, int64_t now_us, const uint8_t *b, size_t n, heard *h)
{
    for (size_t took; n > 0; b += took, n -= took) {
        took = grobo_board_parser_feed(parser, b, n, now_us);
        hear(parser, now_us, h);
    }
}

static const char *const frames[] = {
    "41 00",
    "50 4D 03",
    "50 53 FA",
    "53 09 FA AF 01 00 24 01 01 01 24",
    "54 09 FA AF 01 0F 24 12 00 38 1A",
};

enum { FRAMES = (int)(sizeof frames / sizeof frames[0]) };

TEST(every_split_of_every_frame_gives_it_back)
{
    for (int i = 0; i < FRAMES; i++) {
        uint8_t b[MAX];
        size_t n = (size_t)vector_from_hex(frames[i], b, MAX);
        for (size_t cut = 0; cut <= n; cut++) {
            grobo_board_parser parser;
            heard h = {.frames = 0};
            grobo_board_parser_init(&parser, 0);
            push(&parser, 0, b, cut, &h);
            assert_int_equal(h.frames, cut == n);
            push(&parser, 10 * MS, b + cut, n - cut, &h);
            assert_int_equal(h.frames, 1);
            assert_int_equal(h.frame.kind, i == 0   ? GROBO_BOARD_CHECK
                                           : i == 1 ? GROBO_BOARD_SLOT
                                           : i == 2 ? GROBO_BOARD_SCENARIO
                                           : i == 3 ? GROBO_BOARD_SEND
                                                    : GROBO_BOARD_ASK);
            assert_int_equal(h.frame.number, i == 1 ? 3 : i == 2 ? 0xFA : 0);
            assert_int_equal(h.frame.reply_bytes, i == 4 ? 26 : 0);
            assert_int_equal(h.frame.packet_bytes, i == 3 ? 9 : i == 4 ? 8 : 0);
            assert_memory_equal(h.packet, b + 2, h.frame.packet_bytes);
            assert_int_equal(parser.framer.stats.dropped_bytes, 0);
            assert_int_equal(grobo_board_parser_deadline(&parser), GROBO_NEVER_US);
        }
    }
}

/* Letters of frames occur in rubbish and in packets: they must not swallow the frame behind. */
TEST(rubbish_before_a_frame_is_dropped)
{
    static const uint8_t rubbish[] = {0x53, 0x41, 0x01, 0x50, 0x50, 0x54, 0x09,
                                      0xFA, 0x53, 0x20, 0xFA, 0x00, 0x41, 0x54};
    for (int i = 0; i < FRAMES; i++) {
        uint8_t b[MAX];
        size_t n = (size_t)vector_from_hex(frames[i], b, MAX);
        grobo_board_parser parser;
        heard h = {.frames = 0};
        grobo_board_parser_init(&parser, 0);
        push(&parser, 0, rubbish, sizeof rubbish, &h);
        push(&parser, 0, b, n, &h);
        assert_int_equal(h.frames, 1);
        assert_int_equal(parser.framer.stats.dropped_bytes, sizeof rubbish);
        assert_int_equal(parser.framer.stats.frame_bytes, n);
    }
}

TEST(a_frame_that_stands_still_is_abandoned)
{
    uint8_t b[MAX];
    size_t n = (size_t)vector_from_hex(frames[4], b, MAX);
    grobo_board_parser parser;
    heard h = {.frames = 0};
    grobo_board_parser_init(&parser, 30 * MS);
    push(&parser, 100 * MS, b, n - 1, &h);
    assert_int_equal(grobo_board_parser_deadline(&parser), 130 * MS);
    hear(&parser, 130 * MS - 1, &h);
    assert_int_equal(parser.stalls, 0);
    hear(&parser, 130 * MS, &h);
    assert_int_equal(parser.stalls, 1);
    assert_int_equal(h.frames, 0);
    assert_int_equal(parser.framer.stats.dropped_bytes, n - 1);
    assert_int_equal(grobo_board_parser_deadline(&parser), GROBO_NEVER_US);

    push(&parser, 200 * MS, b, n - 1, &h); /* abandoned by the bytes of the next frame */
    push(&parser, 240 * MS, b, n, &h);
    assert_int_equal(parser.stalls, 2);
    assert_int_equal(h.frames, 1);
}

TEST(a_whole_frame_behind_a_stump_outlives_the_stall)
{
    uint8_t b[MAX];
    size_t stump = (size_t)vector_from_hex("53 7F FA AF 01", b, MAX);
    size_t n = (size_t)vector_from_hex(frames[4], b + stump, MAX - stump);
    grobo_board_parser parser;
    heard h = {.frames = 0};
    grobo_board_parser_init(&parser, 0);
    push(&parser, 0, b, stump + n, &h);
    assert_int_equal(h.frames, 0);
    hear(&parser, GROBO_BOARD_STALL_US, &h);
    assert_int_equal(h.frames, 1);
    assert_int_equal(h.frame.kind, GROBO_BOARD_ASK);
    assert_int_equal(parser.framer.stats.dropped_bytes, stump);
    push(&parser, 2 * GROBO_BOARD_STALL_US, b, 3, &h);
    grobo_board_parser_reset(&parser);
    assert_int_equal(parser.framer.stats.dropped_bytes, stump + 3);
}

static int rebuild(const grobo_board_frame *f, uint8_t *b)
{
    switch (f->kind) {
    case GROBO_BOARD_CHECK:
        return grobo_board_check(b, MAX);
    case GROBO_BOARD_SEND:
        return grobo_board_send(f->packet, f->packet_bytes, b, MAX);
    case GROBO_BOARD_ASK:
        return grobo_board_ask(f->packet, f->packet_bytes, f->reply_bytes, b, MAX);
    case GROBO_BOARD_SLOT:
        return grobo_board_slot(f->number, b, MAX);
    case GROBO_BOARD_SCENARIO:
        return grobo_board_scenario(f->number, b, MAX);
    }
    return -1;
}

/* A relay frame must say the same when it is made again from the servo packet alone. */
static void check_relay(const vector *v, const grobo_board_frame *frame)
{
    uint8_t b[MAX];
    int n = grobo_board_relay(frame->packet, frame->packet_bytes, b, MAX);
    assert_int_equal(n, v->n);
    assert_memory_equal(b, v->bytes, v->n);
}

static bool check_vector(const vector *v)
{
    if (strcmp(v->layer, "controller") != 0 || strcmp(v->kind, "A-reply") == 0) {
        return false;
    }
    grobo_board_frame frame;
    grobo_reply reply;
    uint8_t b[MAX];
    assert_int_equal(grobo_board_parse(v->bytes, v->n, &frame), GROBO_OK);
    if (!v->valid) {
        assert_true(grobo_i_board_protocol.reply_to(v->bytes, v->n, &reply) < 0);
        return true;
    }
    assert_true(grobo_i_board_protocol.reply_to(v->bytes, v->n, &reply) >= 0);
    assert_int_equal(rebuild(&frame, b), v->n);
    assert_memory_equal(b, v->bytes, v->n);
    if (frame.packet_bytes > 0) {
        check_relay(v, &frame);
    }
    return true;
}

TEST(collected_vectors_parse_and_build_byte_for_byte)
{
    vectors_check(check_vector, 20);
}
