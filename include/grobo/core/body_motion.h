/* SPDX-License-Identifier: MIT */
/**
 * @file body_motion.h
 * @brief Key poses as files have them, played with the whole body.
 *
 * The bridge between grobo_motion (what a .pseq file holds) and grobo_body (what solves it). A
 * body made here lives on the heap; everything in body.h works with it. So does its rule for
 * threads: one at a time for a body and for what plays it; two bodies share nothing.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_BODY_MOTION_H
#define GROBO_CORE_BODY_MOTION_H

#include <grobo/core/body.h>
#include <grobo/motion.h>

GROBO_BEGIN_DECLS

/** True if a motion has link targets for the waist or a foot of the model. */
GROBO_API bool grobo_body_wanted(const grobo_body_model *model, const grobo_motion *motion);

/**
 * Makes a body that solves a motion's key poses. Link targets are found by name, or by index where
 * no link has it; others than waist and feet, and joints beyond the model's, are ignored.
 * @param model borrowed for the body's life
 * @param motion used during the call only
 * @param options may be NULL: all zero
 * @param mem borrowed for the body's life; NULL: the C library's
 * @param[out] body owned by the caller: grobo_body_free(). Untouched on error.
 * @return 0, GROBO_ERR_TYPE (no key poses), GROBO_ERR_EMPTY (no key), GROBO_ERR_NOMEM, or as
 * grobo_body_init().
 */
GROBO_API int grobo_body_new(const grobo_body_model *model, const grobo_motion *motion,
                             const grobo_body_options *options, const grobo_mem *mem,
                             grobo_body **body);

/** Frees a body that grobo_body_new() made; NULL is nothing. */
GROBO_API void grobo_body_free(grobo_body *body);

/**
 * A playable view of a body. Keys are the whole body at each time that has a key pose; joints that
 * the motion does not move are not set. Playing allocates nothing.
 * @param stop_unreachable sample() and key() give GROBO_ERR_UNREACHABLE where a leg does not reach
 * its target. False: the leg goes where Choreonoid lets it go, which can be a jump.
 * @param[out] clip reads the body, which must outlive it; nothing is to be freed.
 */
GROBO_API void grobo_body_clip(grobo_body *body, bool stop_unreachable, grobo_clip *clip);

/**
 * All frames of a body, at the rate of its options.
 * @param[out] frames a new motion of kind GROBO_MOTION_FRAMES, owned by the caller.
 * @param mem of the new motion; NULL: the C library's
 * @return number of frames in which a leg did not reach its target, or GROBO_ERR_NOMEM.
 */
GROBO_API int grobo_body_frames(grobo_body *body, const grobo_mem *mem, grobo_motion **frames);

GROBO_END_DECLS

#endif
