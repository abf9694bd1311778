/* SPDX-License-Identifier: MIT */
/* The robot of a transaction that is measured: a joint of one RS30x straight on the line. */
#ifndef GROBO_BENCH_ONE_SERVO_H
#define GROBO_BENCH_ONE_SERVO_H

#include <grobo/core/driver.h>

static const grobo_joint one_servo_joint = {
    .name = "J", .min_rad = -1, .max_rad = 1, .max_speed_rad_s = 1, .motor = 1, .mirror_sign = 1};
static const grobo_model one_servo_model = GROBO_TABLE(
    grobo_model, .name = "one servo", GROBO_MODEL_JOINTS(&one_servo_joint), .n_joints = 1);

#endif
