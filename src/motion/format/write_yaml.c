/* SPDX-License-Identifier: MIT */
/*
 * Body motion. At a rate: the form that every version of Choreonoid and the original library read.
 * Frames with times of their own: version 4 of the format, which older programs refuse, and do
 * not take the times for angles.
 */
#include "src/motion/format/write.h"

static void put_number_line(grobo_i_out *out, const char *lead, double value)
{
    grobo_i_put_text(out, lead);
    grobo_i_put_number(out, value);
    grobo_i_put_text(out, "\n");
}

static void put_head(grobo_i_out *out, const grobo_motion *motion)
{
    bool times = motion->frame_times && motion->size > 0;
    double rate_hz = motion->frame_rate_hz > 0 ? motion->frame_rate_hz : GROBO_MOTION_RATE_HZ;

    grobo_i_put_text(out, times ? "type: CompositeSeq\ncontent: BodyMotion\nformat_version: 4\n"
                                : "type: BodyMotion\n");
    if (grobo_motion_name(motion)[0] != '\0') {
        grobo_i_put_text_line(out, "name", grobo_motion_name(motion));
    }
    if (grobo_motion_target_body(motion)[0] != '\0') {
        grobo_i_put_text_line(out, "targetBody", grobo_motion_target_body(motion));
    }
    grobo_i_put_kept(out, motion->kept, GROBO_KEPT_TOP, 0, 0);
    if (times) {
        put_number_line(out, "frame_rate: ", rate_hz);
        put_number_line(out, "num_frames: ", (double)motion->size);
    }
    grobo_i_put_text(out, "components: \n  - \n    type: MultiValueSeq\n");
    grobo_i_put_text(out, times ? "    content: JointDisplacement\n"
                                : "    content: JointPosition\n    purpose: JointPosition\n");
    put_number_line(out, times ? "    frame_rate: " : "    frameRate: ", rate_hz);
    put_number_line(out, times ? "    num_frames: " : "    numFrames: ", (double)motion->size);
    put_number_line(out, times ? "    num_parts: " : "    numParts: ", motion->n_joints);
    if (times) {
        grobo_i_put_text(out, "    has_frame_time: true\n");
    }
    grobo_i_put_kept(out, motion->kept, GROBO_KEPT_COMPONENT, 0, 4);
    grobo_i_put_text(out, motion->size > 0 ? "    frames: \n" : "    frames: [ ]\n");
}

void grobo_i_write_yaml(const grobo_i_writing *writing, const grobo_motion *motion)
{
    grobo_i_out *out = writing->out;
    grobo_i_row row;

    put_head(out, motion);
    for (size_t n = 0; grobo_i_row_at(motion, n, &row) && out->result == 0; n++) {
        const char *comma = "      - [ ";
        if (motion->frame_times) {
            grobo_i_put_text(out, comma);
            grobo_i_put_number(out, *row.time_s);
            comma = ", ";
        }
        for (int j = 0; j < motion->n_joints; j++) {
            grobo_i_put_text(out, comma);
            grobo_i_put_number(out, (*row.set & GROBO_JOINT_BIT(j)) != 0 ? row.angle_rad[j] : 0);
            comma = ", ";
        }
        grobo_i_put_text(out, " ]\n");
    }
}
