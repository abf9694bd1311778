/* SPDX-License-Identifier: MIT */
/*
 * .pseq and .mseq, laid out as Choreonoid does, to the blank at the end of a line: what it wrote
 * and we read comes out the same, byte for byte.
 */
#include <string.h>

#include "src/motion/format/write.h"

enum {
    LONG_LIST = 10, /* bodies of more joints get long lists, whatever a list's length */
    REF_INDENT = 4,
    POSE_INDENT = 6,
    LINK_INDENT = 10
};

static void put_lead(grobo_i_out *out, int indent, const char *text)
{
    static const char blanks[] = "            ";

    grobo_i_put(out, blanks, (size_t)indent);
    grobo_i_put_text(out, text);
}

/* Where the lines of a list end. */
typedef struct list_shape {
    int first; /* item that begins the first new line */
    int items; /* of each line from there on; 0: all of the list is one line */
    int indent;
} list_shape;

/* What comes before item i of a list: a line break where the list has one, else a comma. */
static void put_gap(grobo_i_out *out, int i, const list_shape *shape)
{
    if (i > 0) {
        grobo_i_put_text(out, ", ");
    }
    if (shape->items > 0 && i >= shape->first && (i - shape->first) % shape->items == 0) {
        grobo_i_put_text(out, "\n");
        put_lead(out, shape->indent, "");
    }
}

/* joints and spJoints, or q: the joints of a mask, by number or by angle. */
static void put_joints(grobo_i_out *out, const char *name, const list_shape *shape,
                       grobo_joint_mask joints, const double *angle_rad)
{
    int i = 0;

    put_lead(out, POSE_INDENT, name);
    grobo_i_put_text(out, ": [ ");
    for (int j = 0; j < GROBO_JOINTS_MAX; j++) {
        if ((joints & GROBO_JOINT_BIT(j)) == 0) {
            continue;
        }
        put_gap(out, i++, shape);
        if (angle_rad != NULL) {
            grobo_i_put_number(out, angle_rad[j]);
        } else {
            grobo_i_put_int(out, j);
        }
    }
    grobo_i_put_text(out, " ]\n");
}

static void put_numbers(grobo_i_out *out, int indent, const char *name, const double *values,
                        int count)
{
    const list_shape shape = {0, count > 3 ? 3 : 0, indent + 2}; /* a matrix row by row */

    put_lead(out, indent, name);
    grobo_i_put_text(out, ": [ ");
    for (int i = 0; i < count; i++) {
        put_gap(out, i, &shape);
        grobo_i_put_number(out, values[i]);
    }
    grobo_i_put_text(out, " ]\n");
}

static void put_flag(grobo_i_out *out, int indent, const char *name, bool value)
{
    if (value) {
        put_lead(out, indent, name);
        grobo_i_put_text(out, ": true\n");
    }
}

static void put_link(grobo_i_out *out, const grobo_i_extra *extra, int i)
{
    const grobo_ik_link *link = &extra->links[i];

    put_lead(out, LINK_INDENT - 2, "- \n");
    if (link->name[0] != '\0') {
        put_lead(out, LINK_INDENT, "name: ");
        grobo_i_put_name(out, link->name, strlen(link->name));
        grobo_i_put_text(out, "\n");
    }
    if (link->index >= 0) {
        put_lead(out, LINK_INDENT, "index: ");
        grobo_i_put_int(out, link->index);
        grobo_i_put_text(out, "\n");
    }
    put_flag(out, LINK_INDENT, "isBaseLink", link->is_base);
    put_flag(out, LINK_INDENT, "isStationaryPoint", link->is_stationary);
    put_numbers(out, LINK_INDENT, "translation", link->translation_m, 3);
    put_numbers(out, LINK_INDENT, "rotation", link->rotation, 9);
    put_flag(out, LINK_INDENT, "isTouching", link->is_touching);
    if (link->has_parting_direction) {
        put_numbers(out, LINK_INDENT, "partingDirection", link->parting_direction, 3);
    }
    grobo_i_put_kept(out, extra->kept, GROBO_KEPT_LINK, i, LINK_INDENT);
    put_flag(out, LINK_INDENT, "isSlave", link->is_slave);
}

/* Written wherever there is a ZMP: without it a ZMP stands still. */
static void put_zmp_stationary(grobo_i_out *out, const grobo_key_info *info)
{
    if (info->has_zmp || info->zmp_stationary) {
        put_lead(out, POSE_INDENT, "isZmpStationaryPoint: ");
        grobo_i_put_text(out, info->zmp_stationary ? "true\n" : "false\n");
    }
}

/* What a pose has besides joints and q. */
static void put_extra(grobo_i_out *out, int line_items, const grobo_i_extra *extra)
{
    const list_shape shape = {GROBO_I_LINE_ITEMS, line_items, POSE_INDENT + 2};

    if (extra->info.stationary != 0) {
        put_joints(out, "spJoints", &shape, extra->info.stationary, NULL);
    }
    if (extra->n_links > 0) {
        put_lead(out, POSE_INDENT, "ikLinks: \n");
        for (int i = 0; i < extra->n_links; i++) {
            put_link(out, extra, i);
        }
    }
    if (extra->info.has_zmp) {
        put_numbers(out, POSE_INDENT, "zmp", extra->info.zmp_m, 3);
    }
    put_zmp_stationary(out, &extra->info);
    grobo_i_put_kept(out, extra->kept, GROBO_KEPT_POSE, 0, POSE_INDENT);
}

static void put_ref(grobo_i_out *out, const grobo_motion *motion, const grobo_i_row *row)
{
    static const grobo_i_extra nothing;
    const int line_items = motion->line_items > 0 ? motion->line_items : GROBO_I_LINE_ITEMS;
    const list_shape shape = {0, motion->n_joints > LONG_LIST ? line_items : 0, POSE_INDENT + 2};
    const grobo_i_extra *extra = *row->extra != NULL ? *row->extra : &nothing;
    const char *name = extra->name != NULL ? extra->name : "";

    put_lead(out, REF_INDENT - 2, "- \n");
    put_lead(out, REF_INDENT, "time: ");
    grobo_i_put_number(out, *row->time_s);
    grobo_i_put_text(out, "\n");
    if (extra->info.max_transition_s > 0) {
        put_lead(out, REF_INDENT, "maxTransitionTime: ");
        grobo_i_put_number(out, extra->info.max_transition_s);
        grobo_i_put_text(out, "\n");
    }
    grobo_i_put_kept(out, extra->kept, GROBO_KEPT_REF, 0, REF_INDENT);
    put_lead(out, REF_INDENT, "refer: \n");
    put_lead(out, POSE_INDENT,
             motion->kind == GROBO_MOTION_STEPS ? "type: Motion\n" : "type: Pose\n");
    put_lead(out, POSE_INDENT, "name: ");
    grobo_i_put_quoted(out, name, strlen(name));
    grobo_i_put_text(out, "\n");
    if (*row->set != 0) {
        put_joints(out, "joints", &shape, *row->set, NULL);
        put_joints(out, "q", &shape, *row->set, row->angle_rad);
    }
    put_extra(out, line_items, extra);
}

void grobo_i_write_pseq(const grobo_i_writing *writing, const grobo_motion *motion)
{
    grobo_i_out *out = writing->out;
    grobo_i_row row;

    if (motion->kind == GROBO_MOTION_STEPS) {
        grobo_i_put_text(out, "type: MotionSeq\n");
    } else {
        grobo_i_put_text(out, "# Body pose sequence format version 1.0 defined by "
                              "cnoid-Robotics\n\ntype: PoseSeq\n");
    }
    grobo_i_put_text_line(out, "name", grobo_motion_name(motion));
    if (grobo_motion_target_body(motion)[0] != '\0') {
        grobo_i_put_text_line(out, "targetBody", grobo_motion_target_body(motion));
    }
    grobo_i_put_kept(out, motion->kept, GROBO_KEPT_TOP, 0, 0);
    grobo_i_put_text(out, "refs: \n");
    for (size_t n = 0; grobo_i_row_at(motion, n, &row) && out->result == 0; n++) {
        put_ref(out, motion, &row);
    }
}
