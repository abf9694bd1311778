/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/cmd/commands.h"

enum { OPT_MAN };

static const cli_option options[] = {
    [OPT_MAN] = {.name = "man", .kind = CLI_FLAG, .help = "print the man page grctl(1), as mdoc"},
};

static json_t *option_json(const cli_option *o)
{
    json_t *object = json_pack("{s:s,s:s}", "name", o->name, "help", o->help);
    if (o->letter)
        json_object_set_new(object, "letter", json_stringn(&o->letter, 1));
    if (o->kind != CLI_FLAG)
        json_object_set_new(object, "value", json_string(o->value));
    return object;
}

static json_t *command_json(const cli_command *command)
{
    json_t *list = json_array();
    for (size_t i = 0; i < command->n_options; i++)
        json_array_append_new(list, option_json(&command->options[i]));
    return json_pack("{s:s,s:s,s:s,s:o}", "name", command->name, "arguments", command->arguments,
                     "summary", command->summary, "options", list);
}

static int run(app *a)
{
    const cli_command *about = NULL;
    if (a->line.n_arguments) {
        const char *name = a->line.argument[0], *nearest;
        about = cli_find_command(name);
        nearest = cli_nearest_command(name);
        if (!about && nearest)
            return app_fail(a, EXIT_USAGE, "USAGE", "no command '%s'; did you mean '%s'?", name,
                            nearest);
        if (!about)
            return app_fail(a, EXIT_USAGE, "USAGE", "no command '%s'; see 'grctl help'", name);
    }
    if (a->json && app_option(a, OPT_MAN)->given) {
        app_print_json(json_pack("{s:o}", "manual", app_json_printed(cli_print_manual)));
    } else if (a->json) {
        json_t *list = json_array();
        for (size_t i = 0; i < cli_n_commands; i++)
            if (!about || about == cli_commands[i])
                json_array_append_new(list, command_json(cli_commands[i]));
        app_print_json(json_pack("{s:o}", "commands", list));
    } else if (app_option(a, OPT_MAN)->given) {
        cli_print_manual(output_stream());
    } else if (about) {
        cli_print_command(output_stream(), about);
    } else {
        cli_print_overview(output_stream());
    }
    return EXIT_DONE;
}

const cli_command cmd_help = {
    .name = "help",
    .arguments = "[COMMAND]",
    .summary = "what grctl can do, or what a command does",
    .details = "Prints the list of commands, or everything about one of them.\n",
    .example = "  grctl help play\n  grctl help --man | man -l -\n",
    .options = options,
    .n_options = sizeof options / sizeof options[0],
    .max_arguments = 1,
    .argument = CLI_ARG_COMMAND,
    .run = run,
};
