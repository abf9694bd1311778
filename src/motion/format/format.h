/* SPDX-License-Identifier: MIT */
/* The formats of motion files, a row each: format.c is the one list of them. */
#ifndef GROBO_MOTION_FORMAT_H
#define GROBO_MOTION_FORMAT_H

#include "src/motion/format/read.h"
#include "src/motion/format/write.h"

typedef struct grobo_i_format {
    const char *name;          /* as it is asked for; also an extension */
    const char *extensions[2]; /* others, in small letters, NULL behind the last */
    grobo_motion_kind kind;    /* of the motions that it holds */
    /* Whether a file that begins with these bytes is one, by its content alone. NULL: it is read as
     * one where no other format says so, and its reader finds the kind. */
    bool (*sniff)(const unsigned char *text, size_t size);
    int (*read)(grobo_i_reader *reader);
    void (*write)(const grobo_i_writing *writing, const grobo_motion *motion);
} grobo_i_format;

/* The row of a format; NULL for GROBO_FORMAT_AUTO, and for a number that is none. */
const grobo_i_format *grobo_i_format_row(grobo_motion_format format);

/* The row that a file which begins with these bytes is read by. */
const grobo_i_format *grobo_i_format_sniff(const unsigned char *text, size_t size);

#endif
