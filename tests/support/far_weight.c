/* SPDX-License-Identifier: MIT */
/*
 * A shaft of the far side that carries a weight: gravity on a lever, the friction of gears, and a
 * position loop that pulls by its error and no more than its motor can. All is counted as an error
 * of that loop, in degrees: of a spring K, a weight that is W where the lever is stretched out is
 * an error W / K, friction F is F / K. Then the shaft swings by two numbers, its frequency and its
 * damping, which families have (far_loop). Those of STS at a gain of 16, MX and XL-320 are of the
 * identified motors of BAM (model m1); others are chosen by stall torque and no-load speed.
 */
#include <math.h>

#include "tests/support/far_side.h"

#define RAD(deg) ((deg)*0.017453292519943295)
/* The lever's own stops. */
#define END_DEG 115.0
/* Of the damping: what is left where the winding is open. */
#define OPEN_PART 0.1
/* Slower is not moving, by a servo's own flag. */
#define MOVING_DPS 1.0

void far_weigh(far_side *far, int64_t now_us)
{
    for (int i = 0; i < far->n_joints; i++) {
        far_turn_to(&far->joint[i], now_us);
        far->joint[i].sag_deg = far->family->loop.weight_deg;
    }
}

double far_carries_deg(const far_joint *joint, double deg)
{
    return joint->sag_deg * cos(RAD(deg));
}

double far_hangs_deg(const far_joint *joint, double set_deg)
{
    double at_deg = set_deg;
    for (int i = 0; i < 20; i++) {
        at_deg = set_deg - far_carries_deg(joint, at_deg);
    }
    return at_deg;
}

bool far_is_moving(const far_joint *joint)
{
    return joint->set_dps != 0 || fabs(joint->dps) >= MOVING_DPS;
}

/* Friction takes as much of the speed as it can, and keeps a shaft that nothing pulls harder. */
static double rub(double dps, double most_dps)
{
    return copysign(fmax(fabs(dps) - most_dps, 0), dps);
}

void far_pull(far_joint *joint, double seconds)
{
    const far_loop *loop = &joint->family->loop;
    double square = loop->rad_s * loop->rad_s;
    double error_deg = joint->torque == 1 ? joint->set_deg - joint->at_deg : 0;
    error_deg = fmin(fmax(error_deg, -loop->most_deg), loop->most_deg);
    double pull_deg = error_deg - far_carries_deg(joint, joint->at_deg);
    double damping = 2 * loop->damping * loop->rad_s * (joint->torque == 0 ? OPEN_PART : 1);
    double dps = (joint->dps + square * pull_deg * seconds) / (1 + damping * seconds);
    joint->dps = rub(dps, square * loop->friction_deg * seconds);
    joint->at_deg += joint->dps * seconds;
    if (fabs(joint->at_deg) > END_DEG) {
        joint->at_deg = copysign(END_DEG, joint->at_deg);
        joint->dps = 0;
    }
    if (joint->torque != 1) {
        joint->set_deg = joint->goal_deg = joint->at_deg;
    }
}
