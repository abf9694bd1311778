/* SPDX-License-Identifier: MIT */
/* Motions with the whole body: as a clip, and as a body that can be checked for balance. */
#ifndef GRCTL_WHOLE_H
#define GRCTL_WHOLE_H

#include <grobo/core/body_motion.h>

#include "tools/grctl/cli/app.h"

typedef struct whole {
    grobo_body *body; /* NULL: the motion's own angles are played */
    grobo_clip clip;
} whole;

/* A robot and its body. */
typedef struct whole_robot {
    const grobo_model *model;
    const grobo_body_model *body; /* NULL: it has no legs that are solved */
} whole_robot;

/* The robot that a motion is for; of a motion for no robot that is known the app's, without a body.
 * The body stays to the end. */
whole_robot whole_robot_of(const app *a, const grobo_motion *motion);
/* The body of a model: that of the app's robot, or of one that comes with grctl. NULL: none. */
const grobo_body_model *whole_legs(const app *a, const grobo_model *model);

/* True if the motion has poses that give the legs of its robot by ikLinks, and IK is on. */
bool whole_applies(const app *a, const grobo_motion *motion, const grobo_body_options *options);
/*
 * Makes the clip that plays a motion, with the whole body where that applies. The motion must
 * outlive it. Returns 0 or a library error.
 */
int whole_open(const app *a, whole *w, const grobo_motion *motion, const grobo_clip_options *plain,
               const grobo_body_options *options);
void whole_close(whole *w);
/* The joints that inverse kinematics moves. */
grobo_joint_mask whole_joints(const grobo_body_model *model);

/*
 * A body for grobo_body_check(): as whole_open() where that applies; else *standing is set, and the
 * legs follow their angles on two feet that are taken to stand from the first pose on.
 * Returns 0 or a library error: GROBO_ERR_TYPE for a motion of a robot without a body.
 */
int whole_body(const app *a, grobo_body **body, const grobo_motion *motion,
               const grobo_body_options *options, bool *standing);

#endif
