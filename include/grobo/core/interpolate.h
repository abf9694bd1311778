/* SPDX-License-Identifier: MIT */
/**
 * @file interpolate.h
 * @brief Choreonoid's interpolation of one value through its keys, on arrays of the caller.
 *
 * A track is the list of keys of one joint, in order of time. Build it with grobo_spline_append()
 * from the poses that list the joint, prepare it once, then read it at any time:
 *
 *     grobo_spline_key room[GROBO_SPLINE_KEYS_FOR(n_poses)];
 *     grobo_spline_track track = {.keys = room, .capacity = sizeof room / sizeof room[0]};
 *     for (...) grobo_spline_append(&track, pose_t_s, q_rad, max_transition_s, is_stationary);
 *     grobo_spline_prepare(track.keys, track.n);
 *     q_rad = grobo_spline_at(track.keys, track.n, t_s, NULL);
 *
 * Poses go in in Choreonoid's order, which grobo_spline_order() finds. The rules are those of
 * Choreonoid's PoseSeqInterpolator; nothing here allocates or keeps state of its own, so every
 * function is safe from any thread that owns its arguments.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_INTERPOLATE_H
#define GROBO_CORE_INTERPOLATE_H

#include <grobo/types.h>

GROBO_BEGIN_DECLS

/** Neighbours whose values differ by less have slope 0 between them (Choreonoid). */
#define GROBO_SPLINE_FLAT 1e-3
/** Keys closer than this jump: the later value holds (Choreonoid). */
#define GROBO_SPLINE_JUMP_S 1e-6

/** Room that n appended keys need at most: each may bring a hold key with it. */
#define GROBO_SPLINE_KEYS_FOR(n) (2 * (n))

/** The slope at this key is 0 whatever its neighbours are. */
#define GROBO_SPLINE_STATIONARY 0x1u
/** The key was put in by a maximum transition time; no pose has it. */
#define GROBO_SPLINE_HOLD 0x2u

/** One key. Plain data. */
typedef struct grobo_spline_key {
    double t_s;     /**< its time, absolute in the motion */
    double value;   /**< rad for a joint, m for a position */
    double slope;   /**< value a second; set by grobo_spline_prepare() */
    unsigned flags; /**< GROBO_SPLINE_... */
} grobo_spline_key;

/** The keys of one value on an array of the caller. */
typedef struct grobo_spline_track {
    grobo_spline_key *keys; /**< borrowed; holds capacity keys */
    size_t n;               /**< keys in use */
    size_t capacity;        /**< room */
} grobo_spline_track;

/**
 * Order in which Choreonoid takes poses: by time, and of poses with equal times the one that
 * stands later in the file first.
 * @param t_s   n times, none NaN.
 * @param order n indices into t_s come out here. O(n log n), no other memory.
 */
GROBO_API void grobo_spline_order(const double *t_s, size_t n, size_t *order);

/**
 * Appends a key, and before it a hold key where the move to it may not take the whole gap: with
 * max_transition_s > 0 and a longer gap to the key before, a copy of that key is put at
 * t_s - max_transition_s, and both are stationary.
 * @param t_s not earlier than the last key
 * @param max_transition_s 0 or less: no such limit
 * @param stationary the pose asks for slope 0 here (spJoints)
 * @return keys appended, 1 or 2; GROBO_ERR_ARG for a time that runs back, GROBO_ERR_NAN for
 *         numbers that are not finite, GROBO_ERR_SPACE with the track untouched.
 */
GROBO_API int grobo_spline_append(grobo_spline_track *track, double t_s, double value,
                                  double max_transition_s, bool stationary);

/**
 * Computes the slopes of n keys in place. Slope 0 for the first, the last, stationary ones,
 * reversals, and where a neighbour differs by less than GROBO_SPLINE_FLAT; otherwise the mean of
 * the slopes of the two straight lines to the neighbours.
 */
GROBO_API void grobo_spline_prepare(grobo_spline_key *keys, size_t n);

/**
 * Value at t_s: before the first key its value, after the last its value, 0 without keys.
 * @param cursor NULL: binary search. Else an index kept by the caller between calls (start with
 *        0): O(1) when times rise, and right for any time.
 */
GROBO_API double grobo_spline_at(const grobo_spline_key *keys, size_t n, double t_s,
                                 size_t *cursor);

/** The cubic between two neighbouring prepared keys, a->t_s <= t_s <= b->t_s. */
GROBO_API double grobo_spline_cubic(const grobo_spline_key *a, const grobo_spline_key *b,
                                    double t_s);

GROBO_END_DECLS

#endif
