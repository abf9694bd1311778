/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tools/grctl/cli/joints.h"
#include "tools/grctl/fleet/say.h"
#include "tools/grctl/fleet/spool.h"
#include "tools/grctl/fleet/wire.h"

/* ---- in general ------------------------------------------------------------------------------ */

static int publish_here(agent *g, const char *a, const char *b, json_t *object, int how)
{
    return wire_tell(g->m, g->host, a, b, object, how);
}

static void keep_event(const agent *g, const json_t *event)
{
    if (*g->spool) {
        (void)spool_add(g->spool, event);
    }
}

/* Kept in memory until the broker has taken it. False: there is no connection. */
static bool publish_event(agent *g, json_t *event)
{
    char number[16];
    int n = publish_here(g, "event", NULL, json_incref(event), WIRE_SURE);
    snprintf(number, sizeof number, "%d", n);
    if (n > 0) {
        g->untaken = g->untaken ? g->untaken : json_object();
        json_object_set(g->untaken, number, event);
    }
    return n > 0;
}

/* While the broker is away, or takes nothing, it waits on disk. Takes the reference. */
static void tell_event(agent *g, json_t *event)
{
    if (json_object_size(g->untaken) >= AGENT_UNTAKEN || !publish_event(g, event)) {
        keep_event(g, event);
        g->keeps = true;
    }
    json_decref(event);
}

static void take_kept(void *ctx, json_t *event)
{
    (void)publish_event(ctx, event);
}

void say_kept(agent *g)
{
    g->keeps = false;
    if (*g->spool) {
        spool_empty(g->spool, take_kept, g);
    }
}

void say_taken(agent *g, int message)
{
    char number[16];
    snprintf(number, sizeof number, "%d", message);
    (void)json_object_del(g->untaken, number);
    if (g->keeps && json_object_size(g->untaken) == 0) {
        say_kept(g);
    }
}

void say_untaken(agent *g)
{
    const char *number;
    json_t *event;
    json_object_foreach(g->untaken, number, event)
    {
        keep_event(g, event);
    }
    json_decref(g->untaken);
    g->untaken = NULL;
}

/* ---- the agent ------------------------------------------------------------------------------- */

static json_t *connection(const agent *g, const char *state)
{
    return json_pack("{s:i,s:s,s:s,s:I}", "v", FLEET_VERSION, "state", state, "epoch", g->epoch,
                     "at_ms", (json_int_t)wire_wall_ms());
}

void say_prepare(agent *g)
{
    json_t *will = connection(g, "CONNECTIONBROKEN");
    size_t n = json_dumpb(will, g->will, sizeof g->will - 1, JSON_COMPACT);
    g->will[n < sizeof g->will ? n : 0] = '\0';
    json_decref(will);
}

static json_t *joints_of(const seat *s)
{
    const grobo_model *model = app_model(&s->a);
    json_t *list = json_array();
    for (int j = 0; j < model->n_joints; j++) {
        const grobo_joint *joint = grobo_model_joint(model, j);
        json_t *row = json_pack("{s:s,s:[o,o]}", "name", joint->name, "limits_deg",
                                app_json_number(grobo_deg_from_rad(joint->min_rad), 2),
                                app_json_number(grobo_deg_from_rad(joint->max_rad), 2));
        joints_add_scale(row, model, j);
        json_array_append_new(list, row);
    }
    return list;
}

/* The page of a robot: its name for each %. False: it is too long. */
static bool link_of(const agent *g, const seat *s, char *link, size_t capacity)
{
    size_t at = 0;
    for (const char *from = g->cockpit; *from && at < capacity - 1; from++) {
        bool named = *from == '%';
        at += (size_t)snprintf(link + at, capacity - at, "%.*s", named ? FLEET_NAME_BYTES : 1,
                               named ? s->name : from);
    }
    return at < capacity;
}

static json_t *robot_fact(const agent *g, const seat *s)
{
    char link[FLEET_URL_BYTES] = "";
    json_t *robot = json_pack("{s:s,s:s,s:o}", "name", s->name, "model",
                              s->is_open ? app_model(&s->a)->name : "", "joints",
                              s->is_open ? joints_of(s) : json_array());
    if (g->cockpit && link_of(g, s, link, sizeof link)) {
        json_object_set_new(robot, "cockpit", json_string(link));
    }
    return robot;
}

static json_t *factsheet(const agent *g)
{
    json_t *robots = json_array(), *groups = json_array();
    for (int i = 0; i < g->all.n; i++) {
        json_array_append_new(robots, robot_fact(g, &g->all.seats[i]));
    }
    for (int i = 0; i < g->n_groups; i++) {
        json_array_append_new(groups, json_string(g->groups[i].name));
    }
    return json_pack("{s:i,s:s,s:o,s:o}", "v", FLEET_VERSION, "epoch", g->epoch, "groups", groups,
                     "robots", robots);
}

void say_hello(agent *g)
{
    (void)publish_here(g, "factsheet", NULL, factsheet(g), WIRE_SURE | WIRE_KEPT);
    (void)publish_here(g, "connection", NULL, connection(g, "ONLINE"), WIRE_SURE | WIRE_KEPT);
}

void say_goodbye(agent *g)
{
    (void)publish_here(g, "connection", NULL, connection(g, "OFFLINE"), WIRE_SURE | WIRE_KEPT);
}

void say_latch(agent *g, const agent_group *group)
{
    (void)wire_tell(g->m, "group", group->name, "latch", json_incref(group->latch),
                    WIRE_SURE | WIRE_KEPT);
}

/* ---- robots ---------------------------------------------------------------------------------- */

/* The angles read last, and the age of the oldest of them: while a motion is played a line may have
 * little time for readings. */
static void add_angles(json_t *state, const seat *s)
{
    const grobo_model *model = app_model(&s->a);
    grobo_joint_info info;
    json_t *list = json_array();
    int64_t oldest_us = -1;
    for (int j = 0; j < model->n_joints; j++) {
        bool known = grobo_robot_joint(s->c.robot, j, &info) == 0 &&
                     (info.state.valid & GROBO_FIELD_ANGLE) != 0;
        json_array_append_new(list,
                              known ? app_json_number(grobo_deg_from_rad(info.state.angle_rad), 1)
                                    : json_null());
        oldest_us = known && info.angle_age_us > oldest_us ? info.angle_age_us : oldest_us;
    }
    json_object_set_new(state, "angles_deg", list);
    json_object_set_new(state, "angles_age_ms",
                        oldest_us < 0 ? json_null() : json_integer(oldest_us / 1000));
}

static void add_worst(json_t *state, const seat *s)
{
    seat_worst w = seat_get_worst(s);
    json_object_set_new(state, "temperature_c", app_json_number(w.hottest_c, 0));
    json_object_set_new(state, "voltage_v", app_json_number(w.lowest_v, 2));
}

static json_t *state_of(const agent *g, const seat *s)
{
    grobo_trip_info trip;
    grobo_robot_tripped(s->c.robot, &trip);
    json_t *state =
        json_pack("{s:i,s:I,s:I,s:b,s:s,s:b,s:b}", "v", FLEET_VERSION, "seq", (json_int_t)g->seq,
                  "t_us", (json_int_t)grobo_now_us(), "up", s->c.up && !s->c.link_error, "play",
                  grobo_sequencer_state_name(grobo_robot_play_state(s->c.robot)), "moving",
                  grobo_robot_moving(s->c.robot), "stopped", agent_latched(g) != NULL);
    json_object_set_new(state, "trip",
                        trip.trip == GROBO_TRIP_NONE ? json_null()
                                                     : app_json_code(grobo_trip_name(trip.trip)));
    const char *file = g->plays && s->chosen ? fleet_text(g->play.is.body, "file") : NULL;
    json_object_set_new(state, "motion", file ? json_string(file) : json_null());
    add_angles(state, s);
    add_worst(state, s);
    return state;
}

void say_state(agent *g, const seat *s, bool last_too)
{
    if (!mqtt_is_up(g->m)) {
        return;
    }
    json_t *state = s->is_open ? state_of(g, s)
                               : json_pack("{s:i,s:I,s:b}", "v", FLEET_VERSION, "seq",
                                           (json_int_t)g->seq, "up", 0);
    if (last_too) {
        (void)publish_here(g, s->name, "last", json_incref(state), WIRE_KEPT);
    }
    (void)publish_here(g, s->name, "state", state, WIRE_ONCE);
}

void say_event(agent *g, const seat *s, const char *kind, const char *text)
{
    char id[FLEET_ID_BYTES];
    fleet_make_id(id);
    json_t *event = json_pack("{s:i,s:s,s:s,s:s,s:I}", "v", FLEET_VERSION, "id", id, "kind", kind,
                              "message", text, "at_ms", (json_int_t)wire_wall_ms());
    if (s) {
        json_object_set_new(event, "robot", json_string(s->name));
    }
    app_note(g->a, "%s%s%s%s%s", s ? s->name : "", s ? ": " : "", kind, *text ? ": " : "", text);
    tell_event(g, event);
}

void say_stopping(agent *g, const agent_group *group)
{
    tell_event(g, json_pack("{s:i,s:s,s:s,s:s,s:I}", "v", FLEET_VERSION, "kind", "stopping", "id",
                            fleet_text(group->latch, "id"), "group", group->name, "at_ms",
                            (json_int_t)wire_wall_ms()));
}

void say_stopped(agent *g, const agent_group *group)
{
    json_t *robots = json_array();
    for (int i = 0; i < g->all.n; i++) {
        const seat *s = &g->all.seats[i];
        bool there = s->is_open && s->c.up && !s->c.link_error;
        bool sure =
            there && (agent_brakes(group) ? s->c.estop_ended && s->c.estop_result >= 0
                                          : !grobo_robot_moving(s->c.robot) && s->c.unstopped == 0);
        json_array_append_new(
            robots, json_pack("{s:s,s:b,s:b}", "name", s->name, "there", there, "stopped", sure));
    }
    tell_event(g, json_pack("{s:i,s:s,s:s,s:o,s:I}", "v", FLEET_VERSION, "kind", "stopped", "id",
                            fleet_text(group->latch, "id"), "robots", robots, "at_ms",
                            (json_int_t)wire_wall_ms()));
}

static json_t *results_of(const agent *g)
{
    json_t *robots = json_array();
    for (int i = 0; i < g->all.n; i++) {
        const seat *s = &g->all.seats[i];
        grobo_team_member how;
        if (s->member >= 0 && grobo_team_get(g->all.team, s->member, &how) == 0) {
            json_t *robot =
                json_pack("{s:s,s:b,s:s}", "name", s->name, "ok", how.result == GROBO_OK, "message",
                          how.result == GROBO_OK ? "" : grobo_error_text(how.result));
            if (s->began_us && g->started) {
                json_object_set_new(robot, "late_us", json_integer(s->began_us - g->start_us));
            }
            json_array_append_new(robots, robot);
        }
    }
    return robots;
}

void say_ended(agent *g, const char *order)
{
    tell_event(g, json_pack("{s:i,s:s,s:s,s:o,s:I}", "v", FLEET_VERSION, "kind", "ended", "id",
                            order, "robots", results_of(g), "at_ms", (json_int_t)wire_wall_ms()));
}

void say_again(agent *g, const agent_order *order, const char *text)
{
    const mqtt_message out = {.topic = order->response,
                              .payload = text,
                              .size = strlen(text),
                              .correlation = order->correlation,
                              .correlation_bytes = order->correlation_bytes};
    (void)mqtt_publish(g->m, &out, 1, 0);
}

void say_answer(agent *g, const agent_order *order, const char *code, const char *message,
                json_t *extra)
{
    json_t *answer = json_pack("{s:i,s:s,s:s,s:s,s:b}", "v", FLEET_VERSION, "id", order->is.id,
                               "host", g->host, "epoch", g->epoch, "ok", code == NULL);
    if (code) {
        json_object_set_new(answer, "code", app_json_code(code));
        json_object_set_new(answer, "message", json_string(message));
    }
    if (extra) {
        json_object_update(answer, extra);
        json_decref(extra);
    }
    char *text = json_dumps(answer, JSON_COMPACT);
    if (text) {
        say_again(g, order, text);
        fleet_seen_end(&g->seen, order->is.id, text);
    }
    free(text);
    json_decref(answer);
}
