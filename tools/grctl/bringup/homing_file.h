/* SPDX-License-Identifier: MIT */
/* Calibrations of servos as files: those of LeRobot, an object for each joint by its name. */
#ifndef GRCTL_HOMING_FILE_H
#define GRCTL_HOMING_FILE_H

#include "tools/grctl/cli/robot.h"

/* Of one servo, in its counts. */
typedef struct homing {
    int32_t offset; /* register OFFSET */
    int32_t min, max;
} homing;

/*
 * Reads the calibration of every joint. any: what the servos held before, whatever it was; else
 * each range must hold the middle of its servo. Returns 0, or the exit status with the reason said.
 */
int homing_read(app *a, const char *path, bool any, homing *all);

/* The same of what such a file holds; path is for messages. */
int homing_take(app *a, const char *path, const char *bytes, size_t size, bool any, homing *all);

/* Writes one; NULL: the first NAME-before.json, NAME-before2.json... that is not there. The name
 * goes to `written`. As above. */
int homing_write(app *a, const char *path, const homing *all, char *written, size_t capacity);

#endif
