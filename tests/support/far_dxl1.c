/* SPDX-License-Identifier: MIT */
/* The frame of DYNAMIXEL protocol 1, of AX and MX, and of Feetech's STS and SCS: reference
 * dynamixel1 and feetech. A goal switches torque on in all: forums say so of AX and MX,
 * feetech-cli measured it. */
#include <string.h>

#include "tests/support/far_dxl1.h"

enum {
    PING = 1,
    READ = 2,
    WRITE = 3,
    SYNC_READ = 0x82,
    SYNC_WRITE = 0x83,
    BULK_READ = 0x92,
    ALL = 254,
    OVER_BYTES = 6
};

static uint8_t sum_of(const uint8_t *bytes, int n)
{
    unsigned sum = 0;
    for (int i = 0; i < n; i++) {
        sum += bytes[i];
    }
    return (uint8_t)~sum;
}

static void write(far_side *far, far_joint *joint, int at, const uint8_t *data, int n)
{
    const far_dxl1_layout *where = far_dxl1_layout_of(far->family);
    if (joint == NULL || joint->deaf || at + n > FAR_REGISTERS) {
        return;
    }
    far_turn_to(joint, far->now_us);
    memcpy(joint->reg + at, data, (size_t)n);
    bool goal = at <= where->goal && where->goal + 2 <= at + n;
    if (where->spin != NULL) {
        where->spin(joint);
    }
    if (at <= where->torque && where->torque < at + n) {
        far_torque(far, joint, joint->reg[where->torque] == 1);
    } else if (goal && joint->torque != 1) {
        joint->reg[where->torque] = 1;
        far_torque(far, joint, 1);
        joint->leaps = false;
    }
    if (goal) {
        far_goal(far, joint);
    }
}

static void status(far_side *far, far_joint *joint, const uint8_t *data, int n)
{
    uint8_t back[FAR_REPLY_BYTES] = {0xFF, 0xFF, (uint8_t)joint->id, (uint8_t)(n + 2), 0};
    memcpy(back + 5, data, (size_t)n);
    back[5 + n] = sum_of(back + 2, n + 3);
    far_answer(far, n > 2 ? joint : NULL, back, OVER_BYTES + n);
}

static void read(far_side *far, far_joint *joint, int at, int n)
{
    if (joint == NULL || at + n > FAR_REGISTERS) {
        return;
    }
    far_turn_to(joint, far->now_us);
    far_dxl1_layout_of(far->family)->refresh(joint);
    status(far, joint, joint->reg + at, n);
}

int far_dxl1_measure(const uint8_t *bytes, int n)
{
    if (bytes[0] != 0xFF || (n > 1 && bytes[1] != 0xFF)) {
        return -1;
    }
    if (n < 4) {
        return 0;
    }
    int size = 4 + bytes[3];
    return size < OVER_BYTES || size >= FAR_FRAME_BYTES ? -1 : n < size ? 0 : size;
}

bool far_dxl1_sound(const uint8_t *frame, int n)
{
    return sum_of(frame + 2, n - 3) == frame[n - 1];
}

bool far_dxl1_moves(const far_dxl1_layout *where, const uint8_t *frame, int n)
{
    if (frame[4] != WRITE && frame[4] != SYNC_WRITE) {
        return false;
    }
    int at = frame[5], bytes = frame[4] == WRITE ? n - 7 : frame[6];
    return (where->speed_at > 0 && at <= where->speed_at && where->speed_at < at + bytes) ||
           (at <= where->torque && where->torque < at + bytes) ||
           (at <= where->goal && where->goal < at + bytes);
}

static void obey_all(far_side *far, const uint8_t *frame, int n)
{
    const far_dxl1_layout *knows = far_dxl1_layout_of(far->family);
    int at = frame[5], bytes = frame[6];
    for (int k = 7; frame[4] == SYNC_WRITE && k + bytes < n - 1; k += bytes + 1) {
        write(far, far_find(far, frame[k]), at, frame + k + 1, bytes);
    }
    for (int k = 7; frame[4] == SYNC_READ && knows->sync_read && k < n - 1; k++) {
        read(far, far_find(far, frame[k]), at, bytes);
    }
    for (int k = 6; frame[4] == BULK_READ && knows->bulk_read && k + 3 < n; k += 3) {
        read(far, far_find(far, frame[k + 1]), frame[k + 2], frame[k]);
    }
}

void far_dxl1_obey(far_side *far, const uint8_t *frame, int n)
{
    far_joint *joint = far_find(far, frame[2]);
    if (frame[2] == ALL) {
        obey_all(far, frame, n);
    } else if (joint != NULL && frame[4] == PING) {
        status(far, joint, frame, 0);
    } else if (joint != NULL && frame[4] == READ) {
        read(far, joint, frame[5], frame[6]);
    } else if (joint != NULL && frame[4] == WRITE) {
        write(far, joint, frame[5], frame + 6, n - 7);
        status(far, joint, frame, 0);
    }
}
