/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include <grobo/core/motion.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/cli/heap.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/play/options.h"

enum { OPT_RATE, OPT_FROM, OPT_TO, OPT_EXACT, OPT_LOSSY, OPT_REPLACE, OPT_INTEGERS, OPT_BODY };

static const cli_option options[] = {
    [OPT_RATE] = OPTION_REAL("rate", 'r', "HZ", 0.1, 1000,
                             "to yaml: frames per second (50, or the source's own)"),
    [OPT_FROM] = OPTION_CHOICE("from", 0, FILE_FORMATS, "format of IN (by its name)"),
    [OPT_TO] = OPTION_CHOICE("to", 0, FILE_FORMATS, "format of OUT (by its name)"),
    [OPT_EXACT] = OPTION_FLAG("exact", 0,
                              "write exact angles (m) and times (yaml), which the original and "
                              "Choreonoid before 2.1 cannot read"),
    [OPT_LOSSY] = OPTION_FLAG("lossy", 0, "write OUT also where it does not play what IN plays"),
    [OPT_REPLACE] =
        OPTION_FLAG("replace", 0,
                    "write OUT also where it holds something other than a motion of its "
                    "format"),
    [OPT_INTEGERS] = OPTION_FLAG("integers", 0, "to m: whole ms and 0.1 degrees; the default"),
    BODY_OPTION_ROWS(OPT_BODY),
};

static grobo_motion_format format_of(const app *a, int option)
{
    const cli_value *v = app_option(a, option);
    return v->given ? (grobo_motion_format)(v->choice + 1) : GROBO_FORMAT_AUTO;
}

/* ---- writing -------------------------------------------------------------------------------- */

static int put_out(const heap *t, const char *path)
{
    if (strcmp(path, "-") != 0) {
        return file_save(path, t->bytes, t->size);
    }
    output_bytes(t->bytes, t->size);
    return 0;
}

/* Reads the text and looks whether it plays what the motion does. 0, or the status. */
static int verify(app *a, const grobo_motion *motion, const char *path, const heap *t,
                  const grobo_write_options *how)
{
    grobo_read_options read = {GROBO_READ_OPTIONS_INIT, .model = how->model, .format = how->format,
                               .name = path};
    grobo_diagnostics *list = NULL;
    grobo_motion *copy = NULL;
    grobo_diagnostic first;
    char said[1024] = "";
    int lost = grobo_diagnostics_new(NULL, &list);
    if (!lost) {
        lost = grobo_motion_read_memory(t->bytes ? t->bytes : "", t->size, &read, list, &copy);
    }
    if (!lost) {
        grobo_diagnostics_clear(list);
        lost = grobo_motion_verify(motion, copy, how, list);
    }
    for (size_t i = 0; grobo_diagnostics_get(list, i, &first) == 0; i++) {
        file_format(&first, false, said, sizeof said);
        if (i > 0) {
            app_note(a, "%s", said);
        } else if (lost) {
            app_fail(a, EXIT_FILE, "MISMATCH", "%s; --lossy writes %s all the same", said, path);
        }
    }
    if (lost < 0 && grobo_diagnostics_get(list, 0, &first) < 0) {
        app_fail_error(a, EXIT_FILE, lost, "%s", path);
    }
    grobo_motion_free(copy);
    grobo_diagnostics_free(list);
    return lost ? EXIT_FILE : 0;
}

static int write_out(app *a, const grobo_motion *motion, const char *path,
                     const grobo_write_options *how, grobo_diagnostics *list)
{
    heap t = {0}; /* the file as it will be: read back before an old one is replaced */
    grobo_sink sink = {.write = heap_sink, .ctx = &t};
    int status = 0, error = grobo_motion_write(motion, how->format, how, &sink, list);
    if (!error && !app_option(a, OPT_LOSSY)->given) {
        status = verify(a, motion, path, &t, how);
    }
    if (!error && !status) {
        error = put_out(&t, path);
    }
    if (error) {
        status = app_fail(a, EXIT_FILE, grobo_error_name(error), "%s: cannot write: %s", path,
                          file_write_error_text(error));
    }
    free(t.bytes);
    return status;
}

/* What may be written over OUT: nothing but a motion of the format to be written. */
static int refuse_out(app *a, const char *out, grobo_motion_format to)
{
    int error = strcmp(out, "-") == 0 || app_option(a, OPT_REPLACE)->given
                    ? 0
                    : grobo_motion_may_save(grobo_files_os(), out, to);
    if (error == GROBO_ERR_EXISTS) {
        return app_fail(a, EXIT_FILE, grobo_error_name(error),
                        "%s: holds something other than a .%s motion; --replace writes over it",
                        out, grobo_motion_format_name(to));
    }
    return error ? app_fail_error(a, EXIT_FILE, error, "%s", out) : 0;
}

/* One frame of so many is enough to tell how long the text of all will be. */
enum { ONE_OF = 1000, FRAMES_FEW = 100 * ONE_OF };

static int count_bytes(void *ctx, const void *bytes, size_t size)
{
    (void)bytes;
    *(double *)ctx += (double)size;
    return 0;
}

/* Frames at a rate may be longer than a file that can be read: said before they are made. */
static int refuse_length(app *a, const grobo_motion *motion, const char *path,
                         const grobo_write_options *how)
{
    grobo_write_options few = *how;
    few.rate_hz = how->rate_hz > 0 ? how->rate_hz : GROBO_MOTION_RATE_HZ;
    double frames = few.rate_hz / 1e6 * (double)grobo_motion_length_us(motion, how->default_us);
    double bytes = 0;
    grobo_sink sink = {.write = count_bytes, .ctx = &bytes};
    bool as_they_are =
        !(how->rate_hz > 0) && (how->exact || grobo_motion_get_kind(motion) == GROBO_MOTION_FRAMES);
    if (how->format != GROBO_FORMAT_YAML || as_they_are || frames < FRAMES_FEW ||
        app_option(a, OPT_LOSSY)->given) {
        return 0;
    }
    few.rate_hz /= ONE_OF;
    int error = grobo_motion_write(motion, few.format, &few, &sink, NULL);
    bytes *= ONE_OF;
    if (!error && bytes > (double)GROBO_FILE_MAX_BYTES) {
        return app_fail(a, EXIT_FILE, grobo_error_name(GROBO_ERR_CAP),
                        "%s: %.0f frames would be about %.1f GB, more than the %.1f GB that can be "
                        "read; give a lower --rate",
                        path, frames, bytes / 1e9, (double)GROBO_FILE_MAX_BYTES / 1e9);
    }
    return 0; /* whoever writes it says what is wrong */
}

/* ---- converting ----------------------------------------------------------------------------- */

/* Legs given by link targets that were not solved, in a format without them. */
static int refuse_links(app *a, const char *path, const grobo_motion *motion,
                        const grobo_write_options *how)
{
    bool keeps = how->format == GROBO_FORMAT_PSEQ || how->format == GROBO_FORMAT_MSEQ;
    size_t n = 0, links;
    const cli_value *ik = app_option(a, OPT_BODY + BODY_IK);
    for (size_t i = 0; i < grobo_motion_size(motion); i++) {
        n += grobo_motion_ik_links(motion, i, &links) && links;
    }
    if (!n || keeps || ik->given || app_option(a, OPT_LOSSY)->given) {
        return 0;
    }
    return app_fail(a, EXIT_FILE, "UNSUPPORTED",
                    "%s: %zu of %zu poses have ikLinks, and the feet of their robot are not known; "
                    "--ik off converts the listed joints alone",
                    path, n, grobo_motion_size(motion));
}

/* Notes what the source has and angles have no place for; the rest they were solved by. */
static void note_lost(const grobo_motion *motion, const grobo_write_options *how,
                      grobo_diagnostics *list)
{
    static const char *const codes[] = {"zmp-dropped", "name-dropped", "keys-dropped"};
    grobo_diagnostics *all = NULL;
    grobo_motion *plain = NULL;
    grobo_diagnostic d;
    if (grobo_diagnostics_new(NULL, &all) == 0) {
        (void)grobo_motion_convert(motion, GROBO_MOTION_POSTURES, how, all, &plain);
    }
    for (size_t i = 0; grobo_diagnostics_get(all, i, &d) == 0; i++) {
        for (size_t k = 0; k < sizeof codes / sizeof codes[0]; k++) {
            if (strcmp(d.code, codes[k]) == 0) {
                grobo_diagnostics_add(list, &d);
            }
        }
    }
    grobo_motion_free(plain);
    grobo_diagnostics_free(all);
}

/* Key poses keep their link targets; any other format gets the angles that they lead to. */
static int solve_legs(app *a, const char *path, const grobo_write_options *how,
                      grobo_motion **motion, grobo_diagnostics *list)
{
    grobo_motion *solved = NULL;
    double rate_hz = how->rate_hz;
    if (how->format == GROBO_FORMAT_PSEQ && !body_options_given(a, OPT_BODY)) {
        return 0;
    }
    if (how->format == GROBO_FORMAT_YAML && !how->exact && !(rate_hz > 0)) {
        rate_hz = GROBO_MOTION_RATE_HZ;
    }
    int status = body_solve(a, OPT_BODY, path, *motion, rate_hz, &solved);
    if (solved) {
        note_lost(*motion, how, list);
        grobo_motion_free(*motion);
        *motion = solved;
    }
    return status;
}

static void report(app *a, const grobo_motion *motion, const char *out,
                   const grobo_diagnostics *list)
{
    grobo_diagnostic d;
    if (a->json) {
        app_print_json(json_pack("{s:o,s:I,s:o}", "file", app_json_text(out), "postures",
                                 (json_int_t)grobo_motion_size(motion), "diagnostics",
                                 file_json(list)));
        return;
    }
    /* what is lost is worth a line even when it is a note */
    for (size_t i = 0; grobo_diagnostics_get(list, i, &d) == 0; i++) {
        char text[1024];
        file_format(&d, false, text, sizeof text);
        app_note(a, "%s", text);
    }
}

static int run(app *a)
{
    const char *in = a->line.argument[0], *out = a->line.argument[1];
    grobo_motion_format to = format_of(a, OPT_TO);
    grobo_read_options read = {GROBO_READ_OPTIONS_INIT, .model = app_model(a),
                               .format = format_of(a, OPT_FROM)};
    grobo_write_options how = {GROBO_WRITE_OPTIONS_INIT, .model = app_model(a),
                               .name = file_shown_name(in), /* notes tell places in IN */
                               .rate_hz = app_number(a, OPT_RATE, 0),
                               .exact = app_option(a, OPT_EXACT)->given > 0};
    grobo_diagnostics *list = NULL;
    grobo_motion *motion = NULL;
    if (to == GROBO_FORMAT_AUTO) {
        to = grobo_motion_format_of_path(out);
    }
    how.format = to;
    if (how.exact && app_option(a, OPT_INTEGERS)->given) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "convert: --exact and --integers cannot be used together");
    }
    if (to == GROBO_FORMAT_AUTO) {
        return app_fail(a, EXIT_USAGE, "ARG", "%s: unknown file type; use --to " FILE_FORMATS, out);
    }
    if (a->json && strcmp(out, "-") == 0) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "--json and the motion cannot both go to standard output");
    }
    int error = refuse_out(a, out, to);
    error = error ? error : file_list(a, &list);
    if (error) {
        return error;
    }
    error = file_load_listed(a, in, &read, list, &motion);
    if (!error) {
        error = solve_legs(a, in, &how, &motion, list);
    }
    if (error) {
        grobo_diagnostics_free(list);
        grobo_motion_free(motion);
        return error;
    }
    error = refuse_links(a, in, motion, &how);
    error = error ? error : refuse_length(a, motion, out, &how);
    if (!error) {
        error = write_out(a, motion, out, &how, list);
    }
    if (!error && output_flush()) { /* else app_finish() says why not */
        report(a, motion, out, list);
    }
    grobo_diagnostics_free(list);
    grobo_motion_free(motion);
    return error;
}

const cli_command cmd_convert = {
    .name = "convert",
    COMMAND_ARGUMENTS("IN OUT", 2, 2, CLI_ARG_FILE),
    .summary = "turn a motion file into another format",
    .details = "Converts between .m, .pseq, .mseq and .yaml (.seq), both ways. The formats follow\n"
               "from the names unless --from or --to say otherwise; - is standard input or\n"
               "output. OUT is read back before it is written: if it does not play what IN plays,\n"
               "that is an error. What its format has no place for (names, ZMP) is a note. An old\n"
               "OUT is replaced only when the new one is safely written, and only where it holds\n"
               "a motion of the same format, unless --replace is given.\n",
    .example = "  grctl convert greet.pseq greet.m\n"
               "  grctl convert --rate 50 greet.pseq greet.yaml\n",
    COMMAND_OPTIONS(options),
    .run = run,
};
