/* SPDX-License-Identifier: MIT */
/* The device behind a name: is it there, may it be opened, and what mends it. */
#ifndef GRCTL_NODE_H
#define GRCTL_NODE_H

#include <stdbool.h>
#include <stddef.h>

/* What was looked at, and how it is. fix: NULL, or it is wrong, and this line mends it. */
typedef void (*node_found_fn)(void *ctx, const char *name, const char *fix, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Is the device there, and may the user open it? True: go on. */
bool node_look(const char *device, node_found_fn found, void *ctx);
/* What a device's name leads to, as the list of ports calls it. */
bool node_true_path(const char *device, char *path, size_t capacity);
/* How to end the program that has the port. */
void node_end_program(char *fix, size_t capacity, int pid);
/* The motion of this name that is installed with the command. False: there is none. */
bool node_installed_motion(const char *name, char *path, size_t capacity);
/* The line that makes an adapter's latency timer short. */
void node_quicken(char *fix, size_t capacity, const char *path);

#endif
