/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "body_options.h"
#include "check_whole.h"
#include "commands.h"
#include "file.h"

enum { OPT_BODY, OPT_BALANCE = OPT_BODY + BODY_BALANCE };

static const cli_option options[] = {
    BODY_LOOK_ROWS(OPT_BODY),
};

typedef struct tally {
    size_t errors, warnings;
    int files;
} tally;

/* Of several files (a shell pattern) those that neither name nor content make a motion. */
static bool is_passed_by(const app *a, const char *path, grobo_diagnostics *list)
{
    grobo_motion *motion = NULL;
    grobo_diagnostic d = {.file = path,
                          .code = "skipped",
                          .message = "no motion file by name or content: skipped",
                          .severity = GROBO_SEVERITY_NOTE};
    int error;
    if (a->line.n_arguments < 2 || strcmp(path, "-") == 0 ||
        grobo_motion_format_of_path(path) != GROBO_FORMAT_AUTO)
        return false;
    error = file_read(path, NULL, NULL, &motion);
    grobo_motion_free(motion);
    if (error != GROBO_ERR_SYNTAX && error != GROBO_ERR_TYPE && error != GROBO_ERR_ISDIR)
        return false;
    grobo_diagnostics_add(list, &d);
    return true;
}

/* Everything about one file goes to the list: reading it, then playing it on the model. */
static void check_file(const app *a, const char *path, grobo_diagnostics *list)
{
    grobo_body_options body = body_options_read(a, OPT_BODY, 0);
    grobo_read_options read = {
        .model = &grobo_gr001_model, .keep_positions = true, .keep_going = true};
    const char *name = file_shown_name(path);
    grobo_check_options check = {.name = name};
    grobo_motion *motion = NULL;
    size_t before = grobo_diagnostics_total(list, GROBO_SEVERITY_ERROR);
    int error = file_read(path, &read, list, &motion);
    if (!error) {
        error = grobo_motion_check(motion, &grobo_gr001_model, &check, list);
        if (error >= 0)
            error = check_whole(name, motion, &body, app_option(a, OPT_BALANCE)->given, list);
        grobo_motion_free(motion);
    }
    if (error < 0 && grobo_diagnostics_total(list, GROBO_SEVERITY_ERROR) == before) {
        grobo_diagnostic d = {.file = name,
                              .code = "file",
                              .message = file_error_text(error),
                              .severity = GROBO_SEVERITY_ERROR};
        grobo_diagnostics_add(list, &d);
    }
}

static const char *color_of(const app *a, grobo_severity severity)
{
    if (!a->color_out)
        return "";
    return severity == GROBO_SEVERITY_ERROR     ? "\033[31m"
           : severity == GROBO_SEVERITY_WARNING ? "\033[33m"
                                                : "\033[2m";
}

static void print_text(const app *a, const grobo_diagnostics *list)
{
    char text[1024];
    grobo_diagnostic d;
    for (size_t i = 0; grobo_diagnostics_get(list, i, &d) == 0; i++) {
        if (d.severity == GROBO_SEVERITY_NOTE && a->verbosity < 1)
            continue;
        file_format(&d, true, text, sizeof text);
        printf("%s%s%s\n", color_of(a, d.severity), text, a->color_out ? "\033[0m" : "");
    }
}

static void print_json(const grobo_diagnostics *list, bool ok)
{
    json_t *all = json_array();
    grobo_diagnostic d;
    for (size_t i = 0; grobo_diagnostics_get(list, i, &d) == 0; i++)
        json_array_append_new(all, file_json(&d));
    app_print_json(json_pack("{s:b,s:o}", "ok", ok, "diagnostics", all));
}

static int run(app *a)
{
    grobo_diagnostics *list = NULL;
    tally t = {0};
    int error = grobo_diagnostics_new(&list, NULL);
    if (error)
        return app_fail(a, EXIT_ROBOT, grobo_error_name(error), "%s", grobo_error_text(error));
    for (int i = 0; i < a->line.n_arguments; i++) {
        if (is_passed_by(a, a->line.argument[i], list))
            continue;
        check_file(a, a->line.argument[i], list);
        t.files++;
    }
    t.errors = grobo_diagnostics_total(list, GROBO_SEVERITY_ERROR);
    t.warnings = grobo_diagnostics_total(list, GROBO_SEVERITY_WARNING);
    if (a->json)
        print_json(list, t.errors == 0);
    else
        print_text(a, list);
    grobo_diagnostics_free(list);
    if (!a->json && (t.errors || t.warnings))
        app_note(a, "%zu error%s, %zu warning%s", t.errors, t.errors == 1 ? "" : "s", t.warnings,
                 t.warnings == 1 ? "" : "s");
    else if (!a->json)
        app_note(a, "%d file%s, nothing wrong", t.files, t.files == 1 ? "" : "s");
    return t.errors ? EXIT_FILE : EXIT_DONE;
}

const cli_command cmd_check = {
    .name = "check",
    .arguments = "FILE...",
    .summary = "what is wrong with motion files",
    .details =
        "Reads motion files (.m .pseq .mseq .yaml .seq) and says every problem with its\n"
        "line and column: what is malformed, angles outside a joint's limits, moves too\n"
        "fast for the servo (and the time they would need), times going back, joints that\n"
        "GR001 does not have, legs that only ikLinks give. Exit status 3 if there is an\n"
        "error; warnings alone leave it 0. Notes are shown with -v. Of several files those that\n"
        "neither name nor content make a motion are passed by.\n\n"
        "Legs given by ikLinks are solved, and what they come to is checked too. --balance\n"
        "adds where the ZMP leaves the soles, no foot stands, or a standing foot slips; a\n"
        "motion that gives no feet is taken to stand on both.\n",
    .example = "  grctl check motions/*\n  grctl check --json walk.pseq\n"
               "  grctl check --balance walk.pseq\n",
    .options = options,
    .n_options = sizeof options / sizeof options[0],
    .min_arguments = 1,
    .max_arguments = -1,
    .argument = CLI_ARG_FILE,
    .run = run,
};
