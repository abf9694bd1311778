/* SPDX-License-Identifier: MIT */
/* DYNAMIXEL AX, protocol 1, and Feetech STS, which has the same frame: reference dynamixel1 and
 * feetech. A goal switches torque on in both: forums say so of AX, feetech-cli measured it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/far_side.h"

enum {
    PING = 1,
    READ = 2,
    WRITE = 3,
    SYNC_READ = 0x82,
    SYNC_WRITE = 0x83,
    ALL = 254,
    OVER_BYTES = 6,
    STS_MIDDLE = 2048,
    AX_MIDDLE = 512,
    SIGN = 0x8000
};

#define STS_STEP_DEG (360.0 / 4096)
#define AX_STEP_DEG (300.0 / 1023)
#define AX_SPEED_DPS (0.111 * 6)
#define STS_ACCEL_DPS2 (100 * STS_STEP_DEG)

/* Where the registers are in which the two differ. */
typedef struct layout {
    int goal, torque, speed;
} layout;

static const layout ax = {30, 24, 32};
static const layout sts = {42, 40, 46};

static const layout *layout_of(const far_family *family)
{
    return family == &far_sts ? &sts : &ax;
}

static uint8_t sum_of(const uint8_t *bytes, int n)
{
    unsigned sum = 0;
    for (int i = 0; i < n; i++) {
        sum += bytes[i];
    }
    return (uint8_t)~sum;
}

/* Sign and magnitude. */
static int signed_of(int value)
{
    return (value & SIGN) != 0 ? -(value & ~SIGN) : value;
}

static int with_sign(int value)
{
    return value < 0 ? SIGN | -value : value;
}

/* ---- what is in their registers -------------------------------------------------------------- */

static void begin_ax(far_joint *joint)
{
    memset(joint->reg, 0, sizeof joint->reg);
    far_put16(joint->reg, 12);
    joint->reg[2] = 24;
    joint->reg[3] = (uint8_t)joint->id;
    joint->reg[4] = 1;
    far_put16(joint->reg + 8, 1023);
    joint->reg[11] = 70;
    joint->reg[12] = 60;
    joint->reg[13] = 140;
    far_put16(joint->reg + 14, 1023);
    joint->reg[16] = 2;
    joint->reg[18] = 36;
    far_put16(joint->reg + 34, 1023);
    far_put16(joint->reg + ax.goal, AX_MIDDLE);
}

static void begin_sts(far_joint *joint)
{
    memset(joint->reg, 0, sizeof joint->reg);
    joint->reg[0] = 3;
    joint->reg[1] = 9;
    far_put16(joint->reg + 3, 777);
    joint->reg[5] = (uint8_t)joint->id;
    joint->reg[8] = 1;
    far_put16(joint->reg + 11, 4095);
    joint->reg[13] = 70;
    joint->reg[14] = 80;
    joint->reg[15] = 40;
    far_put16(joint->reg + 16, 1000);
    joint->reg[18] = 12;
    joint->reg[19] = 44;
    far_put16(joint->reg + 28, 500);
    joint->reg[30] = 1;
    far_put16(joint->reg + sts.goal, STS_MIDDLE);
    far_put16(joint->reg + 48, 1000);
    joint->reg[55] = 1;
}

static void plan_ax(const far_joint *joint, double *goal_deg, double *cruise_dps,
                    double *accel_dps2)
{
    *goal_deg = (far_get16(joint->reg + ax.goal) - AX_MIDDLE) * AX_STEP_DEG;
    *cruise_dps = (far_get16(joint->reg + ax.speed) & 0x3FF) * AX_SPEED_DPS;
    *accel_dps2 = 0;
}

static void plan_sts(const far_joint *joint, double *goal_deg, double *cruise_dps,
                     double *accel_dps2)
{
    *goal_deg = (signed_of(far_get16(joint->reg + sts.goal)) - STS_MIDDLE) * STS_STEP_DEG;
    *cruise_dps = abs(signed_of(far_get16(joint->reg + sts.speed))) * STS_STEP_DEG;
    *accel_dps2 = joint->reg[41] * STS_ACCEL_DPS2;
}

static void hold_ax(far_joint *joint, double deg, double dps, int64_t now_us)
{
    (void)now_us;
    joint->reg[ax.torque] = (uint8_t)joint->torque;
    far_put16(joint->reg + ax.goal, (int)lround(deg / AX_STEP_DEG) + AX_MIDDLE);
    far_put16(joint->reg + ax.speed, (int)ceil(dps / AX_SPEED_DPS));
}

static void hold_sts(far_joint *joint, double deg, double dps, int64_t now_us)
{
    (void)now_us;
    joint->reg[sts.torque] = (uint8_t)joint->torque;
    far_put16(joint->reg + sts.goal, with_sign((int)lround(deg / STS_STEP_DEG) + STS_MIDDLE));
    far_put16(joint->reg + sts.speed, (int)ceil(dps / STS_STEP_DEG));
}

static void refresh_ax(far_joint *joint)
{
    int speed = (int)lround(fabs(joint->dps) / AX_SPEED_DPS);
    far_put16(joint->reg + 36, (int)lround(joint->at_deg / AX_STEP_DEG) + AX_MIDDLE);
    far_put16(joint->reg + 38, joint->dps < 0 ? 0x400 | speed : speed);
    far_put16(joint->reg + 40, joint->dps != 0 ? 100 : 10);
    joint->reg[42] = 120;
    joint->reg[43] = (uint8_t)joint->celsius;
    joint->reg[46] = joint->dps != 0;
}

static void refresh_sts(far_joint *joint)
{
    far_put16(joint->reg + 56, with_sign((int)lround(joint->at_deg / STS_STEP_DEG) + STS_MIDDLE));
    far_put16(joint->reg + 58, with_sign((int)lround(joint->dps / STS_STEP_DEG)));
    far_put16(joint->reg + 60, 0);
    joint->reg[62] = 74;
    joint->reg[63] = (uint8_t)joint->celsius;
    joint->reg[66] = joint->dps != 0;
    far_put16(joint->reg + 69, joint->dps != 0 ? 20 : 2);
    far_put16(joint->reg + 71, far_get16(joint->reg + sts.goal));
}

/* ---- instructions ---------------------------------------------------------------------------- */

static void write(far_side *far, far_joint *joint, int at, const uint8_t *data, int n)
{
    const layout *where = layout_of(far->family);
    if (joint == NULL || joint->deaf || at + n > FAR_REGISTERS) {
        return;
    }
    far_turn_to(joint, far->now_us);
    memcpy(joint->reg + at, data, (size_t)n);
    bool goal = at <= where->goal && where->goal + 2 <= at + n;
    if (at <= where->torque && where->torque < at + n) {
        far_torque(far, joint, joint->reg[where->torque] != 0);
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
    uint8_t back[FAR_FRAME_BYTES] = {0xFF, 0xFF, (uint8_t)joint->id, (uint8_t)(n + 2), 0};
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
    if (far->family == &far_sts) {
        refresh_sts(joint);
    } else {
        refresh_ax(joint);
    }
    status(far, joint, joint->reg + at, n);
}

static int measure(const uint8_t *bytes, int n)
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

static bool sound(const uint8_t *frame, int n)
{
    return sum_of(frame + 2, n - 3) == frame[n - 1];
}

static bool moves(const layout *where, const uint8_t *frame, int n)
{
    if (frame[4] != WRITE && frame[4] != SYNC_WRITE) {
        return false;
    }
    int at = frame[5], bytes = frame[4] == WRITE ? n - 7 : frame[6];
    return (at <= where->torque && where->torque < at + bytes) ||
           (at <= where->goal && where->goal < at + bytes);
}

static bool moves_ax(const uint8_t *frame, int n)
{
    return moves(&ax, frame, n);
}

static bool moves_sts(const uint8_t *frame, int n)
{
    return moves(&sts, frame, n);
}

static void obey_all(far_side *far, const uint8_t *frame, int n)
{
    int at = frame[5], bytes = frame[6];
    for (int k = 7; frame[4] == SYNC_WRITE && k + bytes < n - 1; k += bytes + 1) {
        write(far, far_find(far, frame[k]), at, frame + k + 1, bytes);
    }
    for (int k = 7; frame[4] == SYNC_READ && far->family == &far_sts && k < n - 1; k++) {
        read(far, far_find(far, frame[k]), at, bytes);
    }
}

static void obey(far_side *far, const uint8_t *frame, int n)
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

#define COMMON                                                                                     \
    .baud_bps = 1000000, .bits_a_byte = 10, .dead_us = 2000, .think_us = 60, .measure = measure,   \
    .sound = sound, .obey = obey

const far_family far_dxl1 = {COMMON,
                             .name = "dxl1",
                             .top_dps = 354,
                             .step_deg = AX_STEP_DEG,
                             .count_dps = AX_SPEED_DPS,
                             .moves = moves_ax,
                             .begin = begin_ax,
                             .plan = plan_ax,
                             .hold = hold_ax};
const far_family far_sts = {COMMON,
                            .name = "sts",
                            .top_dps = 300,
                            .step_deg = STS_STEP_DEG,
                            .count_dps = STS_STEP_DEG,
                            .moves = moves_sts,
                            .begin = begin_sts,
                            .plan = plan_sts,
                            .hold = hold_sts};
