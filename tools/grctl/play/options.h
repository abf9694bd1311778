/* SPDX-License-Identifier: MIT */
/* BODY OPTIONS: how legs that a key-pose file gives by ikLinks are solved. */
#ifndef GRCTL_BODY_OPTIONS_H
#define GRCTL_BODY_OPTIONS_H

#include <grobo/core/body_motion.h>
#include <grobo/core/motion_io.h>

#include "tools/grctl/cli/app.h"

enum { BODY_LIKE, BODY_IK, BODY_STEP, BODY_ZMP, BODY_BALANCE, BODY_OPTIONS };

/* The rows of a command's table, from row `base` on; the words of ik, step and balance are in the
 * order of the enums of body.h. How legs are solved, */
#define BODY_LEG_ROWS(base)                                                                        \
    [(base) +                                                                                      \
        BODY_LIKE] = OPTION_CHOICE("like", 0, "choreonoid|choreonoid-1.1|robot",                   \
                                   "solve legs as these do; the options below change it"),         \
        [(base) + BODY_IK] = OPTION_CHOICE("ik", 0, "exact|numeric|off",                           \
                                           "solve legs given by ikLinks (exact), or ignore them"), \
        [(base) + BODY_STEP] =                                                                     \
            OPTION_CHOICE("step", 0, "none|stealthy", "soften lift and landing of feet (none)"),   \
        [(base) + BODY_ZMP] = OPTION_CHOICE(                                                       \
            "zmp", 0, "auto|file", "source of the desired ZMP (file; auto with a balancer)")

/* and whether the waist is moved; for play and convert, */
#define BODY_OPTION_ROWS(base)                                                                     \
    BODY_LEG_ROWS(base),                                                                           \
        [(base) + BODY_BALANCE] =                                                                  \
            OPTION_CHOICE("balance", 0, "off|on|compat11",                                         \
                          "shift the waist to keep balance (off); compat11 as Choreonoid 1.1")

/* for check and plot, which look at the balance when the option is given, even without a word. */
#define BODY_LOOK_ROWS(base)                                                                       \
    BODY_LEG_ROWS(base),                                                                           \
        [(base) + BODY_BALANCE] = {.name = "balance",                                              \
                                   .kind = CLI_CHOICE,                                             \
                                   .value = "off|on|compat11",                                     \
                                   .optional = true,                                               \
                                   .help = "would it fall? on: with the waist shifted to keep it"}

/* Beside them, for show and plot: which joints, and the motion as it is sent. */
#define MOTION_LOOK_ROWS(joints, rate, rate_help)                                                  \
    [joints] = OPTION_TEXT("joints", 'j', "LIST", "only these joints or groups, split by commas"), \
    [rate] = OPTION_REAL("rate", 'r', "HZ", 0.1, 1000, rate_help)

/*
 * The options as given, at a rate (0: the default): what --like names, changed by the others. A
 * balancer without --zmp has automatic ZMP. Returns 0, or the exit status with the reason said: a
 * balancer without IK.
 */
int body_options_read(app *a, int base, double rate_hz, grobo_body_options *options);
/* True if any of them was given. */
bool body_options_given(const app *a, int base);

/*
 * Makes a body for a motion whose legs are given by ikLinks; *body stays NULL for any other motion
 * and with --ik off. Returns 0, or the exit status with the reason said. grobo_body_free() after.
 */
int body_make(app *a, int base, const char *path, const grobo_motion *motion, double rate_hz,
              grobo_body **body);

/*
 * Refuses what a robot cannot do: legs that do not reach, angles beyond limits. Those within the
 * slack of a limit are counted. 0 or the status.
 */
int body_refuse(app *a, const char *path, const grobo_motion *motion, grobo_body *body,
                grobo_slack_taken *slack);

/*
 * The motion with its legs solved: frames at a rate, or (0) a posture a key time. It belongs to the
 * caller; *solved stays NULL as *body above. 0 or the status.
 */
int body_solve(app *a, int base, const char *path, const grobo_motion *motion, double rate_hz,
               grobo_motion **solved);

#endif
