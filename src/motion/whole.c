/* SPDX-License-Identifier: MIT */
/* Editing whole motions: each works on a copy and takes it over when all went well. */
#include <math.h>
#include <string.h>

#include "motion/container.h"

static bool same_rate(const grobo_motion *a, const grobo_motion *b)
{
    return a->frame_times == b->frame_times &&
           (a->frame_times || a->frame_rate_hz == b->frame_rate_hz);
}

/* Rows of other behind those of motion, which is as before if that fails. */
static int append_rows(grobo_motion *motion, const grobo_motion *other, double shift_s)
{
    size_t size = motion->size;

    if (motion->kind != other->kind || !same_rate(motion, other)) {
        return GROBO_ERR_TYPE;
    }
    if (other->n_joints > motion->n_joints) {
        return GROBO_ERR_ARG;
    }
    /* Its size is read before: a motion may be appended to itself. */
    int result = grobo_i_copy_rows(motion, other, 0, other->size, shift_s);
    while (result < 0 && motion->size > size) {
        grobo_i_row_remove(motion, motion->size - 1);
    }
    return result;
}

static double end_s(const grobo_motion *motion)
{
    return motion->size > 0 ? grobo_i_time_s(motion, motion->size - 1) : 0;
}

int grobo_motion_append_motion(grobo_motion *motion, const grobo_motion *other)
{
    return append_rows(motion, other, end_s(motion));
}
