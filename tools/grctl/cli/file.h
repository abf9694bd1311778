/* SPDX-License-Identifier: MIT */
/* Motion files on the command line: reading them, and saying what is wrong with them. */
#ifndef GRCTL_FILE_H
#define GRCTL_FILE_H

#include <grobo/core/motion_io.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/cli/heap.h"

/*
 * Reads a motion; "-" is standard input, "@record" what a shell has recorded. On failure says the
 * first error ("walk.pseq:41:9: ...") and returns the exit status; on success 0, and warnings are
 * said on standard error. The motion belongs to the caller.
 */
int file_load(app *a, const char *path, const grobo_read_options *options, grobo_motion **motion);

/*
 * The model whose joints a motion's are: the robot's, unless the motion names another body or,
 * naming none, has more joints; without --robot also that of a robot which the motion names. NULL:
 * none we know.
 */
const grobo_model *file_model(const app *a, const grobo_motion *motion);

/*
 * The one rule of which motion may move the robot, for every command and the cockpit: refuses one
 * that names another robot, one of angles whose number is not that of the joints and which names no
 * robot (grobo_motion_is_for()), and one of more joints than the robot has. forced: that only. 0,
 * or the exit status with it said.
 */
int file_fits(app *a, const char *path, const grobo_motion *motion, bool forced);

/* Says a warning on standard error, a note only with -v. */
void file_say_one(const app *a, const grobo_diagnostic *d);

/* A file that is read in the middle of a command: of a pipe the writer would be waited for. 0, or
 * the exit status of what was said. */
int file_refuse_pipe(app *a, const char *path);

/*
 * As grobo_motion_read_file(), but "-" is standard input, and a pipe that nobody writes to is
 * waited for a second only.
 */
int file_read(const char *path, const grobo_read_options *options, grobo_diagnostics *list,
              grobo_motion **motion);

/* As file_load(), but what there is to say beside an error goes to the caller's list. */
int file_load_listed(app *a, const char *path, const grobo_read_options *options,
                     grobo_diagnostics *list, grobo_motion **motion);

/* Whether there is one that can be read. */
bool file_is_there(const char *path);

/* All that a file has, or what is to come of a stream. Without bytes: errno says why; EFBIG: they
 * are more than `most`. */
heap file_rest(FILE *from, size_t most);
heap file_bytes(const char *path, size_t most);

/* Replaces a file, or what a symbolic link leads to, once the new one is safely written. */
int file_save(const char *path, const void *bytes, size_t size);
/* The same of a file that is not there yet; else GROBO_ERR_EXISTS. */
int file_save_new(const char *path, const void *bytes, size_t size);

/* Its name without folders. */
const char *file_last_part(const char *path);

/* What a file is called in messages: "-" is standard input. */
const char *file_shown_name(const char *path);

/*
 * One line of a diagnostic: "file:line:column: warning: message [code]"; without the code what that
 * means stands behind it, where the language is not that of the message: the library's, English.
 */
void file_format(const grobo_diagnostic *d, bool with_code, char *text, size_t capacity);
/* Prints it with its code, as a result; on a terminal with what that means. color: "" for none. */
void file_print(const app *a, const grobo_diagnostic *d, const char *color);

/* An empty list of them. 0, or the exit status with it said. */
int file_list(app *a, grobo_diagnostics **list);
/* Diagnostics as a list of JSON. */
json_t *file_json(const grobo_diagnostics *list);

/* Words of --from, --to: CLI_CHOICE of these gives the format at choice + 1. */
#define FILE_FORMATS "m|pseq|mseq|yaml"

/* What went wrong with a file as a whole, for a person. */
const char *file_error_text(int error);

/* The same of one that was to be written: what is not there is its folder. */
const char *file_write_error_text(int error);

#endif
