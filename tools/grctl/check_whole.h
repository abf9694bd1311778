/* SPDX-License-Identifier: MIT */
/* What goes wrong when a motion is played with the whole body. */
#ifndef GRCTL_CHECK_WHOLE_H
#define GRCTL_CHECK_WHOLE_H

#include <grobo/motion_io.h>

#include "whole.h"

/*
 * Adds what is wrong after inverse kinematics to a list: targets out of reach, limits, speeds; with
 * `balance` also where the ZMP leaves the soles and where feet slip, for motions without targets
 * too. Returns 0 or a library error.
 */
int check_whole(const char *path, const grobo_motion *motion, const grobo_body_options *options,
                bool balance, grobo_diagnostics *list);

#endif
