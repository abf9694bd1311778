/* SPDX-License-Identifier: MIT */
/* What `grctl agent` is told; it runs in a program of its own (beside.h). */
#include "tools/grctl/cli/realtime.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/fleet/run.h"

static const cli_option options[AGENT_OPTIONS] = {
    BROKER_OPTION_ROWS,
    [AGENT_HOST] = OPTION_TEXT("host", 0, "NAME", "name of this machine (its host name)"),
    [AGENT_GROUP] =
        OPTION_TEXT("group", 0, "NAME", "the group of its robots, beside all (that of -d)"),
    [AGENT_LABEL] = OPTION_TEXT("label", 0, "NAME,...", "further groups of its robots, at most 8"),
    [AGENT_MOTIONS] = OPTION_TEXT("motions", 0, "FOLDER", "folder of the motion files (motions)"),
    [AGENT_COCKPIT] = OPTION_TEXT("cockpit", 0, "URL",
                                  "a page of each robot, its name for %: a link "
                                  "in the view of the fleet"),
    [AGENT_REALTIME] = REALTIME_OPTION,
};

const cli_command cmd_agent = {
    .name = "agent",
    .heading = "Several robots, scripts, this command",
    .arguments = "",
    .summary = "lend the robots of this machine to a fleet",
    .details =
        "Connects to an MQTT 5 broker, reports the state of the robots, and executes the orders\n"
        "of 'grctl fleet': one connection, however many robots. -d names a robot or a group of\n"
        "the configuration.\n"
        "\n"
        "It moves nothing by itself. Without its broker it keeps trying to connect, and a motion\n"
        "that is being played ends as was chosen at its start: by default it stops smoothly. A\n"
        "robot that does not answer is tried again every 5 s. A stop of the group stands until it\n"
        "is released.\n"
        "\n"
        "GRCTL_MQTT_PASSWORD is the password of USER. docs/guide/fleet.md lists the rights that\n"
        "the broker should grant, and what a stop over a network is not.\n",
    .example = "  grctl -d stage agent --broker mqtt://stage.local\n",
    COMMAND_OPTIONS(options),
    .group = CLI_GROUP_TOGETHER,
    .run = agent_run,
};
