/* SPDX-License-Identifier: MIT */
/* The writers of the formats: each writes a motion of the kind it holds. */
#ifndef GROBO_MOTION_WRITE_H
#define GROBO_MOTION_WRITE_H

#include "src/motion/store/container.h"
#include "src/motion/store/diagnostics.h"
#include "src/motion/text/out.h"

/* What is told to a writer. */
typedef struct grobo_i_writing {
    const grobo_write_options *options;
    grobo_diagnostics *list;
    grobo_i_out *out;
} grobo_i_writing;

/* Its postures have columns. */
void grobo_i_write_m(const grobo_i_writing *writing, const grobo_motion *motion);
void grobo_i_write_pseq(const grobo_i_writing *writing, const grobo_motion *motion);
void grobo_i_write_yaml(const grobo_i_writing *writing, const grobo_motion *motion);

/* "key: value" lines of the kept keys of a level, and a link, each behind `indent` spaces. */
void grobo_i_put_kept(grobo_i_out *out, const grobo_i_kept *kept, grobo_kept_level level, int link,
                      int indent);
/* name: "value" */
void grobo_i_put_text_line(grobo_i_out *out, const char *name, const char *value);

#endif
