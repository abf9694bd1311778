/* SPDX-License-Identifier: MIT */
/* Playing a motion: its keys, its posture at any time, and frames at a rate. Nothing allocates
 * but the frames. */
#include <math.h>
#include <string.h>

#include "src/motion/play/clip.h"

/* ---- keys --------------------------------------------------------------------------------- */

static int64_t at_us_of(const grobo_i_clip *clip, size_t i)
{
    double at_s = grobo_i_clip_at_s(clip, i);

    return at_s > 0 ? grobo_i_us_from_s(at_s) : 0;
}

int grobo_i_clip_key(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    const grobo_i_clip *clip = ctx;
    grobo_i_row row;

    if (i >= clip->size || !grobo_i_row_at(clip->motion, grobo_i_clip_row(clip, i), &row)) {
        return GROBO_ERR_ARG;
    }
    (void)grobo_posture_init(posture, clip->motion->n_joints);
    for (int j = 0; j < clip->motion->n_joints; j++) {
        if ((*row.set & GROBO_JOINT_BIT(j)) != 0) {
            posture->angle_rad[j] = grobo_i_clip_angle(clip, i, &row, j);
        }
    }
    posture->set = *row.set;
    *at_us = at_us_of(clip, i);
    posture->time_us = *at_us - (i > 0 ? at_us_of(clip, i - 1) : 0);
    return 0;
}

/* ---- samples ------------------------------------------------------------------------------ */

/* The key at or before t_s, 0 if there is none: near where it was the last time, or by search. */
static size_t key_before(grobo_i_clip *clip, double t_s)
{
    size_t low = 0, high = clip->size;
    size_t guess = clip->cursor;

    if (guess + 1 < clip->size && grobo_i_clip_at_s(clip, guess) <= t_s) {
        guess += grobo_i_clip_at_s(clip, guess + 1) <= t_s;
        if (guess + 1 == clip->size || grobo_i_clip_at_s(clip, guess + 1) > t_s) {
            clip->cursor = guess;
            return guess;
        }
    }
    while (low + 1 < high) {
        size_t middle = low + (high - low) / 2;
        if (grobo_i_clip_at_s(clip, middle) <= t_s) {
            low = middle;
        } else {
            high = middle;
        }
    }
    clip->cursor = low;
    return low;
}

/* The frame before t_s and how far behind it; just on it where only rounding says otherwise. */
static size_t frame_before(const grobo_i_clip *clip, double t_s, double *part)
{
    double place = t_s * clip->motion->frame_rate_hz;
    double nearest = round(place);

    place = fabs(place - nearest) < 1e-9 * (1 + nearest) ? nearest : place;
    if (!(place > 0)) {
        place = 0;
    } else if (place > (double)(clip->size - 1)) {
        place = (double)(clip->size - 1);
    }
    *part = place - floor(place);
    return (size_t)place;
}

static void sample_rows(grobo_i_clip *clip, double t_s, grobo_posture *posture)
{
    grobo_i_row before, after;
    double part = 0;
    size_t i;

    if (grobo_i_at_rate(clip->motion)) {
        i = frame_before(clip, t_s, &part);
    } else {
        i = key_before(clip, t_s);
        double from_s = grobo_i_clip_at_s(clip, i);
        if (i + 1 < clip->size && t_s > from_s) {
            part = (t_s - from_s) / (grobo_i_clip_at_s(clip, i + 1) - from_s);
        }
    }
    (void)grobo_i_row_at(clip->motion, grobo_i_clip_row(clip, i), &before);
    if (part > 0) {
        (void)grobo_i_row_at(clip->motion, grobo_i_clip_row(clip, i + 1), &after);
    } else {
        after = before;
    }
    for (int j = 0; j < clip->motion->n_joints; j++) {
        if ((clip->listed & GROBO_JOINT_BIT(j)) != 0) {
            double from_rad = before.angle_rad[j];
            posture->angle_rad[j] = from_rad + part * (after.angle_rad[j] - from_rad);
        }
    }
}

static double straight_at(grobo_i_track *track, double t_s)
{
    const grobo_spline_key *keys = track->keys.keys;
    size_t low = 0, high = track->keys.n;

    if (t_s <= keys[0].t_s) {
        return keys[0].value;
    }
    if (t_s >= keys[high - 1].t_s) {
        return keys[high - 1].value;
    }
    if (keys[track->cursor].t_s <= t_s) {
        low = track->cursor;
        high = low + 2 < high && keys[low + 2].t_s > t_s ? low + 2 : high;
    }
    while (low + 1 < high) {
        size_t middle = low + (high - low) / 2;
        if (keys[middle].t_s <= t_s) {
            low = middle;
        } else {
            high = middle;
        }
    }
    track->cursor = low;
    double part = (t_s - keys[low].t_s) / (keys[low + 1].t_s - keys[low].t_s);
    return keys[low].value + part * (keys[low + 1].value - keys[low].value);
}

static void sample_tracks(grobo_i_clip *clip, double t_s, grobo_posture *posture)
{
    for (int j = 0; j < clip->motion->n_joints; j++) {
        grobo_i_track *track = &clip->tracks[j];
        if (track->keys.n == 0) {
            continue;
        }
        posture->angle_rad[j] =
            clip->filling == GROBO_I_SPLINE
                ? grobo_spline_at(track->keys.keys, track->keys.n, t_s, &track->cursor)
                : straight_at(track, t_s);
    }
}

void grobo_i_clip_sample_s(grobo_i_clip *clip, double t_s, grobo_posture *posture)
{
    (void)grobo_posture_init(posture, clip->motion->n_joints);
    posture->set = clip->listed;
    posture->time_us = 0;
    if (clip->size == 0) {
        return;
    }
    if (clip->filling == GROBO_I_ROWS) {
        sample_rows(clip, t_s, posture);
    } else {
        sample_tracks(clip, t_s, posture);
    }
}

int grobo_i_clip_sample(void *ctx, int64_t t_us, grobo_posture *posture)
{
    grobo_i_clip_sample_s(ctx, (double)t_us / 1e6, posture);
    return 0;
}

/* ---- frames ------------------------------------------------------------------------------- */

/*
 * Frames of a clip at a rate, as Choreonoid counts them. For what stands on frames already, a last
 * one that only rounding puts beyond the end is one too.
 */
static double count_frames(const grobo_clip *clip, double rate_hz)
{
    double length_s = (double)clip->length_us / 1e6;

    if (clip->sample == grobo_i_clip_sample && clip->n_keys > 0) {
        const grobo_i_clip *ours = clip->ctx;
        length_s = grobo_i_clip_at_s(ours, clip->n_keys - 1);
        if (ours->filling == GROBO_I_SPLINE) {
            return floor(fmax(rate_hz * length_s, 0)) + 1;
        }
    }
    return floor(fmax(rate_hz * length_s, 0) + 1e-6) + 1;
}

static int sample_frame(const grobo_clip *clip, double t_s, grobo_posture *posture)
{
    if (clip->sample == grobo_i_clip_sample) {
        grobo_i_clip_sample_s(clip->ctx, t_s, posture);
        return 0;
    }
    return clip->sample(clip->ctx, grobo_i_us_from_s(t_s), posture);
}

static int add_frames(const grobo_clip *clip, grobo_motion *frames, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        grobo_posture posture;
        int result = sample_frame(clip, (double)i / frames->frame_rate_hz, &posture);
        if (result == 0) {
            posture.time_us = 0;
            result = grobo_motion_append(frames, &posture);
        }
        if (result < 0) {
            return result;
        }
    }
    return 0;
}

int grobo_motion_resample(const grobo_clip *clip, double rate_hz, const grobo_mem *mem,
                          grobo_motion **frames)
{
    if (clip == NULL || frames == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_motion *made;

    if (clip->sample == NULL) {
        return GROBO_ERR_UNSUPPORTED;
    }
    int result = grobo_motion_new(GROBO_MOTION_FRAMES, clip->n_joints, mem, &made);
    if (result < 0) {
        return result;
    }
    double count = clip->n_keys > 0 ? count_frames(clip, rate_hz) : 0;
    result = grobo_motion_set_frame_rate(made, rate_hz);
    if (result == 0 && count > GROBO_MOTION_FRAMES_MAX) {
        result = GROBO_ERR_CAP;
    }
    if (result == 0) {
        result = add_frames(clip, made, (size_t)count);
    }
    if (result < 0) {
        grobo_motion_free(made);
        return result;
    }
    *frames = made;
    return 0;
}
