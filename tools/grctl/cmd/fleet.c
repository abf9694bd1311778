/* SPDX-License-Identifier: MIT */
/* What `grctl fleet` is told; it runs in a program of its own (beside.h). */
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/fleet/run.h"

static const cli_option options[FLEET_OPTIONS] = {
    BROKER_OPTION_ROWS,
    [FLEET_OPT_GROUP] = OPTION_TEXT("group", 0, "NAME", "the robots of this group (all)"),
    [FLEET_OPT_HOST] = OPTION_TEXT("host", 0, "NAME", "those of this machine alone"),
    [FLEET_OPT_SPEED] = OPTION_WHOLE("speed", 's', "PCT", 1, 1000, "play: speed in percent (100)"),
    [FLEET_OPT_REPEAT] = OPTION_WHOLE("repeat", 'n', "N", 1, 1000000, "play: N times"),
    [FLEET_OPT_MIRROR] = OPTION_FLAG("mirror", 'm', "play: left for right"),
    [FLEET_OPT_IF_LOST] = OPTION_CHOICE("if-lost", 0, "stop|pause|continue",
                                        "play: what the others do when a robot falls out (stop)"),
    [FLEET_OPT_ON_LOST] =
        OPTION_CHOICE("on-link-lost", 0, "stop|finish|exit",
                      "play: what robots do that hear no more of this command (stop)"),
    [FLEET_OPT_SPREAD] =
        OPTION_REAL("spread", 0, "MS", 0.1, 1000, "play: begin within this time (5)"),
    [FLEET_OPT_AT] =
        OPTION_TEXT("at", 0, "HH:MM:SS", "play: begin at this time, by the clock here"),
    [FLEET_OPT_WATCH] = OPTION_FLAG("watch", 'w', "status: repeat until a signal"),
};

const cli_command cmd_fleet = {
    .name = "fleet",
    COMMAND_ARGUMENTS("list|status|play|stop|estop|reset|push|log [FILE]", 1, -1, CLI_ARG_FILE),
    .summary = "command the robots of many machines, over a broker",
    .details =
        "Commands every 'grctl agent' at the broker, or those of a group or of a machine.\n"
        "\n"
        "  list, status, log  the agents; the state of robots; events, until Ctrl-C\n"
        "  push FILE...       puts motions into the folders of the agents\n"
        "  play FILE...       all prepare, wait for each other, and begin at one time;\n"
        "                     names in the folders of the agents, played in turn\n"
        "  stop, estop        a stop of the group that stands until 'reset': smoothly, or\n"
        "                     as an emergency stop that is read back joint by joint;\n"
        "                     always of the whole group, also with --host\n"
        "  reset              releases the stop; nothing moves\n"
        "\n"
        "A stop over a network is a convenience and no safety function: it may come late or\n"
        "never. Keep the switches within reach.\n",
    .example = "  grctl fleet list --broker mqtt://stage.local\n"
               "  grctl fleet push motions/greet.pseq\n"
               "  grctl fleet play greet.pseq --group stage\n",
    COMMAND_OPTIONS(options),
    .run = fleet_run,
};
