/* SPDX-License-Identifier: MIT */
/* Kondo KRS of ICS 3.6: reference ics. A position is answered with where the shaft is, and 0 lets
 * go. The wire loops back, without parity here. */
#include <math.h>
#include <string.h>

#include "tests/support/far_side.h"

#define STEP_DEG (270.0 / 8000)
#define FULL_SPEED 127

enum {
    MIDDLE = 7500,
    POSITION = 0x80,
    READ = 0xA0,
    WRITE = 0xC0,
    SC_EEPROM = 0,
    SC_STRETCH = 1,
    SC_SPEED = 2,
    SC_CURRENT = 3,
    SC_HEAT = 4,
    SC_POSITION = 5,
    EEPROM_BYTES = 64,
    AT_SPEED = 100, /* kept in reg behind the EEPROM */
    AT_GOAL = 102,
    FLAG_FREE = 2
};

/* High nibble first; numbers of the manual begin at 1. */
static void put_nibbles(uint8_t *eeprom, int number, int value)
{
    eeprom[number - 1] = (uint8_t)(value >> 4 & 15);
    eeprom[number] = (uint8_t)(value & 15);
}

static void begin(far_joint *joint)
{
    static const uint8_t factory[][2] = {{1, 0x5A},  {3, 60},    {5, 127}, {7, 1},     {9, 2},
                                         {11, 40},   {13, 250},  {15, 4},  {17, 0x2C}, {19, 0xEC},
                                         {21, 0x0D}, {23, 0xAC}, {27, 10}, {29, 80},   {31, 63},
                                         {51, 3},    {59, 120},  {61, 60}, {63, 254}};
    memset(joint->reg, 0, sizeof joint->reg);
    for (size_t i = 0; i < sizeof factory / sizeof factory[0]; i++) {
        put_nibbles(joint->reg, factory[i][0], factory[i][1]);
    }
    put_nibbles(joint->reg, 57, joint->id);
    joint->reg[AT_SPEED] = FULL_SPEED;
    far_put16(joint->reg + AT_GOAL, MIDDLE);
}

static void plan(const far_joint *joint, double *goal_deg, double *cruise_dps, double *accel_dps2)
{
    *goal_deg = (far_get16(joint->reg + AT_GOAL) - MIDDLE) * STEP_DEG;
    *cruise_dps = joint->reg[AT_SPEED] * joint->top_dps / FULL_SPEED;
    *accel_dps2 = 0;
}

static void hold(far_joint *joint, double deg, double dps, int64_t now_us)
{
    (void)now_us;
    far_put16(joint->reg + AT_GOAL, (int)lround(deg / STEP_DEG) + MIDDLE);
    if (dps > 0) {
        joint->reg[AT_SPEED] = (uint8_t)fmax(1, round(dps / joint->top_dps * FULL_SPEED));
    }
}

static int position_of(const far_joint *joint)
{
    return (int)lround(joint->at_deg / STEP_DEG) + MIDDLE;
}

/* Small is hot: 75 is 70 degrees, 87 is 60, 127 is 27. */
static int heat_of(const far_joint *joint)
{
    return joint->celsius >= 60 ? (int)(87 - (joint->celsius - 60) * 1.2)
                                : (int)(87 + (60 - joint->celsius) * 1.2);
}

static int measure(const uint8_t *bytes, int n)
{
    int size = 0;
    switch (bytes[0] & 0xE0) {
    case POSITION:
        size = 3;
        break;
    case READ:
        size = 2;
        break;
    case WRITE:
        size = n < 2 ? 3 : bytes[1] == SC_EEPROM ? 2 + EEPROM_BYTES : 3;
        break;
    default:
        return bytes[0] >= 0xE0 ? (n < 4 ? 0 : 4) : -1;
    }
    return n < size ? 0 : size;
}

static bool sound(const uint8_t *frame, int n)
{
    for (int i = 1; i < n; i++) {
        if ((frame[i] & 0x80) != 0) {
            return false;
        }
    }
    return true;
}

static bool moves(const uint8_t *frame, int n)
{
    (void)n;
    return (frame[0] & 0xE0) == POSITION;
}

static void answer_position(far_side *far, far_joint *joint, const uint8_t *head, int n_head)
{
    uint8_t back[4];
    int position = position_of(joint);
    memcpy(back, head, (size_t)n_head);
    back[n_head] = (uint8_t)(position >> 7 & 0x7F);
    back[n_head + 1] = (uint8_t)(position & 0x7F);
    far_answer(far, joint, back, n_head + 2);
}

static void take_position(far_side *far, far_joint *joint, const uint8_t *frame)
{
    int goal = frame[1] << 7 | frame[2];
    far_turn_to(joint, far->now_us);
    answer_position(far, joint, (const uint8_t[]){frame[0] & 0x7F}, 1);
    if (goal == 0) {
        far_torque(far, joint, 0);
        return;
    }
    far_put16(joint->reg + AT_GOAL, goal);
    if (joint->torque != 1) {
        far_torque(far, joint, 1);
        joint->leaps = false;
    }
    far_goal(far, joint);
}

static void answer_eeprom(far_side *far, const far_joint *joint, uint8_t head)
{
    uint8_t back[2 + EEPROM_BYTES] = {head, SC_EEPROM};
    memcpy(back + 2, joint->reg, EEPROM_BYTES);
    if (joint->torque != 1) {
        back[2 + 15] |= FLAG_FREE;
    }
    far_answer(far, NULL, back, sizeof back);
}

static void answer_read(far_side *far, far_joint *joint, const uint8_t *frame)
{
    uint8_t back[3] = {frame[0] & 0x7F, frame[1], 0};
    far_turn_to(joint, far->now_us);
    switch (frame[1]) {
    case SC_EEPROM:
        answer_eeprom(far, joint, back[0]);
        return;
    case SC_POSITION:
        answer_position(far, joint, back, 2);
        return;
    case SC_STRETCH:
        back[2] = 30;
        break;
    case SC_SPEED:
        back[2] = joint->reg[AT_SPEED];
        break;
    case SC_CURRENT:
        back[2] = far_is_moving(joint) ? 2 : 0;
        break;
    case SC_HEAT:
        back[2] = (uint8_t)heat_of(joint);
        break;
    default:
        return;
    }
    far_answer(far, NULL, back, 3);
}

static void obey(far_side *far, const uint8_t *frame, int n)
{
    far_joint *joint = far_find(far, frame[0] & 0x1F);
    if (joint == NULL || (joint->deaf && (frame[0] & 0xE0) != READ)) {
        return;
    }
    switch (frame[0] & 0xE0) {
    case POSITION:
        take_position(far, joint, frame);
        break;
    case READ:
        answer_read(far, joint, frame);
        break;
    case WRITE:
        if (frame[1] == SC_SPEED) {
            joint->reg[AT_SPEED] = frame[2];
        }
        far_answer(far, NULL, (const uint8_t[]){frame[0] & 0x7F, frame[1], frame[2]},
                   n < 4 ? 3 : 2);
        break;
    default:
        break;
    }
}

const far_family far_ics = {.name = "ics",
                            .loop = {25, 0.5, 0.5, 12, 3},
                            .baud_bps = 115200,
                            .bits_a_byte = 11,
                            .echo = true,
                            .dead_us = 2000,
                            .think_us = 100,
                            .top_dps = 500,
                            .step_deg = STEP_DEG,
                            .count_dps = 500.0 / FULL_SPEED,
                            .measure = measure,
                            .sound = sound,
                            .moves = moves,
                            .obey = obey,
                            .begin = begin,
                            .plan = plan,
                            .hold = hold};
