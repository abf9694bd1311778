/* SPDX-License-Identifier: MIT */
/* Stealthy step: choreonoid-whole-body.md, section of that name. A foot goes straight up before it
 * travels, stops travelling before it comes straight down, and touches down softly. */
#include "src/body/body.h"
#include "src/body/vec.h"

/* Height in which a foot does not travel, and from which it comes down softly. */
#define STEALTH_M 0.005
/* Time of the soft touchdown. */
#define IMPACT_S 0.04

static bool touches(const struct grobo_i_track *track, int i)
{
    return (track->flags[i] & TRACK_TOUCH) != 0;
}

/* Speed of the cubic that is level at keys i and i + 1, so long before the second. */
static double speed_before(const struct grobo_i_track *track, int i, double before_s)
{
    const double dt_s = track->t_s[i + 1] - track->t_s[i];
    const double s = 1 - before_s / dt_s;

    return 6 * s * (1 - s) * (track->v[i + 1] - track->v[i]) / dt_s;
}

static void soften_landing(struct grobo_i_track *height, int i)
{
    const double t_s = height->t_s[i + 1] - IMPACT_S;
    const double z = height->v[i + 1] + STEALTH_M;
    const double slope = -2 * STEALTH_M / IMPACT_S;

    if (IMPACT_S < 0.5 * (height->t_s[i + 1] - height->t_s[i]) &&
        speed_before(height, i, IMPACT_S) < slope) {
        grobo_i_track_insert(height, i + 1, t_s, &z, TRACK_SLOPE);
        height->slope[i + 1] = slope;
    }
}

static void stealthy_foot(struct grobo_i_track *foot, struct grobo_i_track *height)
{
    for (int i = foot->n - 2; i >= 0; i--) {
        const double *from = grobo_i_track_row(foot, i);
        const double *to = grobo_i_track_row(foot, i + 1);
        const double dt_s = foot->t_s[i + 1] - foot->t_s[i];
        const double rise = to[2] - from[2];

        if (touches(foot, i) && !touches(foot, i + 1) && rise >= 2 * STEALTH_M) {
            grobo_i_track_insert(foot, i + 1, foot->t_s[i] + STEALTH_M / rise * dt_s, from,
                                 foot->flags[i]);
        } else if (!touches(foot, i) && touches(foot, i + 1) && -rise >= 2 * STEALTH_M) {
            grobo_i_track_insert(foot, i + 1, foot->t_s[i + 1] + STEALTH_M / rise * dt_s, to,
                                 foot->flags[i + 1] | TRACK_AUX);
            soften_landing(height, i);
        }
    }
}

void grobo_i_stealthy_step(grobo_body *body)
{
    for (int foot = 0; foot < 2; foot++) {
        stealthy_foot(&body->target[GROBO_I_RIGHT + foot], &body->height[foot]);
    }
}
