/* SPDX-License-Identifier: MIT */
/*
 * The second process that stops the robot when this one dies (grobo/guard.h): grctl itself, called
 * "grctl guard". Nobody types that.
 */
#ifndef GRCTL_GUARD_H
#define GRCTL_GUARD_H

#include <grobo/guard.h>

#include "tools/grctl/cli/config.h"

/* How main() was called. */
void guard_note_program(const char *argv0);

/* The guard's own main(). Returns its exit status. */
int guard_main(void);

/*
 * For a command that moves the robot at this device: starts the guard, before an event base, a
 * thread or a port is made. Does nothing where there is one, where the system has none, and for a
 * simulator in process. That there is none is said in a line, and is no failure.
 */
void guard_start(const app *a, const char *device);

/* The guard that was started, or NULL. */
grobo_guard *guard_started(void);

/* What it needs to make the driver of a configured robot; *bytes 0 for one without trims. */
const void *guard_data(const app *a, size_t *bytes);

/* After the session that has it was freed. */
void guard_end(void);

/* Does a guard of a program that died have that port, or with `auto` any? It will release it. */
bool guard_has(const char *device);

#endif
