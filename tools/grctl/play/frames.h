/* SPDX-License-Identifier: MIT */
/* How evenly the frames of a motion went out. */
#ifndef GRCTL_PLAY_FRAMES_H
#define GRCTL_PLAY_FRAMES_H

#include "tools/grctl/conn/conn.h"

/* {"done": true, "frames", "late_frames", "jitter_us"} since the command began. */
json_t *frames_json(const conn *c);
/* The same as a line; name: "a: " of a group, or "". */
void frames_print(const conn *c, const char *name);

#endif
