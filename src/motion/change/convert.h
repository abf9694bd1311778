/* SPDX-License-Identifier: MIT */
#ifndef GROBO_MOTION_CONVERT_H
#define GROBO_MOTION_CONVERT_H

#include <grobo/core/motion_io.h>

/* True for a motion that is written as it is: of that kind, with rows that the format can hold. */
bool grobo_i_is_as_written(const grobo_motion *motion, grobo_motion_kind kind,
                           const grobo_write_options *options);

#endif
