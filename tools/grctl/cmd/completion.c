/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/cmd/commands.h"

static int run(app *a)
{
    static const struct {
        const char *shell;
        void (*print)(FILE *to);
    } all[] = {{"bash", cli_print_bash}, {"zsh", cli_print_zsh}, {"fish", cli_print_fish}};
    const char *shell = a->line.argument[0];
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        if (strcmp(shell, all[i].shell) != 0)
            continue;
        if (a->json)
            app_print_json(
                json_pack("{s:s,s:o}", "shell", shell, "script", app_json_printed(all[i].print)));
        else
            all[i].print(output_stream());
        return EXIT_DONE;
    }
    return app_fail(a, EXIT_USAGE, "ARG", "completion: '%s' is none of bash, zsh, fish", shell);
}

const cli_command cmd_completion = {
    .name = "completion",
    .arguments = "bash|zsh|fish",
    .summary = "a script that completes command lines",
    .details = "Prints the script that makes a shell complete commands, options, joints, groups\n"
               "and files of grctl. 'make install' puts it where the shells look for it.\n",
    .example = "  source <(grctl completion bash)\n"
               "  grctl completion fish >~/.config/fish/completions/grctl.fish\n",
    .min_arguments = 1,
    .max_arguments = 1,
    .argument = CLI_ARG_WORD,
    .run = run,
};
