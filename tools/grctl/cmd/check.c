/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tools/grctl/cli/config.h"
#include "tools/grctl/cli/file.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/play/check.h"
#include "tools/grctl/play/options.h"

enum { OPT_FORCE, OPT_BODY, OPT_BALANCE = OPT_BODY + BODY_BALANCE };

static const cli_option options[] = {
    [OPT_FORCE] = OPTION_FLAG("force", 0, "do not warn of a fall"),
    BODY_LOOK_ROWS(OPT_BODY),
};

/* What check_file() needs beside the file. */
typedef struct order {
    grobo_body_options body;
    unsigned what; /* CHECK_... */
} order;

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
    if (a->line.n_arguments < 2 || strcmp(path, "-") == 0 ||
        grobo_motion_format_of_path(path) != GROBO_FORMAT_AUTO) {
        return false;
    }
    int error = file_read(path, NULL, NULL, &motion);
    grobo_motion_free(motion);
    if (error != GROBO_ERR_SYNTAX && error != GROBO_ERR_TYPE && error != GROBO_ERR_ISDIR) {
        return false;
    }
    grobo_diagnostics_add(list, &d);
    return true;
}

/* Everything about one file goes to the list: reading it, then playing it on the model. */
static void check_file(const app *a, const char *path, const order *o, grobo_diagnostics *list)
{
    grobo_read_options read = {GROBO_READ_OPTIONS_INIT, .model = app_model(a),
                               .keep_positions = true, .keep_going = true};
    const char *name = file_shown_name(path);
    grobo_slack_taken slack = {.n = 0};
    grobo_check_options check = {GROBO_CHECK_OPTIONS_INIT, .name = name, .slack = &slack};
    check_whole_how how = {.path = name, .what = o->what, .slack = &slack};
    grobo_motion *motion = NULL;
    size_t before = grobo_diagnostics_total(list, GROBO_SEVERITY_ERROR);
    int error = file_read(path, &read, list, &motion);
    if (!error) {
        const grobo_model *model = whole_robot_of(a, motion).model;
        error = grobo_motion_check(motion, model, &check, list);
        if (error >= 0) {
            error = check_whole(a, motion, &o->body, &how, list);
        }
        check_report_slack(name, model, &slack, list);
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
    if (!a->color_out) {
        return "";
    }
    return severity == GROBO_SEVERITY_ERROR     ? "\033[31m"
           : severity == GROBO_SEVERITY_WARNING ? "\033[33m"
                                                : "\033[2m";
}

static void print_text(const app *a, const grobo_diagnostics *list)
{
    grobo_diagnostic d;
    for (size_t i = 0; grobo_diagnostics_get(list, i, &d) == 0; i++) {
        if (d.severity == GROBO_SEVERITY_NOTE && a->verbosity < 1) {
            continue;
        }
        file_print(a, &d, color_of(a, d.severity));
    }
}

static unsigned how_to_balance(const app *a)
{
    if (app_option(a, OPT_BALANCE)->given) {
        return CHECK_BALANCE;
    }
    return app_option(a, OPT_FORCE)->given || !config_warns_of_falls(a) ? 0 : CHECK_FALL;
}

static int run(app *a)
{
    order o = {.what = CHECK_LEGS | how_to_balance(a)};
    grobo_diagnostics *list = NULL;
    tally t = {0};
    int error = body_options_read(a, OPT_BODY, 0, &o.body);
    error = error ? error : file_list(a, &list);
    if (error) {
        return error;
    }
    for (int i = 0; i < a->line.n_arguments; i++) {
        if (is_passed_by(a, a->line.argument[i], list)) {
            continue;
        }
        check_file(a, a->line.argument[i], &o, list);
        t.files++;
    }
    t.errors = grobo_diagnostics_total(list, GROBO_SEVERITY_ERROR);
    t.warnings = grobo_diagnostics_total(list, GROBO_SEVERITY_WARNING);
    if (a->json) {
        app_print_json(json_pack("{s:b,s:o}", "ok", t.errors == 0, "diagnostics", file_json(list)));
    } else {
        print_text(a, list);
    }
    grobo_diagnostics_free(list);
    if (!a->json && (t.errors || t.warnings)) {
        app_note(a, "%zu error%s, %zu warning%s", t.errors, t.errors == 1 ? "" : "s", t.warnings,
                 t.warnings == 1 ? "" : "s");
    } else if (!a->json) {
        app_note(a, "%d file%s, nothing wrong", t.files, t.files == 1 ? "" : "s");
    }
    return t.errors ? EXIT_FILE : EXIT_DONE;
}

const cli_command cmd_check = {
    .name = "check",
    COMMAND_ARGUMENTS("FILE...", 1, -1, CLI_ARG_FILE),
    .summary = "check motion files",
    .details =
        "Reads motion files (.m .pseq .mseq .yaml .seq) and reports every problem with its line\n"
        "and column: malformed contents, angles outside a joint's limits, moves too fast for the\n"
        "servo (and the time they would need), times that go back, joints that GR001 does not\n"
        "have, legs that only ikLinks give. The exit status is 3 if there is an error; warnings\n"
        "alone leave it 0. Notes are shown with -v. Of several files, those that are no motion by\n"
        "name or content are skipped.\n"
        "\n"
        "Legs given by ikLinks are solved, and the solved angles are checked too. One warning\n"
        "reports where the robot would fall; --force and 'warn_fall: false' in config.yaml\n"
        "silence it. --balance reports more: where the ZMP leaves the soles, no foot stands, or a\n"
        "standing foot slips; the first two are errors. A motion that gives no feet is assumed to\n"
        "stand on both.\n"
        "\n"
        "Angles up to one degree outside a limit, as recordings have them, are played at the\n"
        "limit: one warning counts them.\n",
    .example = "  grctl check motions/*\n  grctl check --json walk.pseq\n"
               "  grctl check --balance walk.pseq\n",
    COMMAND_OPTIONS(options),
    .run = run,
};
