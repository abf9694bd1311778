/* SPDX-License-Identifier: MIT */
/* What lies between two times of a motion. */
#include <math.h>

#include "src/motion/play/clip.h"

typedef struct cut {
    const grobo_motion *from;
    grobo_motion *to;
    grobo_clip view;
    grobo_i_clip *clip; /* view's */
    double first_s, last_s;
} cut;

/* The posture at a cut becomes a key there. */
static int put_cut(cut *c, double at_s)
{
    grobo_posture posture;

    grobo_i_clip_sample_s(c->clip, at_s, &posture);
    return grobo_motion_append_at(c->to, at_s - c->first_s, &posture);
}

static int put_row(cut *c, size_t i)
{
    size_t n = grobo_i_clip_row(c->clip, i);
    int result = grobo_i_copy_rows(c->to, c->from, n, n + 1, 0);
    grobo_i_row row;

    if (result == 0 && grobo_i_row_at(c->to, c->to->size - 1, &row)) {
        *row.time_s = grobo_i_clip_at_s(c->clip, i) - c->first_s;
    }
    return result;
}

/* The first key at t_s or later, or with `later` set, later only. */
static size_t key_from(const cut *c, double t_s, bool later)
{
    size_t i = 0;

    while (i < c->from->size && (grobo_i_clip_at_s(c->clip, i) < t_s ||
                                 (later && grobo_i_clip_at_s(c->clip, i) <= t_s))) {
        i++;
    }
    return i;
}

/* Key poses and postures: those within, and one at each end that lies between two. */
static int crop_keys(cut *c)
{
    size_t size = c->from->size;
    size_t first = key_from(c, c->first_s, false), last = key_from(c, c->last_s, true);
    int result = 0;

    if (first > 0 && (first == size || grobo_i_clip_at_s(c->clip, first) > c->first_s)) {
        result = put_cut(c, c->first_s);
    }
    for (size_t i = first; i < last && result == 0; i++) {
        result = put_row(c, i);
    }
    if (result == 0 && c->last_s > c->first_s && last > 0 && last < size &&
        grobo_i_clip_at_s(c->clip, last - 1) < c->last_s) {
        result = put_cut(c, c->last_s);
    }
    return result;
}

/* Increments: of a step that is cut, the part that lies within. */
static int crop_steps(cut *c)
{
    double before_s = 0;

    for (size_t i = 0; i < c->from->size; i++) {
        double at_s = grobo_i_clip_at_s(c->clip, i);
        double low_s = fmax(before_s, c->first_s), high_s = fmin(at_s, c->last_s);
        if (high_s > low_s) {
            grobo_i_row row;
            int result = put_row(c, i);
            if (result < 0) {
                return result;
            }
            (void)grobo_i_row_at(c->to, c->to->size - 1, &row);
            *row.time_s = high_s - c->first_s;
            double part = (high_s - low_s) / (at_s - before_s);
            for (int j = 0; part < 1 && j < c->to->n_joints; j++) {
                row.angle_rad[j] *= part;
            }
        }
        before_s = at_s;
    }
    return 0;
}

/* Frames are kept or not; one that rounding puts just outside is within. */
static int crop_frames(cut *c)
{
    double slack_s = 1e-6;

    for (size_t i = 0; i < c->from->size; i++) {
        double at_s = grobo_i_clip_at_s(c->clip, i);
        if (at_s >= c->first_s - slack_s && at_s <= c->last_s + slack_s) {
            int result = put_row(c, i);
            if (result < 0) {
                return result;
            }
        }
    }
    return 0;
}

static int crop(cut *c)
{
    switch (c->from->kind) {
    case GROBO_MOTION_POSTURES:
    case GROBO_MOTION_KEYS:
        return crop_keys(c);
    case GROBO_MOTION_STEPS:
        return crop_steps(c);
    case GROBO_MOTION_FRAMES:
        return crop_frames(c);
    }
    return GROBO_ERR_STATE;
}

int grobo_motion_crop(grobo_motion *motion, int64_t from_us, int64_t to_us)
{
    if (motion == NULL) {
        return GROBO_ERR_ARG;
    }
    cut c = {.from = motion, .first_s = (double)from_us / 1e6, .last_s = (double)to_us / 1e6};

    if (from_us < 0 || to_us < from_us) {
        return GROBO_ERR_ARG;
    }
    int result = grobo_motion_clip(motion, NULL, &c.view);
    if (result < 0) {
        return result;
    }
    c.clip = c.view.ctx;
    result = grobo_i_new_like(motion, &c.to);
    if (result == 0) {
        result = crop(&c);
    }
    grobo_motion_clip_free(&c.view);
    if (result == 0) {
        grobo_i_swap(motion, c.to);
    }
    grobo_motion_free(c.to);
    return result;
}
