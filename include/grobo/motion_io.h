/* SPDX-License-Identifier: MIT */
/**
 * @file motion_io.h
 * @brief Motion files: read, check, convert and write .m, .pseq, .mseq and .yaml (.seq).
 *
 * Files are untrusted: every size has a cap in limits.h, a document is streamed and never held as
 * a tree, and what is wrong with it is reported with line and column. docs/spec.md is the manual of
 * the formats. Nothing here depends on the locale. Calls on different motions and lists may run
 * in different threads.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_MOTION_IO_H
#define GROBO_MOTION_IO_H

#include <stdio.h>

#include <grobo/files.h>
#include <grobo/motion.h>

GROBO_BEGIN_DECLS

/* ---- diagnostics -------------------------------------------------------------------------- */

/** How bad it is. */
typedef enum grobo_severity {
    GROBO_SEVERITY_ERROR = 0,   /**< the file is refused, or would harm or be refused in play */
    GROBO_SEVERITY_WARNING = 1, /**< works, but probably not as meant */
    GROBO_SEVERITY_NOTE = 2     /**< what was skipped, dropped or taken as given */
} grobo_severity;

/** One thing to say about a file. Texts belong to the list that gave it. */
typedef struct grobo_diagnostic {
    const char *file;        /**< as the caller named it, "" where it has no name */
    const char *code;        /**< stable, for programs: "q-length", "limit" */
    const char *message;     /**< one English line for a person, without its place */
    uint32_t line;           /**< counted from 1; 0: the file as a whole */
    uint32_t column;         /**< counted from 1; 0: the line as a whole */
    grobo_severity severity; /**< how bad */
} grobo_diagnostic;

/** A bounded list of diagnostics: GROBO_DIAGNOSTICS_MAX are kept, the others counted. */
typedef struct grobo_diagnostics grobo_diagnostics;

/** Makes an empty list; mem as everywhere. @return 0 or GROBO_ERR_NOMEM. */
GROBO_API int grobo_diagnostics_new(const grobo_mem *mem, grobo_diagnostics **list);
/** Frees a list; NULL is nothing. */
GROBO_API void grobo_diagnostics_free(grobo_diagnostics *list);
/** Empties it. */
GROBO_API void grobo_diagnostics_clear(grobo_diagnostics *list);
/** Number of diagnostics of a severity that were added, kept or not. NULL has none. */
GROBO_API size_t grobo_diagnostics_total(const grobo_diagnostics *list, grobo_severity severity);
/** Number of diagnostics that are kept: those that grobo_diagnostics_get() gives. NULL has none. */
GROBO_API size_t grobo_diagnostics_kept(const grobo_diagnostics *list);
/** Diagnostic i of those that are kept, in the order they were found. @return 0, or GROBO_ERR_ARG:
 *  there are not so many. */
GROBO_API int grobo_diagnostics_get(const grobo_diagnostics *list, size_t i,
                                    grobo_diagnostic *diagnostic);
/** Adds one; its texts are copied (a message is cut at 255 bytes). NULL list, or a severity that is
 *  none: nothing happens. */
GROBO_API void grobo_diagnostics_add(grobo_diagnostics *list, const grobo_diagnostic *diagnostic);
/** "error", "warning" or "note"; "unknown" for a number that is none. Static. */
GROBO_API const char *grobo_severity_name(grobo_severity severity);

/* ---- formats ------------------------------------------------------------------------------ */

/** The file formats. */
typedef enum grobo_motion_format {
    GROBO_FORMAT_AUTO = 0, /**< by the name's extension, else by content */
    GROBO_FORMAT_M = 1,    /**< .m: postures of the original library */
    GROBO_FORMAT_PSEQ = 2, /**< .pseq: Choreonoid's key poses */
    GROBO_FORMAT_MSEQ = 3, /**< .mseq: increments */
    GROBO_FORMAT_YAML = 4  /**< .yaml, .seq: Choreonoid's body motion */
} grobo_motion_format;

/** "m", "pseq", "mseq", "yaml"; "auto" for GROBO_FORMAT_AUTO, "unknown" for a number that is no
 *  format. Static. */
GROBO_API const char *grobo_motion_format_name(grobo_motion_format format);
/** The format that the extension of a path names, in any case (".seq" and ".yml" are yaml);
 *  GROBO_FORMAT_AUTO for any other. */
GROBO_API grobo_motion_format grobo_motion_format_of_path(const char *path);

/* ---- reading ------------------------------------------------------------------------------ */

/** Options of reading. Zero (or NULL): the defaults. */
typedef struct grobo_read_options {
    size_t size;                /**< GROBO_READ_OPTIONS_INIT */
    grobo_motion_format format; /**< AUTO: by extension, else by content */
    const grobo_model *model;   /**< order of .m: its motors; NULL, or more angles in the file
                                     than it has motors: joint order */
    const grobo_mem *mem;       /**< of the motion and of reading; NULL: the C library's */
    const char *name;           /**< the file's name in diagnostics and for AUTO; NULL: the path, or
                                     "" where there is none */
    bool keep_positions;        /**< remember where each angle stands (8 bytes an angle), in the
                                     first GROBO_MOTION_POSITIONS_MAX postures */
    bool keep_going;            /**< after an error look for more; the result is an error still */
} grobo_read_options;
/** Begins an initializer of one. */
#define GROBO_READ_OPTIONS_INIT GROBO_SIZED(grobo_read_options)

/** Where bytes come from. */
typedef struct grobo_source {
    /** Up to size bytes into buffer. @return count, 0 at the end, or an error. */
    int (*read)(void *ctx, void *buffer, size_t size);
    void *ctx; /**< handed back to read */
} grobo_source;

/**
 * Reads a motion file.
 * @param[out] motion owned by the caller; untouched on error.
 * @param list diagnostics of the file are added to it; NULL: none are kept.
 * @return 0; GROBO_ERR_NOENT, GROBO_ERR_PERM, GROBO_ERR_ISDIR (on Windows GROBO_ERR_PERM too),
 *   GROBO_ERR_IO for the file itself;
 *   GROBO_ERR_SYNTAX (malformed), GROBO_ERR_TYPE (another kind of file), GROBO_ERR_NAN,
 *   GROBO_ERR_CAP (a cap of limits.h), GROBO_ERR_NOMEM. Every error but NOMEM adds a diagnostic.
 */
GROBO_API int grobo_motion_read_file(const char *path, const grobo_read_options *options,
                                     grobo_diagnostics *list, grobo_motion **motion);
/** Reads a motion from memory; as grobo_motion_read_file(). */
GROBO_API int grobo_motion_read_memory(const void *data, size_t size,
                                       const grobo_read_options *options, grobo_diagnostics *list,
                                       grobo_motion **motion);

/* ---- checking ----------------------------------------------------------------------------- */

/** Angles of a motion file played at the limit that they exceed: grobo_model.limit_slack_deg. */
typedef struct grobo_slack_taken {
    size_t n;         /**< angles */
    int joint;        /**< joint of the largest excess; meaningful with n > 0 */
    double worst_rad; /**< that excess */
    uint32_t line;    /**< line of the first one, 0: unknown */
} grobo_slack_taken;

/** Options of grobo_motion_check(). Zero (or NULL): the defaults. */
typedef struct grobo_check_options {
    size_t size;                /**< GROBO_CHECK_OPTIONS_INIT */
    const char *name;           /**< the file's name in diagnostics; NULL: "" */
    int64_t default_us;         /**< for steps without time; 0: GROBO_MOTION_DEFAULT_US */
    const grobo_posture *start; /**< what .mseq counts from; NULL: the model's initial posture */
    grobo_motion_style style;   /**< how key poses are filled when speeds are looked at */
    uint16_t speed_pct;         /**< the speed it is played at; 0: 100 */
    /**
     * Not NULL: angles that exceed a limit by no more than the model's slack are no errors, and
     * are added here. The player of the motion has to apply grobo_model_take_slack().
     */
    grobo_slack_taken *slack;
} grobo_check_options;
/** Begins an initializer of one. */
#define GROBO_CHECK_OPTIONS_INIT GROBO_SIZED(grobo_check_options)

/**
 * Looks for everything that would go wrong in play on a robot: angles outside limits, moves too
 * fast for the servo between two postures (with the time they would need), times going back,
 * joints and links unknown to the robot, legs given by ikLinks only, an empty motion.
 * Places are lines, and columns for a motion read with keep_positions.
 * @return number of errors found (warnings and notes are in the list), GROBO_ERR_NOMEM, or what
 *   grobo_motion_clip() gives.
 */
GROBO_API int grobo_motion_check(const grobo_motion *motion, const grobo_model *model,
                                 const grobo_check_options *options, grobo_diagnostics *list);

/* ---- converting --------------------------------------------------------------------------- */

/** Options of converting and writing. Zero (or NULL): the defaults. */
typedef struct grobo_write_options {
    size_t size;                /**< GROBO_WRITE_OPTIONS_INIT */
    grobo_motion_format format; /**< of grobo_motion_save(); AUTO: by the path's extension, else the
                                     one that holds the motion's kind */
    const grobo_model *model;   /**< motor order of .m (as in reading), and `start` if NULL below */
    const grobo_posture *start; /**< what increments count from; NULL: grobo_motion_start() */
    double rate_hz;             /**< to frames: resample at this rate; 0: postures that stand at 25
                                     or more per second one by one, others resampled at
                                     GROBO_MOTION_RATE_HZ, or at 2 or 4 times it where only
                                     then the end is on a frame, in the form that every version of
                                     Choreonoid and the original library read */
    int64_t default_us;         /**< for steps without time; 0: GROBO_MOTION_DEFAULT_US */
    grobo_motion_style style;   /**< how key poses are filled when resampled */
    bool exact;                 /**< .m: decimals where a number needs them, which the original
                                     library cannot read; otherwise whole milliseconds and 0.1
                                     degrees. Frames, with rate_hz 0: each posture at its own time,
                                     which this library and Choreonoid from 2.1 on read */
    bool replace;               /**< grobo_motion_save(): whatever the old file holds; otherwise
                                     see grobo_motion_may_save() */
    const char *name;           /**< the file's name in diagnostics; NULL: the path or "" */
} grobo_write_options;
/** Begins an initializer of one. */
#define GROBO_WRITE_OPTIONS_INIT GROBO_SIZED(grobo_write_options)

/**
 * A motion of another kind with the same postures at the same times. What that kind cannot hold
 * is noted in the list (severity note): ikLinks, ZMP, joints that are not set, steps of 10 s.
 * @param[out] converted owned by the caller; a copy where the kind is the same.
 * @return 0, GROBO_ERR_ARG, GROBO_ERR_STATE (frames without rate), GROBO_ERR_CAP, NOMEM.
 */
GROBO_API int grobo_motion_convert(const grobo_motion *motion, grobo_motion_kind kind,
                                   const grobo_write_options *options, grobo_diagnostics *list,
                                   grobo_motion **converted);

/* ---- writing ------------------------------------------------------------------------------ */

/** Where bytes go. */
typedef struct grobo_sink {
    /** Takes all of data. @return 0 or an error, which ends the writing. */
    int (*write)(void *ctx, const void *data, size_t size);
    void *ctx; /**< handed back to write */
} grobo_sink;

/**
 * Writes a motion to a file: to a temporary one beside it, which takes its place when all is
 * safely stored. An old file is replaced whole or stays as it was.
 * @param files the system's: grobo_files_os()
 * @return 0, GROBO_ERR_NOENT, GROBO_ERR_PERM, GROBO_ERR_ISDIR, GROBO_ERR_IO, GROBO_ERR_EXISTS
 *   (grobo_motion_may_save() refuses it, and `replace` is not set), or as above.
 */
GROBO_API int grobo_motion_save(const grobo_motion *motion, const grobo_files *files,
                                const char *path, const grobo_write_options *options,
                                grobo_diagnostics *list);

/* ---- motion directory --------------------------------------------------------------------- */

/**
 * Finds a motion in a directory: a name with an extension as it is, a base name by .m, .yaml,
 * .pseq, .mseq in this order. The name may go into folders below, but not out of the directory:
 * an absolute name, "..", and a symbolic link that leads out are refused.
 * @param[out] path of the file, NUL-terminated on success.
 * @return 0, GROBO_ERR_OUTSIDE (out of the directory), GROBO_ERR_PERM, GROBO_ERR_NOENT,
 *   GROBO_ERR_ISDIR, GROBO_ERR_SPACE, GROBO_ERR_IO.
 */
GROBO_API int grobo_motion_find(const grobo_files *files, const char *directory, const char *name,
                                char *path, size_t path_bytes);

GROBO_END_DECLS

#endif
