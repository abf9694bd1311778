/* SPDX-License-Identifier: MIT */
/* A list of keys of one quantity (a joint, a link, the ZMP), and the curve through it.
 * choreonoid-whole-body.md: Keys, Slopes. */
#ifndef GROBO_SRC_BODY_TRACK_H
#define GROBO_SRC_BODY_TRACK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What a key is. */
enum {
    TRACK_BASE = 1,   /* the tree is walked from this link */
    TRACK_TOUCH = 2,  /* the foot stands */
    TRACK_SLAVE = 4,  /* the foot follows the joints' own keys */
    TRACK_END = 8,    /* the curve is level here */
    TRACK_AUX = 16,   /* added by a step, not by the author */
    TRACK_SLOPE = 32, /* the slope is given and stays */
    TRACK_ADDED = 64  /* a ZMP key added here */
};

#define TRACK_DIM_MAX 6

/* Storage belongs to the body's workspace. Keys are in the order of time, except those of a ZMP
 * that the automatic ZMP inserted behind a later one, as Choreonoid does. Keys take effect in the
 * order of the list: such a key does when the one before it has. */
struct grobo_i_track {
    double *t_s;    /* n of them */
    double *from_s; /* when each takes effect: the latest time up to it in the list */
    double *v;      /* n rows of dim values */
    double *slope;  /* n rows of dim values a second, by grobo_i_track_slopes() */
    uint8_t *flags; /* n of them */
    int dim;        /* 1, 3 or 6 */
    int n;
    int capacity;
    bool overflow; /* a key was dropped: the maker's count was wrong */
};

/* Inserts a key before key `at`. v may be a row of this track. */
void grobo_i_track_insert(struct grobo_i_track *track, int at, double t_s, const double *v,
                          unsigned flags);

/* Inserts a key behind those at or before its time. */
void grobo_i_track_add(struct grobo_i_track *track, double t_s, const double *v, unsigned flags);

/* A hold before a key at t_s that is, or is about to be, key `at`: with a gap to key at - 1 longer
 * than max_transition_s (0: none), that one is repeated at t_s - max_transition_s, both level. */
void grobo_i_track_hold(struct grobo_i_track *track, int at, double t_s, double max_transition_s);

/* Computes the slopes; components from first_turn on are angles, first shifted by whole turns. */
void grobo_i_track_slopes(struct grobo_i_track *track, int first_turn);

/* Last key in effect at t_s, -1 if there is none. */
int grobo_i_track_find(const struct grobo_i_track *track, double t_s);

/* The curve at t_s: dim values; constant before the first and after the last key. n > 0. */
void grobo_i_track_value(const struct grobo_i_track *track, double t_s, double *out);

/* Row of key i. */
static inline double *grobo_i_track_row(const struct grobo_i_track *track, int i)
{
    return track->v + (size_t)i * (size_t)track->dim;
}

#endif
