/* SPDX-License-Identifier: MIT */
/* Frames of DYNAMIXEL protocol 2: reference dynamixel2, 2 to 10. What registers mean is in
 * far_dxl2_tables.c. */
#include <string.h>

#include "tests/support/far_dxl2.h"

enum {
    WATCHDOG_OVER = 0xFF,
    PING = 1,
    READ = 2,
    WRITE = 3,
    SYNC_READ = 0x82,
    SYNC_WRITE = 0x83,
    BULK_READ = 0x92,
    ALL = 254,
    ERROR_RANGE = 4
};

/* Where so many registers are kept, or -1. */
static int place_of(const far_dxl2_layout *its, int at, int n)
{
    for (int i = 0; i < FAR_DXL2_PARTS; i++) {
        const far_dxl2_part *part = &its->part[i];
        if (at >= part->from && at + n <= part->from + part->bytes) {
            return at - part->from + part->kept;
        }
    }
    return -1;
}

static bool has(int at, int n, const far_dxl2_field *field)
{
    return field->bytes > 0 && at <= field->at && field->at + field->bytes <= at + n;
}

static uint16_t crc_of(const uint8_t *bytes, int n)
{
    unsigned crc = 0;
    for (int i = 0; i < n; i++) {
        crc ^= (unsigned)bytes[i] << 8;
        for (int k = 0; k < 8; k++) {
            crc = (crc & 0x8000) != 0 ? crc << 1 ^ 0x8005 : crc << 1;
        }
    }
    return (uint16_t)crc;
}

/* The error of the status. */
static int write(far_side *far, far_joint *joint, int at, const uint8_t *data, int n)
{
    const far_dxl2_layout *its = far_dxl2_layout_of(far->family);
    int kept = place_of(its, at, n);
    if (joint == NULL || kept < 0) {
        return ERROR_RANGE;
    }
    far_turn_to(joint, far->now_us);
    joint->heard_us = far->now_us;
    bool goal = has(at, n, &its->goal);
    if (joint->deaf) {
        return 0;
    }
    if ((goal || has(at, n, &its->velocity)) && its->watchdog > 0 &&
        joint->reg[its->watchdog] == WATCHDOG_OVER) {
        return ERROR_RANGE;
    }
    memcpy(joint->reg + kept, data, (size_t)n);
    if (its->spin != NULL) {
        its->spin(joint);
    }
    if (has(at, n, &its->torque)) {
        far_torque(far, joint, joint->reg[place_of(its, its->torque.at, 1)] != 0);
    }
    if (goal) {
        far_goal(far, joint);
    }
    return 0;
}

static void status(far_side *far, far_joint *joint, int error, const uint8_t *data, int n)
{
    uint8_t back[FAR_REPLY_BYTES] = {0xFF, 0xFF, 0xFD, 0, (uint8_t)joint->id, 0, 0, 0x55};
    int size = 8;
    back[size++] = (uint8_t)error;
    for (int i = 0; i < n; i++) {
        back[size++] = data[i];
        if (back[size - 1] == 0xFD && back[size - 2] == 0xFF && back[size - 3] == 0xFF) {
            back[size++] = 0xFD;
        }
    }
    far_put16(back + 5, size - 7 + 2);
    far_put16(back + size, crc_of(back, size));
    far_answer(far, n > 3 ? joint : NULL, back, size + 2);
}

static void read(far_side *far, far_joint *joint, int at, int n)
{
    const far_dxl2_layout *its = far_dxl2_layout_of(far->family);
    int kept = place_of(its, at, n);
    if (joint == NULL || kept < 0) {
        return;
    }
    far_turn_to(joint, far->now_us);
    joint->heard_us = far->now_us;
    its->refresh(joint);
    status(far, joint, 0, joint->reg + kept, n);
}

int far_dxl2_measure(const uint8_t *bytes, int n)
{
    static const uint8_t head[] = {0xFF, 0xFF, 0xFD, 0};
    for (int i = 0; i < n && i < 4; i++) {
        if (bytes[i] != head[i]) {
            return -1;
        }
    }
    if (n < 7) {
        return 0;
    }
    int size = 7 + far_get16(bytes + 5);
    return size >= FAR_FRAME_BYTES || size < 10 ? -1 : n < size ? 0 : size;
}

bool far_dxl2_sound(const uint8_t *frame, int n)
{
    return crc_of(frame, n - 2) == far_get16(frame + n - 2);
}

/* The parameters without what was stuffed in. */
static int take_out(const uint8_t *frame, int n, uint8_t *to)
{
    int k = 0;
    for (int i = 8; i < n - 2; i++) {
        to[k++] = frame[i];
        bool stuffed = k >= 3 && to[k - 1] == 0xFD && to[k - 2] == 0xFF && to[k - 3] == 0xFF;
        i += stuffed && i + 1 < n - 2 && frame[i + 1] == 0xFD;
    }
    return k;
}

bool far_dxl2_moves(const far_dxl2_layout *its, const uint8_t *frame, int n)
{
    uint8_t p[FAR_FRAME_BYTES];
    int size = take_out(frame, n, p), at = far_get16(p);
    if (frame[7] != WRITE && frame[7] != SYNC_WRITE) {
        return false;
    }
    int bytes = frame[7] == WRITE ? size - 2 : far_get16(p + 2);
    return has(at, bytes, &its->velocity) || has(at, bytes, &its->torque) ||
           has(at, bytes, &its->goal);
}

static void obey_all(far_side *far, int instruction, const uint8_t *p, int n)
{
    int at = far_get16(p), bytes = far_get16(p + 2);
    for (int k = 4; instruction == SYNC_WRITE && k + bytes < n; k += bytes + 1) {
        (void)write(far, far_find(far, p[k]), at, p + k + 1, bytes);
    }
    for (int k = 4; instruction == SYNC_READ && k < n; k++) {
        read(far, far_find(far, p[k]), at, bytes);
    }
    for (int k = 0; instruction == BULK_READ && k + 5 <= n; k += 5) {
        read(far, far_find(far, p[k]), far_get16(p + k + 1), far_get16(p + k + 3));
    }
}

void far_dxl2_obey(far_side *far, const uint8_t *frame, int n)
{
    uint8_t p[FAR_FRAME_BYTES];
    int size = take_out(frame, n, p), id = frame[4], instruction = frame[7];
    far_joint *joint = far_find(far, id);
    if (id == ALL) {
        obey_all(far, instruction, p, size);
    } else if (joint != NULL && instruction == PING) {
        status(far, joint, 0, (const uint8_t[]){joint->reg[0], joint->reg[1], joint->reg[6]}, 3);
    } else if (joint != NULL && instruction == READ) {
        read(far, joint, far_get16(p), far_get16(p + 2));
    } else if (joint != NULL && instruction == WRITE) {
        status(far, joint, write(far, joint, far_get16(p), p + 2, size - 2), NULL, 0);
    }
}
