/* SPDX-License-Identifier: MIT */
/* Looking at frames without a parser, good ones and those with a wrong sum. */
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>

#include "tests/support/test.h"

enum { EVERYTHING = GROBO_ACCEPT_COMMANDS | GROBO_ACCEPT_RETURNS };

static const uint8_t goal[] = {0xFA, 0xAF, 0x03, 0x00, 0x1E, 0x04, 0x01,
                               0xF6, 0xFF, 0x00, 0x00, 0x11, 0xFA, 0xAF};
enum { GOAL_BYTES = 12 };

TEST(every_prefix_needs_more_and_the_whole_has_its_size)
{
    grobo_rs30x_packet packet = {.id = 99};
    bool sum_ok = false;
    for (size_t n = 0; n < GOAL_BYTES; n++) {
        assert_int_equal(grobo_rs30x_peek(goal, n, EVERYTHING, &packet, &sum_ok), 0);
        assert_int_equal(packet.id, 99);
    }
    for (size_t n = GOAL_BYTES; n <= sizeof goal; n++) {
        assert_int_equal(grobo_rs30x_peek(goal, n, EVERYTHING, &packet, &sum_ok), GOAL_BYTES);
    }
    assert_true(sum_ok);
    assert_int_equal(packet.kind, GROBO_RS30X_SHORT);
    assert_int_equal(packet.id, 3);
    assert_ptr_equal(packet.data, goal + 7);
    assert_int_equal(packet.data_bytes, 4);
}

TEST(a_wrong_sum_is_told_with_the_packet)
{
    uint8_t bad[GOAL_BYTES];
    grobo_rs30x_packet packet;
    bool sum_ok = true;
    memcpy(bad, goal, sizeof bad);
    bad[GOAL_BYTES - 1] ^= 1;
    assert_int_equal(grobo_rs30x_peek(bad, sizeof bad, EVERYTHING, &packet, &sum_ok), GOAL_BYTES);
    assert_false(sum_ok);
    assert_int_equal(packet.address, GROBO_RS30X_GOAL);
}

TEST(only_what_is_accepted_is_seen)
{
    static const uint8_t back[] = {0xFD, 0xDF, 0x01, 0x00, 0x24, 0x01, 0x01, 0x01, 0x24};
    static const uint8_t ack[] = {GROBO_RS30X_ACK};
    grobo_rs30x_packet packet;
    bool sum_ok = false;
    assert_int_equal(grobo_rs30x_peek(back, sizeof back, EVERYTHING, &packet, &sum_ok), 9);
    assert_true(sum_ok);
    assert_int_equal(packet.kind, GROBO_RS30X_RETURN);
    assert_int_equal(grobo_rs30x_peek(back, sizeof back, GROBO_ACCEPT_COMMANDS, &packet, &sum_ok),
                     GROBO_ERR_FRAME);
    assert_int_equal(grobo_rs30x_peek(ack, 1, EVERYTHING, &packet, &sum_ok), GROBO_ERR_FRAME);
    assert_int_equal(grobo_rs30x_peek(ack, 1, GROBO_ACCEPT_ACKS, &packet, &sum_ok), 1);
    assert_int_equal(packet.kind, GROBO_RS30X_ACK_BYTE);
}

TEST(a_board_frame_is_seen_before_what_follows)
{
    static const uint8_t bytes[] = {0x41, 0x00, 0x50, 0x4D, 0x07, 0x12};
    grobo_board_frame frame;
    assert_int_equal(grobo_board_peek(bytes, 0, &frame), 0);
    assert_int_equal(grobo_board_peek(bytes, 1, &frame), 0);
    assert_int_equal(grobo_board_peek(bytes, sizeof bytes, &frame), 2);
    assert_int_equal(frame.kind, GROBO_BOARD_CHECK);
    assert_int_equal(grobo_board_peek(bytes + 2, 4, &frame), 3);
    assert_int_equal(frame.kind, GROBO_BOARD_SLOT);
    assert_int_equal(frame.number, 7);
    assert_int_equal(grobo_board_peek(bytes + 5, 1, &frame), GROBO_ERR_FRAME);
}
