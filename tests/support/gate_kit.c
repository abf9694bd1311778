/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>

#include "tests/support/gate_kit.h"
#include "tests/support/test.h"

grobo_robot_slot *slot;

void await(int joint, double way_deg, int64_t time_us)
{
    grobo_robot_axis *axis = &robot.axes[joint];
    axis->next = NUMBER;
    axis->next_rad = here_rad(joint) + RAD(way_deg);
    axis->next_time_us = time_us;
}

void take(grobo_robot_order order)
{
    slot = grobo_i_slot_take(&robot, GROBO_I_USE_PLAIN);
    assert_non_null(slot);
    slot->order = order;
    slot->txn.sent_us = -1;
    /* As if the longest frame waited: what leaves takes its place. */
    slot->room = slot->txn.frame_bytes = GROBO_FRAME_MAX_BYTES;
    slot->txn.frame = robot.frames + robot.frames_used;
    robot.frames_used += slot->room;
    assert_true(robot.frames_used <= sizeof robot.frames);
    memset(robot.frames, 0xA5, sizeof robot.frames);
    memset(&robot.built, 0xA5, sizeof robot.built);
    keep_axes();
}

int leave(grobo_robot_order order)
{
    take(order);
    return grobo_i_gate_leave(slot);
}

void drop(void)
{
    grobo_i_slot_drop(slot);
}

void expect_packet(const uint8_t *packet, int size)
{
    grobo_exchange be = {0};
    assert_true(size > 0);
    int n = grobo_frame_wrap(driver.protocol, packet, (size_t)size, be.frame, sizeof be.frame);
    assert_int_equal(slot->txn.frame_bytes, n);
    assert_memory_equal(slot->txn.frame, be.frame, (size_t)n);
    assert_int_equal(driver.protocol->reply_to(be.frame, (size_t)n, &be.reply), 0);
    assert_int_equal(slot->txn.reply.kind, be.reply.kind);
    assert_int_equal(robot.built.settle_us, 0);
}

int doubled_goal = -1;

void expect_goals(grobo_joint_mask of, double way_deg, int64_t time_us)
{
    uint8_t packet[GROBO_RS30X_PACKET_MAX_BYTES];
    grobo_rs30x_goal goals[GROBO_JOINTS_MAX];
    size_t n = 0;
    for (int j = 0; j < N; j++) {
        if ((of & GROBO_JOINT_BIT(j)) != 0) {
            double deg = j - 20 + way_deg * (j == doubled_goal ? 2 : 1);
            goals[n++] = (grobo_rs30x_goal){(uint8_t)(j + 1), (int16_t)lround(deg * 10),
                                            (uint16_t)(time_us / 10000)};
        }
    }
    int size = n == 1 ? grobo_rs30x_write_goal(goals, packet, sizeof packet)
                      : grobo_rs30x_write_goals(goals, n, packet, sizeof packet);
    expect_packet(packet, size);
}

void expect_torque(int joint, grobo_torque torque)
{
    uint8_t packet[GROBO_RS30X_PACKET_MAX_BYTES];
    expect_packet(packet,
                  grobo_rs30x_write_u8((uint8_t)(joint + 1), GROBO_RS30X_WANT_NOTHING,
                                       GROBO_RS30X_TORQUE, (uint8_t)torque, packet, sizeof packet));
}

void note_goal(int joint, double way_deg, int64_t time_us)
{
    grobo_robot_axis *axis = &before[joint];
    axis->trajectory = (grobo_robot_trajectory){here_rad(joint), here_rad(joint) + RAD(way_deg),
                                                NOW, NOW + time_us};
    axis->own_until_us = 0;
    axis->phase = GROBO_I_JOINT_SENT;
    axis->told_us = NOW;
    axis->last = NUMBER;
    axis->next = 0;
}
