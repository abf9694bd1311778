/* SPDX-License-Identifier: MIT */
/* Futaba RS30x on a bus, and behind the board of GR001: protocol 2 to 5. */
#include <math.h>
#include <string.h>

#include "tests/support/far_side.h"

enum {
    HEAD_BYTES = 7, /* FA AF id flags address length count */
    OVER_BYTES = 8,
    AT_ID = 4,
    AT_GOAL = 30,
    AT_TIME = 32,
    AT_TORQUE = 36,
    AT_POSITION = 42,
    AT_SINCE = 44,
    AT_SPEED = 46,
    AT_CURRENT = 48,
    AT_HEAT = 50,
    AT_SUPPLY = 52,
    BOARD_CHECK = 0x41,
    BOARD_SEND = 0x53,
    BOARD_ASK = 0x54
};

static uint8_t sum_of(const uint8_t *bytes, int n)
{
    uint8_t sum = 0;
    for (int i = 0; i < n; i++) {
        sum ^= bytes[i];
    }
    return sum;
}

static void begin(far_joint *joint)
{
    memset(joint->reg, 0, sizeof joint->reg);
    far_put16(joint->reg, 0x3020);
    joint->reg[2] = 3;
    joint->reg[AT_ID] = (uint8_t)joint->id;
    joint->reg[6] = 7;
    far_put16(joint->reg + 8, 1500);
    far_put16(joint->reg + 10, -1500);
    joint->reg[14] = 80;
    joint->reg[35] = 100;
}

static void plan(const far_joint *joint, double *goal_deg, double *cruise_dps, double *accel_dps2)
{
    int cs = far_get16(joint->reg + AT_TIME);
    *goal_deg = far_signed16(joint->reg + AT_GOAL) / 10.0;
    *cruise_dps = cs > 0 ? fabs(*goal_deg - joint->set_deg) * 100 / cs : 0;
    *accel_dps2 = 0;
}

static void hold(far_joint *joint, double deg, double dps, int64_t now_us)
{
    (void)now_us;
    far_put16(joint->reg + AT_GOAL, (int)lround(deg * 10));
    far_put16(joint->reg + AT_TIME,
              dps > 0 ? (int)lround(fabs(deg - joint->set_deg) / dps * 100) : 0);
    joint->reg[AT_TORQUE] = (uint8_t)joint->torque;
}

static void refresh(far_joint *joint, int64_t now_us)
{
    int64_t since_us = now_us - joint->begun_us, time_us = far_get16(joint->reg + AT_TIME) * 10000;
    since_us = since_us < time_us ? since_us : time_us; /* wherever its goal is */
    far_put16(joint->reg + AT_POSITION, (int)lround(joint->at_deg * 10));
    far_put16(joint->reg + AT_SINCE, (int)(since_us / 10000));
    far_put16(joint->reg + AT_SPEED, (int)lround(fabs(joint->dps)));
    far_put16(joint->reg + AT_CURRENT, far_is_moving(joint) ? 120 : 20);
    far_put16(joint->reg + AT_HEAT, joint->celsius);
    far_put16(joint->reg + AT_SUPPLY, 740);
}

static void write(far_side *far, far_joint *joint, int at, const uint8_t *data, int n)
{
    if (joint == NULL || joint->deaf || at + n > FAR_REGISTERS) {
        return;
    }
    far_turn_to(joint, far->now_us);
    memcpy(joint->reg + at, data, (size_t)n);
    if (at <= AT_TORQUE && AT_TORQUE < at + n) {
        far_torque(far, joint, joint->reg[AT_TORQUE] > 2 ? 1 : joint->reg[AT_TORQUE]);
    }
    if (at <= AT_GOAL && AT_GOAL + 2 <= at + n) {
        far_goal(far, joint);
    }
}

/* Low nibble of the flags: what comes back. */
static void answer(far_side *far, far_joint *joint, const uint8_t *packet, int most)
{
    static const struct {
        int at, n;
    } blocks[16] = {[3] = {0, 30}, [5] = {30, 30}, [7] = {20, 10}, [9] = {42, 18}, [11] = {30, 12}};
    uint8_t back[FAR_REPLY_BYTES] = {0xFD, 0xDF, (uint8_t)joint->id};
    int kind = packet[3] & 15, at = blocks[kind].at, n = blocks[kind].n;
    if (kind == 1) {
        far_answer(far, NULL, (const uint8_t[]){7}, 1);
        return;
    }
    if (kind == 15) {
        at = packet[4];
        n = packet[5];
    }
    if (n == 0 || at + n > FAR_REGISTERS) {
        return;
    }
    far_turn_to(joint, far->now_us);
    refresh(joint, far->now_us);
    back[4] = (uint8_t)at;
    back[5] = (uint8_t)n;
    back[6] = 1;
    memcpy(back + HEAD_BYTES, joint->reg + at, (size_t)n);
    back[HEAD_BYTES + n] = sum_of(back + 2, n + HEAD_BYTES - 2);
    bool tells = at <= AT_POSITION && AT_POSITION + 2 <= at + n;
    far_answer(far, tells ? joint : NULL, back, OVER_BYTES + n < most ? OVER_BYTES + n : most);
}

static void obey_packet(far_side *far, const uint8_t *packet, int most)
{
    int id = packet[2], at = packet[4], n = packet[5], count = packet[6];
    if (id == 0) {
        for (int k = 0; k < count; k++) {
            const uint8_t *each = packet + HEAD_BYTES + k * n;
            write(far, far_find(far, each[0]), at, each + 1, n - 1);
        }
        return;
    }
    for (int i = 0; i < far->n_joints; i++) {
        if ((id == 255 || far->joint[i].id == id) && count == 1) {
            write(far, &far->joint[i], at, packet + HEAD_BYTES, n);
        }
    }
    far_joint *joint = far_find(far, id);
    if (joint != NULL && most > 0 && (packet[3] & 15) != 0) {
        answer(far, joint, packet, most);
    }
}

static bool moves_packet(const uint8_t *packet)
{
    int at = packet[4], n = packet[5] - (packet[2] == 0);
    return packet[6] > 0 && n > 0 && at <= AT_TORQUE && at + n > AT_GOAL;
}

static bool sound_packet(const uint8_t *packet, int n)
{
    return n >= OVER_BYTES && n == OVER_BYTES + packet[5] * packet[6] &&
           sum_of(packet + 2, n - 3) == packet[n - 1];
}

/* ---- on a bus -------------------------------------------------------------------------------- */

static int measure_bus(const uint8_t *bytes, int n)
{
    if (bytes[0] != 0xFA || (n > 1 && bytes[1] != 0xAF)) {
        return -1;
    }
    if (n < HEAD_BYTES) {
        return 0;
    }
    int size = OVER_BYTES + bytes[5] * bytes[6];
    return size >= FAR_FRAME_BYTES ? -1 : n < size ? 0 : size;
}

static void obey_bus(far_side *far, const uint8_t *frame, int n)
{
    (void)n;
    obey_packet(far, frame, FAR_REPLY_BYTES);
}

static bool moves_bus(const uint8_t *frame, int n)
{
    (void)n;
    return moves_packet(frame);
}

/* ---- behind the board, which stores and forwards --------------------------------------------- */

static int measure_board(const uint8_t *bytes, int n)
{
    if (bytes[0] != BOARD_CHECK && bytes[0] != BOARD_SEND && bytes[0] != BOARD_ASK) {
        return -1;
    }
    int size = n < 2 ? 2 : bytes[0] == BOARD_CHECK ? 2 : 2 + bytes[1];
    return n < size ? 0 : size;
}

/* Bytes of the packet in a frame that relays one. */
static int relayed(const uint8_t *frame, int n)
{
    return n - 2 - (frame[0] == BOARD_ASK);
}

static bool sound_board(const uint8_t *frame, int n)
{
    return frame[0] == BOARD_CHECK || sound_packet(frame + 2, relayed(frame, n));
}

static bool moves_board(const uint8_t *frame, int n)
{
    return frame[0] != BOARD_CHECK && n > 2 + HEAD_BYTES && moves_packet(frame + 2);
}

static int64_t relay_us(const far_side *far, const uint8_t *frame, int n)
{
    return frame[0] == BOARD_CHECK ? 0 : far_wire_us(far, relayed(frame, n));
}

/* A reply takes the way of the packet back. */
static void obey_board(far_side *far, const uint8_t *frame, int n)
{
    int before = far->n_replies;
    if (frame[0] == BOARD_CHECK) {
        far_answer(far, NULL, (const uint8_t[]){7}, 1);
        return;
    }
    obey_packet(far, frame + 2, frame[0] == BOARD_ASK ? frame[n - 1] : 0);
    if (far->n_replies > before) {
        far_reply *reply = &far->reply[far->n_replies - 1];
        reply->due_us += far_wire_us(far, reply->n);
    }
}

#define COMMON                                                                                     \
    .baud_bps = 115200, .bits_a_byte = 10, .dead_us = 2000, .think_us = 100, .top_dps = 450,       \
    .step_deg = 0.1, .loop = {30, 0.5, 0.4, 8, 2.5}, .begin = begin, .plan = plan, .hold = hold

const far_family far_bus = {COMMON,
                            .name = "bus",
                            .measure = measure_bus,
                            .sound = sound_packet,
                            .moves = moves_bus,
                            .obey = obey_bus};
const far_family far_board = {COMMON,
                              .name = "board",
                              .measure = measure_board,
                              .sound = sound_board,
                              .moves = moves_board,
                              .obey = obey_board,
                              .relay_us = relay_us};
