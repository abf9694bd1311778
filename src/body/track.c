/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "src/body/track.h"
#include "src/body/vec.h"

/* Keys closer than this jump. */
#define SEGMENT_MIN_S 1e-6
/* A smaller change is none, in radians and in metres. */
#define FLAT 1e-3

void grobo_i_track_insert(struct grobo_i_track *track, int at, double t_s, const double *v,
                          unsigned flags)
{
    const size_t behind = (size_t)(track->n - at);
    const size_t dim = (size_t)track->dim;
    double row[TRACK_DIM_MAX];

    if (track->n >= track->capacity) {
        track->overflow = true;
        return;
    }
    memcpy(row, v, dim * sizeof *row); /* before what v may point to moves */
    memmove(track->t_s + at + 1, track->t_s + at, behind * sizeof *track->t_s);
    memmove(track->flags + at + 1, track->flags + at, behind);
    memmove(grobo_i_track_row(track, at + 1), grobo_i_track_row(track, at),
            behind * dim * sizeof *track->v);
    memmove(track->slope + (size_t)(at + 1) * dim, track->slope + (size_t)at * dim,
            behind * dim * sizeof *track->slope);
    track->t_s[at] = t_s;
    track->n++;
    for (int i = at; i < track->n; i++) {
        track->from_s[i] = i > 0 ? fmax(track->from_s[i - 1], track->t_s[i]) : track->t_s[i];
    }
    track->flags[at] = (uint8_t)flags;
    memcpy(grobo_i_track_row(track, at), row, dim * sizeof *row);
    memset(track->slope + (size_t)at * dim, 0, dim * sizeof *track->slope);
}

void grobo_i_track_add(struct grobo_i_track *track, double t_s, const double *v, unsigned flags)
{
    grobo_i_track_insert(track, grobo_i_track_find(track, t_s) + 1, t_s, v, flags);
}

void grobo_i_track_hold(struct grobo_i_track *track, int at, double t_s, double max_transition_s)
{
    const int last = at - 1;

    if (last < 0 || max_transition_s <= 0 || t_s - track->t_s[last] <= max_transition_s) {
        return;
    }
    track->flags[last] |= TRACK_END;
    grobo_i_track_insert(track, at, t_s - max_transition_s, grobo_i_track_row(track, last),
                         track->flags[last]);
}

/* Slope of one component between two secants: their mean, 0 at a turning point or where level, and
 * beside a jump. A key that stands behind a later one is reached in a negative time. */
static double mean_slope(double before, double dt_before_s, double after, double dt_after_s)
{
    if (fabs(before) < FLAT || fabs(after) < FLAT || before * after <= 0 ||
        fabs(dt_before_s) < SEGMENT_MIN_S || fabs(dt_after_s) < SEGMENT_MIN_S) {
        return 0;
    }
    return 0.5 * (before / dt_before_s + after / dt_after_s);
}

static void unwrap(double *angle_rad, double near_rad)
{
    *angle_rad -= 2 * BODY_PI * floor((*angle_rad - near_rad + BODY_PI) / (2 * BODY_PI));
}

void grobo_i_track_slopes(struct grobo_i_track *track, int first_turn)
{
    const int dim = track->dim;

    for (int i = 0; i < track->n; i++) {
        const double *v = grobo_i_track_row(track, i);
        const bool level = i == 0 || i == track->n - 1 || (track->flags[i] & TRACK_END) != 0;
        double *slope = track->slope + (size_t)i * (size_t)dim;

        for (int k = first_turn; k < dim && i + 1 < track->n; k++) {
            unwrap(&grobo_i_track_row(track, i + 1)[k], v[k]);
        }
        if ((track->flags[i] & TRACK_SLOPE) != 0) {
            continue;
        }
        for (int k = 0; k < dim; k++) {
            slope[k] = level ? 0
                             : mean_slope(v[k] - v[k - dim], track->t_s[i] - track->t_s[i - 1],
                                          v[k + dim] - v[k], track->t_s[i + 1] - track->t_s[i]);
        }
    }
}

int grobo_i_track_find(const struct grobo_i_track *track, double t_s)
{
    int low = -1, high = track->n;

    while (high - low > 1) {
        const int middle = low + (high - low) / 2;

        if (track->from_s[middle] <= t_s) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

void grobo_i_track_value(const struct grobo_i_track *track, double t_s, double *out)
{
    const size_t dim = (size_t)track->dim;
    const int found = grobo_i_track_find(track, t_s);
    const int i = found < 0 ? 0 : found;
    const double *v = grobo_i_track_row(track, i);

    if (found < 0 || found == track->n - 1) {
        memcpy(out, v, dim * sizeof *out);
        return;
    }
    const double dt_s = track->t_s[i + 1] - track->t_s[i];

    if (dt_s < SEGMENT_MIN_S) {
        memcpy(out, v + dim, dim * sizeof *out);
        return;
    }
    /* cubic Hermite */
    const double s = (t_s - track->t_s[i]) / dt_s;
    const double h01 = s * s * (3 - 2 * s);
    const double h10 = s * (s - 1) * (s - 1) * dt_s;
    const double h11 = s * s * (s - 1) * dt_s;
    const double *slope = track->slope + (size_t)i * dim;

    for (size_t k = 0; k < dim; k++) {
        out[k] = v[k] + h01 * (v[k + dim] - v[k]) + h10 * slope[k] + h11 * slope[k + dim];
    }
}
