/* SPDX-License-Identifier: MIT */
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/fleet/message.h"
#include "tools/grctl/web/web.h"

enum { OPT_PORT = BROKER_OPTIONS, OPT_LISTEN, OPT_NAME, OPT_OPERATOR, OPT_GROUP, OPTIONS };

static const cli_option options[OPTIONS] = {
    BROKER_OPTION_ROWS,
    [OPT_PORT] = OPTION_WHOLE("port", 'p', "PORT", 0, 65534,
                              "port of the page; stop has the next one; 0: any two (8717)"),
    [OPT_LISTEN] = OPTION_TEXT("listen", 0, "ADDRESS",
                               "listen there, not on this machine alone; then all needs the token"),
    [OPT_NAME] = OPTION_TEXT("name", 0, "HOST", "a name that browsers may use for this machine"),
    [OPT_OPERATOR] = OPTION_FLAG("operator", 0, "a page that asks for control gets it at once"),
    [OPT_GROUP] = OPTION_TEXT("group", 0, "NAME", "of a fleet: the robots of this group (all)"),
};

static int run_fleet(app *a, const web_options *o)
{
    static broker b;
    const cli_value *group = app_option(a, OPT_GROUP);
    if (a->line.n_arguments) {
        return app_fail(a, EXIT_USAGE, "ARG", "serve --broker: motions are not of a fleet");
    }
    if (group->given && !fleet_is_name(group->text)) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "serve: letters, digits, _ and - in the name of a group");
    }
    int status = broker_read(&b, a);
    return status ? status : web_run_fleet(a, o, &b, group->given ? group->text : FLEET_ALL);
}

static int run(app *a)
{
    web_options o = {.folder = a->line.n_arguments ? a->line.argument[0] : ".",
                     .listen = app_option(a, OPT_LISTEN)->text,
                     .name = app_option(a, OPT_NAME)->text,
                     .port = (uint16_t)app_number(a, OPT_PORT, WEB_PORT),
                     .takes_over = app_option(a, OPT_OPERATOR)->given > 0};
    return app_option(a, BROKER_URL)->given ? run_fleet(a, &o) : web_run(a, &o);
}

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
    .run = run,
};
