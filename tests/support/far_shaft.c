/* SPDX-License-Identifier: MIT */
/* How a set point of the far side goes to its goal, and the shaft with it. */
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
    joint->set_deg = joint->goal_deg;
    joint->set_dps = 0;
}

/* Straight: no ramps. */
static void glide(far_joint *joint, double seconds)
{
    double way_deg = joint->goal_deg - joint->set_deg;
    double step_deg = joint->cruise_dps * seconds;
    if (fabs(way_deg) <= step_deg + EQUAL_DEG) {
        arrive(joint, copysign(joint->cruise_dps, way_deg), fabs(way_deg) / joint->cruise_dps);
        return;
    }
    joint->set_dps = copysign(joint->cruise_dps, way_deg);
    joint->set_deg += joint->set_dps * seconds;
}

/* It speeds up and brakes; a goal that is nearer than it can brake is passed, and come back to. */
static void ramp(far_joint *joint, double seconds)
{
    double way_deg = joint->goal_deg - joint->set_deg;
    double change_dps = joint->accel_dps2 * seconds;
    double most_dps = fmin(joint->cruise_dps, sqrt(2 * joint->accel_dps2 * fabs(way_deg)));
    double want_dps = copysign(most_dps, way_deg);
    if (fabs(way_deg) < NEAR_DEG && fabs(joint->set_dps) <= 2 * change_dps) {
        arrive(joint, joint->set_dps, 0);
        return;
    }
    joint->set_dps += fmin(fmax(want_dps - joint->set_dps, -change_dps), change_dps);
    joint->set_deg += joint->set_dps * seconds;
}

/* Its loop of speed is without a ramp of its own. */
static void spin(far_joint *joint, int64_t until_us)
{
    joint->dps = joint->torque == 1 ? joint->wheel_dps : 0;
    joint->dps = fmin(fmax(joint->dps, -joint->top_dps), joint->top_dps);
    joint->at_deg += joint->dps * (double)(until_us - joint->at_us) / SECOND_US;
    joint->goal_deg = joint->set_deg = joint->at_deg;
    joint->set_dps = 0;
    joint->at_us = until_us;
}

static void advance(far_joint *joint, double seconds)
{
    if (joint->torque != 1 || (joint->set_dps == 0 && joint->set_deg == joint->goal_deg)) {
        joint->set_dps = 0;
    } else if (joint->accel_dps2 > 0) {
        ramp(joint, seconds);
    } else {
        glide(joint, seconds);
    }
}

/* How long one step may be. */
static int64_t slice_of(const far_joint *joint)
{
    bool at_goal = joint->torque != 1 || (joint->set_dps == 0 && joint->set_deg == joint->goal_deg);
    bool steps = joint->sag_deg != 0 || (joint->accel_dps2 > 0 && !at_goal);
    return steps ? SLICE_US : INT64_MAX;
}

static void turn(far_joint *joint, int64_t until_us)
{
    if (joint->wheel) {
        spin(joint, until_us > joint->at_us ? until_us : joint->at_us);
        return;
    }
    while (joint->at_us < until_us) {
        int64_t left_us = until_us - joint->at_us, most_us = slice_of(joint);
        double seconds = (double)(left_us < most_us ? left_us : most_us) / SECOND_US;
        advance(joint, seconds);
        if (joint->sag_deg != 0) {
            far_pull(joint, seconds);
        } else {
            joint->at_deg = joint->set_deg;
            joint->dps = joint->set_dps;
        }
        joint->at_us += left_us < most_us ? left_us : most_us;
    }
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
    bool goes = j->waits || j->set_dps != 0 || fabs(j->goal_deg - j->set_deg) > NEAR_DEG;
    return (j->torque == 1 && goes) || j->dps != 0;
}
