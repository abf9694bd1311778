/* SPDX-License-Identifier: MIT */
/*
 * The second process that stops the robot when this one dies (grobo/guard.h): grctl itself, called
 * "grctl guard". Nobody types that.
 */
#ifndef GRCTL_GUARD_H
#define GRCTL_GUARD_H

#include <grobo/guard.h>

#include "tools/grctl/cli/config.h"
#include "tools/grctl/cli/robot.h"

/* Of a configured robot, or of another than GR001, as it goes to the guard. Other programs, such as
 * those in Python, give the first field alone, as far as its NUL. */
typedef struct guard_robot {
    char robot[ROBOT_PATH_BYTES - 64]; /* what robot_find() takes; "": GR001 */
    bool trimmed;
    double trim_deg[GROBO_JOINTS_MAX];
    double offset_deg[GROBO_JOINTS_MAX];
    bool offsets;
} guard_robot;

/* How main() was called. */
void guard_note_program(const char *argv0);

/* The guard's own main(). Returns its exit status. */
int guard_main(void);

/*
 * For a command that moves the robot at this device: starts a guard of it, before its port is
 * opened; before an event base too where there is one robot. Does nothing where there is one, where
 * the system has none, and for a simulator in process. That there is none is said in a line, and is
 * no failure. Freed by grobo_guard_free(), after the session that has it was.
 */
void guard_start(const app *a, const char *device, grobo_guard **guard);

/* What it needs to make the driver of a configured robot; 0 bytes for one without trims. */
size_t guard_data(const app *a, guard_robot *given);

/* Does a guard of a program that died have that port, or with `auto` any? It will release it. */
bool guard_has(const char *device);

#endif
