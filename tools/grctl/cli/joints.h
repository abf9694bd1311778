/* SPDX-License-Identifier: MIT */
/* Joints and groups as people name them: R_KNEE_P, m12, j3, right_arm, 0..7. */
#ifndef GRCTL_JOINTS_H
#define GRCTL_JOINTS_H

#include <grobo/core/unit.h>
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
/*
 * A joint's servo as a command of a hint names it: its id behind `prefix` ("12", "m12"), or the
 * joint's name where lines of the robot may have the same ids. The text is the buffer's.
 */
enum { JOINTS_SERVO_BYTES = 80 };
const char *joints_servo(const app *a, int joint, const char *prefix, char *buffer);
/* The same of a servo of the only line, which may be no joint's. */
const char *joints_servo_of(const app *a, int id, const char *prefix, char *buffer);
/* Refuses a posture with an angle outside its limits: says which, returns the exit status, or 0. */
int joints_check_limits(app *a, const grobo_posture *posture, const char *doing);
/* An angle as a person gives it: a number in the joint's unit ("50"), or with its unit behind it
 * ("50%", "120mm", "-40deg"; degrees of any joint). */
bool joints_read_angle(const grobo_model *model, int joint, const char *text, double *angle_rad);
/* An angle as a person reads it: "-40.0 deg", "120.0 mm", "50.0 %". The text is the buffer's. */
enum { JOINTS_TEXT_BYTES = 40 };
const char *joints_text(const grobo_model *model, int joint, double angle_rad, int decimals,
                        char *buffer);
/* The same of an error in degrees, which has no sign. */
const char *joints_error_text(const grobo_model *model, int joint, double deg, char *buffer);
/* What stands behind a number in a column: nothing for degrees, else "mm" or "% ". Two columns
 * wide, in the gap before the next column. */
const char *joints_mark(const grobo_model *model, int joint);
/* Adds the unit of a joint and values in it to an object of JSON, beside those in degrees; a joint
 * in degrees has neither. NAN is null. */
void joints_add_unit(json_t *object, const grobo_model *model, int joint);
/* The same, with the angle of its 0 and the degrees of 1 of it. */
void joints_add_scale(json_t *object, const grobo_model *model, int joint);
void joints_add_value(json_t *object, const char *key, const grobo_model *model, int joint,
                      double angle_rad);
/* Their numbers as a list, and the names of the groups that a joint is in. */
json_t *joints_json(grobo_joint_mask joints);
json_t *joints_groups_json(const grobo_model *model, int joint);

#endif
