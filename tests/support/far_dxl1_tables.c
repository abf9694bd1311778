/* SPDX-License-Identifier: MIT */
/* Registers of the servos with the frame of DYNAMIXEL protocol 1, as their makers' tables have
 * them: AX-12A and MX-28 (reference dynamixel1, 5 and 6), STS3215, SM8512BL and SCS0009 (reference
 * feetech, 4, 5 and 9), HLS3930 (the maker's HLSCL.h and memory table). SCS put the high byte
 * first. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/far_dxl1.h"

enum { AX_MIDDLE = 512, MX_MIDDLE = 2048, STS_MIDDLE = 2048, SCS_MIDDLE = 512, SIGN = 0x8000 };

#define AX_STEP_DEG (300.0 / 1023)
#define AX_SPEED_DPS (0.111 * 6)
#define MX_STEP_DEG (360.0 / 4096)
#define MX_SPEED_DPS (0.114 * 6)
#define MX_ACCEL_DPS2 8.583
#define STS_STEP_DEG (360.0 / 4096)
#define STS_ACCEL_DPS2 (100 * STS_STEP_DEG)
#define HLS_COUNT_DPS (0.732 * 6)
#define SCS_STEP_DEG (300.0 / 1024)

/* Sign and magnitude. */
static int signed_of(int value)
{
    return (value & SIGN) != 0 ? -(value & ~SIGN) : value;
}

static int with_sign(int value)
{
    return value < 0 ? SIGN | -value : value;
}

/* High byte first. */
static void put_high(uint8_t *to, int value)
{
    to[0] = (uint8_t)((unsigned)value >> 8 & 0xFF);
    to[1] = (uint8_t)((unsigned)value & 0xFF);
}

static int get_high(const uint8_t *from)
{
    return from[0] << 8 | from[1];
}

/* ---- AX -------------------------------------------------------------------------------------- */

enum { AX_TORQUE = 24, AX_GOAL = 30, AX_SPEED = 32 };

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
    far_put16(joint->reg + AX_GOAL, AX_MIDDLE);
}

static void plan_ax(const far_joint *joint, double *goal_deg, double *cruise_dps,
                    double *accel_dps2)
{
    *goal_deg = (far_get16(joint->reg + AX_GOAL) - AX_MIDDLE) * AX_STEP_DEG;
    *cruise_dps = (far_get16(joint->reg + AX_SPEED) & 0x3FF) * AX_SPEED_DPS;
    *accel_dps2 = 0;
}

static void hold_ax(far_joint *joint, double deg, double dps, int64_t now_us)
{
    (void)now_us;
    joint->reg[AX_TORQUE] = (uint8_t)joint->torque;
    far_put16(joint->reg + AX_GOAL, (int)lround(deg / AX_STEP_DEG) + AX_MIDDLE);
    far_put16(joint->reg + AX_SPEED, (int)ceil(dps / AX_SPEED_DPS));
}

static void refresh_ax(far_joint *joint)
{
    int speed = (int)lround(fabs(joint->dps) / AX_SPEED_DPS);
    far_put16(joint->reg + 36, (int)lround(joint->at_deg / AX_STEP_DEG) + AX_MIDDLE);
    far_put16(joint->reg + 38, joint->dps < 0 ? 0x400 | speed : speed);
    far_put16(joint->reg + 40, far_is_moving(joint) ? 100 : 10);
    joint->reg[42] = 120;
    joint->reg[43] = (uint8_t)joint->celsius;
    joint->reg[46] = far_is_moving(joint);
}

static const far_dxl1_layout ax = {.goal = AX_GOAL, .torque = AX_TORQUE, .refresh = refresh_ax};

static bool moves_ax(const uint8_t *frame, int n)
{
    return far_dxl1_moves(&ax, frame, n);
}

/* ---- MX, with the places of AX --------------------------------------------------------------- */

enum { MX_ACCEL = 73 };

static void begin_mx(far_joint *joint)
{
    memset(joint->reg, 0, sizeof joint->reg);
    far_put16(joint->reg, 29);
    joint->reg[2] = 36;
    joint->reg[3] = (uint8_t)joint->id;
    joint->reg[4] = 1; /* as sold 34 */
    far_put16(joint->reg + 8, 4095);
    joint->reg[11] = 80;
    joint->reg[12] = 60;
    joint->reg[13] = 160;
    far_put16(joint->reg + 14, 1023);
    joint->reg[16] = 2;
    joint->reg[17] = joint->reg[18] = 36;
    joint->reg[22] = 1;
    joint->reg[28] = 32;
    far_put16(joint->reg + 34, 1023);
    far_put16(joint->reg + AX_GOAL, MX_MIDDLE);
}

static void plan_mx(const far_joint *joint, double *goal_deg, double *cruise_dps,
                    double *accel_dps2)
{
    *goal_deg = (far_signed16(joint->reg + AX_GOAL) - MX_MIDDLE) * MX_STEP_DEG;
    *cruise_dps = (far_get16(joint->reg + AX_SPEED) & 0x3FF) * MX_SPEED_DPS;
    *accel_dps2 = joint->reg[MX_ACCEL] * MX_ACCEL_DPS2;
}

static void hold_mx(far_joint *joint, double deg, double dps, int64_t now_us)
{
    (void)now_us;
    joint->reg[AX_TORQUE] = (uint8_t)joint->torque;
    far_put16(joint->reg + AX_GOAL, (int)lround(deg / MX_STEP_DEG) + MX_MIDDLE);
    far_put16(joint->reg + AX_SPEED, (int)ceil(dps / MX_SPEED_DPS));
}

static void refresh_mx(far_joint *joint)
{
    int speed = (int)lround(fabs(joint->dps) / MX_SPEED_DPS);
    far_put16(joint->reg + 36, (int)lround(joint->at_deg / MX_STEP_DEG) + MX_MIDDLE);
    far_put16(joint->reg + 38, joint->dps < 0 ? 0x400 | speed : speed);
    far_put16(joint->reg + 40, far_is_moving(joint) ? 100 : 10);
    joint->reg[42] = 120;
    joint->reg[43] = (uint8_t)joint->celsius;
    joint->reg[46] = far_is_moving(joint);
}

static const far_dxl1_layout mx = {
    .goal = AX_GOAL, .torque = AX_TORQUE, .bulk_read = true, .refresh = refresh_mx};

/* ---- STS ------------------------------------------------------------------------------------- */

/* STS_VOLTS: where what is measured at 62 is kept; no register of theirs. */
enum {
    STS_MODE = 33,
    STS_TORQUE = 40,
    STS_GOAL = 42,
    STS_SPEED = 46,
    STS_TURN = 4096,
    STS_VOLTS = 150
};

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
    far_put16(joint->reg + STS_GOAL, STS_MIDDLE);
    far_put16(joint->reg + 48, 1000);
    joint->reg[55] = 1;
    joint->reg[STS_VOLTS] = 74;
}

/* The registers of STS, at 12 V. */
static void begin_sm(far_joint *joint)
{
    begin_sts(joint);
    far_put16(joint->reg + 3, 11272);
    joint->reg[7] = 250;
    joint->reg[14] = 140;
    joint->reg[STS_VOLTS] = 120;
}

/* Places of STS, but a second id at 7, a current at 44 and no overload; speeds count 0.732 rpm. */
static void begin_hls(far_joint *joint)
{
    begin_sts(joint);
    joint->reg[1] = 42;
    far_put16(joint->reg + 3, 4106);
    joint->reg[14] = 140;
    far_put16(joint->reg + 16, 980);
    joint->reg[18] = 0;
    far_put16(joint->reg + 44, 500);
    far_put16(joint->reg + STS_SPEED, 60);
    far_put16(joint->reg + 48, 980);
    joint->reg[STS_VOLTS] = 120;
}

static void plan_sts(const far_joint *joint, double *goal_deg, double *cruise_dps,
                     double *accel_dps2)
{
    *goal_deg = (signed_of(far_get16(joint->reg + STS_GOAL)) - STS_MIDDLE) * STS_STEP_DEG;
    *cruise_dps = abs(signed_of(far_get16(joint->reg + STS_SPEED))) * joint->family->count_dps;
    *accel_dps2 = joint->reg[41] * STS_ACCEL_DPS2;
}

static void hold_sts(far_joint *joint, double deg, double dps, int64_t now_us)
{
    (void)now_us;
    joint->reg[STS_TORQUE] = (uint8_t)joint->torque;
    far_put16(joint->reg + STS_GOAL, with_sign((int)lround(deg / STS_STEP_DEG) + STS_MIDDLE));
    far_put16(joint->reg + STS_SPEED, (int)ceil(dps / joint->family->count_dps));
}

static void refresh_sts(far_joint *joint)
{
    int steps = (int)lround(joint->at_deg / STS_STEP_DEG) + STS_MIDDLE;
    if (joint->wheel) { /* within one turn */
        steps = (steps % STS_TURN + STS_TURN) % STS_TURN;
    }
    far_put16(joint->reg + 56, with_sign(steps));
    far_put16(joint->reg + 58, with_sign((int)lround(joint->dps / joint->family->count_dps)));
    far_put16(joint->reg + 60, 0);
    joint->reg[62] = joint->reg[STS_VOLTS];
    joint->reg[63] = (uint8_t)joint->celsius;
    joint->reg[66] = far_is_moving(joint);
    far_put16(joint->reg + 69, far_is_moving(joint) ? 20 : 2);
    far_put16(joint->reg + (joint->family == &far_hls ? 67 : 71), far_get16(joint->reg + STS_GOAL));
}

/* Register 33 is the mode, 1 a constant speed: register 46 then, signed, in steps a second
 * (reference feetech, 4 and 5). */
static void spin_sts(far_joint *joint)
{
    joint->wheel = joint->reg[STS_MODE] == 1;
    joint->wheel_dps = signed_of(far_get16(joint->reg + STS_SPEED)) * joint->family->count_dps;
}

static const far_dxl1_layout sts = {.goal = STS_GOAL,
                                    .torque = STS_TORQUE,
                                    .sync_read = true,
                                    .speed_at = STS_SPEED,
                                    .spin = spin_sts,
                                    .refresh = refresh_sts};

static bool moves_sts(const uint8_t *frame, int n)
{
    return far_dxl1_moves(&sts, frame, n);
}

/* ---- SCS, with places of STS ----------------------------------------------------------------- */

enum { SCS_MIN = 9, SCS_MAX = 11, SCS_TIME = 44 };

static void begin_scs(far_joint *joint)
{
    memset(joint->reg, 0, sizeof joint->reg);
    joint->reg[2] = 1;
    put_high(joint->reg + 3, 1284);
    joint->reg[5] = (uint8_t)joint->id;
    joint->reg[8] = 1;
    put_high(joint->reg + SCS_MIN, 20);
    put_high(joint->reg + SCS_MAX, 1003);
    joint->reg[13] = 80;
    joint->reg[14] = 90;
    joint->reg[15] = 45;
    put_high(joint->reg + 16, 1000);
    joint->reg[19] = joint->reg[20] = 37;
    joint->reg[21] = joint->reg[22] = 15;
    put_high(joint->reg + 24, 30);
    joint->reg[26] = joint->reg[27] = joint->reg[28] = 1;
    joint->reg[37] = 20;
    joint->reg[38] = 100;
    joint->reg[39] = 80;
    joint->reg[48] = 1;
    put_high(joint->reg + STS_GOAL, SCS_MIDDLE);
}

/* The time counts where the speed is 0. A goal outside the limits is drawn in, without a word. */
static void plan_scs(const far_joint *joint, double *goal_deg, double *cruise_dps,
                     double *accel_dps2)
{
    int goal = get_high(joint->reg + STS_GOAL), ms = get_high(joint->reg + SCS_TIME);
    int speed = get_high(joint->reg + STS_SPEED);
    int least = get_high(joint->reg + SCS_MIN), most = get_high(joint->reg + SCS_MAX);
    goal = goal < least ? least : goal > most ? most : goal;
    *goal_deg = (goal - SCS_MIDDLE) * SCS_STEP_DEG;
    *cruise_dps = speed > 0 ? speed * SCS_STEP_DEG
                  : ms > 0  ? fabs(*goal_deg - joint->set_deg) * 1000 / ms
                            : 0;
    *accel_dps2 = 0;
}

static void hold_scs(far_joint *joint, double deg, double dps, int64_t now_us)
{
    (void)now_us;
    joint->reg[STS_TORQUE] = (uint8_t)joint->torque;
    put_high(joint->reg + STS_GOAL, (int)lround(deg / SCS_STEP_DEG) + SCS_MIDDLE);
    put_high(joint->reg + SCS_TIME, 0);
    put_high(joint->reg + STS_SPEED, (int)ceil(dps / SCS_STEP_DEG));
}

static void refresh_scs(far_joint *joint)
{
    put_high(joint->reg + 56, (int)lround(joint->at_deg / SCS_STEP_DEG) + SCS_MIDDLE);
    put_high(joint->reg + 58, with_sign((int)lround(joint->dps / SCS_STEP_DEG)));
    put_high(joint->reg + 60, 0);
    joint->reg[62] = 60;
    joint->reg[63] = (uint8_t)joint->celsius;
    joint->reg[66] = far_is_moving(joint);
}

static const far_dxl1_layout scs = {.goal = STS_GOAL, .torque = STS_TORQUE, .refresh = refresh_scs};

/* ---- families -------------------------------------------------------------------------------- */

const far_dxl1_layout *far_dxl1_layout_of(const far_family *family)
{
    bool is_sts = family == &far_sts || family == &far_sm || family == &far_hls;
    return is_sts ? &sts : family == &far_scs ? &scs : family == &far_mx ? &mx : &ax;
}

#define COMMON                                                                                     \
    .baud_bps = 1000000, .bits_a_byte = 10, .dead_us = 2000, .think_us = 60,                       \
    .measure = far_dxl1_measure, .sound = far_dxl1_sound, .obey = far_dxl1_obey

const far_family far_dxl1 = {COMMON,
                             .name = "dxl1",
                             .loop = {25, 0.33, 0.37, 9.4, 3},
                             .top_dps = 354,
                             .step_deg = AX_STEP_DEG,
                             .count_dps = AX_SPEED_DPS,
                             .moves = moves_ax,
                             .begin = begin_ax,
                             .plan = plan_ax,
                             .hold = hold_ax};
const far_family far_sts = {COMMON,
                            .name = "sts",
                            .loop = {14.5, 0.5, 0.34, 12.3, 4},
                            .top_dps = 300,
                            .step_deg = STS_STEP_DEG,
                            .count_dps = STS_STEP_DEG,
                            .moves = moves_sts,
                            .begin = begin_sts,
                            .plan = plan_sts,
                            .hold = hold_sts};
/* It waits for its return delay before it answers: 250 counts of 2 us. */
const far_family far_sm = {.baud_bps = 1000000,
                           .bits_a_byte = 10,
                           .dead_us = 2000,
                           .think_us = 560,
                           .measure = far_dxl1_measure,
                           .sound = far_dxl1_sound,
                           .obey = far_dxl1_obey,
                           .name = "sm",
                           .loop = {14.5, 0.5, 0.34, 12.3, 4},
                           .top_dps = 270,
                           .step_deg = STS_STEP_DEG,
                           .count_dps = STS_STEP_DEG,
                           .moves = moves_sts,
                           .begin = begin_sm,
                           .plan = plan_sts,
                           .hold = hold_sts};
const far_family far_hls = {COMMON,
                            .name = "hls",
                            .loop = {14.5, 0.5, 0.34, 12.3, 4},
                            .top_dps = 272,
                            .step_deg = STS_STEP_DEG,
                            .count_dps = HLS_COUNT_DPS,
                            .moves = moves_sts,
                            .begin = begin_hls,
                            .plan = plan_sts,
                            .hold = hold_sts};
const far_family far_mx = {COMMON,
                           .name = "mx",
                           .loop = {31, 0.34, 0.17, 10.8, 3},
                           .top_dps = 330,
                           .step_deg = MX_STEP_DEG,
                           .count_dps = MX_SPEED_DPS,
                           .moves = moves_ax,
                           .begin = begin_mx,
                           .plan = plan_mx,
                           .hold = hold_mx};
const far_family far_scs = {COMMON,
                            .name = "scs",
                            .loop = {25, 0.4, 0.4, 10, 3},
                            .top_dps = 600,
                            .step_deg = SCS_STEP_DEG,
                            .moves = moves_sts,
                            .begin = begin_scs,
                            .plan = plan_scs,
                            .hold = hold_scs};
