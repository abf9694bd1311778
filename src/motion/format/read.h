/* SPDX-License-Identifier: MIT */
/* The readers of the formats: each reads reader->input into reader->motion. */
#ifndef GROBO_MOTION_READ_H
#define GROBO_MOTION_READ_H

#include "src/motion/format/reader.h"

int grobo_i_read_m(grobo_i_reader *reader);
/* Of the formats that are YAML, whichever it is: its kind becomes the motion's, and the place where
 * that stands is kept in reader->top. */
int grobo_i_read_yaml(grobo_i_reader *reader);

/* Of a .m file the first word that is no comment is a number with another one behind it. */
bool grobo_i_sniff_m(const unsigned char *text, size_t size);

#endif
