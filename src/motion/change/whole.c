/* SPDX-License-Identifier: MIT */
/* Editing whole motions: each works on a copy and takes it over when all went well. */
#include <math.h>
#include <string.h>

#include <grobo/motion_io.h>

#include "src/motion/store/container.h"

static bool same_rate(const grobo_motion *a, const grobo_motion *b)
{
    return a->frame_times == b->frame_times &&
           (a->frame_times || a->frame_rate_hz == b->frame_rate_hz);
}

/* Rows of other behind those of motion, which is as before if that fails. */
static int append_rows(grobo_motion *motion, const grobo_motion *other, double shift_s)
{
    size_t size = motion->size;

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

/* ---- a motion of another kind ------------------------------------------------------------- */

static bool is_alike(const grobo_motion *motion, const grobo_motion *other)
{
    return motion->kind == other->kind && same_rate(motion, other);
}

/* The last angle of each joint that the motion sets. */
static void find_end(const grobo_motion *motion, grobo_posture *end)
{
    grobo_joint_mask all = GROBO_JOINTS_ALL(motion->n_joints);
    grobo_i_row row;

    (void)grobo_posture_init(end, motion->n_joints);
    for (size_t n = motion->size; n > 0 && end->set != all; n--) {
        (void)grobo_i_row_at(motion, n - 1, &row);
        for (int j = 0; j < motion->n_joints; j++) {
            if ((*row.set & ~end->set & GROBO_JOINT_BIT(j)) != 0) {
                end->angle_rad[j] = row.angle_rad[j];
                end->set |= GROBO_JOINT_BIT(j);
            }
        }
    }
}

static grobo_joint_mask joints_of(const grobo_motion *motion)
{
    grobo_joint_mask joints = 0;
    grobo_i_row row;

    for (size_t n = 0; grobo_i_row_at(motion, n, &row); n++) {
        joints |= *row.set;
    }
    return joints;
}

/* Joints that neither motion sets are not set in what was converted either. */
static void keep_joints(grobo_motion *motion, grobo_joint_mask joints)
{
    grobo_i_row row;

    for (size_t n = 0; grobo_i_row_at(motion, n, &row); n++) {
        *row.set &= joints;
    }
}

/*
 * The other as a motion of this one's kind and rate, which goes on where this one ends. Where
 * nobody knows from where increments count there is none: postures would be reached from there.
 */
static int convert_for(const grobo_motion *motion, const grobo_motion *other, grobo_motion **made)
{
    bool at_rate = motion->kind == GROBO_MOTION_FRAMES && !motion->frame_times;
    grobo_joint_mask joints = joints_of(other);
    grobo_posture end;
    grobo_write_options how = {GROBO_WRITE_OPTIONS_INIT, .start = &end, .exact = true};

    if (other->n_joints > motion->n_joints) {
        return GROBO_ERR_ARG;
    }
    find_end(motion, &end);
    if (motion->kind == GROBO_MOTION_STEPS ||
        (other->kind == GROBO_MOTION_STEPS && (joints & ~end.set) != 0)) {
        return GROBO_ERR_TYPE;
    }
    if (at_rate && !(motion->frame_rate_hz > 0)) {
        return GROBO_ERR_STATE;
    }
    how.rate_hz = at_rate ? motion->frame_rate_hz : 0;
    int result = grobo_motion_convert(other, motion->kind, &how, NULL, made);
    if (result < 0) {
        return result;
    }
    keep_joints(*made, joints | end.set);
    return motion->kind == GROBO_MOTION_FRAMES
               ? grobo_motion_set_frame_times(*made, motion->frame_times)
               : 0;
}

int grobo_motion_append_motion(grobo_motion *motion, const grobo_motion *other)
{
    if (motion == NULL || other == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_motion *made = NULL;
    int result = is_alike(motion, other) ? 0 : convert_for(motion, other, &made);

    if (result == 0) {
        result = append_rows(motion, made != NULL ? made : other, end_s(motion));
    }
    grobo_motion_free(made);
    return result;
}

/* ---- concatenation ------------------------------------------------------------------------ */

/* All joints that a posture lacks are taken from another. */
static void complete(grobo_posture *posture, const grobo_posture *from)
{
    grobo_posture whole = *from;

    grobo_posture_merge(&whole, posture);
    whole.time_us = posture->time_us;
    *posture = whole;
}

/* Frames between the last of motion and the first of other, easing in and out. */
static int blend_frames(grobo_motion *motion, const grobo_motion *other, size_t count)
{
    grobo_posture from, to, between;

    if (count == 0) {
        return 0;
    }
    (void)grobo_motion_get(other, 0, &to);
    (void)grobo_motion_get(motion, motion->size - 1, &from);
    complete(&to, &from);
    for (size_t i = 1; i <= count; i++) {
        double part = (double)i / (double)(count + 1);
        double eased = part * part * (3 - 2 * part);
        between = from;
        between.time_us = 0;
        for (int j = 0; j < to.n_joints; j++) {
            between.angle_rad[j] += eased * (to.angle_rad[j] - from.angle_rad[j]);
        }
        int result = grobo_motion_append(motion, &between);
        if (result < 0) {
            return result;
        }
    }
    return 0;
}

/* The motion and, blend_s later, the other; into a motion that is thrown away on error. */
static int concat_into(grobo_motion *made, const grobo_motion *other, double blend_s)
{
    double first_s = other->size > 0 ? grobo_i_time_s(other, 0) : 0;

    if (made->kind == GROBO_MOTION_FRAMES) {
        double rate_hz = made->frame_rate_hz;
        double start_s = end_s(made);
        /* The first frame of the other is itself one step behind the last one between. */
        double steps = fmax(round(blend_s * rate_hz), 1);
        if (!(steps < GROBO_MOTION_FRAMES_MAX)) {
            return GROBO_ERR_CAP;
        }
        size_t between = made->size > 0 && other->size > 0 ? (size_t)steps - 1 : 0;
        int result = blend_frames(made, other, between);
        grobo_i_row row;
        for (size_t n = made->size - between; result == 0 && grobo_i_row_at(made, n, &row); n++) {
            start_s += 1 / rate_hz;
            *row.time_s = start_s;
        }
        return result < 0 ? result : append_rows(made, other, start_s + 1 / rate_hz - first_s);
    }
    return append_rows(made, other, end_s(made) + blend_s - first_s);
}

int grobo_motion_concat(grobo_motion *motion, const grobo_motion *other, int64_t blend_us)
{
    if (other == NULL || motion == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_motion *made = NULL;
    grobo_motion *converted = NULL;

    if (blend_us < 0 || (motion->kind == GROBO_MOTION_FRAMES && !(motion->frame_rate_hz > 0))) {
        return GROBO_ERR_ARG;
    }
    int result = is_alike(motion, other) ? 0 : convert_for(motion, other, &converted);
    if (result == 0) {
        result = grobo_motion_dup(motion, &made);
    }
    if (result == 0) {
        result = concat_into(made, converted != NULL ? converted : other, (double)blend_us / 1e6);
    }
    if (result == 0) {
        grobo_i_swap(motion, made);
    }
    grobo_motion_free(made);
    grobo_motion_free(converted);
    return result;
}
