/* SPDX-License-Identifier: MIT */
#include <stdint.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/raw_frames.h"
#include "tests/support/test.h"

static struct {
    uint8_t bytes[GROBO_RS30X_PACKET_MAX_BYTES];
    size_t size;
} packet;

static uint8_t motor_of(const grobo_test_rig *rig, int joint)
{
    return rig->driver->model->joints[joint].motor;
}

static void remember(int size)
{
    assert_true(size > 0);
    packet.size = (size_t)size;
}

/* Asks for the packet just built. */
static int ask(grobo_test_rig *rig, int size)
{
    uint8_t frame[GROBO_FRAME_MAX_BYTES];
    remember(size);
    int n = grobo_frame_wrap(rig->driver->protocol, packet.bytes, packet.size, frame, sizeof frame);
    assert_true(n > 0);
    return grobo_robot_raw(&rig->robot, frame, (size_t)n);
}

int raw_goal(grobo_test_rig *rig, int joint, double deg, int time_ms)
{
    const grobo_rs30x_goal goal = {motor_of(rig, joint), (int16_t)(deg * 10),
                                   (uint16_t)(time_ms / 10)};
    return ask(rig, grobo_rs30x_write_goal(&goal, packet.bytes, sizeof packet.bytes));
}

int raw_goal_with_ack(grobo_test_rig *rig, int joint, double deg, int time_ms)
{
    int ddeg = (int)(deg * 10);
    int units = time_ms / 10;
    const uint8_t data[] = {(uint8_t)ddeg, (uint8_t)(ddeg >> 8), (uint8_t)units,
                            (uint8_t)(units >> 8)};
    const grobo_rs30x_packet goal = {.kind = GROBO_RS30X_SHORT,
                                     .id = motor_of(rig, joint),
                                     .flags = GROBO_RS30X_WANT_ACK,
                                     .address = GROBO_RS30X_GOAL,
                                     .length = 4,
                                     .count = 1,
                                     .data = data,
                                     .data_bytes = 4};
    return ask(rig, grobo_rs30x_build(&goal, packet.bytes, sizeof packet.bytes));
}

int raw_torque(grobo_test_rig *rig, int joint, grobo_torque torque)
{
    return ask(rig, grobo_rs30x_write_u8(motor_of(rig, joint), GROBO_RS30X_WANT_NOTHING,
                                         GROBO_RS30X_TORQUE, (uint8_t)torque, packet.bytes,
                                         sizeof packet.bytes));
}

int raw_reboot(grobo_test_rig *rig, int joint)
{
    remember(grobo_rs30x_control(motor_of(rig, joint), GROBO_RS30X_REBOOT, packet.bytes,
                                 sizeof packet.bytes));
    return grobo_robot_command(&rig->robot, motor_of(rig, joint), GROBO_SERVO_REBOOT);
}

int raw_cw_limit(grobo_test_rig *rig, int joint, int deg)
{
    int ddeg = deg * 10;
    const uint8_t data[2] = {(uint8_t)ddeg, (uint8_t)(ddeg >> 8)};
    const grobo_register_io io = {motor_of(rig, joint), GROBO_RS30X_CW_LIMIT, 2, data};
    remember(grobo_rs30x_write_u16(io.id, GROBO_RS30X_WANT_ACK, (uint8_t)io.address, (uint16_t)ddeg,
                                   packet.bytes, sizeof packet.bytes));
    return grobo_robot_registers(&rig->robot, &io);
}

size_t raw_times_sent(const grobo_test_rig *rig)
{
    size_t n = 0;
    for (size_t i = 0; i < rig->n_sent; i++) {
        const uint8_t *sent;
        n += rig_packet(&rig->sent[i], &sent) == packet.size &&
             memcmp(sent, packet.bytes, packet.size) == 0;
    }
    return n;
}
