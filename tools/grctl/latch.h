/* SPDX-License-Identifier: MIT */
/*
 * An emergency stop outlives the command that made it: a mark for the device, among the files of
 * the user that last until log-out, that every command that moves looks at. A simulator in process
 * has none.
 */
#ifndef GRCTL_LATCH_H
#define GRCTL_LATCH_H

#include <stdbool.h>

/* Both return 0 or GROBO_ERR_*; setting twice and clearing what is not set are fine. */
int latch_set(const char *device);
int latch_clear(const char *device);

bool latch_is_set(const char *device);

#endif
