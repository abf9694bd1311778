/* SPDX-License-Identifier: MIT */
/*
 * Registers of the servos with the frame of DYNAMIXEL protocol 2, as ROBOTIS' e-manual has them: X
 * (reference dynamixel2), XL-320 (docs/en/dxl/x/xl320.md), P (docs/en/dxl/p/ph42-020-s300-r.md and
 * _includes/en/dxl/p) and PRO before (A) (docs/en/dxl/pro/h54-200-s500-r.md). X and P have
 * time-based profiles (drive mode 4) and a watchdog; XL-320 and PRO have a speed beside the goal.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/far_dxl2.h"

static void put32(uint8_t *to, int32_t value)
{
    far_put16(to, (int)((uint32_t)value & 0xFFFF));
    far_put16(to + 2, (int)((uint32_t)value >> 16));
}

static int32_t get32(const uint8_t *from)
{
    return (int32_t)((uint32_t)far_get16(from) | (uint32_t)far_get16(from + 2) << 16);
}

/* ---- X and P --------------------------------------------------------------------------------- */

enum { AT_ID = 7, AT_DRIVE = 10, AT_MODE = 11, MODE_VELOCITY = 1, WATCHDOG_OVER = 0xFF };

/* RAM of P begins at 512; it is kept from here on. */
enum { P_RAM = 512, P_KEPT = 64, P_BYTES = 96 };

/* Where registers are kept. */
typedef struct profile {
    int torque, watchdog, velocity, ramp, time, goal, moving, load, speed, position, trajectory,
        supply, heat, supply_01v, middle;
    double speed_dps; /* of a count */
} profile;

static const profile x_profile = {.torque = 64,
                                  .watchdog = 98,
                                  .velocity = 104,
                                  .ramp = 108,
                                  .time = 112,
                                  .goal = 116,
                                  .moving = 122,
                                  .load = 126,
                                  .speed = 128,
                                  .position = 132,
                                  .trajectory = 140,
                                  .supply = 144,
                                  .heat = 146,
                                  .supply_01v = 120,
                                  .middle = 2048,
                                  .speed_dps = 0.229 * 6};

#define P_AT(address) ((address)-P_RAM + P_KEPT)

static const profile p_profile = {.torque = P_AT(512),
                                  .watchdog = P_AT(546),
                                  .velocity = P_AT(552),
                                  .ramp = P_AT(556),
                                  .time = P_AT(560),
                                  .goal = P_AT(564),
                                  .moving = P_AT(570),
                                  .load = P_AT(574),
                                  .speed = P_AT(576),
                                  .position = P_AT(580),
                                  .trajectory = P_AT(588),
                                  .supply = P_AT(592),
                                  .heat = P_AT(594),
                                  .supply_01v = 240,
                                  .middle = 0,
                                  .speed_dps = 0.01 * 6};

static const profile *profile_of(const far_joint *joint)
{
    return joint->family == &far_p ? &p_profile : &x_profile;
}

static void begin_x(far_joint *joint)
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
    put32(joint->reg + x_profile.goal, x_profile.middle);
}

static void begin_p(far_joint *joint)
{
    memset(joint->reg, 0, sizeof joint->reg);
    far_put16(joint->reg, 2000); /* PH42-020-S300-R */
    joint->reg[6] = 11;          /* from 12 on it would answer fast reads */
    joint->reg[AT_ID] = (uint8_t)joint->id;
    joint->reg[8] = 3; /* as sold 1 */
    joint->reg[AT_DRIVE] = 4;
    joint->reg[AT_MODE] = 3;
    joint->reg[12] = 255;
    joint->reg[13] = 2;
    put32(joint->reg + 24, 20);
    joint->reg[31] = 80;
    far_put16(joint->reg + 32, 350);
    far_put16(joint->reg + 34, 150);
    far_put16(joint->reg + 36, 2009);
    far_put16(joint->reg + 38, 4500);
    put32(joint->reg + 40, 10765);
    put32(joint->reg + 44, 2920);
    put32(joint->reg + 48, 303454);
    put32(joint->reg + 52, -303454);
    joint->reg[63] = 58;
    joint->reg[P_AT(516)] = 2;
    far_put16(joint->reg + P_AT(548), 2009);
    far_put16(joint->reg + P_AT(550), 4500);
}

static void plan_profile(const far_joint *joint, double *goal_deg, double *cruise_dps,
                         double *accel_dps2)
{
    const profile *its = profile_of(joint);
    int32_t ms = get32(joint->reg + its->time);
    *goal_deg = (get32(joint->reg + its->goal) - its->middle) * joint->family->step_deg;
    *cruise_dps = ms > 0 ? fabs(*goal_deg - joint->set_deg) * 1000 / ms : 0;
    *accel_dps2 = 0;
}

static void hold_profile(far_joint *joint, double deg, double dps, int64_t now_us)
{
    const profile *its = profile_of(joint);
    joint->reg[its->torque] = (uint8_t)joint->torque;
    joint->heard_us = now_us;
    put32(joint->reg + its->goal, (int32_t)lround(deg / joint->family->step_deg) + its->middle);
    put32(joint->reg + its->time,
          dps > 0 ? (int32_t)lround(fabs(deg - joint->set_deg) / dps * 1000) : 0);
}

/* Nothing was said to it for so long: it stops and takes no goal. */
static void watch_profile(far_joint *joint, int64_t now_us)
{
    const profile *its = profile_of(joint);
    int64_t bound_us = joint->reg[its->watchdog] * INT64_C(20000);
    int64_t ends_us = joint->heard_us + bound_us;
    if (joint->reg[its->watchdog] != 0 && joint->reg[its->watchdog] != WATCHDOG_OVER &&
        joint->torque == 1 && ends_us < now_us) {
        far_turn_to(joint, ends_us);
        joint->waits = false;
        joint->set_dps = 0;
        joint->goal_deg = joint->set_deg;
        put32(joint->reg + its->ramp, 0);
        put32(joint->reg + its->time, 0);
        put32(joint->reg + its->velocity, 0);
        joint->wheel_dps = 0;
        joint->reg[its->watchdog] = WATCHDOG_OVER;
    }
}

static void spin_profile(far_joint *joint)
{
    const profile *its = profile_of(joint);
    joint->wheel = joint->reg[AT_MODE] == MODE_VELOCITY;
    joint->wheel_dps = get32(joint->reg + its->velocity) * its->speed_dps;
}

static void refresh_profile(far_joint *joint)
{
    const profile *its = profile_of(joint);
    int32_t position = (int32_t)lround(joint->at_deg / joint->family->step_deg) + its->middle;
    put32(joint->reg + its->position, position);
    put32(joint->reg + its->trajectory,
          (int32_t)lround(joint->set_deg / joint->family->step_deg) + its->middle);
    put32(joint->reg + its->speed, (int32_t)lround(joint->dps / its->speed_dps));
    far_put16(joint->reg + its->load, far_is_moving(joint) ? 100 : 5);
    joint->reg[its->moving] = far_is_moving(joint);
    far_put16(joint->reg + its->supply, its->supply_01v);
    joint->reg[its->heat] = (uint8_t)joint->celsius;
}

static const far_dxl2_layout x_series = {.part = {{0, FAR_REGISTERS, 0}},
                                         .torque = {64, 1},
                                         .goal = {116, 4},
                                         .velocity = {104, 4},
                                         .watchdog = 98,
                                         .spin = spin_profile,
                                         .refresh = refresh_profile};

static const far_dxl2_layout p_series = {.part = {{0, P_KEPT, 0}, {P_RAM, P_BYTES, P_KEPT}},
                                         .torque = {512, 1},
                                         .goal = {564, 4},
                                         .velocity = {552, 4},
                                         .watchdog = P_AT(546),
                                         .spin = spin_profile,
                                         .refresh = refresh_profile};

static bool moves_x(const uint8_t *frame, int n)
{
    return far_dxl2_moves(&x_series, frame, n);
}

static bool moves_p(const uint8_t *frame, int n)
{
    return far_dxl2_moves(&p_series, frame, n);
}

/* ---- XL-320 ---------------------------------------------------------------------------------- */

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
    far_put16(joint->reg + 41, far_is_moving(joint) ? 100 : 5);
    joint->reg[45] = 74;
    joint->reg[46] = (uint8_t)joint->celsius;
    joint->reg[49] = far_is_moving(joint);
}

static const far_dxl2_layout xl320 = {.part = {{0, FAR_REGISTERS, 0}},
                                      .torque = {XL320_TORQUE, 1},
                                      .goal = {XL320_GOAL, 2},
                                      .refresh = refresh_xl320};

static bool moves_xl320(const uint8_t *frame, int n)
{
    return far_dxl2_moves(&xl320, frame, n);
}

/* ---- PRO, RAM from 562 on, and three registers from 890 on ----------------------------------- */

enum { PRO_RAM = 562, PRO_KEPT = 64, PRO_BYTES = 72, PRO_LAST = 890, PRO_LAST_KEPT = 140 };

#define PRO_AT(address) ((address)-PRO_RAM + PRO_KEPT)
#define PRO_STEP_DEG (360.0 / 501923)
#define PRO_SPEED_DPS (0.00199234 * 6)
#define PRO_ACCEL_DPS2 (58000.0 * 360 / 3600)

static void begin_pro(far_joint *joint)
{
    memset(joint->reg, 0, sizeof joint->reg);
    far_put16(joint->reg, 54024); /* H54-200-S500-R */
    joint->reg[6] = 11;
    joint->reg[AT_ID] = (uint8_t)joint->id;
    joint->reg[8] = 3; /* as sold 1 */
    joint->reg[AT_MODE] = 3;
    put32(joint->reg + 17, 50);
    joint->reg[21] = 80;
    far_put16(joint->reg + 22, 400);
    far_put16(joint->reg + 24, 150);
    put32(joint->reg + 26, 255);
    far_put16(joint->reg + 30, 620);
    put32(joint->reg + 32, 17000);
    put32(joint->reg + 36, 250961);
    put32(joint->reg + 40, -250961);
    joint->reg[48] = 58;
    far_put16(joint->reg + PRO_AT(586), 14);
    far_put16(joint->reg + PRO_AT(588), 399);
    far_put16(joint->reg + PRO_AT(594), 32);
    joint->reg[PRO_LAST_KEPT + 1] = 2;
}

/* Speed 0: as fast as its limit. */
static void plan_pro(const far_joint *joint, double *goal_deg, double *cruise_dps,
                     double *accel_dps2)
{
    *goal_deg = get32(joint->reg + PRO_AT(596)) * PRO_STEP_DEG;
    *cruise_dps = abs(get32(joint->reg + PRO_AT(600))) * PRO_SPEED_DPS;
    *accel_dps2 = get32(joint->reg + PRO_AT(606)) * PRO_ACCEL_DPS2;
}

static void hold_pro(far_joint *joint, double deg, double dps, int64_t now_us)
{
    (void)now_us;
    joint->reg[PRO_AT(562)] = (uint8_t)joint->torque;
    put32(joint->reg + PRO_AT(596), (int32_t)lround(deg / PRO_STEP_DEG));
    put32(joint->reg + PRO_AT(600), (int32_t)ceil(dps / PRO_SPEED_DPS));
}

static void spin_pro(far_joint *joint)
{
    joint->wheel = joint->reg[AT_MODE] == MODE_VELOCITY;
    joint->wheel_dps = get32(joint->reg + PRO_AT(600)) * PRO_SPEED_DPS;
}

static void refresh_pro(far_joint *joint)
{
    joint->reg[PRO_AT(610)] = far_is_moving(joint);
    put32(joint->reg + PRO_AT(611), (int32_t)lround(joint->at_deg / PRO_STEP_DEG));
    put32(joint->reg + PRO_AT(615), (int32_t)lround(joint->dps / PRO_SPEED_DPS));
    far_put16(joint->reg + PRO_AT(621), far_is_moving(joint) ? 100 : 5);
    far_put16(joint->reg + PRO_AT(623), 240);
    joint->reg[PRO_AT(625)] = (uint8_t)joint->celsius;
}

static const far_dxl2_layout pro_series = {
    .part = {{0, PRO_KEPT, 0}, {PRO_RAM, PRO_BYTES, PRO_KEPT}, {PRO_LAST, 3, PRO_LAST_KEPT}},
    .torque = {562, 1},
    .goal = {596, 4},
    .velocity = {600, 4},
    .spin = spin_pro,
    .refresh = refresh_pro};

static bool moves_pro(const uint8_t *frame, int n)
{
    return far_dxl2_moves(&pro_series, frame, n);
}

/* ---- families -------------------------------------------------------------------------------- */

const far_dxl2_layout *far_dxl2_layout_of(const far_family *family)
{
    return family == &far_xl320 ? &xl320
           : family == &far_p   ? &p_series
           : family == &far_pro ? &pro_series
                                : &x_series;
}

#define COMMON                                                                                     \
    .baud_bps = 1000000, .bits_a_byte = 10, .dead_us = 2000, .think_us = 60,                       \
    .measure = far_dxl2_measure, .sound = far_dxl2_sound, .obey = far_dxl2_obey

const far_family far_dxl2 = {COMMON,
                             .name = "dxl2",
                             .loop = {16, 0.6, 1.3, 50, 4},
                             .top_dps = 366,
                             .step_deg = 360.0 / 4096,
                             .moves = moves_x,
                             .begin = begin_x,
                             .plan = plan_profile,
                             .hold = hold_profile,
                             .watch = watch_profile};
const far_family far_p = {COMMON,
                          .name = "p",
                          .loop = {40, 0.8, 0.1, 20, 2},
                          .top_dps = 196,
                          .step_deg = 360.0 / 607500,
                          .moves = moves_p,
                          .begin = begin_p,
                          .plan = plan_profile,
                          .hold = hold_profile,
                          .watch = watch_profile};
const far_family far_xl320 = {COMMON,
                              .name = "xl320",
                              .loop = {15.5, 0.7, 4.7, 35, 5},
                              .top_dps = 684,
                              .step_deg = XL320_STEP_DEG,
                              .count_dps = XL320_SPEED_DPS,
                              .moves = moves_xl320,
                              .begin = begin_xl320,
                              .plan = plan_xl320,
                              .hold = hold_xl320};
const far_family far_pro = {COMMON,
                            .name = "pro",
                            .loop = {40, 0.8, 0.1, 20, 2},
                            .top_dps = 199,
                            .step_deg = PRO_STEP_DEG,
                            .count_dps = PRO_SPEED_DPS,
                            .moves = moves_pro,
                            .begin = begin_pro,
                            .plan = plan_pro,
                            .hold = hold_pro};
