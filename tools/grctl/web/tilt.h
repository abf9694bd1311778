/* SPDX-License-Identifier: MIT */
/* How the robot's base stands by its IMU (--imu): in the state, in the picture, and its falls. */
#ifndef GRCTL_WEB_TILT_H
#define GRCTL_WEB_TILT_H

#include <jansson.h>

#include <grobo/core/body.h>
#include <grobo/posture.h>

#include "tools/grctl/conn/imu.h"

typedef struct serve serve;

typedef struct tilt {
    imu port;
    bool fallen;
} tilt;

/* Reads the IMU of the options from now on; nothing without one. 0, or the exit status. */
int tilt_open(serve *s);
void tilt_close(serve *s);

/* Of the state; null: no reading is there, or the last one is old. */
json_t *tilt_json(serve *s);

/* Turns a body that stands by its joints as the IMU has it, where that is another way. Returns
 * whether it is. */
bool tilt_apply(serve *s, const grobo_posture *posture, grobo_body_stand *stood);

#endif
