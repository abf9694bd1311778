/* SPDX-License-Identifier: MIT */
/* Joints as text and JSON, the same wherever they are shown. */
#ifndef GRCTL_RENDER_H
#define GRCTL_RENDER_H

#include "tools/grctl/conn/conn.h"

/* The joints of a mask, as `status --json` promises them. */
json_t *render_joints_json(const conn *c, grobo_joint_mask joints);

/* What of a joint's servo is not as the joint needs it: {"message", "fix"}. NULL: nothing is. */
json_t *render_setup_json(const conn *c, int joint);

/* The table of `status`; joints in the mask only. */
void render_status(const conn *c, grobo_joint_mask joints);

/* Name, target, reached and error of every joint that has a target. */
void render_reached(const conn *c);
/* The largest error among them in degrees, its joint in *joint (-1: none is known). */
double render_worst_error(const conn *c, int *joint);

/*
 * Where the joint was sent: by this process, or as its servo reports. A servo without torque keeps
 * an old goal that it does not go to. False: it is not known.
 */
bool render_target(const grobo_joint_info *info, double *target_rad);

/* "on", "off", "brake" or "?". */
const char *render_torque(const grobo_joint_info *info);

#endif
