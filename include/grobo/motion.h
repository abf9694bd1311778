/* SPDX-License-Identifier: MIT */
/**
 * @file motion.h
 * @brief A sequence of postures: the container behind every motion file.
 *
 * A motion keeps numbers as its file gave them (absolute times in seconds, radians), so that what
 * is read and written back is the same to the bit; durations are a view. Key poses carry, beside
 * angles, what Choreonoid's files have: link targets, ZMP, stationary joints, unknown keys.
 *
 * Postures are counted from 0. A call that fails (GROBO_ERR_NOMEM included) leaves the motion as
 * it was. A motion belongs to one thread at a time; const calls on an unchanged motion are safe
 * from many. Storage is chunked: appending costs amortised constant time, a key with n joints
 * takes 28 + 8 n bytes, and what a key has besides is allocated only where it has some.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_MOTION_H
#define GROBO_MOTION_H

#include <grobo/clip.h>
#include <grobo/mem.h>

GROBO_BEGIN_DECLS

/** Time of a step that gives none, where the caller names no other (the original records so). */
#define GROBO_MOTION_DEFAULT_US 250000

/** A step of this or more means 'the default motion time' in .m and .mseq files. */
#define GROBO_MOTION_STEP_MAX_US 10000000

/** Frames per second of a motion that becomes frames, where no other rate is asked for. */
#define GROBO_MOTION_RATE_HZ 50

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
    double parting_direction[3];     /**< meaningful with has_parting_direction */
    int index;                       /**< link index in the body, -1 where the file gives none */
    char name[GROBO_NAME_MAX_BYTES]; /**< empty where the file gives none */
    bool is_base;                    /**< isBaseLink */
    bool is_stationary;              /**< isStationaryPoint */
    bool is_touching;                /**< isTouching */
    bool is_slave;                   /**< isSlave */
    bool has_parting_direction;
} grobo_ik_link;

/** What a key has beside its posture, its links and its kept keys. All zero: nothing. */
typedef struct grobo_key_info {
    double max_transition_s;     /**< maxTransitionTime; 0: none */
    double zmp_m[3];             /**< meaningful with has_zmp */
    grobo_joint_mask stationary; /**< spJoints: joints with zero velocity at this key */
    bool has_zmp;
    bool zmp_stationary; /**< isZmpStationaryPoint; a file that gives a zmp alone means true */
} grobo_key_info;

/** Where a kept key stands in a file. */
typedef enum grobo_kept_level {
    GROBO_KEPT_TOP = 0,      /**< in the document's mapping: of the motion itself */
    GROBO_KEPT_REF = 1,      /**< beside `time` and `refer` */
    GROBO_KEPT_POSE = 2,     /**< in the mapping of `refer` */
    GROBO_KEPT_LINK = 3,     /**< in an entry of `ikLinks` */
    GROBO_KEPT_COMPONENT = 4 /**< in the component with the joints' frames: of the motion itself */
} grobo_kept_level;

/** A key that a file had and this library gives no meaning: kept to be written back. */
typedef struct grobo_kept {
    const char *key;        /**< plain text */
    const char *value;      /**< YAML in flow style on one line: `{ a: 1, b: [ 2 ] }` */
    grobo_kept_level level; /**< where it stands */
    uint8_t link;           /**< GROBO_KEPT_LINK: index of its entry in ikLinks */
} grobo_kept;

/** In place of a key's number: the motion itself. */
#define GROBO_MOTION_TOP SIZE_MAX

/** A motion. Opaque: made by grobo_motion_new(), freed by grobo_motion_free(). */
typedef struct grobo_motion grobo_motion;

/* ---- making and freeing ------------------------------------------------------------------- */

/**
 * Makes an empty motion.
 * @param n_joints 0..GROBO_JOINTS_MAX; see grobo_motion_set_joints()
 * @param mem borrowed for the motion's life; NULL: the C library's
 * @param[out] motion owned by the caller: grobo_motion_free().
 * @return 0, GROBO_ERR_ARG, GROBO_ERR_CAP or GROBO_ERR_NOMEM.
 */
GROBO_API int grobo_motion_new(grobo_motion_kind kind, int n_joints, const grobo_mem *mem,
                               grobo_motion **motion);
/** Frees a motion and all it has; NULL is nothing. */
GROBO_API void grobo_motion_free(grobo_motion *motion);
/** A deep copy, with the same allocator. @return 0 or GROBO_ERR_NOMEM. */
GROBO_API int grobo_motion_dup(const grobo_motion *motion, grobo_motion **copy);
/**
 * Deletes all postures; names, rate, joints and the motion's own kept keys stay. One of increments
 * becomes one of postures: what is appended then is where the joints go, not by how much.
 * grobo_motion_renew() makes an empty one of increments.
 */
GROBO_API void grobo_motion_clear(grobo_motion *motion);

/* ---- the motion itself -------------------------------------------------------------------- */

/** Number of postures. */
GROBO_API size_t grobo_motion_size(const grobo_motion *motion);
/** What its postures mean. */
GROBO_API grobo_motion_kind grobo_motion_get_kind(const grobo_motion *motion);
/** Number of joints of its postures. */
GROBO_API int grobo_motion_joints(const grobo_motion *motion);
/** The motion's name, "" where it has none. Valid until it is changed or freed. */
GROBO_API const char *grobo_motion_name(const grobo_motion *motion);
/** Sets the name (copied). @return 0, GROBO_ERR_ARG (not UTF-8), GROBO_ERR_CAP, GROBO_ERR_NOMEM. */
GROBO_API int grobo_motion_set_name(grobo_motion *motion, const char *name);
/** The body it was made for, "" where it names none. Valid until it is changed or freed. */
GROBO_API const char *grobo_motion_target_body(const grobo_motion *motion);
/** Sets the target body; as grobo_motion_set_name(). */
GROBO_API int grobo_motion_set_target_body(grobo_motion *motion, const char *name);
/** Frames a second of GROBO_MOTION_FRAMES, 0 where none was set and for the other kinds. */
GROBO_API double grobo_motion_frame_rate(const grobo_motion *motion);
/** Sets the frame rate: finite, > 0. @return 0 or GROBO_ERR_ARG (also for the other kinds). */
GROBO_API int grobo_motion_set_frame_rate(grobo_motion *motion, double rate_hz);

/* ---- postures ----------------------------------------------------------------------------- */

/**
 * Posture n from the front. time_us is the step from the posture before (the first: from 0), 0
 * where that means the default motion time, see grobo_motion_step_us().
 * @return 0, or GROBO_ERR_ARG (n too large; the posture is untouched).
 */
GROBO_API int grobo_motion_get(const grobo_motion *motion, size_t n, grobo_posture *posture);
/** Time of posture n as the file gives it, in seconds. @return 0 or GROBO_ERR_ARG. */
GROBO_API int grobo_motion_time_s(const grobo_motion *motion, size_t n, double *time_s);
/**
 * When the last posture is reached, with default_us for each step that gives no time (negative:
 * GROBO_MOTION_DEFAULT_US); a motion that begins at 0 begins with its first posture. For key
 * poses and frames the time of the last. 0 for an empty motion, INT64_MAX for one that would be
 * longer.
 */
GROBO_API int64_t grobo_motion_length_us(const grobo_motion *motion, int64_t default_us);

/**
 * Appends a posture, reached posture->time_us after the last one (frames at a rate: the next
 * frame). Its joints must fit the motion's: grobo_motion_set_joints() makes room.
 * In a motion of increments its angles are increments.
 * @return 0, GROBO_ERR_ARG (more joints than the motion, time negative or above INT64_MAX / 4, in a
 *   motion of postures or increments GROBO_MOTION_STEP_MAX_US or more, an angle beyond 10^6
 *   radians), GROBO_ERR_NAN, GROBO_ERR_CAP (GROBO_MOTION_FRAMES_MAX), GROBO_ERR_NOMEM.
 */
GROBO_API int grobo_motion_append(grobo_motion *motion, const grobo_posture *posture);
/**
 * Inserts a posture before posture n (n = size appends). Durations stay: what comes after is
 * reached posture->time_us later. Errors as grobo_motion_append().
 */
GROBO_API int grobo_motion_insert(grobo_motion *motion, size_t n, const grobo_posture *posture);
/** Deletes posture n and its step: what comes after is reached earlier. @return 0 or ARG. */
GROBO_API int grobo_motion_delete(grobo_motion *motion, size_t n);
/** Replaces joints and angles of posture n; its time stays. Errors as grobo_motion_append(). */
GROBO_API int grobo_motion_set(grobo_motion *motion, size_t n, const grobo_posture *posture);

/* ---- comparing and editing whole motions -------------------------------------------------- */

/**
 * Appends a deep copy of another motion, its steps as they are. One of another kind or frame rate
 * is converted before, as grobo_motion_convert() does without a note of what is lost: frames are
 * resampled, and increments count from where this motion leaves each joint.
 * @return 0, GROBO_ERR_TYPE (increments of a joint that this motion does not set, or anything but
 *   increments to a motion of increments: it is unknown from where they count, see
 *   grobo_motion_resolve()), GROBO_ERR_ARG (more joints), GROBO_ERR_STATE (frames without a rate),
 *   GROBO_ERR_CAP or GROBO_ERR_NOMEM.
 */
GROBO_API int grobo_motion_append_motion(grobo_motion *motion, const grobo_motion *other);
/**
 * Appends another motion with blend_us from the last posture to its first: key poses are
 * interpolated, postures are one step, frames at a rate get blended frames between (smooth start
 * and end). Errors as grobo_motion_append_motion(), GROBO_ERR_ARG for a negative blend.
 */
GROBO_API int grobo_motion_concat(grobo_motion *motion, const grobo_motion *other,
                                  int64_t blend_us);
/**
 * Swaps left and right by the model's table: joints, link targets (by name and index), ZMP.
 * @return 0, GROBO_ERR_ARG (other number of joints), GROBO_ERR_NOTFOUND (a link target that is
 *   neither a link of the model nor unsided by its name).
 */
GROBO_API int grobo_motion_mirror(grobo_motion *motion, const grobo_model *model);
/**
 * Turns time around. Waits that maxTransitionTime makes become keys of their own before, so that
 * the same curve is run backwards. @return 0, GROBO_ERR_CAP or GROBO_ERR_NOMEM.
 */
GROBO_API int grobo_motion_reverse(grobo_motion *motion);
/**
 * Makes it take factor times as long (> 0). Steps that mean the default time stay so.
 * @return 0, GROBO_ERR_ARG, or GROBO_ERR_CAP if a step of a .m or .mseq would reach 10 s.
 */
GROBO_API int grobo_motion_scale_time(grobo_motion *motion, double factor);
/**
 * Keeps what lies between two times of the motion, which then starts at 0. Where key poses or
 * .m postures are cut between two, the posture there becomes a key. Steps that give no time count
 * as GROBO_MOTION_DEFAULT_US. @return 0, GROBO_ERR_ARG (from negative or above to), NOMEM.
 */
GROBO_API int grobo_motion_crop(grobo_motion *motion, int64_t from_us, int64_t to_us);

/* ---- the robot it is for ------------------------------------------------------------------ */

/**
 * True for a motion of a model's robot: it has no more joints, and names as its target body the
 * model, one of its `alike`, "SerialRobot" (as the original library calls any robot) or none;
 * postures and frames that do not name the model have exactly its number of joints. Everything else
 * is a motion of another robot, whose joints have no names here, and which must not move this one:
 * see grobo_motion_set_target_body(). False where the model is NULL.
 */
GROBO_API bool grobo_motion_is_for(const grobo_motion *motion, const grobo_model *model);

/* ---- playing ------------------------------------------------------------------------------ */

/** How the time between two key postures is filled. */
typedef enum grobo_motion_style {
    GROBO_STYLE_CHOREONOID = 0, /**< key poses: Choreonoid's interpolation, joint by joint */
    GROBO_STYLE_SEED = 1        /**< as the original: each posture a copy of the one before with
                                     the listed joints set, straight lines between (the servo's) */
} grobo_motion_style;

/** Options of grobo_motion_clip(). Zero (or NULL): the defaults. */
typedef struct grobo_clip_options {
    size_t size;                /**< GROBO_CLIP_OPTIONS_INIT */
    grobo_motion_style style;   /**< key poses only; the other kinds have straight lines */
    int64_t default_us;         /**< for steps without time; 0: GROBO_MOTION_DEFAULT_US */
    const grobo_posture *start; /**< the sensed posture, used during the call: what .mseq counts
                                     from; may be NULL */
} grobo_clip_options;
/** Begins an initializer of one. */
#define GROBO_CLIP_OPTIONS_INIT GROBO_SIZED(grobo_clip_options)

/**
 * A playable view. Key mode: every posture with the joints it lists. Sampled: key poses by the
 * style; .m straight from posture to posture, the first held until its time; frames straight from
 * frame to frame. Steps without a time take default_us in both. .mseq with a start becomes
 * absolute postures; without one it stays relative and can be played by keys only.
 *
 * Everything is prepared here, with the motion's allocator: playing allocates nothing.
 * @param options may be NULL.
 * @param[out] clip reads the motion, which must outlive it unchanged: grobo_motion_clip_free().
 * @return 0, GROBO_ERR_ARG (start has other joints), GROBO_ERR_STATE (frames without a rate),
 *   GROBO_ERR_NOMEM.
 */
GROBO_API int grobo_motion_clip(const grobo_motion *motion, const grobo_clip_options *options,
                                grobo_clip *clip);
/** Frees what grobo_motion_clip() made; the clip is zeroed. For clips of that call only. */
GROBO_API void grobo_motion_clip_free(grobo_clip *clip);

/**
 * Frames at a rate: (int)(rate * length) + 1 of them at i / rate, of any clip that can be sampled.
 * Joints that are set nowhere stay unset.
 * @param rate_hz finite, > 0
 * @param[out] frames a new motion of kind GROBO_MOTION_FRAMES, owned by the caller.
 * @return 0, GROBO_ERR_ARG, GROBO_ERR_UNSUPPORTED (no sample), GROBO_ERR_CAP, GROBO_ERR_NOMEM, or
 *   what the clip's sample() gave.
 */
GROBO_API int grobo_motion_resample(const grobo_clip *clip, double rate_hz, const grobo_mem *mem,
                                    grobo_motion **frames);

GROBO_END_DECLS

#endif
