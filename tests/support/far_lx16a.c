/* SPDX-License-Identifier: MIT */
/* LewanSoul LX-16A: reference lx16a. Writes are not answered; a goal has a time, and wakes. */
#include <math.h>
#include <string.h>

#include "tests/support/far_side.h"

#define STEP_DEG 0.24

enum {
    MIDDLE = 500,
    MOVE = 1,
    MOVE_READ = 2,
    MOVE_STOP = 12,
    ID_READ = 14,
    OFFSET_READ = 19,
    LIMITS_READ = 21,
    VOLTS_READ = 23,
    HOT_READ = 25,
    HEAT_READ = 26,
    SUPPLY_READ = 27,
    POSITION_READ = 28,
    MODE_READ = 30,
    LOAD = 31,
    LOAD_READ = 32,
    ALL = 254,
    OVER_BYTES = 6,
    TIME_MAX_MS = 30000,
    AT_GOAL = 0, /* in reg: the last MOVE */
    AT_TIME = 2
};

static uint8_t sum_of(const uint8_t *bytes, int n)
{
    unsigned sum = 0;
    for (int i = 0; i < n; i++) {
        sum += bytes[i];
    }
    return (uint8_t)~sum;
}

static void begin(far_joint *joint)
{
    memset(joint->reg, 0, sizeof joint->reg);
    far_put16(joint->reg + AT_GOAL, MIDDLE);
}

static void plan(const far_joint *joint, double *goal_deg, double *cruise_dps, double *accel_dps2)
{
    int ms = far_get16(joint->reg + AT_TIME);
    *goal_deg = (far_get16(joint->reg + AT_GOAL) - MIDDLE) * STEP_DEG;
    *cruise_dps = ms > 0 ? fabs(*goal_deg - joint->set_deg) * 1000 / ms : 0;
    *accel_dps2 = 0;
}

static void hold(far_joint *joint, double deg, double dps, int64_t now_us)
{
    (void)now_us;
    far_put16(joint->reg + AT_GOAL, (int)lround(deg / STEP_DEG) + MIDDLE);
    double ms = dps > 0 ? fabs(deg - joint->set_deg) / dps * 1000 : 0;
    far_put16(joint->reg + AT_TIME, (int)lround(fmin(ms, TIME_MAX_MS)));
}

static int measure(const uint8_t *bytes, int n)
{
    if (bytes[0] != 0x55 || (n > 1 && bytes[1] != 0x55)) {
        return -1;
    }
    if (n < 4) {
        return 0;
    }
    int size = 3 + bytes[3];
    return size < OVER_BYTES || size >= FAR_FRAME_BYTES ? -1 : n < size ? 0 : size;
}

static bool sound(const uint8_t *frame, int n)
{
    return sum_of(frame + 2, n - 3) == frame[n - 1];
}

static bool moves(const uint8_t *frame, int n)
{
    (void)n;
    return frame[4] == MOVE || frame[4] == MOVE_STOP || frame[4] == LOAD;
}

static void answer(far_side *far, far_joint *joint, int command, int value, int n)
{
    uint8_t back[FAR_REPLY_BYTES] = {0x55, 0x55, (uint8_t)joint->id, (uint8_t)(n + 3),
                                     (uint8_t)command};
    back[5] = (uint8_t)((unsigned)value & 0xFF);
    for (int i = 1; i < n; i++) {
        back[5 + i] = (uint8_t)((unsigned)value >> (8 * i) & 0xFF);
    }
    back[5 + n] = sum_of(back + 2, n + 3);
    far_answer(far, command == POSITION_READ ? joint : NULL, back, OVER_BYTES + n);
}

static void answer_read(far_side *far, far_joint *joint, int command)
{
    far_turn_to(joint, far->now_us);
    int position = (int)lround(joint->at_deg / STEP_DEG) + MIDDLE;
    const struct {
        int command, value, n;
    } values[] = {{MOVE_READ,
                   far_get16(joint->reg) | (int)((unsigned)far_get16(joint->reg + AT_TIME) << 16),
                   4},
                  {ID_READ, joint->id, 1},
                  {OFFSET_READ, 0, 1},
                  {LIMITS_READ, 1000 << 16, 4},
                  {VOLTS_READ, 4500 | 12000 << 16, 4},
                  {HOT_READ, 85, 1},
                  {HEAT_READ, joint->celsius, 1},
                  {SUPPLY_READ, 7400, 2},
                  {POSITION_READ, position & 0xFFFF, 2},
                  {MODE_READ, 0, 4},
                  {LOAD_READ, joint->torque == 1, 1}};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        if (values[i].command == command) {
            answer(far, joint, command, values[i].value, values[i].n);
        }
    }
}

static void take_move(far_side *far, far_joint *joint, const uint8_t *frame)
{
    far_turn_to(joint, far->now_us);
    memcpy(joint->reg + AT_GOAL, frame + 5, 4);
    if (joint->torque != 1) {
        far_torque(far, joint, 1);
        joint->leaps = false;
    }
    far_goal(far, joint);
}

static void take_stop(far_side *far, far_joint *joint)
{
    far_turn_to(joint, far->now_us);
    hold(joint, joint->at_deg, 0, far->now_us);
    far_goal(far, joint);
}

static void obey(far_side *far, const uint8_t *frame, int n)
{
    for (int i = 0; i < far->n_joints; i++) {
        far_joint *joint = &far->joint[i];
        bool deaf = joint->deaf && moves(frame, n);
        if ((frame[2] != joint->id && frame[2] != ALL) || deaf) {
            continue;
        }
        if (frame[4] == MOVE && n == OVER_BYTES + 4) {
            take_move(far, joint, frame);
        } else if (frame[4] == MOVE_STOP) {
            take_stop(far, joint);
        } else if (frame[4] == LOAD) {
            far_torque(far, joint, frame[5] != 0);
        } else if (n == OVER_BYTES && frame[2] != ALL) {
            answer_read(far, joint, frame[4]);
        }
    }
}

const far_family far_lx16a = {.name = "lx16a",
                              .loop = {25, 0.35, 0.4, 8, 2.5},
                              .baud_bps = 115200,
                              .bits_a_byte = 10,
                              .dead_us = 2000,
                              .think_us = 400,
                              .top_dps = 375,
                              .step_deg = STEP_DEG,
                              .measure = measure,
                              .sound = sound,
                              .moves = moves,
                              .obey = obey,
                              .begin = begin,
                              .plan = plan,
                              .hold = hold};
