/* SPDX-License-Identifier: MIT */
/* What is prepared of a motion to play it. */
#ifndef GROBO_MOTION_CLIP_PRIVATE_H
#define GROBO_MOTION_CLIP_PRIVATE_H

#include <grobo/core/interpolate.h>

#include "src/motion/store/container.h"

typedef enum grobo_i_filling {
    GROBO_I_ROWS = 0, /* straight from row to row: every row sets the same joints */
    GROBO_I_STRAIGHT, /* tracks, straight from key to key */
    GROBO_I_SPLINE    /* tracks, Choreonoid's curve */
} grobo_i_filling;

/* The keys of one joint. */
typedef struct grobo_i_track {
    grobo_spline_track keys;
    size_t cursor;
} grobo_i_track;

typedef struct grobo_i_clip {
    const grobo_motion *motion;
    const grobo_mem *mem;
    size_t size;
    int64_t default_us;
    double *at_s;           /* when key i is reached; NULL for frames at a rate */
    size_t *order;          /* key i is row order[i]; NULL if they are in order */
    double *sums;           /* of increments: key i's angles, n_joints each; NULL if relative */
    grobo_spline_key *keys; /* of all tracks */
    size_t n_keys;
    grobo_i_track tracks[GROBO_JOINTS_MAX];
    grobo_joint_mask listed; /* joints that any row sets */
    size_t cursor;           /* of rows */
    grobo_i_filling filling;
} grobo_i_clip;

/* A clip of which keys are asked only: as grobo_motion_clip(), without room for curves. */
int grobo_i_clip_keys(const grobo_motion *motion, const grobo_clip_options *options,
                      grobo_clip *clip);
/* Has it sampled too, which is asked for once; start as in the options. */
int grobo_i_clip_fill(const grobo_clip *clip, const grobo_posture *start);

/* When key i is reached. */
static inline double grobo_i_clip_at_s(const grobo_i_clip *clip, size_t i)
{
    return clip->at_s != NULL ? clip->at_s[i] : grobo_i_time_s(clip->motion, i);
}

/* The row that key i is. */
static inline size_t grobo_i_clip_row(const grobo_i_clip *clip, size_t i)
{
    return clip->order != NULL ? clip->order[i] : i;
}

/* Angle of joint j of key i; the row sets it. */
static inline double grobo_i_clip_angle(const grobo_i_clip *clip, size_t i, const grobo_i_row *row,
                                        int j)
{
    return clip->sums != NULL ? clip->sums[i * clip->motion->n_joints + (size_t)j]
                              : row->angle_rad[j];
}

/* The two faces of a grobo_clip. */
int grobo_i_clip_key(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us);
int grobo_i_clip_sample(void *ctx, int64_t t_us, grobo_posture *posture);
/* As grobo_i_clip_sample(), with time in full precision. */
void grobo_i_clip_sample_s(grobo_i_clip *clip, double t_s, grobo_posture *posture);

#endif
