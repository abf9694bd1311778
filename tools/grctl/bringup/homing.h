/* SPDX-License-Identifier: MIT */
/*
 * Calibration of servos that keep it themselves: where their middle is, and how far they go. The
 * hand does the moving, torque is off all the time.
 */
#ifndef GRCTL_HOMING_H
#define GRCTL_HOMING_H

#include "tools/grctl/cli/app.h"

typedef struct homing_orders {
    const char *from;    /* a calibration to be taken, or NULL */
    const char *restore; /* what was there before, to be written as it is, or NULL */
    const char *out;     /* where the calibration is kept; NULL: NAME-calibration.json */
    bool dry_run;
} homing_orders;

/* Whether the servos of the robot keep how far they go. */
bool homing_fits(const app *a);

/* Carries it out. Returns the exit status. */
int homing_run(app *a, const homing_orders *orders);

#endif
