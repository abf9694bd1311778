/* SPDX-License-Identifier: MIT */
/**
 * @file core/motion_io.h
 * @brief The rest of motion files: sources, sinks, kinds, comparing.
 *
 * grobo/motion_io.h has reading, checking and writing of files.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_MOTION_IO_H
#define GROBO_CORE_MOTION_IO_H

#include <grobo/motion_io.h>

GROBO_BEGIN_DECLS

/* ---- formats -------------------------------------------------------------------------------- */

/** The kind of motion a format holds. GROBO_FORMAT_AUTO, and what is none, give
 *  GROBO_MOTION_KEYS. */
GROBO_API grobo_motion_kind grobo_motion_format_kind(grobo_motion_format format);
/** The format that holds a kind of motion; GROBO_FORMAT_AUTO for a number that is none. */
GROBO_API grobo_motion_format grobo_motion_kind_format(grobo_motion_kind kind);

/* ---- reading -------------------------------------------------------------------------------- */

/** Reads a motion from a source; as grobo_motion_read_file(), or what the source gave. */
GROBO_API int grobo_motion_read(const grobo_source *source, const grobo_read_options *options,
                                grobo_diagnostics *list, grobo_motion **motion);

/* ---- converting ----------------------------------------------------------------------------- */

/**
 * Whether a copy, read back from a file that source was written to with the same options, plays
 * what source plays: every posture at its time with every joint it sets (.m: within what whole
 * numbers can hold), and frames at a rate where the source is at their times. What cannot be in
 * the file's format at all (ikLinks, ZMP, names) is reported when it is written, and not here.
 * @param options of the writing; NULL: the defaults
 * @param list each joint that differs, where it differs first, and a time that does: errors.
 * @return how many differences were found, GROBO_ERR_NOMEM, or what grobo_motion_clip() gives.
 */
GROBO_API int grobo_motion_verify(const grobo_motion *source, const grobo_motion *copy,
                                  const grobo_write_options *options, grobo_diagnostics *list);

/* ---- writing -------------------------------------------------------------------------------- */

/**
 * Writes a motion, converted first where its kind is not the format's. .pseq and .yaml are laid
 * out as Choreonoid does, numbers as %.9g where that gives the same number, else %.17g.
 * @param format AUTO: the one that holds the motion's kind
 * @return 0, what the sink gave, GROBO_ERR_EMPTY (a body motion without frames, postures without
 *   joints), or as grobo_motion_convert().
 */
GROBO_API int grobo_motion_write(const grobo_motion *motion, grobo_motion_format format,
                                 const grobo_write_options *options, const grobo_sink *sink,
                                 grobo_diagnostics *list);

/**
 * Whether a motion may be saved in this format without the loss of anything but an older motion of
 * the same format: nothing is at the path, or an empty file, what is no regular file (a pipe, a
 * terminal), or a file that is read without an error in this format.
 * @param files the system's: grobo_files_os()
 * @param format not GROBO_FORMAT_AUTO
 * @return 0, GROBO_ERR_EXISTS (a file that holds something else), GROBO_ERR_ARG, GROBO_ERR_NOMEM.
 */
GROBO_API int grobo_motion_may_save(const grobo_files *files, const char *path,
                                    grobo_motion_format format);

/**
 * Writes a motion as .m to the first of Motion1.m, Motion2.m, ... that is not there yet in a
 * directory; no other program's file is replaced, even when two programs do so at once.
 * @param[out] path NUL-terminated on success.
 * @return N, GROBO_ERR_SPACE, GROBO_ERR_FULL (a million of them), or as grobo_motion_save().
 */
GROBO_API int grobo_motion_save_next(const grobo_motion *motion, const grobo_files *files,
                                     const char *directory, const grobo_write_options *options,
                                     char *path, size_t path_bytes);

/* ---- printing ------------------------------------------------------------------------------- */

/**
 * Prints angles in degrees with one decimal on one line, "-" for joints not set.
 * @param stream the caller's. @return 0 or GROBO_ERR_IO.
 */
GROBO_API int grobo_posture_print(const grobo_posture *posture, FILE *stream);
/** Prints a motion as its .m file would be (the original's printMotion). @return as writing. */
GROBO_API int grobo_motion_print(const grobo_motion *motion, const grobo_model *model,
                                 FILE *stream);

GROBO_END_DECLS

#endif
