/* SPDX-License-Identifier: MIT */
/*
 * DYNAMIXEL X, protocol 2: reference dynamixel2, 2 to 10. Time-based profiles (drive mode 4). And
 * XL-320: the same frames, the table of its page in ROBOTIS' e-manual (docs/en/dxl/x/xl320.md):
 * 1024 steps over 300 degrees, a moving speed in units of 0.111 rpm, no profiles, no watchdog.
 */
#include <math.h>
#include <string.h>

#include "tests/support/far_side.h"

#define STEP_DEG (360.0 / 4096)
#define SPEED_DPS (0.229 * 6)

enum {
    MIDDLE = 2048,
    AT_ID = 7,
    AT_DRIVE = 10,
    AT_MODE = 11,
    AT_TORQUE = 64,
    AT_WATCHDOG = 98,
    AT_VELOCITY = 104,
    AT_RAMP = 108,
    AT_TIME = 112,
    AT_GOAL = 116,
    AT_MOVING = 122,
    AT_LOAD = 126,
    AT_SPEED = 128,
    AT_POSITION = 132,
    AT_SUPPLY = 144,
    AT_HEAT = 146,
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

#define XL320_STEP_DEG (300.0 / 1024)
#define XL320_SPEED_DPS (0.111 * 6)

enum {
    XL320_MIDDLE = 512,
    XL320_TORQUE = 24,
    XL320_GOAL = 30,
    XL320_SPEED = 32,
    XL320_POSITION = 37,
    XL320_SENSE = 1024 /* of a speed that is read: clockwise */
};

/* Where a servo's torque and goal are. */
typedef struct layout {
    int torque, goal, goal_bytes;
} layout;

static const layout x_series = {AT_TORQUE, AT_GOAL, 4}, xl320 = {XL320_TORQUE, XL320_GOAL, 2};

static const layout *layout_of(const far_family *family)
{
    return family == &far_xl320 ? &xl320 : &x_series;
}

static void put32(uint8_t *to, int32_t value)
{
    far_put16(to, (int)((uint32_t)value & 0xFFFF));
    far_put16(to + 2, (int)((uint32_t)value >> 16));
}

static int32_t get32(const uint8_t *from)
{
    return (int32_t)((uint32_t)far_get16(from) | (uint32_t)far_get16(from + 2) << 16);
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

static void begin(far_joint *joint)
{
    memset(joint->reg, 0, sizeof joint->reg);
    far_put16(joint->reg, 1060); /* XL430-W250 */
    joint->reg[6] = 45;
    joint->reg[AT_ID] = (uint8_t)joint->id;
    joint->reg[8] = 3;
    joint->reg[AT_DRIVE] = 4;
    joint->reg[AT_MODE] = 3;
    joint->reg[12] = 255;
    joint->reg[13] = 2;
    joint->reg[31] = 72;
    far_put16(joint->reg + 32, 140);
    far_put16(joint->reg + 34, 60);
    far_put16(joint->reg + 36, 885);
    put32(joint->reg + 44, 265);
    put32(joint->reg + 48, 4095);
    joint->reg[63] = 52;
    joint->reg[68] = 2;
    far_put16(joint->reg + 100, 885);
    put32(joint->reg + AT_GOAL, MIDDLE);
}

static void plan(const far_joint *joint, double *goal_deg, double *cruise_dps, double *accel_dps2)
{
    int32_t ms = get32(joint->reg + AT_TIME);
    *goal_deg = (get32(joint->reg + AT_GOAL) - MIDDLE) * STEP_DEG;
    *cruise_dps = ms > 0 ? fabs(*goal_deg - joint->at_deg) * 1000 / ms : 0;
    *accel_dps2 = 0;
}

static void hold(far_joint *joint, double deg, double dps, int64_t now_us)
{
    joint->reg[AT_TORQUE] = (uint8_t)joint->torque;
    joint->heard_us = now_us;
    put32(joint->reg + AT_GOAL, (int32_t)lround(deg / STEP_DEG) + MIDDLE);
    put32(joint->reg + AT_TIME,
          dps > 0 ? (int32_t)lround(fabs(deg - joint->at_deg) / dps * 1000) : 0);
}

/* Nothing was said to it for so long: it stops and takes no goal. */
static void watch(far_joint *joint, int64_t now_us)
{
    int64_t bound_us = joint->reg[AT_WATCHDOG] * INT64_C(20000);
    int64_t ends_us = joint->heard_us + bound_us;
    if (joint->reg[AT_WATCHDOG] != 0 && joint->reg[AT_WATCHDOG] != WATCHDOG_OVER &&
        joint->torque == 1 && ends_us < now_us) {
        far_turn_to(joint, ends_us);
        joint->waits = false;
        joint->dps = 0;
        joint->goal_deg = joint->at_deg;
        put32(joint->reg + AT_RAMP, 0);
        put32(joint->reg + AT_TIME, 0);
        put32(joint->reg + AT_VELOCITY, 0);
        joint->wheel_dps = 0;
        joint->reg[AT_WATCHDOG] = WATCHDOG_OVER;
    }
}

static void begin_xl320(far_joint *joint)
{
    memset(joint->reg, 0, sizeof joint->reg);
    far_put16(joint->reg, 350);
    joint->reg[2] = 29;
    joint->reg[3] = (uint8_t)joint->id;
    joint->reg[4] = 3;
    far_put16(joint->reg + 8, 1023);
    joint->reg[11] = 2;
    joint->reg[12] = 65;
    joint->reg[13] = 60;
    joint->reg[14] = 90;
    far_put16(joint->reg + 15, 1023);
    joint->reg[17] = 2;
    joint->reg[18] = 3;
    joint->reg[29] = 32;
    far_put16(joint->reg + XL320_GOAL, XL320_MIDDLE);
    far_put16(joint->reg + 35, 1023);
    far_put16(joint->reg + 51, 32);
}

/* Speed 0 is as fast as it can. */
static void plan_xl320(const far_joint *joint, double *goal_deg, double *cruise_dps,
                       double *accel_dps2)
{
    *goal_deg = (far_get16(joint->reg + XL320_GOAL) - XL320_MIDDLE) * XL320_STEP_DEG;
    *cruise_dps = far_get16(joint->reg + XL320_SPEED) * XL320_SPEED_DPS;
    *accel_dps2 = 0;
}

static void hold_xl320(far_joint *joint, double deg, double dps, int64_t now_us)
{
    (void)now_us;
    joint->reg[XL320_TORQUE] = (uint8_t)joint->torque;
    far_put16(joint->reg + XL320_GOAL, (int)lround(deg / XL320_STEP_DEG) + XL320_MIDDLE);
    far_put16(joint->reg + XL320_SPEED, (int)ceil(dps / XL320_SPEED_DPS));
}

static void refresh_xl320(far_joint *joint)
{
    int speed = (int)lround(fabs(joint->dps) / XL320_SPEED_DPS);
    int position = (int)lround(joint->at_deg / XL320_STEP_DEG) + XL320_MIDDLE;
    far_put16(joint->reg + XL320_POSITION, position);
    far_put16(joint->reg + 39, joint->dps < 0 ? speed | XL320_SENSE : speed);
    far_put16(joint->reg + 41, joint->dps != 0 ? 100 : 5);
    joint->reg[45] = 74;
    joint->reg[46] = (uint8_t)joint->celsius;
    joint->reg[49] = joint->dps != 0;
}

static void refresh_x(far_joint *joint)
{
    put32(joint->reg + AT_POSITION, (int32_t)lround(joint->at_deg / STEP_DEG) + MIDDLE);
    put32(joint->reg + 140, get32(joint->reg + AT_POSITION));
    put32(joint->reg + AT_SPEED, (int32_t)lround(joint->dps / SPEED_DPS));
    far_put16(joint->reg + AT_LOAD, joint->dps != 0 ? 100 : 5);
    joint->reg[AT_MOVING] = joint->dps != 0;
    far_put16(joint->reg + AT_SUPPLY, 120);
    joint->reg[AT_HEAT] = (uint8_t)joint->celsius;
}

static void refresh(far_joint *joint)
{
    if (joint->family == &far_xl320) {
        refresh_xl320(joint);
    } else {
        refresh_x(joint);
    }
}

/* The error of the status. */
static int write(far_side *far, far_joint *joint, int at, const uint8_t *data, int n)
{
    if (joint == NULL || at + n > FAR_REGISTERS) {
        return ERROR_RANGE;
    }
    far_turn_to(joint, far->now_us);
    joint->heard_us = far->now_us;
    const layout *its = layout_of(joint->family);
    bool goal = at <= its->goal && its->goal + its->goal_bytes <= at + n;
    if (joint->deaf) {
        return 0;
    }
    bool velocity = at <= AT_VELOCITY && AT_VELOCITY + 4 <= at + n, is_x = its == &x_series;
    if (is_x && (goal || velocity) && joint->reg[AT_WATCHDOG] == WATCHDOG_OVER) {
        return ERROR_RANGE;
    }
    memcpy(joint->reg + at, data, (size_t)n);
    joint->wheel = is_x && joint->reg[AT_MODE] == 1; /* velocity control (emanual) */
    joint->wheel_dps = get32(joint->reg + AT_VELOCITY) * SPEED_DPS;
    if (at <= its->torque && its->torque < at + n) {
        far_torque(far, joint, joint->reg[its->torque] != 0);
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
    if (joint == NULL || at + n > FAR_REGISTERS) {
        return;
    }
    far_turn_to(joint, far->now_us);
    joint->heard_us = far->now_us;
    refresh(joint);
    status(far, joint, 0, joint->reg + at, n);
}

static int measure(const uint8_t *bytes, int n)
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

static bool sound(const uint8_t *frame, int n)
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

static bool moves_by(const layout *its, const uint8_t *frame, int n)
{
    uint8_t p[FAR_FRAME_BYTES];
    int size = take_out(frame, n, p), at = far_get16(p);
    if (frame[7] != WRITE && frame[7] != SYNC_WRITE) {
        return false;
    }
    int bytes = frame[7] == WRITE ? size - 2 : far_get16(p + 2);
    return (its == &x_series && at <= AT_VELOCITY && AT_VELOCITY < at + bytes) ||
           (at <= its->torque && its->torque < at + bytes) ||
           (at <= its->goal && its->goal < at + bytes);
}

static bool moves(const uint8_t *frame, int n)
{
    return moves_by(&x_series, frame, n);
}

static bool moves_xl320(const uint8_t *frame, int n)
{
    return moves_by(&xl320, frame, n);
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

static void obey(far_side *far, const uint8_t *frame, int n)
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

const far_family far_dxl2 = {.name = "dxl2",
                             .baud_bps = 1000000,
                             .bits_a_byte = 10,
                             .dead_us = 2000,
                             .think_us = 60,
                             .top_dps = 366,
                             .step_deg = STEP_DEG,
                             .measure = measure,
                             .sound = sound,
                             .moves = moves,
                             .obey = obey,
                             .begin = begin,
                             .plan = plan,
                             .hold = hold,
                             .watch = watch};

const far_family far_xl320 = {.name = "xl320",
                              .baud_bps = 1000000,
                              .bits_a_byte = 10,
                              .dead_us = 2000,
                              .think_us = 60,
                              .top_dps = 684,
                              .step_deg = XL320_STEP_DEG,
                              .count_dps = XL320_SPEED_DPS,
                              .measure = measure,
                              .sound = sound,
                              .moves = moves_xl320,
                              .obey = obey,
                              .begin = begin_xl320,
                              .plan = plan_xl320,
                              .hold = hold_xl320};
