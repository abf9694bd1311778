/* SPDX-License-Identifier: MIT */
/**
 * @file core/motion.h
 * @brief The rest of a motion: keys of Choreonoid's files, times, walking through.
 *
 * grobo/motion.h has the container, and says how its postures and times count.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_MOTION_H
#define GROBO_CORE_MOTION_H

#include <grobo/motion.h>

GROBO_BEGIN_DECLS

/* ---- making and freeing --------------------------------------------------------------------- */

/**
 * Makes it an empty motion of a kind, as grobo_motion_new() does: what it has goes, but for the
 * number of joints. A kind that is none changes nothing.
 */
GROBO_API void grobo_motion_renew(grobo_motion *motion, grobo_motion_kind kind);

/**
 * Makes absolute postures of a motion of increments, which count from start: each with the joints
 * and the time it had. Names and kept keys of its postures go. A motion of another kind stays.
 * @param start sets every joint that the motion sets
 * @return 0, GROBO_ERR_ARG (start lacks a joint) or GROBO_ERR_NOMEM.
 */
GROBO_API int grobo_motion_resolve(grobo_motion *motion, const grobo_posture *start);

/* ---- the motion itself ---------------------------------------------------------------------- */

/**
 * Sets the number of joints, 0..GROBO_JOINTS_MAX. New joints are not set in the postures there
 * are; angles of joints taken away are lost. Constant time to grow.
 * @return n_joints, GROBO_ERR_CAP or GROBO_ERR_ARG.
 */
GROBO_API int grobo_motion_set_joints(grobo_motion *motion, int n_joints);
/** True if each frame has a time of its own; false: frame i stands at i / rate. */
GROBO_API bool grobo_motion_has_frame_times(const grobo_motion *motion);
/** Gives each frame a time of its own, starting at i / rate, or takes it. @return 0 or ARG. */
GROBO_API int grobo_motion_set_frame_times(grobo_motion *motion, bool own);

/* ---- postures ------------------------------------------------------------------------------- */

/**
 * Posture n from the back, counted as the original does: get(size - n), so 1 is the last and
 * size the first. @return 0, or GROBO_ERR_ARG for 0 and above size.
 */
GROBO_API int grobo_motion_rget(const grobo_motion *motion, size_t n, grobo_posture *posture);

/**
 * Time from the posture before (the first: from 0) to posture n. For .m and .mseq 0 where the
 * times mean 'default' (a step <= 0 or >= 10 s); for the others 0 where times are equal or go back.
 * @return >= 0, or GROBO_ERR_ARG.
 */
GROBO_API int64_t grobo_motion_step_us(const grobo_motion *motion, size_t n);
/** Appends a posture at an absolute time as files have it. Errors as grobo_motion_append(). */
GROBO_API int grobo_motion_append_at(grobo_motion *motion, double time_s,
                                     const grobo_posture *posture);

/**
 * Inserts a posture at an absolute time, behind those that are not later; all other times stay.
 * For key poses and frames with times. @return its number, or as grobo_motion_append();
 * GROBO_ERR_TYPE for the other kinds. (The number is at most GROBO_MOTION_FRAMES_MAX.)
 */
GROBO_API int grobo_motion_insert_at(grobo_motion *motion, double time_s,
                                     const grobo_posture *posture);
/** Deletes posture n; the times of all others stay. @return 0 or GROBO_ERR_ARG. */
GROBO_API int grobo_motion_delete_keep_times(grobo_motion *motion, size_t n);
/** Sets the time of posture n: finite. @return 0, GROBO_ERR_ARG, GROBO_ERR_NAN. */
GROBO_API int grobo_motion_set_time_s(grobo_motion *motion, size_t n, double time_s);

/* ---- what key poses have besides ------------------------------------------------------------ */

/** What key n has besides; all zero where nothing. @return 0 or GROBO_ERR_ARG. */
GROBO_API int grobo_motion_get_key(const grobo_motion *motion, size_t n, grobo_key_info *info);
/** Sets it. @return 0, GROBO_ERR_ARG (no such key, time negative), GROBO_ERR_NAN, NOMEM. */
GROBO_API int grobo_motion_set_key(grobo_motion *motion, size_t n, const grobo_key_info *info);
/** Name of key n, "" where it has none (or there is no key n). Valid until it is changed. */
GROBO_API const char *grobo_motion_key_name(const grobo_motion *motion, size_t n);
/** Names key n; errors as grobo_motion_set_name(). */
GROBO_API int grobo_motion_set_key_name(grobo_motion *motion, size_t n, const char *name);
/** Link targets of key n, *count of them. @return them, valid until a change, or NULL. */
GROBO_API const grobo_ik_link *grobo_motion_ik_links(const grobo_motion *motion, size_t n,
                                                     size_t *count);

/**
 * Replaces the link targets of key n (copied); count 0 takes them away. Kept keys of links go.
 * @return 0, GROBO_ERR_ARG, GROBO_ERR_NAN, GROBO_ERR_CAP (GROBO_IK_LINKS_MAX), GROBO_ERR_NOMEM.
 */
GROBO_API int grobo_motion_set_ik_links(grobo_motion *motion, size_t n, const grobo_ik_link *links,
                                        size_t count);
/** Number of kept keys of key n, or of the motion itself (GROBO_MOTION_TOP). */
GROBO_API size_t grobo_motion_kept_count(const grobo_motion *motion, size_t n);
/** Kept key i of key n. @return 0 or GROBO_ERR_ARG. The texts are valid until a change. */
GROBO_API int grobo_motion_get_kept(const grobo_motion *motion, size_t n, size_t i,
                                    grobo_kept *kept);

/**
 * Adds a kept key to key n or to the motion itself; its texts are copied. The value must be YAML
 * in flow style on one line: it is written as it is.
 * @return 0, GROBO_ERR_ARG, GROBO_ERR_EXISTS, GROBO_ERR_CAP, GROBO_ERR_NOMEM.
 */
GROBO_API int grobo_motion_keep(grobo_motion *motion, size_t n, const grobo_kept *kept);
/** Line of the file that key n was read from, counted from 1; 0 where it was not read. */
GROBO_API uint32_t grobo_motion_line(const grobo_motion *motion, size_t n);

/**
 * Where in its file the angle of a joint of key n stands, for a motion read with keep_positions.
 * @return true and line and column counted from 1, or false and both untouched.
 */
GROBO_API bool grobo_motion_position(const grobo_motion *motion, size_t n, int joint,
                                     uint32_t *line, uint32_t *column);

/* ---- walking through ------------------------------------------------------------------------ */

/** Sets the direction of grobo_motion_next(); the place stays. @return reverse. */
GROBO_API bool grobo_motion_set_reverse(grobo_motion *motion, bool reverse);
/** The direction. */
GROBO_API bool grobo_motion_is_reverse(const grobo_motion *motion);
/** Goes to the first posture, in reverse to the last. */
GROBO_API void grobo_motion_reset(grobo_motion *motion);
/** Number of the posture that next gives; size or above (SIZE_MAX in reverse) behind the end. */
GROBO_API size_t grobo_motion_current(const grobo_motion *motion);
/** Gives the current posture and steps to the next.
 *  @return 1, or 0 behind the end (posture untouched) */
GROBO_API int grobo_motion_next(grobo_motion *motion, grobo_posture *posture);

/* ---- comparing and editing whole motions ---------------------------------------------------- */

/** True if kind, joints, times, postures, details and links are the same to the bit. */
GROBO_API bool grobo_motion_equal(const grobo_motion *a, const grobo_motion *b);
/** True if kind, size and set joints agree and every angle and time differs by less than these. */
GROBO_API bool grobo_motion_near(const grobo_motion *a, const grobo_motion *b, double delta_rad,
                                 double delta_s);

/* ---- the robot it is for -------------------------------------------------------------------- */

/**
 * Where a motion starts when no robot was read: what .mseq counts from, and where joints are that
 * no posture sets. The model's initial posture for a motion that is for it, else 0 everywhere.
 * @param[out] start all joints set: the model's, or as many as the motion has.
 */
GROBO_API void grobo_motion_start(const grobo_motion *motion, const grobo_model *model,
                                  grobo_posture *start);

GROBO_END_DECLS

#endif
