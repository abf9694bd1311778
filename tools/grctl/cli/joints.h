/* SPDX-License-Identifier: MIT */
/* Joints and groups as people name them: R_KNEE_P, m12, j3, right_arm, 0..7. */
#ifndef GRCTL_JOINTS_H
#define GRCTL_JOINTS_H

#include <grobo/posture.h>

#include "tools/grctl/cli/app.h"

/* The joint, or also the group, whose name is nearest to a mistyped one; NULL: none is near. */
const char *joints_nearest(const grobo_model *model, const char *name, size_t length, bool groups);
/* Names of joints and groups, none: all; on failure says so and returns the exit status, else 0. */
int joints_parse_all(app *a, int n, const char *const *names, grobo_joint_mask *joints);
/*
 * Names split by commas, of a motion's joints: j0, j1 .. always, other names by its model (NULL:
 * none). As joints_parse_all().
 */
int joints_parse_motion(app *a, const char *list, const grobo_model *model, int n_joints,
                        grobo_joint_mask *joints);
/* One joint alone. Returns the joint, or -1 with *status set and said. */
int joints_parse_one(app *a, const char *name, size_t length, int *status);
/* Refuses a posture with an angle outside its limits: says which, returns the exit status, or 0. */
int joints_check_limits(app *a, const grobo_posture *posture, const char *doing);
/* Their numbers as a list, and the names of the groups that a joint is in. */
json_t *joints_json(grobo_joint_mask joints);
json_t *joints_groups_json(const grobo_model *model, int joint);

#endif
