/* SPDX-License-Identifier: MIT */
#include "tools/grctl/bringup/setup.h"
#include "tools/grctl/cmd/commands.h"

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
    .heading = "Begin",
    .arguments = "",
    .summary = "find a robot, name it and read its joints",
    .details =
        "Guides through the first steps: finds the adapter, and prints the fix if it cannot be\n"
        "opened; finds the servos that answer; takes the robot of grctl that has these servos, or\n"
        "writes a file of them; names it in ~/.config/grctl/config.yaml; reads its joints once;\n"
        "offers to calibrate it, and to move its last joint a little for the first time. Nothing\n"
        "else moves, and nothing is done as root. Each step prints what it has changed; --undo\n"
        "restores the configuration and removes a robot's file that was made, unless they have\n"
        "changed since. -d sim shows how it goes.\n"
        "\n"
        "New servos all have one id. Where one answers, or fewer than the robot has, setup offers\n"
        "to give them theirs: plug in the servo of each joint alone, as it is asked for. What was\n"
        "begun before is found and finished. Ids and rates are kept; what a servo kept before is\n"
        "saved to a file.\n"
        "\n"
        "It asks on a terminal. With --yes it does not: each answer is the value in the brackets,\n"
        "or a line of standard input where that is no terminal. It does not calibrate then.\n",
    .example = "  grctl setup\n  grctl -d sim --robot so101 setup\n  grctl setup --undo\n",
    COMMAND_OPTIONS(options),
    .run = run,
};
