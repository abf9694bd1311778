/* SPDX-License-Identifier: MIT */
/* One line of a robot that has several, as a robot of its own: what --line names. */
#ifndef GRCTL_NARROW_H
#define GRCTL_NARROW_H

#include <grobo/robot_file.h>

#include "tools/grctl/cli/app.h"

/* The line of this name, 0..n_lines-1; negative: there is none. */
int narrow_find(const grobo_robot_def *def, const char *name);

/*
 * The part of a robot that is on a line: its joints, rate and family, no links and no feet. Joints
 * have the names that they have in the robot, and its number there is the index in the mask of
 * grobo_lines.on. Lives as long as the process. NULL: no memory.
 */
const grobo_robot_def *narrow_def(const grobo_robot_def *def, int line);

/* The port of a line in the device of the whole robot: NAME=PORT,NAME=PORT, sim, auto (the file's
 * port), or a port alone. False: it has none, or a longer one than fits. */
bool narrow_device(const grobo_robot_def *def, int line, const char *device, char *port,
                   size_t capacity);

/*
 * The command speaks to this line alone from here on: def, device, rate, echo, wiring and trims are
 * those of the line. a->def is the whole robot. Returns 0, or the exit status with the reason said.
 */
int narrow_to(app *a, int line);

#endif
