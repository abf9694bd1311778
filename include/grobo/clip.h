/* SPDX-License-Identifier: MIT */
/**
 * @file clip.h
 * @brief Something that can be played: what the sequencer sees of a motion.
 *
 * A clip is a view with two faces. `key` gives the key postures one by one, as the reference
 * library sends them (one frame a posture, the servos interpolate over its time). `sample` gives
 * the posture at any time, for playing at a rate. Neither may allocate, block or fail for reasons
 * other than a bad argument or a target out of reach: they run on the control path, on the thread
 * that plays.
 */
#ifndef GROBO_CLIP_H
#define GROBO_CLIP_H

#include <grobo/posture.h>

GROBO_BEGIN_DECLS

/** A playable view; the owner of ctx keeps it alive and unchanged while it is played. */
typedef struct grobo_clip {
    /**
     * Key posture i, 0 <= i < n_keys: joints set by it and the time to reach it from the key
     * before (0: the player's default time). *at_us is the time at which it is to be reached,
     * counted from the clip's start, with the player's default time not yet added.
     * @return 0 or an error.
     */
    int (*key)(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us);
    /**
     * The posture at time t_us, 0 <= t_us <= length_us; outside it is the nearest end. Of a
     * relative clip: the way from where it starts (its increments added up). NULL where a clip can
     * only be played by keys. @return 0 or an error.
     */
    int (*sample)(void *ctx, int64_t t_us, grobo_posture *posture);
    void *ctx;         /**< handed back to both */
    int64_t length_us; /**< time of the last key */
    size_t n_keys;     /**< number of key postures, 0 for an empty clip */
    uint8_t n_joints;  /**< joints of its postures */
    bool relative;     /**< keys are increments on the posture before (.mseq) */
} grobo_clip;

GROBO_END_DECLS

#endif
