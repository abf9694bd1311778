/* SPDX-License-Identifier: MIT */
/* Key poses that give the legs by ikLinks, played with the whole body: the BODY OPTIONS. */
#ifndef GRCTL_WHOLE_H
#define GRCTL_WHOLE_H

#include <grobo/body_motion.h>

#include "app.h"

/* Four options of a command, from `first` of its table on. */
enum { WHOLE_IK, WHOLE_STEP, WHOLE_ZMP, WHOLE_BALANCE, WHOLE_OPTIONS };
#define WHOLE_IK_OPTION                                                                            \
    {                                                                                              \
        .name = "ik", .kind = CLI_CHOICE, .value = "exact|numeric|off",                            \
        .help = "how ikLinks become leg angles (exact)"                                            \
    }
#define WHOLE_STEP_OPTION                                                                          \
    {                                                                                              \
        .name = "step", .kind = CLI_CHOICE, .value = "none|stealthy",                              \
        .help = "feet straight up and softly down (none)"                                          \
    }
#define WHOLE_ZMP_OPTION                                                                           \
    {                                                                                              \
        .name = "zmp", .kind = CLI_CHOICE, .value = "auto|file",                                   \
        .help = "where the weight shall be: by rule, or as drawn (file)"                           \
    }
#define WHOLE_BALANCE_OPTION                                                                       \
    {                                                                                              \
        .name = "balance", .kind = CLI_CHOICE, .value = "off|on|compat11",                         \
        .help = "move the waist so that the weight is there (off)"                                 \
    }

typedef struct whole {
    grobo_body *body; /* NULL: the motion's own angles are played */
    grobo_clip clip;
} whole;

/* The options as given, from option `first` of the command on. */
void whole_options(const app *a, int first, grobo_body_options *options);
/* True if the motion is one of GR001's that gives the legs by ikLinks, and IK is on. */
bool whole_applies(const grobo_motion *motion, const grobo_body_options *options);
/*
 * Makes the clip that plays a motion, with the whole body where that applies. The motion must
 * outlive it. Returns 0 or a library error.
 */
int whole_open(whole *w, const grobo_motion *motion, const grobo_clip_options *plain,
               const grobo_body_options *options);
void whole_close(whole *w);
/* The joints that inverse kinematics moves. */
grobo_joint_mask whole_joints(void);

/*
 * A body for grobo_body_check(): as whole_open() where that applies; else *standing is set, and the
 * legs follow their angles on two feet that are taken to stand from the first pose on.
 * Returns 0 or a library error: GROBO_ERR_TYPE for what is no motion of GR001's.
 */
int whole_body(grobo_body **body, const grobo_motion *motion, const grobo_body_options *options,
               bool *standing);

#endif
