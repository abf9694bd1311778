/* SPDX-License-Identifier: MIT */
/* How a shaft of the far side turns. */
#include <math.h>
#include <string.h>

#include "tests/support/far_side.h"

#define SECOND_US 1e6
#define SLICE_US 500
/* Rounding. */
#define EQUAL_DEG 1e-6
/* A ramp ends where the goal is so near and the shaft so slow. */
#define NEAR_DEG 0.02

static void arrive(far_joint *joint, double dps, double seconds)
{
    joint->last_dps = dps;
    joint->last_us = joint->at_us + (int64_t)(seconds * SECOND_US);
    joint->at_deg = joint->goal_deg;
    joint->dps = 0;
}

/* Straight: no ramps. */
static void glide(far_joint *joint, double seconds)
{
    double way_deg = joint->goal_deg - joint->at_deg;
    double step_deg = joint->cruise_dps * seconds;
    if (fabs(way_deg) <= step_deg + EQUAL_DEG) {
        arrive(joint, copysign(joint->cruise_dps, way_deg), fabs(way_deg) / joint->cruise_dps);
        return;
    }
    joint->dps = copysign(joint->cruise_dps, way_deg);
    joint->at_deg += joint->dps * seconds;
}

/* It speeds up and brakes; a goal that is nearer than it can brake is passed, and come back to. */
static void ramp(far_joint *joint, double seconds)
{
    double way_deg = joint->goal_deg - joint->at_deg;
    double change_dps = joint->accel_dps2 * seconds;
    double most_dps = fmin(joint->cruise_dps, sqrt(2 * joint->accel_dps2 * fabs(way_deg)));
    double want_dps = copysign(most_dps, way_deg);
    if (fabs(way_deg) < NEAR_DEG && fabs(joint->dps) <= 2 * change_dps) {
        arrive(joint, joint->dps, 0);
        return;
    }
    joint->dps += fmin(fmax(want_dps - joint->dps, -change_dps), change_dps);
    joint->at_deg += joint->dps * seconds;
}

/* Its loop of speed is without a ramp of its own. */
static void spin(far_joint *joint, int64_t until_us)
{
    joint->dps = joint->torque == 1 ? joint->wheel_dps : 0;
    joint->dps = fmin(fmax(joint->dps, -joint->top_dps), joint->top_dps);
    joint->at_deg += joint->dps * (double)(until_us - joint->at_us) / SECOND_US;
    joint->goal_deg = joint->at_deg;
    joint->at_us = until_us;
}

static void turn(far_joint *joint, int64_t until_us)
{
    if (joint->wheel) {
        spin(joint, until_us > joint->at_us ? until_us : joint->at_us);
        return;
    }
    if (joint->torque != 1 || (joint->dps == 0 && joint->at_deg == joint->goal_deg)) {
        joint->dps = 0;
        joint->at_us = until_us;
        return;
    }
    while (joint->at_us < until_us) {
        int64_t slice_us = until_us - joint->at_us;
        if (joint->accel_dps2 > 0) {
            slice_us = slice_us < SLICE_US ? slice_us : SLICE_US;
            ramp(joint, (double)slice_us / SECOND_US);
        } else {
            glide(joint, (double)slice_us / SECOND_US);
        }
        joint->at_us += slice_us;
    }
}

static double length_of(const far_joint *joint)
{
    double way_deg = fabs(joint->goal_deg - joint->at_deg);
    return joint->cruise_dps > 0 ? way_deg / joint->cruise_dps * SECOND_US : 0;
}

/* Begins the way to the goal that the registers hold. */
static void set_out(far_joint *joint)
{
    joint->waits = false;
    joint->family->plan(joint, &joint->goal_deg, &joint->cruise_dps, &joint->accel_dps2);
    if (joint->leaps || joint->cruise_dps <= 0 || joint->cruise_dps > joint->top_dps) {
        joint->cruise_dps = joint->top_dps;
    }
    joint->leaps = false;
    joint->begun_us = joint->at_us;
    joint->length_us = (int64_t)length_of(joint);
}

void far_turn_to(far_joint *joint, int64_t now_us)
{
    if (joint->family->watch != NULL) {
        joint->family->watch(joint, now_us);
    }
    joint->waits = joint->waits && !joint->wheel; /* of goals */
    if (joint->waits && joint->wakes_us <= now_us) {
        turn(joint, joint->wakes_us);
        set_out(joint);
    }
    turn(joint, now_us);
}

double far_angle(far_side *far, int joint, int64_t now_us)
{
    far_turn_to(&far->joint[joint], now_us);
    return far->joint[joint].at_deg;
}

bool far_turns(far_side *far, int joint, int64_t now_us)
{
    const far_joint *j = &far->joint[joint];
    (void)far_angle(far, joint, now_us);
    return j->torque == 1 && (j->waits || j->dps != 0 || fabs(j->goal_deg - j->at_deg) > NEAR_DEG);
}
