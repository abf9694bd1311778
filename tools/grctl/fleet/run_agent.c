/* SPDX-License-Identifier: MIT */
/* `grctl agent`: the robots of this machine, until a signal. */
#include <string.h>

#include "tools/grctl/cli/realtime.h"
#include "tools/grctl/fleet/agent.h"
#include "tools/grctl/fleet/run.h"

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
    const cli_value *given = app_option(a, AGENT_LABEL);
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
    const cli_value *given = app_option(a, AGENT_COCKPIT);
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

int agent_run(app *a)
{
    static agent g;
    static broker b;
    char group[FLEET_NAME_BYTES], own[FLEET_NAME_BYTES];
    const cli_value *motions = app_option(a, AGENT_MOTIONS);
    memset(&g, 0, sizeof g);
    g.motions = motions->given ? motions->text : "motions";
    fleet_host_name(own);
    int status = realtime_begin(a, AGENT_REALTIME);
    if (!status) {
        status = broker_read(&b, a);
    }
    if (!status) {
        status = check_robots(a);
    }
    if (!status) {
        status = take_name(a, AGENT_HOST, own, "host", g.host);
    }
    if (!status) {
        status =
            take_name(a, AGENT_GROUP, a->group ? a->group->name : a->robot->name, "group", group);
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
