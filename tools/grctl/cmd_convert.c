/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <string.h>

#include "body_options.h"
#include "commands.h"
#include "file.h"

enum { OPT_RATE, OPT_FROM, OPT_TO, OPT_INTEGERS, OPT_BODY };

static const cli_option options[] = {
    [OPT_RATE] = {.name = "rate",
                  .letter = 'r',
                  .kind = CLI_NUMBER,
                  .value = "HZ",
                  .help = "to yaml: frames a second; else one frame a posture",
                  .min = 0.1,
                  .max = 1000,
                  .real = true},
    [OPT_FROM] = {.name = "from",
                  .kind = CLI_CHOICE,
                  .value = FILE_FORMATS,
                  .help = "format of IN, whatever its name says"},
    [OPT_TO] = {.name = "to",
                .kind = CLI_CHOICE,
                .value = FILE_FORMATS,
                .help = "format of OUT, whatever its name says"},
    [OPT_INTEGERS] = {.name = "integers",
                      .kind = CLI_FLAG,
                      .help = "to m: whole ms and 0.1 degrees, which the original reads"},
    BODY_OPTION_ROWS(OPT_BODY),
};

static grobo_motion_format format_of(const app *a, int option)
{
    const cli_value *v = app_option(a, option);
    return v->given ? (grobo_motion_format)(v->choice + 1) : GROBO_FORMAT_AUTO;
}

static int write_error(void)
{
    return errno == ENOSPC ? GROBO_ERR_DISK : GROBO_ERR_IO;
}

static int write_stream(void *ctx, const void *data, size_t size)
{
    return fwrite(data, 1, size, ctx) == size ? 0 : write_error();
}

static int write_out(const grobo_motion *motion, const char *path, const grobo_write_options *how,
                     grobo_diagnostics *list)
{
    grobo_sink sink = {.write = write_stream, .ctx = stdout};
    int error;
    if (strcmp(path, "-") != 0)
        return grobo_motion_save(motion, grobo_files_os(), path, how, list);
    error = grobo_motion_write(motion, how->format, how, &sink, list);
    return !error && fflush(stdout) != 0 ? write_error() : error;
}

/* Key poses keep their link targets; any other format gets the angles that they lead to. */
static int solve_legs(app *a, const char *path, const grobo_write_options *how,
                      grobo_motion **motion)
{
    grobo_body *body = NULL;
    grobo_motion *solved = NULL;
    int status;
    if (how->format == GROBO_FORMAT_PSEQ && !body_options_given(a, OPT_BODY))
        return 0;
    status = body_make(a, OPT_BODY, path, *motion, how->rate_hz, &body);
    if (!status && body)
        status = body_motion(a, path, body, how->rate_hz, &solved);
    grobo_body_free(body);
    if (solved) {
        (void)grobo_motion_set_name(solved, grobo_motion_name(*motion));
        (void)grobo_motion_set_target_body(solved, grobo_motion_target_body(*motion));
        grobo_motion_free(*motion);
        *motion = solved;
    }
    return status;
}

static void report(app *a, const grobo_motion *motion, const char *out,
                   const grobo_diagnostics *list)
{
    size_t n = grobo_diagnostics_count(list);
    if (a->json && strcmp(out, "-") != 0) {
        json_t *all = json_array();
        grobo_diagnostic d;
        for (size_t i = 0; grobo_diagnostics_get(list, i, &d) == 0; i++)
            json_array_append_new(all, file_json(&d));
        app_print_json(json_pack("{s:o,s:I,s:o}", "file", app_json_text(out), "postures",
                                 (json_int_t)grobo_motion_size(motion), "diagnostics", all));
        return;
    }
    for (size_t i = 0; i < n; i++) { /* what is lost is worth a line even when it is a note */
        char text[1024];
        grobo_diagnostic d;
        grobo_diagnostics_get(list, i, &d);
        file_format(&d, false, text, sizeof text);
        app_note(a, "%s", text);
    }
}

static int run(app *a)
{
    const char *in = a->line.argument[0], *out = a->line.argument[1];
    grobo_motion_format to = format_of(a, OPT_TO);
    grobo_read_options read = {.model = &grobo_gr001_model, .format = format_of(a, OPT_FROM)};
    grobo_write_options how = {.model = &grobo_gr001_model,
                               .name = file_shown_name(in), /* notes tell places in IN */
                               .rate_hz = app_number(a, OPT_RATE, 0),
                               .integers = app_option(a, OPT_INTEGERS)->given > 0};
    grobo_diagnostics *list = NULL;
    grobo_motion *motion = NULL;
    int error;
    if (to == GROBO_FORMAT_AUTO)
        to = grobo_motion_format_of_path(out);
    how.format = to;
    if (to == GROBO_FORMAT_AUTO)
        return app_fail(a, EXIT_USAGE, "USAGE",
                        "%s: its name tells no format; give --to " FILE_FORMATS, out);
    error = grobo_diagnostics_new(&list, NULL);
    if (error)
        return app_fail(a, EXIT_ROBOT, grobo_error_name(error), "%s", grobo_error_text(error));
    error = file_load_listed(a, in, &read, list, &motion);
    if (!error)
        error = solve_legs(a, in, &how, &motion);
    if (error) {
        grobo_diagnostics_free(list);
        grobo_motion_free(motion);
        return error;
    }
    error = write_out(motion, out, &how, list);
    if (error)
        error = app_fail(a, EXIT_FILE, grobo_error_name(error), "%s: cannot write: %s", out,
                         file_write_error_text(error));
    else
        report(a, motion, out, list);
    grobo_diagnostics_free(list);
    grobo_motion_free(motion);
    return error;
}

const cli_command cmd_convert = {
    .name = "convert",
    .arguments = "IN OUT",
    .summary = "turn a motion file into another format",
    .details = "Converts between .m, .pseq, .mseq and .yaml (.seq), both ways. The formats follow\n"
               "from the names unless --from or --to say otherwise; - is standard input or\n"
               "output. What the other format cannot hold is said. An old OUT is replaced only\n"
               "when the new one is safely written.\n",
    .example = "  grctl convert greet.pseq greet.m\n"
               "  grctl convert --rate 50 greet.pseq greet.yaml\n",
    .options = options,
    .n_options = sizeof options / sizeof options[0],
    .min_arguments = 2,
    .max_arguments = 2,
    .argument = CLI_ARG_FILE,
    .run = run,
};
