/* SPDX-License-Identifier: MIT */
#include <grobo/version.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/cmd/commands.h"

static int run(app *a)
{
    if (a->json) {
        app_print_json(json_pack("{s:s,s:s}", "name", "grctl", "version", grobo_version()));
    } else {
        app_print("grctl %s\n", grobo_version());
    }
    return EXIT_DONE;
}

const cli_command cmd_version = {
    .name = "version",
    .arguments = "",
    .summary = "print the version",
    .details = "Prints the version of grctl and its library.\n",
    .run = run,
};
