/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tools/grctl/cli/output.h"
#include "tools/grctl/cli/sync.h"
#include "tools/grctl/fleet/agent.h"
#include "tools/grctl/fleet/orders.h"
#include "tools/grctl/fleet/say.h"
#include "tools/grctl/fleet/wire.h"

enum { TICK_US = 100000, LAST_EVERY = 10 /* ticks */, RETRY_US = 5000000 };

/* ---- stops ----------------------------------------------------------------------------------- */

/* Every robot, in this call. */
static void stop_now(agent *g, bool brakes)
{
    for (int i = 0; i < g->all.n; i++) {
        seat *s = &g->all.seats[i];
        if (!s->is_open) {
            continue;
        }
        if (brakes) {
            s->c.estop_ended = false;
            (void)grobo_robot_estop(s->c.robot);
        } else {
            (void)grobo_robot_stop(s->c.robot, false);
        }
    }
    robot_group_look(&g->all);
}

/* The broker keeps something else than the stop that stands: who comes later would not hear of it,
 * and nobody could take it back, who has to know its id. */
static void remind_broker(agent *g, const agent_group *group)
{
    if (group->latch) {
        say_latch(g, group);
    }
}

/* The retained stop of a group: it stands until who has its id takes it back. */
static void take_latch(agent *g, agent_group *group, json_t *latch)
{
    const char *id = latch ? fleet_text(latch, "id") : NULL;
    const char *before = group->latch ? fleet_text(group->latch, "id") : NULL;
    bool known = id && before && strcmp(id, before) == 0;
    if (!id || strlen(id) != FLEET_ID_BYTES - 1) {
        remind_broker(g, group); /* what cannot be read changes nothing */
        return;
    }
    if (json_is_true(json_object_get(latch, "stopped"))) {
        json_decref(group->latch);
        group->latch = json_incref(latch);
        if (!known) {
            stop_now(g, agent_brakes(group));
            say_stopping(g, group);
            group->telling = true;
        }
    } else if (known) {
        json_decref(group->latch);
        group->latch = NULL;
        group->telling = false;
        say_event(g, NULL, "released", "the stop of the group was released");
    } else {
        remind_broker(g, group);
    }
}

static void find_latch(agent *g, const char *name, const mqtt_message *message)
{
    json_t *latch = message->size ? fleet_read(message->payload, message->size) : NULL;
    agent_group *group = agent_find_group(g, name);
    if (group) {
        take_latch(g, group, latch);
    }
    json_decref(latch);
}

static bool stands(const seat *s)
{
    return !s->is_open || !s->c.up ||
           (grobo_robot_job(s->c.robot) == GROBO_JOB_NONE && !grobo_robot_moving(s->c.robot) &&
            !grobo_robot_is_playing(s->c.robot));
}

static bool all_stand(void *ctx)
{
    const agent *g = ctx;
    for (int i = 0; i < g->all.n; i++) {
        if (!stands(&g->all.seats[i])) {
            return false;
        }
    }
    return true;
}

/* Told once all stand, or could not be made to. */
static void tell_stopped(agent *g)
{
    if (!all_stand(g)) {
        return;
    }
    for (int i = 0; i < g->n_groups; i++) {
        if (g->groups[i].telling) {
            g->groups[i].telling = false;
            say_stopped(g, &g->groups[i]);
        }
    }
}

/* ---- the permit ------------------------------------------------------------------------------ */

static void take_permit(agent *g, const char *group, const mqtt_message *message)
{
    json_t *permit = fleet_read(message->payload, message->size);
    const char *leader = permit ? fleet_text(permit, "leader") : NULL;
    if (leader && g->plays && strcmp(leader, g->play.is.from) == 0 &&
        strcmp(group, g->permit_group) == 0) {
        g->permit_us = grobo_now_us();
    }
    json_decref(permit);
}

/* As was said when it began; before it began it stops in any case. */
static void let_go(agent *g)
{
    bool begun = g->started && grobo_now_us() >= g->start_us;
    agent_lost lost = begun ? g->on_lost : AGENT_STOP;
    g->let_go = true;
    say_event(g, NULL, "unpermitted",
              !begun                 ? "the permit lapsed before the start: it stops"
              : lost == AGENT_FINISH ? "the permit lapsed: the motion goes on"
              : lost == AGENT_EXIT   ? "the permit lapsed: the exit policy"
                                     : "the permit lapsed: the motion stops");
    if (lost == AGENT_FINISH) {
        return;
    }
    (void)grobo_team_stop(g->all.team, false);
    for (int i = 0; i < g->all.n && lost == AGENT_EXIT; i++) {
        seat *s = &g->all.seats[i];
        if (s->chosen && s->c.up) {
            (void)grobo_robot_exit(s->c.robot, GROBO_EXIT_DEFAULT);
        }
    }
    robot_group_look(&g->all);
}

/* ---- what comes ------------------------------------------------------------------------------ */

/* What the broker keeps of this host: where our own was before, that of another life is another
 * agent's, and each connection of one ends that of the other. */
static void take_connection(const agent *g, const mqtt_message *message)
{
    json_t *said = fleet_read(message->payload, message->size);
    const char *epoch = said ? fleet_text(said, "epoch") : NULL;
    if (g->greeted && epoch && strcmp(epoch, g->epoch) != 0) {
        app_note(g->a, "the broker has another agent of the name '%s': give one another --host",
                 g->host);
    }
    json_decref(said);
}

static void on_message(void *ctx, const mqtt_message *message)
{
    agent *g = ctx;
    char part[4][FLEET_NAME_BYTES];
    int n = fleet_parts(message->topic, part);
    if (n == 2 && strcmp(part[1], "connection") == 0) {
        take_connection(g, message);
    } else if (n == 3 && strcmp(part[0], "group") == 0 && strcmp(part[2], "latch") == 0) {
        find_latch(g, part[1], message);
    } else if (message->retained) {
        say_event(g, NULL, "refused", "a retained message is no order");
    } else if (n == 3 && strcmp(part[0], "group") == 0 && strcmp(part[2], "permit") == 0) {
        take_permit(g, part[1], message);
    } else if (n == 3 && strcmp(part[0], "time") == 0) {
        orders_take_time(g, message);
    } else if (n == 3 && strcmp(part[1], "cmd") == 0 && g->listens) {
        orders_take(g, part[2], message);
    }
}

/* The latches first; orders when they have come. */
static void on_up(void *ctx)
{
    agent *g = ctx;
    g->away = false;
    app_report(g->a,
               json_pack("{s:b,s:s,s:s,s:s}", "connected", 1, "host", g->host, "group",
                         g->groups[1].name, "epoch", g->epoch),
               "connected to the broker as %s", g->host);
    output_flush();
    for (int i = 0; i < g->n_groups; i++) {
        wire_subscribe(g->m, "group", g->groups[i].name, "latch", true);
    }
    wire_subscribe(g->m, g->host, "connection", NULL, true);
    g->listens = false;
    g->settled_us = grobo_now_us() + AGENT_SETTLE_US;
    say_hello(g);
    say_kept(g);
}

static void begin_listening(agent *g)
{
    for (int i = 0; i < g->n_groups; i++) {
        const agent_group *group = &g->groups[i];
        wire_subscribe(g->m, "group", group->name, "permit", false);
        if (group->latch) {
            say_latch(g, group); /* a broker may have forgotten it */
        }
    }
    wire_subscribe(g->m, "time", g->host, "pong", false);
    wire_subscribe(g->m, g->host, "cmd", "+", false);
    g->listens = true;
}

static void on_down(void *ctx, const char *why)
{
    agent *g = ctx;
    if (!g->away) { /* once, however often it is tried again */
        app_note(g->a, "the broker is away: %s", why);
    }
    g->away = true;
    g->greeted = g->greeted || g->listens || g->settled_us;
    g->listens = false;
    g->settled_us = 0;
    orders_forget(g);
    say_untaken(g);
}

static void on_refused(void *ctx, const char *why)
{
    agent *g = ctx;
    app_note(g->a, "the broker refuses: %s", why);
}

static void on_taken(void *ctx, int message, bool taken)
{
    (void)taken; /* what is refused is refused again: it does not wait on disk */
    say_taken(ctx, message);
}

static void on_tick(evutil_socket_t fd, short what, void *ctx)
{
    agent *g = ctx;
    int64_t now_us = grobo_now_us();
    (void)fd;
    (void)what;
    if (!g->listens && g->settled_us && now_us >= g->settled_us) {
        begin_listening(g);
    }
    if (g->plays && g->all.team && !g->let_go && now_us - g->permit_us > AGENT_PERMIT_US) {
        let_go(g);
    }
    tell_stopped(g);
    orders_age(g, now_us);
    g->seq++;
    for (int i = 0; i < g->all.n; i++) {
        say_state(g, &g->all.seats[i], g->seq % LAST_EVERY == 0);
    }
}

/* ---- robots ---------------------------------------------------------------------------------- */

static void on_robot(seat *s, const grobo_event *event)
{
    agent *g = s->all->ctx;
    if (event->kind == GROBO_EVENT_TRIP) {
        say_event(g, s, "trip", grobo_trip_name(event->u.trip.trip));
    } else if (event->kind == GROBO_EVENT_LINK_DOWN || event->kind == GROBO_EVENT_LINK_UP) {
        say_event(g, s, event->kind == GROBO_EVENT_LINK_UP ? "link_up" : "link_down", "");
    }
}

/* One that is not there is no failure; it is said once. */
static void open_robots(agent *g, bool first)
{
    char line[APP_LINE_BYTES];
    for (int i = 0; i < g->all.n; i++) {
        seat *s = &g->all.seats[i];
        if (s->is_open) {
            continue;
        }
        int status = seat_try(&g->all, i, line);
        if (status && first) {
            app_note(g->a, "%s; tried again every 5 s", *line ? line : s->name);
        } else if (!status && !first) {
            app_note(g->a, "%s is there", s->name);
        }
        if (!status && agent_latched(g)) {
            (void)grobo_robot_latch(s->c.robot);
        }
    }
}

static void retry(agent *g)
{
    int64_t now_us = grobo_now_us();
    if (now_us >= g->retry_us && !g->plays) {
        open_robots(g, false);
        g->retry_us = grobo_now_us() + RETRY_US;
    }
}

/* A line that is lost for good is opened anew. */
static void close_lost(agent *g)
{
    for (int i = 0; i < g->all.n && !g->plays; i++) {
        seat *s = &g->all.seats[i];
        if (s->is_open && s->c.link_error) {
            (void)seat_close(s, EXIT_ROBOT);
        }
    }
}

void agent_work(agent *g)
{
    orders_work(g);
    close_lost(g);
    retry(g);
}

/* ---- an agent -------------------------------------------------------------------------------- */

int agent_begin(agent *g, app *a, const mqtt_config *with)
{
    static config_group one;
    mqtt_config config = *with;
    char topic[FLEET_TOPIC_BYTES];
    const char *why;
    g->a = a;
    fleet_make_id(g->epoch);
    if (a->group) {
        one = *a->group;
    } else {
        one.n = 1;
        snprintf(one.robot[0], sizeof one.robot[0], "%s", a->robot->name);
    }
    int status = robot_group_begin(&g->all, a, one.robot, one.n);
    if (status) {
        return status;
    }
    a->reconnects = true;
    g->all.on_team = orders_on_team;
    g->all.on_robot = on_robot;
    g->all.ctx = g;
    snprintf(topic, sizeof topic, "agent-%s.events", g->host);
    if (!os_state_path(topic, g->spool, sizeof g->spool)) {
        *g->spool = '\0';
    }
    say_prepare(g);
    config.base = g->all.host.base;
    config.id = g->host;
    (void)fleet_topic(topic, g->host, "connection", NULL, NULL);
    config.will_topic = topic;
    config.will = g->will;
    config.on_up = on_up;
    config.on_down = on_down;
    config.on_message = on_message;
    config.on_refused = on_refused;
    config.on_taken = on_taken;
    config.may_block = all_stand;
    config.ctx = g;
    g->m = mqtt_new(&config, &why);
    if (!g->m) {
        return app_fail(a, EXIT_ROBOT, "IO", "agent: %s: %s", config.host, why);
    }
    open_robots(g, true);
    g->retry_us = grobo_now_us() + RETRY_US;
    mqtt_start(g->m);
    g->tick = conn_every(g->all.host.base, TICK_US, on_tick, g);
    return g->tick ? EXIT_DONE : EXIT_ROBOT;
}

int agent_end(agent *g, int status)
{
    if (g->all.team) {
        (void)grobo_team_stop(g->all.team, false);
    }
    for (int i = 0; i < g->all.n; i++) {
        seat *s = &g->all.seats[i];
        int left = seat_close(s, s->c.moving ? EXIT_SIGNAL : EXIT_DONE);
        status = left > status && left != EXIT_SIGNAL ? left : status;
    }
    if (g->m) {
        say_goodbye(g);
    }
    conn_forget(g->tick);
    mqtt_free(g->m);
    say_untaken(g);
    sync_end();
    orders_free(g);
    for (int i = 0; i < g->n_groups; i++) {
        json_decref(g->groups[i].latch);
    }
    if (g->all.seats) {
        robot_group_end(&g->all);
    }
    return status;
}
