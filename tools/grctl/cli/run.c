/* SPDX-License-Identifier: MIT */
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/session.h>

#include "tools/grctl/cli/config.h"
#include "tools/grctl/cli/each.h"
#include "tools/grctl/cli/each_line.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/cli/robot.h"
#include "tools/grctl/cli/run.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/os.h"

/* A mistake ends parsing, but a --json behind it is still read. */
static bool wants_json(int argc, char *const *argv)
{
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
        if (strcmp(argv[i], "--json") == 0) {
            return true;
        }
    }
    return false;
}

/* As 'grctl help COMMAND'. */
static int help(app *a)
{
    const cli_command *about = a->line.command;
    memset(a->line.option, 0, sizeof a->line.option);
    a->line.n_arguments = about ? 1 : 0;
    a->line.argument[0] = about ? about->name : NULL;
    return cli_find_command("help")->run(a);
}

static int fail(app *a, const char *complaint)
{
    const cli_command *command = a->line.command;
    if (complaint[strlen(complaint) - 1] == '?') { /* what was meant says enough */
        return app_fail(a, EXIT_USAGE, "ARG", "%s", complaint);
    }
    return app_fail(a, EXIT_USAGE, "ARG", "%s; see 'grctl help%s%s'", complaint, command ? " " : "",
                    command ? command->name : "");
}

static const char echo_alone[] = N_("--echo needs --wiring bus: the board returns nothing");

static bool is_echo_alone(const app *a)
{
    return app_global(a, GLOBAL_ECHO)->given && app_global(a, GLOBAL_WIRING)->choice == 0;
}

/* By configuration and options. A stop goes on with what could be found. */
static int find_robot(app *a)
{
    static config_robot first;
    int status = config_apply(a);
    if (!status && a->group && a->line.command->group == CLI_GROUP_FIRST) {
        app_note(a, "%s: %s, the first of %s", a->line.command->name, a->group->robot[0],
                 a->group->name);
        status = config_apply_member(a, a->group->robot[0], &first);
    }
    if (a->group) { /* each of its robots is found by itself */
        return status;
    }
    if (!status || a->hushed) {
        int chosen = robot_choose(a);
        status = status ? status : chosen;
    }
    return status;
}

/* What a line that names a group cannot ask for. */
static int refuse_group(app *a)
{
    const cli_command *command = a->line.command;
    const config_group *group = a->group;
    if (command->group == CLI_GROUP_NEVER) {
        return app_fail(a, EXIT_USAGE, "UNSUPPORTED",
                        "%s is a group of robots; '%s' works with one of them, such as -d %s",
                        group->name, command->name, group->robot[0]);
    }
    if (app_global(a, GLOBAL_TRACE)->given) {
        return app_fail(a, EXIT_USAGE, "UNSUPPORTED",
                        "--trace: %s is a group of robots; a trace is of one of them", group->name);
    }
    return 0;
}

/* The command of the line, for one robot or a group. */
static int run_it(app *a, int argc, char *const *argv)
{
    const cli_command *command = a->line.command;
    bool each =
        a->group && command->group == CLI_GROUP_EACH && !(command->goes_on && command->goes_on(a));
    return each ? each_run(a, argc, argv) : a->group ? command->run(a) : each_line_run(a);
}

/* The first signal to a command that stops the robot. */
static volatile sig_atomic_t noted;
static volatile sig_atomic_t is_over;

static void on_signal(int number)
{
    if (is_over) { /* only the output is still to be written */
        _Exit(EXIT_SIGNAL + number);
    }
    if (!noted) {
        noted = number;
    }
}

/* Does Ctrl-Z suspend it? */
static void suspend_by(void (*handler)(int number))
{
    if (os_suspension) {
        signal(os_suspension, handler);
    }
}

/* What was wrong before a stop: of the configuration, and of the line. The status of the last. */
static int complain_late(app *a, int later, const char *said, const char *complaint)
{
    if (later) {
        *a->place = '\0'; /* it stands in the message */
        app_fail(a, later, later == EXIT_FILE ? "SYNTAX" : "ARG", "%s", said);
    }
    return complaint ? fail(a, complaint) : later;
}

/*
 * A command that stops the robot: neither a mistake on its line nor a bad configuration keeps it
 * from that, nor a signal. They are reported after it; the status is that of a signal, or of the
 * stop where that failed.
 */
static int stop_first(app *a, int argc, char *const *argv, const char *complaint,
                      int (*prepare)(void *ctx, app *a), void *ctx)
{
    char hushed[APP_LINE_BYTES] = "";
    if (!a->link) {
        os_take_signals();
        os_catch_endings(on_signal);
        suspend_by(SIG_IGN);
    }
    a->hushed = hushed;
    int later = a->link ? EXIT_DONE : find_robot(a);
    if (prepare && !later) {
        later = prepare(ctx, a);
    }
    a->hushed = NULL;
    if (a->group) { /* each says it itself */
        complaint = NULL;
    } else if (is_echo_alone(a)) {
        complaint = complaint ? complaint : _(echo_alone);
        a->line.global[GLOBAL_ECHO].given = 0;
    }
    a->stops = true;
    a->mistaken = complaint || (later && !app_global(a, GLOBAL_DEVICE)->given);
    int status = run_it(a, argc, argv);
    a->stops = a->mistaken = false;
    is_over = true;
    if (!a->link) {
        suspend_by(SIG_DFL);
    }
    later = complain_late(a, later, hushed, complaint);
    if (noted && status < EXIT_SIGNAL) {
        return EXIT_SIGNAL + noted;
    }
    return status ? status : later;
}

/* Help and version, and a line without a command: the exit status, or -1 for any other line. */
static int run_without_robot(app *a)
{
    if (app_global(a, GLOBAL_VERSION)->given) {
        return cli_find_command("version")->run(a);
    }
    if (app_global(a, GLOBAL_HELP)->given) {
        return help(a);
    }
    if (a->line.command) {
        return -1;
    }
    if (a->json) {
        return app_fail(a, EXIT_USAGE, "ARG", "a command is missing; see 'grctl help'");
    }
    cli_print_overview(stderr);
    return EXIT_USAGE;
}

static const char *device_of(const app *a)
{
    const char *fallback = getenv("GRCTL_DEVICE");
    const cli_value *given = app_global(a, GLOBAL_DEVICE);
    return given->given ? given->text : fallback && *fallback ? fallback : GROBO_DEVICE_AUTO;
}

/* A robot of several lines, where a command or an option would speak to one of them alone. */
static int refuse_lines(app *a)
{
    const grobo_robot_def *def = robot_of(a);
    if (def->n_lines == 0) {
        return EXIT_DONE;
    }
    const char *fault = robot_lines_fault(a, device_of(a));
    if (fault) {
        return app_fail(a, EXIT_USAGE, "ARG", "%s", fault);
    }
    static const int one[] = {GLOBAL_BAUD, GLOBAL_ECHO};
    for (size_t i = 0; i < sizeof one / sizeof one[0]; i++) {
        if (app_global(a, one[i])->given) {
            return app_fail(a, EXIT_USAGE, "UNSUPPORTED",
                            "%s has %d lines: --baud and --echo are for one, as --line %s names "
                            "it; its file has the rate and echo of each",
                            def->name, def->n_lines, def->lines[0].name);
        }
    }
    return EXIT_DONE;
}

static int run_command(app *a, int argc, char *const *argv, int (*prepare)(void *ctx, app *a),
                       void *ctx)
{
    int status;
    if (!a->link && (status = find_robot(a)) != 0) {
        return status;
    }
    if (a->group && (status = refuse_group(a)) != 0) {
        return status;
    }
    if (!a->group && (status = refuse_lines(a)) != 0) {
        return status;
    }
    if (!a->group && is_echo_alone(a)) {
        return fail(a, _(echo_alone));
    }
    if (prepare && (status = prepare(ctx, a)) != 0) {
        return status;
    }
    status = run_it(a, argc, argv);
    if (status == EXIT_DONE && app_global(a, GLOBAL_TRACE)->given && !a->traced) {
        app_note(a, "nothing was traced: no robot was spoken to");
    }
    return status;
}

int run_line(app *a, int argc, char **argv, int (*prepare)(void *ctx, app *a), void *ctx)
{
    char complaint[512];
    lang_keep_english(a->json || wants_json(argc, argv));
    bool ok = cli_parse(&a->line, argc, argv, complaint, sizeof complaint);
    const cli_command *command = a->line.command;
    bool json = a->json; /* of the shell */
    app_settle(a);
    if (!ok) {
        a->json = a->json || json || wants_json(argc, argv);
    }
    if (command && command->stops && !app_global(a, GLOBAL_VERSION)->given &&
        !app_global(a, GLOBAL_HELP)->given) {
        return stop_first(a, argc, argv, ok ? NULL : complaint, prepare, ctx);
    }
    if (!ok) {
        return fail(a, complaint);
    }
    int status = run_without_robot(a);
    return status < 0 ? run_command(a, argc, argv, prepare, ctx) : status;
}
