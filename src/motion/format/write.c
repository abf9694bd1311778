/* SPDX-License-Identifier: MIT */
#include "src/base/sized.h"
#include "src/motion/change/convert.h"
#include "src/motion/format/format.h"

/* Postures without joints are no lines. */
static int check_writable(const grobo_motion *motion, const grobo_i_writing *writing)
{
    bool frames = motion->kind == GROBO_MOTION_FRAMES;

    if ((frames || motion->kind == GROBO_MOTION_POSTURES) && motion->size > 0 &&
        motion->n_joints == 0) {
        grobo_i_say(writing->list,
                    &(grobo_i_said){writing->options->name, "empty", 0, 0, GROBO_SEVERITY_ERROR},
                    "no posture sets any joint");
        return GROBO_ERR_EMPTY;
    }
    return frames && motion->size > 0 && !(motion->frame_rate_hz > 0) ? GROBO_ERR_STATE : 0;
}

int grobo_motion_write(const grobo_motion *motion, grobo_motion_format format,
                       const grobo_write_options *options, const grobo_sink *sink,
                       grobo_diagnostics *list)
{
    if (sink == NULL || motion == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_write_options how;
    grobo_i_out out;
    grobo_i_writing writing = {&how, list, &out};
    grobo_motion *converted = NULL;

    if (grobo_i_sized_take(&how, sizeof how, options) < 0 ||
        (format != GROBO_FORMAT_AUTO && grobo_i_format_row(format) == NULL)) {
        return GROBO_ERR_ARG;
    }
    if (format == GROBO_FORMAT_AUTO) {
        format = grobo_motion_kind_format(motion->kind);
    }
    const grobo_i_format *row = grobo_i_format_row(format);
    grobo_motion_kind kind = row->kind;
    if (!grobo_i_is_as_written(motion, kind, writing.options)) {
        int result = grobo_motion_convert(motion, kind, writing.options, list, &converted);
        if (result < 0) {
            return result;
        }
        motion = converted;
    }
    int result = check_writable(motion, &writing);
    if (result < 0) {
        grobo_motion_free(converted);
        return result;
    }
    grobo_i_out_begin(&out, sink);
    if (motion->frame_times && motion->size > 0) {
        grobo_i_say(
            list, &(grobo_i_said){writing.options->name, "frame-times", 0, 0, GROBO_SEVERITY_NOTE},
            "each frame has a time of its own: read by this library, and by Choreonoid from "
            "2.1 on, which holds it until the next");
    }
    row->write(&writing, motion);
    grobo_motion_free(converted);
    return grobo_i_out_end(&out);
}
