/* SPDX-License-Identifier: MIT */
/* The bytes of frames under way: each frame's are its own, and some are kept for halts. */
#include <stdint.h>
#include <string.h>

#include "tests/support/axes_kit.h"
#include "tests/support/test.h"

static void do_nothing(grobo_robot_slot *slot, int result, const grobo_packet *reply)
{
    (void)slot;
    (void)result;
    (void)reply;
}

/* A frame of so many bytes, all alike. @return the result; *into: its slot. */
static int give(grobo_i_use use, size_t bytes, uint8_t all, grobo_robot_slot **into)
{
    grobo_robot_slot *slot = grobo_i_slot_take(&robot, use);
    assert_non_null(slot);
    memset(robot.built.frame, all, bytes);
    robot.built.frame_bytes = (uint16_t)bytes;
    *into = slot;
    return grobo_i_slot_send(slot, &robot.built, GROBO_PRIORITY_USER);
}

static void expect_bytes(const grobo_robot_slot *slot, size_t bytes, uint8_t all)
{
    uint8_t be[GROBO_FRAME_MAX_BYTES];
    memset(be, all, bytes);
    assert_int_equal(slot->txn.frame_bytes, bytes);
    assert_memory_equal(slot->txn.frame, be, bytes);
}

/* Whichever is over first: the others keep theirs, and the room is that of one again. */
TEST_WITH(rig_wirings, frames_keep_their_bytes_when_one_is_over)
{
    enum { FRAMES = 4 };
    static const size_t bytes[FRAMES] = {3, 40, 1, 17};
    for (int order = 0; order < FRAMES * FRAMES; order++) {
        grobo_robot_slot *slot[FRAMES];
        start();
        for (int i = 0; i < FRAMES; i++) {
            assert_int_equal(give(GROBO_I_USE_PLAIN, bytes[i], (uint8_t)(i + 1), &slot[i]), 0);
        }
        robot.over = do_nothing;
        const int first = order % FRAMES, second = order / FRAMES;
        assert_int_equal(grobo_bus_cancel(&robot.bus, &slot[first]->txn), GROBO_OK);
        (void)grobo_bus_cancel(&robot.bus, &slot[second]->txn);
        size_t left = 0;
        for (int i = 0; i < FRAMES; i++) {
            if (i != first && i != second) {
                expect_bytes(slot[i], bytes[i], (uint8_t)(i + 1));
                left += bytes[i];
            }
        }
        assert_int_equal(robot.frames_used, left);
        assert_int_equal(give(GROBO_I_USE_PLAIN, 9, 9, &slot[first]), 0);
        expect_bytes(slot[first], 9, 9);
        assert_int_equal(robot.frames_used, left + 9);
    }
}

/* One that is longer than at first never leaves, and touches no other's. */
TEST_WITH(rig_wirings, a_frame_does_not_outgrow_its_room)
{
    grobo_robot_slot *slot, *other;
    start();
    assert_int_equal(give(GROBO_I_USE_PLAIN, 10, 1, &slot), 0);
    assert_int_equal(give(GROBO_I_USE_PLAIN, 10, 2, &other), 0);
    memset(robot.built.frame, 3, 11);
    robot.built.frame_bytes = 11;
    assert_int_equal(grobo_i_slot_renew(slot), GROBO_ERR_SPACE);
    expect_bytes(slot, 10, 1);
    robot.built.frame_bytes = 4;
    assert_int_equal(grobo_i_slot_renew(slot), GROBO_OK);
    expect_bytes(slot, 4, 3);
    robot.built.frame_bytes = 10; /* at the next attempt: as many as at first */
    assert_int_equal(grobo_i_slot_renew(slot), GROBO_OK);
    expect_bytes(slot, 10, 3);
    expect_bytes(other, 10, 2);
}

/* However long the frames are that wait, three of the longest find room if they are halts. */
TEST_WITH(rig_wirings, bytes_are_kept_for_halts)
{
    const size_t longest = GROBO_FRAME_MAX_BYTES;
    const size_t others = sizeof robot.frames / longest - 3;
    for (int halts = 0; halts <= 3; halts++) {
        grobo_robot_slot *slot;
        start();
        for (int i = 0; i < halts; i++) {
            assert_int_equal(give(GROBO_I_USE_HALT, longest, 7, &slot), GROBO_OK);
        }
        for (size_t i = 0; i < others; i++) {
            assert_int_equal(give(GROBO_I_USE_PLAIN, longest, 1, &slot), GROBO_OK);
        }
        assert_int_equal(give(GROBO_I_USE_PLAIN, 1, 1, &slot), GROBO_ERR_FULL);
        assert_int_equal(slot->use, GROBO_I_USE_FREE);
        for (int i = halts; i < 3; i++) {
            assert_int_equal(give(GROBO_I_USE_HALT, longest, 7, &slot), GROBO_OK);
        }
        assert_int_equal(give(GROBO_I_USE_HALT, 1, 7, &slot), GROBO_ERR_FULL);
    }
}
