/* SPDX-License-Identifier: MIT */
/* From a sketch to a robot's file: servos and ids of the command line; checked and written. */
#ifndef GRCTL_SKETCH_MAKE_H
#define GRCTL_SKETCH_MAKE_H

#include "tools/grctl/sketch/sketch.h"

typedef struct sketch_orders {
    const char *family; /* as a robot's file names it; NULL: a guess */
    const char *servos; /* "STS3215", or one for each joint with commas; NULL: a guess */
    const char *ids;    /* "1-4,7"; NULL: from 1 on */
    const char *name;   /* of the robot; NULL: that of the description */
    const char *out;    /* the file; NULL: standard output */
} sketch_orders;

/* Reads a URDF or a body, and writes a robot's file. Returns the exit status. */
int sketch_import(app *a, const char *path, const sketch_orders *orders);

/* Writes the file of a sketch whose joints have servos and ids, once its reader has nothing against
 * it. A file that is there is replaced with --yes only. fits: names of robots for JSON, borrowed,
 * or NULL. Returns the exit status. */
int sketch_write(app *a, sketch *s, const char *out, json_t *fits);

#endif
