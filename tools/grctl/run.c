/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "commands.h"
#include "config.h"
#include "run.h"
#include "trace.h"

/* A mistake ends parsing, but not the wish for JSON that stands behind it. */
static bool wants_json(int argc, char *const *argv)
{
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++)
        if (strcmp(argv[i], "--json") == 0)
            return true;
    return false;
}

static int help(const cli_command *command)
{
    if (command)
        cli_print_command(stdout, command);
    else
        cli_print_overview(stdout);
    return EXIT_DONE;
}

static int fail(app *a, const char *complaint)
{
    const cli_command *command = a->line.command;
    if (complaint[strlen(complaint) - 1] == '?') /* what was meant says enough */
        return app_fail(a, EXIT_USAGE, "USAGE", "%s", complaint);
    return app_fail(a, EXIT_USAGE, "USAGE", "%s; see 'grctl help%s%s'", complaint,
                    command ? " " : "", command ? command->name : "");
}

int run_line(app *a, int argc, char **argv, int (*prepare)(void *ctx, app *a), void *ctx)
{
    char complaint[512];
    bool ok = cli_parse(&a->line, argc, argv, complaint, sizeof complaint);
    const cli_command *command = a->line.command;
    bool json = a->json; /* of the shell */
    int status;
    app_settle(a);
    if (!ok) {
        a->json = json || wants_json(argc, argv);
        return fail(a, complaint);
    }
    if (app_global(a, GLOBAL_VERSION)->given)
        return cmd_version.run(a);
    if (app_global(a, GLOBAL_HELP)->given)
        return help(command);
    if (!command) {
        cli_print_overview(stderr);
        return EXIT_USAGE;
    }
    if (!a->link && (status = config_apply(a)) != 0)
        return status;
    if (app_global(a, GLOBAL_ECHO)->given && app_global(a, GLOBAL_WIRING)->choice == 0)
        return fail(a, "--echo needs --wiring bus: the board returns nothing");
    if (prepare && (status = prepare(ctx, a)) != 0)
        return status;
    status = command->run(a);
    if (status == EXIT_DONE && app_global(a, GLOBAL_TRACE)->given && !trace_was_tried())
        app_note(a, "nothing was traced: no robot was spoken to");
    return status;
}
