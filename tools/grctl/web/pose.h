/* SPDX-License-Identifier: MIT */
/* What a picture of the robot is drawn from: its parts, where they stand, how it balances. */
#ifndef GRCTL_WEB_POSE_H
#define GRCTL_WEB_POSE_H

#include <jansson.h>

#include <grobo/core/body.h>
#include <grobo/posture.h>

#include "tools/grctl/cli/app.h"

typedef struct serve serve;
typedef struct http_request http_request;

/* The body of the command's robot, or NULL. */
const grobo_body_model *pose_body(const app *a);

/* Of /api/robot. */
json_t *pose_links_json(const app *a);
json_t *pose_feet_json(const app *a);
/* Stands a posture: joints that it does not set are at their initial angles. False: no body. */
bool pose_stand(const app *a, const grobo_posture *posture, grobo_body_stand *stood);
/* Angles in degrees; null: not set. */
json_t *pose_angles_json(const grobo_posture *posture, int n_joints, int decimals);
/* Where the root is then; null: no body. */
json_t *pose_root_json(const app *a, const grobo_posture *posture);
json_t *pose_placement_json(const grobo_transform *at);
/* Of a body; point: the ZMP, or NULL. */
json_t *pose_stand_json(const grobo_body_stand *stand, const double *zmp_m);

/* The rotation, row by row, about z, then y, then x. */
void pose_rotation(double r[9], const double rpy_rad[3]);

/* Place and attitude by their lists; what is NULL or missing stays. False: it is none. */
bool pose_read_placement(const json_t *p_m, const json_t *rotation, grobo_transform *at);

void pose_ik(serve *s, http_request *r, const json_t *body);

#endif
