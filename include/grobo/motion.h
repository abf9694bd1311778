/* SPDX-License-Identifier: MIT */
/**
 * @file motion.h
 * @brief A sequence of postures: the container behind every motion file.
 *
 * A motion keeps numbers as its file gave them (absolute times in seconds, radians), so that what
 * is read and written back is the same to the bit; durations are a view. Key poses carry, beside
 * angles, what Choreonoid's files have: link targets, ZMP, stationary joints, unknown keys.
 * A motion belongs to one thread at a time; const calls on an unchanged motion are safe from many.
 */
#ifndef GROBO_MOTION_H
#define GROBO_MOTION_H

#include <grobo/clip.h>
#include <grobo/mem.h>

GROBO_BEGIN_DECLS

/** What the postures of a motion mean and how its times count. */
typedef enum grobo_motion_kind {
    GROBO_MOTION_POSTURES = 0, /**< .m: steps <= 0 or >= 10 s mean the default motion time */
    GROBO_MOTION_KEYS = 1,     /**< .pseq: key poses, interpolated by Choreonoid's rules */
    GROBO_MOTION_STEPS = 2,    /**< .mseq: increments; times as for .m */
    GROBO_MOTION_FRAMES = 3    /**< .yaml: frames at a fixed rate, or with a time each */
} grobo_motion_kind;

/** A link target of a key pose (an ikLinks entry): world frame, metres, row-major rotation. */
typedef struct grobo_ik_link {
    double translation_m[3];
    double rotation[9];
    double parting_direction[3]; /**< meaningful with has_parting_direction */
    int index;                   /**< link index in the body, -1 where the file gives none */
    char name[GROBO_NAME_MAX_BYTES];
    bool is_base, is_stationary, is_touching, is_slave, has_parting_direction;
} grobo_ik_link;

/** A motion. Opaque: made by grobo_motion_new(), freed by grobo_motion_free(). */
typedef struct grobo_motion grobo_motion;

GROBO_END_DECLS

#endif
