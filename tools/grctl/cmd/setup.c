/* SPDX-License-Identifier: MIT */
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/setup/setup.h"

enum { OPT_UNDO };

static const cli_option options[] = {
    [OPT_UNDO] = OPTION_FLAG("undo", 0, "put the configuration back, remove a file that was made"),
};

static int run(app *a)
{
    return app_option(a, OPT_UNDO)->given ? setup_undo(a) : setup_run(a);
}

const cli_command cmd_setup = {
    .name = "setup",
    .arguments = "",
    .summary = "find a robot, name it and read its joints",
    .details =
        "Asks its way through: finds the adapter, and prints the fix where it may not be\n"
        "opened; looks who answers; takes the robot of grctl that has these servos, or writes a\n"
        "file of them; names it in ~/.config/grctl/config.yaml; reads its joints once; and\n"
        "offers to calibrate it. Nothing moves, and nothing is done as root. Each step says what\n"
        "it has changed; --undo undoes it, the configuration and a robot's file, unless they\n"
        "have changed since. -d sim shows how it goes.\n"
        "\n"
        "It asks at a terminal. With --yes it does not: each answer is what stands in the\n"
        "brackets, or a line of standard input where that is no terminal. No calibration then.\n",
    .example = "  grctl setup\n  grctl -d sim --robot so101 setup\n  grctl setup --undo\n",
    COMMAND_OPTIONS(options),
    .run = run,
};
