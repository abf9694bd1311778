/* SPDX-License-Identifier: MIT */
/* What `grctl serve` is told; it runs in a program of its own (beside.h). */
#include "tools/grctl/cli/realtime.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/imu.h"
#include "tools/grctl/web/run.h"

static const cli_option options[SERVE_OPTIONS] = {
    BROKER_OPTION_ROWS,
    [SERVE_PORT] = OPTION_WHOLE("port", 'p', "PORT", 0, 65534,
                                "port of the page; stop has the next one; 0: any two (8717)"),
    [SERVE_LISTEN] =
        OPTION_TEXT("listen", 0, "ADDRESS",
                    "listen there, not on this machine alone; then all needs the token"),
    [SERVE_NAME] = OPTION_TEXT("name", 0, "HOST", "a name that browsers may use for this machine"),
    [SERVE_OPERATOR] = OPTION_FLAG("operator", 0, "a page that asks for control gets it at once"),
    [SERVE_GROUP] = OPTION_TEXT("group", 0, "NAME", "of a fleet: the robots of this group (all)"),
    [SERVE_REALTIME] = REALTIME_OPTION,
    [SERVE_IMU] = IMU_OPTION,
};

const cli_command cmd_serve = {
    .name = "serve",
    COMMAND_ARGUMENTS("[DIR]", 0, 1, CLI_ARG_FILE),
    .summary = "serve the cockpit: see and move the robot in a browser",
    .details =
        "Prints a link: its page shows the robot in 3-D, live, plays the motions of DIR (the\n"
        "present directory), edits poses, and has a STOP that is always visible. Nothing moves\n"
        "until a page asks for it. One page drives at a time, the others watch; every page may\n"
        "stop the robot. When the page that drives is silent for one second, jogging stops; after\n"
        "three seconds its motion stops smoothly.\n"
        "\n"
        "Only programs of this machine can connect. The link has a token, without which nothing\n"
        "moves; it is new at each start, or that of $GRCTL_TOKEN. Programs use the same interface\n"
        "as the page: docs/serve.md. With --listen the token is needed to watch, too; HTTP is not\n"
        "encrypted: use 'ssh -L' or a proxy with TLS.\n"
        "\n"
        "With --broker it shows a fleet instead: every robot whose agent is at that broker, and a\n"
        "STOP for all of them that stands until it is released. It moves none of them.\n",
    .example = "  grctl serve -d sim motions\n  grctl serve --listen 0.0.0.0 --name robot.local\n"
               "  grctl serve --broker mqtt://stage.local\n",
    COMMAND_OPTIONS(options),
    .run = serve_run,
};
