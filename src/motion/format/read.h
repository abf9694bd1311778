/* SPDX-License-Identifier: MIT */
/* The readers of the formats: each reads reader->input into reader->motion. */
#ifndef GROBO_MOTION_READ_H
#define GROBO_MOTION_READ_H

#include "src/motion/format/reader.h"

int grobo_i_read_m(grobo_i_reader *reader);
/* If forced, another format than the one given is refused; else it is doubted only. */
int grobo_i_read_yaml(grobo_i_reader *reader, grobo_motion_format format, bool forced);

#endif
