/* SPDX-License-Identifier: MIT */
/* What goes wrong when a motion is played with the whole body. */
#ifndef GRCTL_CHECK_WHOLE_H
#define GRCTL_CHECK_WHOLE_H

#include <grobo/core/motion_io.h>

#include "tools/grctl/play/whole.h"

/* What is looked for. */
enum {
    CHECK_LEGS = 1,    /* after inverse kinematics: targets out of reach, limits, speeds */
    CHECK_BALANCE = 2, /* where the ZMP leaves the soles and where feet slip */
    CHECK_FALL = 4     /* one warning where the robot would fall, where that is certain */
};

/* Feet that are taken to stand and move more than this do not stand: such a motion steps. */
#define CHECK_STEP_LEAST_M 0.005

typedef struct check_whole_how {
    const char *path;   /* for diagnostics */
    unsigned what;      /* CHECK_... */
    uint16_t speed_pct; /* as it is played; 0: 100 */
    /* Solved angles that are played at a limit are no problem, and are added here. */
    grobo_slack_taken *slack;
} check_whole_how;

/*
 * Adds what is wrong when a motion is played with the whole body to a list; balance is judged for
 * motions without targets too. Returns 0 or a library error.
 */
int check_whole(const app *a, const grobo_motion *motion, const grobo_body_options *options,
                const check_whole_how *how, grobo_diagnostics *list);

/* True if a solved angle exceeds its limit by no more than the robot's slack. */
bool check_takes_slack(const grobo_model *model, const grobo_body_finding *limit);
/* Adds that to what was counted. */
void check_add_slack(grobo_slack_taken *slack, const grobo_body_finding *limit);
/* The one warning of angles that are played at a limit, where there are any. */
void check_report_slack(const char *path, const grobo_model *model, const grobo_slack_taken *slack,
                        grobo_diagnostics *list);

#endif
