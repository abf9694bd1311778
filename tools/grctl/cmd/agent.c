/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/fleet/agent.h"
#include "tools/grctl/fleet/broker.h"

enum { OPT_HOST = BROKER_OPTIONS, OPT_GROUP, OPT_LABEL, OPT_MOTIONS, OPT_COCKPIT, OPTIONS };

static const cli_option options[OPTIONS] = {
    BROKER_OPTION_ROWS,
    [OPT_HOST] = OPTION_TEXT("host", 0, "NAME", "name of this machine (its host name)"),
    [OPT_GROUP] =
        OPTION_TEXT("group", 0, "NAME", "the group of its robots, beside all (that of -d)"),
    [OPT_LABEL] = OPTION_TEXT("label", 0, "NAME,...", "further groups of its robots, at most 8"),
    [OPT_MOTIONS] = OPTION_TEXT("motions", 0, "FOLDER", "folder of the motion files (motions)"),
    [OPT_COCKPIT] = OPTION_TEXT("cockpit", 0, "URL",
                                "a page of each robot, its name for %: a link "
                                "in the view of the fleet"),
};

static int take_name(app *a, int option, const char *otherwise, const char *what, char *name)
{
    const cli_value *given = app_option(a, option);
    const char *text = given->given ? given->text : otherwise;
    if (!fleet_is_name(text)) {
        return app_fail(a, EXIT_USAGE, "ARG", "%s '%s': letters, digits, _ and -, at most 63", what,
                        text);
    }
    snprintf(name, FLEET_NAME_BYTES, "%s", text);
    return EXIT_DONE;
}

/* NAME,... */
static int take_labels(app *a, agent *g)
{
    const cli_value *given = app_option(a, OPT_LABEL);
    char name[FLEET_NAME_BYTES];
    for (const char *at = given->given ? given->text : ""; *at; at += *at == ',') {
        size_t length = strcspn(at, ",");
        snprintf(name, sizeof name, "%.*s", length < sizeof name ? (int)length : 0, at);
        if (!fleet_is_name(name) || g->n_groups == AGENT_GROUPS) {
            return app_fail(a, EXIT_USAGE, "ARG",
                            "--label '%s': at most 8 names of letters, digits, _ and - are wanted",
                            given->text);
        }
        agent_join(g, name);
        at += length;
    }
    return EXIT_DONE;
}

/* A link to a page. */
static int take_cockpit(app *a, agent *g)
{
    const cli_value *given = app_option(a, OPT_COCKPIT);
    if (given->given && !fleet_is_link(given->text)) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "--cockpit '%s': http:// or https:// and less than %d characters",
                        given->text, FLEET_URL_BYTES);
    }
    g->cockpit = given->given ? given->text : NULL;
    return EXIT_DONE;
}

static int check_robots(app *a)
{
    if (!a->group && !a->robot) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "agent: -d names a robot or a group of the configuration");
    }
    for (int i = 0; a->group && i < a->group->n; i++) {
        if (!fleet_is_name(a->group->robot[i])) {
            return app_fail(a, EXIT_USAGE, "ARG",
                            "robot '%s': letters, digits, _ and - in a name for a fleet",
                            a->group->robot[i]);
        }
    }
    return EXIT_DONE;
}

static int serve(agent *g)
{
    while (!g->all.host.signal) {
        if (event_base_loop(g->all.host.base, EVLOOP_ONCE) != 0) {
            return app_fail_error(g->a, EXIT_ROBOT, GROBO_ERR_IO, "agent");
        }
        agent_work(g);
    }
    return EXIT_SIGNAL + g->all.host.signal;
}

static int run(app *a)
{
    static agent g;
    static broker b;
    char group[FLEET_NAME_BYTES], own[FLEET_NAME_BYTES];
    const cli_value *motions = app_option(a, OPT_MOTIONS);
    memset(&g, 0, sizeof g);
    g.motions = motions->given ? motions->text : "motions";
    fleet_host_name(own);
    int status = broker_read(&b, a);
    if (!status) {
        status = check_robots(a);
    }
    if (!status) {
        status = take_name(a, OPT_HOST, own, "host", g.host);
    }
    if (!status) {
        status =
            take_name(a, OPT_GROUP, a->group ? a->group->name : a->robot->name, "group", group);
    }
    if (!status) {
        agent_join(&g, FLEET_ALL);
        agent_join(&g, group);
        status = take_labels(a, &g);
    }
    if (!status) {
        status = take_cockpit(a, &g);
    }
    if (status) {
        return status;
    }
    status = agent_begin(&g, a, &b.config);
    return agent_end(&g, status ? status : serve(&g));
}

const cli_command cmd_agent = {
    .name = "agent",
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
    .run = run,
};
