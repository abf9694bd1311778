/* SPDX-License-Identifier: MIT */
/* From a sketch to a robot's file: servos and ids of the command line; checked and written. */
#ifndef GRCTL_SKETCH_MAKE_H
#define GRCTL_SKETCH_MAKE_H

#include "tools/grctl/robot/sketch.h"

enum { SKETCH_ANSWER_BYTES = 256 };

typedef struct sketch_orders {
    const char *family; /* as a robot's file names it; NULL: a guess */
    const char *servos; /* "STS3215", or one for each joint with commas; NULL: a guess */
    const char *ids;    /* "turn=3,lift=4", "@FILE", or "1-4,7" along the chain; NULL: not given */
    bool as_listed;     /* joints in the order of a URDF, not along the chain */
    const char *name;   /* of the robot; NULL: that of the description */
    const char *out;    /* the file; NULL: standard output */
    /* Asks a person for a line of at most SKETCH_ANSWER_BYTES; false: none came. NULL: no person is
     * there. */
    bool (*ask)(const app *a, const char *question, const char *usual, char *answer);
} sketch_orders;

/* Reads a URDF or a body, and writes a robot's file. Returns the exit status. */
int sketch_import(app *a, const char *path, const sketch_orders *orders);

/*
 * The id of each joint: as given by name; as of a robot's file; as of the robot of the library
 * whose joints have these names; as listed, along the chain, once a person has seen which joint
 * gets which, or with --yes; or as a person answers. None is guessed. 0, or the exit status.
 */
int sketch_give_ids(app *a, sketch *s, const sketch_orders *orders);
/* Reports the ids that were taken from a robot of the library. */
void sketch_say_ids(const app *a, sketch *s, const sketch_orders *orders);

/* The robot of the library whose joints have the names of a model's, in any order; NULL: none. */
const grobo_robot_def *sketch_namesake(const grobo_model *model);

/* Writes the file of a sketch whose joints have servos and ids, once its reader has nothing against
 * it. A file that is there is replaced with --yes only. fits: names of robots for JSON, borrowed,
 * or NULL. Returns the exit status. */
int sketch_write(app *a, sketch *s, const char *out, json_t *fits);

/* Writes a text to a file, unless it is there already. Returns 0, or the exit status. */
int sketch_save(app *a, const char *out, const char *text);

/* Writes a robot's links and joints as MJCF or URDF, to a file or (out NULL) to standard output. */
int sketch_export(app *a, const grobo_robot_def *def, bool urdf, bool free_base, const char *out);

#endif
