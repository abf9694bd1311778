/* SPDX-License-Identifier: MIT */
/* The robot that a command is for: one that comes with the library, or a file. */
#ifndef GRCTL_ROBOT_H
#define GRCTL_ROBOT_H

#include <grobo/robot_file.h>

#include "tools/grctl/cli/app.h"

enum { ROBOT_PATH_BYTES = 1024 };

/*
 * The robot of this name; a name with a slash or an extension is a file's. Files are read once, and
 * kept. NULL with one line of complaint: "arm.yaml:3:8: ...".
 */
const grobo_robot_def *robot_find(const char *name, char *complaint, size_t capacity);

/*
 * Chooses the robot of a command: that of --robot, else of the configuration, else of $GRCTL_ROBOT,
 * else GR001; from then on app_driver() is its. Returns 0, or the exit status with the reason said.
 */
int robot_choose(app *a);

/* For completion: the robot of a line that may have no end yet. Says nothing. */
void robot_of_words(app *a, int n, char *const *words);

/* Of a robot of several lines: this one alone from here on, as with --line. As robot_choose(). */
int robot_on_line(app *a, int line);

/* What robot_choose() has chosen. */
const grobo_robot_def *robot_of(const app *a);

/* Its simulator, with the line of the options. */
void robot_sim(const app *a, grobo_robot_sim *sim);
/* The link that holds what it carries; NULL: its file does not tell. */
const char *robot_payload_link(const app *a);
/* Gives it weight, if that is asked for: a world, freed with grobo_sim_physics_free() after the
 * simulator, else NULL. 0 or an error. */
/* What is wrong with the device of a robot of several lines, "sim", "auto" or NAME=PORT,NAME=PORT;
 * NULL: nothing, or it has one line. */
const char *robot_lines_fault(const app *a, const char *device);

int robot_physics(const app *a, grobo_sim_config *config, grobo_sim_physics **physics);

/* What robot_find() found it by, in a form that holds in another folder; "" for GR001. */
const char *robot_path(const app *a);

/* Reads a file and keeps nothing: all that is wrong goes to the list. def is the caller's. */
int robot_read(const char *path, grobo_diagnostics *list, grobo_robot_def **def);
/* Why robot_read() read nothing, where the list is empty. */
const char *robot_read_fault(int error);

#endif
