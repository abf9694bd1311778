/* SPDX-License-Identifier: MIT */
/* Preparing a motion to be played: order and times of keys, sums of increments, tracks. */
#include <math.h>
#include <string.h>

#include "src/base/memory.h"
#include "src/base/sized.h"
#include "src/motion/play/clip.h"

static bool counts_steps(const grobo_motion *motion)
{
    return motion->kind == GROBO_MOTION_POSTURES || motion->kind == GROBO_MOTION_STEPS;
}

static void clip_free(grobo_i_clip *clip)
{
    const grobo_mem *mem = clip->mem;

    grobo_i_free(mem, clip->at_s, clip->size * sizeof *clip->at_s);
    grobo_i_free(mem, clip->order, clip->size * sizeof *clip->order);
    grobo_i_free(mem, clip->sums, clip->size * clip->motion->n_joints * sizeof *clip->sums);
    grobo_i_free(mem, clip->keys, clip->n_keys * sizeof *clip->keys);
    grobo_i_free(mem, clip, sizeof *clip);
}

/* ---- order and times ---------------------------------------------------------------------- */

static bool in_order(const grobo_motion *motion)
{
    for (size_t n = 1; n < motion->size; n++) {
        if (grobo_i_time_s(motion, n) < grobo_i_time_s(motion, n - 1)) {
            return false;
        }
    }
    return true;
}

/* Choreonoid's order puts keys of equal time the other way round than the file: back again. */
static void turn_equals(size_t *order, const double *time_s, size_t size)
{
    for (size_t first = 0; first < size;) {
        size_t last = first + 1;
        while (last < size && time_s[order[last]] == time_s[order[first]]) {
            last++;
        }
        for (size_t low = first, high = last - 1; low < high; low++, high--) {
            size_t other = order[low];
            order[low] = order[high];
            order[high] = other;
        }
        first = last;
    }
}

/* clip->at_s has the rows' times; afterwards it is in the order of time. */
static int sort_keys(grobo_i_clip *clip)
{
    size_t bytes = clip->size * sizeof *clip->at_s;
    double *time_s;

    clip->order = grobo_i_alloc(clip->mem, clip->size * sizeof *clip->order);
    time_s = grobo_i_alloc(clip->mem, bytes);
    if (clip->order == NULL || time_s == NULL) {
        grobo_i_free(clip->mem, time_s, bytes);
        return GROBO_ERR_NOMEM;
    }
    memcpy(time_s, clip->at_s, bytes);
    grobo_spline_order(time_s, clip->size, clip->order);
    turn_equals(clip->order, time_s, clip->size);
    for (size_t i = 0; i < clip->size; i++) {
        clip->at_s[i] = time_s[clip->order[i]];
    }
    grobo_i_free(clip->mem, time_s, bytes);
    return 0;
}

/*
 * When each posture is reached: as the file says, moved on by a constant from each step that means
 * the default time. (Not summed up: without such steps the times are the file's to the bit.)
 */
static void time_postures(grobo_i_clip *clip)
{
    double offset_s = 0, before_s = 0;

    for (size_t n = 0; n < clip->size; n++) {
        double time_s = grobo_i_time_s(clip->motion, n);
        if (grobo_i_takes_default(clip->motion, n)) {
            offset_s = before_s + (double)clip->default_us / 1e6 - time_s;
        }
        before_s = clip->at_s[n] = time_s + offset_s;
    }
}

static int set_times(grobo_i_clip *clip)
{
    const grobo_motion *motion = clip->motion;

    if (grobo_i_at_rate(motion) || clip->size == 0) {
        return 0;
    }
    clip->at_s = grobo_i_alloc(clip->mem, clip->size * sizeof *clip->at_s);
    if (clip->at_s == NULL) {
        return GROBO_ERR_NOMEM;
    }
    if (counts_steps(motion)) {
        time_postures(clip);
        return 0;
    }
    for (size_t n = 0; n < clip->size; n++) {
        clip->at_s[n] = grobo_i_time_s(motion, n);
    }
    return in_order(motion) ? 0 : sort_keys(clip);
}

/* ---- increments --------------------------------------------------------------------------- */

/* Adds the increments up from the start posture. */
static int add_up(grobo_i_clip *clip, const grobo_posture *start)
{
    const grobo_motion *motion = clip->motion;
    size_t n_joints = motion->n_joints;
    double sum_rad[GROBO_JOINTS_MAX];

    if (start->n_joints < n_joints || (clip->listed & ~start->set) != 0) {
        return GROBO_ERR_ARG;
    }
    if (clip->size == 0 || n_joints == 0) {
        return 0;
    }
    clip->sums = grobo_i_alloc(clip->mem, clip->size * n_joints * sizeof *clip->sums);
    if (clip->sums == NULL) {
        return GROBO_ERR_NOMEM;
    }
    memcpy(sum_rad, start->angle_rad, sizeof sum_rad);
    for (size_t n = 0; n < clip->size; n++) {
        grobo_i_row row;
        (void)grobo_i_row_at(motion, n, &row);
        for (size_t j = 0; j < n_joints; j++) {
            if ((*row.set & GROBO_JOINT_BIT(j)) != 0) {
                sum_rad[j] += row.angle_rad[j];
            }
        }
        memcpy(clip->sums + n * n_joints, sum_rad, n_joints * sizeof *sum_rad);
    }
    return 0;
}

/* ---- tracks ------------------------------------------------------------------------------- */

/* Room for each joint's keys: two a row that sets it, and one to start from. */
static int make_tracks(grobo_i_clip *clip)
{
    size_t counts[GROBO_JOINTS_MAX] = {0};
    grobo_i_row row;

    for (size_t n = 0; grobo_i_row_at(clip->motion, n, &row); n++) {
        for (int j = 0; j < clip->motion->n_joints; j++) {
            counts[j] += (*row.set & GROBO_JOINT_BIT(j)) != 0;
        }
    }
    for (int j = 0; j < clip->motion->n_joints; j++) {
        counts[j] = counts[j] > 0 ? GROBO_SPLINE_KEYS_FOR(counts[j]) + 1 : 0;
        clip->n_keys += counts[j];
    }
    if (clip->n_keys == 0) {
        return 0;
    }
    clip->keys = grobo_i_alloc(clip->mem, clip->n_keys * sizeof *clip->keys);
    if (clip->keys == NULL) {
        return GROBO_ERR_NOMEM;
    }
    grobo_spline_key *room = clip->keys;
    for (int j = 0; j < clip->motion->n_joints; j++) {
        clip->tracks[j].keys = (grobo_spline_track){.keys = room, .capacity = counts[j]};
        room += counts[j];
    }
    return 0;
}

/* A key of a straight track: the joint stays where it was until the key before begins to move. */
static void append_straight(grobo_spline_track *track, double before_s, double t_s, double value)
{
    if (track->n > 0 && track->keys[track->n - 1].t_s < before_s) {
        double held = track->keys[track->n - 1].value;
        (void)grobo_spline_append(track, before_s, held, 0, false);
    }
    (void)grobo_spline_append(track, t_s, value, 0, false);
}

/* Row `row` of key i, its joints to their tracks. */
static void append_key(grobo_i_clip *clip, size_t i, const grobo_i_row *row)
{
    static const grobo_key_info nothing;
    const grobo_key_info *info = *row->extra != NULL ? &(*row->extra)->info : &nothing;
    double t_s = grobo_i_clip_at_s(clip, i);
    double before_s = i > 0 ? grobo_i_clip_at_s(clip, i - 1) : 0;

    for (int j = 0; j < clip->motion->n_joints; j++) {
        if ((*row->set & GROBO_JOINT_BIT(j)) == 0) {
            continue;
        }
        grobo_spline_track *track = &clip->tracks[j].keys;
        double angle_rad = grobo_i_clip_angle(clip, i, row, j);
        /* Room was counted and numbers are finite: nothing can fail. */
        if (clip->filling == GROBO_I_SPLINE) {
            (void)grobo_spline_append(track, t_s, angle_rad, info->max_transition_s,
                                      (info->stationary & GROBO_JOINT_BIT(j)) != 0);
        } else {
            append_straight(track, before_s, t_s, angle_rad);
        }
    }
}

/* Choreonoid takes poses of equal time in its own order, which only curves can tell. */
static int fill_spline(grobo_i_clip *clip)
{
    size_t bytes = clip->size * sizeof(size_t);
    size_t *order = grobo_i_alloc(clip->mem, bytes);

    if (order == NULL) {
        return GROBO_ERR_NOMEM;
    }
    grobo_spline_order(clip->at_s, clip->size, order);
    for (size_t i = 0; i < clip->size; i++) {
        grobo_i_row row;
        (void)grobo_i_row_at(clip->motion, grobo_i_clip_row(clip, order[i]), &row);
        append_key(clip, order[i], &row);
    }
    grobo_i_free(clip->mem, order, bytes);
    for (int j = 0; j < clip->motion->n_joints; j++) {
        grobo_spline_prepare(clip->tracks[j].keys.keys, clip->tracks[j].keys.n);
    }
    return 0;
}

/* Increments begin at the start posture, but for joints that have their first one at 0. */
static void fill_straight(grobo_i_clip *clip, const grobo_posture *start)
{
    grobo_i_row first;
    (void)grobo_i_row_at(clip->motion, grobo_i_clip_row(clip, 0), &first);
    grobo_joint_mask begun = grobo_i_clip_at_s(clip, 0) == 0 ? *first.set : 0;

    for (int j = 0; clip->sums != NULL && j < clip->motion->n_joints; j++) {
        if (clip->tracks[j].keys.capacity > 0 && (begun & GROBO_JOINT_BIT(j)) == 0) {
            (void)grobo_spline_append(&clip->tracks[j].keys, 0, start->angle_rad[j], 0, false);
        }
    }
    for (size_t i = 0; i < clip->size; i++) {
        grobo_i_row row;
        (void)grobo_i_row_at(clip->motion, grobo_i_clip_row(clip, i), &row);
        append_key(clip, i, &row);
    }
}

static int fill_tracks(grobo_i_clip *clip, const grobo_posture *start)
{
    int result = make_tracks(clip);

    if (result < 0 || clip->size == 0) {
        return result;
    }
    if (clip->filling == GROBO_I_SPLINE) {
        return fill_spline(clip);
    }
    fill_straight(clip, start);
    return 0;
}

/* ---- all of it ---------------------------------------------------------------------------- */

/* Which joints there are, and whether every row has them all. */
static bool all_alike(grobo_i_clip *clip)
{
    bool alike = true;
    grobo_i_row row;

    for (size_t n = 0; grobo_i_row_at(clip->motion, n, &row); n++) {
        alike = alike && (n == 0 || *row.set == clip->listed);
        clip->listed |= *row.set;
    }
    return alike;
}

static int prepare(grobo_i_clip *clip, const grobo_clip_options *options)
{
    const grobo_motion *motion = clip->motion;
    bool alike = all_alike(clip);
    int result = set_times(clip);

    if (motion->kind == GROBO_MOTION_STEPS) {
        if (result < 0 || options->start == NULL) {
            return result;
        }
        result = add_up(clip, options->start);
        clip->filling = GROBO_I_STRAIGHT;
    } else if (motion->kind == GROBO_MOTION_KEYS) {
        clip->filling = options->style == GROBO_STYLE_SEED ? GROBO_I_STRAIGHT : GROBO_I_SPLINE;
    } else {
        clip->filling = alike ? GROBO_I_ROWS : GROBO_I_STRAIGHT;
    }
    return result;
}

int grobo_i_clip_keys(const grobo_motion *motion, const grobo_clip_options *options,
                      grobo_clip *clip)
{
    grobo_i_clip *made;

    if (options->default_us < 0 || options->style < GROBO_STYLE_CHOREONOID ||
        options->style > GROBO_STYLE_SEED) {
        return GROBO_ERR_ARG;
    }
    if (grobo_i_at_rate(motion) && motion->size > 0 && !(motion->frame_rate_hz > 0)) {
        return GROBO_ERR_STATE;
    }
    made = grobo_i_new(motion->mem, sizeof *made);
    if (made == NULL) {
        return GROBO_ERR_NOMEM;
    }
    made->motion = motion;
    made->mem = motion->mem;
    made->size = motion->size;
    made->default_us = options->default_us > 0 ? options->default_us : GROBO_MOTION_DEFAULT_US;
    int result = prepare(made, options);
    if (result < 0) {
        clip_free(made);
        return result;
    }
    bool relative = motion->kind == GROBO_MOTION_STEPS && options->start == NULL;
    double end_s = made->size > 0 ? grobo_i_clip_at_s(made, made->size - 1) : 0;
    *clip = (grobo_clip){.key = grobo_i_clip_key,
                         .sample = relative ? NULL : grobo_i_clip_sample,
                         .ctx = made,
                         .length_us = end_s > 0 ? grobo_i_us_from_s(end_s) : 0,
                         .n_keys = made->size,
                         .n_joints = motion->n_joints,
                         .relative = relative};
    return 0;
}

int grobo_i_clip_fill(const grobo_clip *clip, const grobo_posture *start)
{
    grobo_i_clip *made = clip->ctx;

    return clip->relative || made->filling == GROBO_I_ROWS ? 0 : fill_tracks(made, start);
}

int grobo_motion_clip(const grobo_motion *motion, const grobo_clip_options *options,
                      grobo_clip *clip)
{
    if (motion == NULL || clip == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_clip_options how;
    grobo_clip made;

    int result = grobo_i_sized_take(&how, sizeof how, options);
    if (result >= 0) {
        result = grobo_i_clip_keys(motion, &how, &made);
    }
    if (result < 0) {
        return result;
    }
    result = grobo_i_clip_fill(&made, how.start);
    if (result < 0) {
        grobo_motion_clip_free(&made);
        return result;
    }
    *clip = made;
    return 0;
}

void grobo_motion_clip_free(grobo_clip *clip)
{
    if (clip == NULL) {
        return;
    }
    if (clip->ctx != NULL) {
        clip_free(clip->ctx);
    }
    memset(clip, 0, sizeof *clip);
}
