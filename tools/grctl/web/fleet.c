/* SPDX-License-Identifier: MIT */
/*
 * serve --broker: how the robots of a fleet are, and a stop for all of them. It orders no motion.
 * What agents say is hostile: it is copied by known keys, with bounds.
 */
#include <string.h>

#include <grobo/core/port.h>
#include <grobo/version.h>

#include "tools/grctl/fleet/leader.h"
#include "tools/grctl/web/based.h"
#include "tools/grctl/web/fields.h"
#include "tools/grctl/web/listener.h"
#include "tools/grctl/web/page.h"

enum { STATE_HZ = 5, JOINTS_MAX = 64, TEXT_BYTES = 128 };
/* A robot of which nothing was heard for so long is silent. */
#define SILENT_US INT64_C(1500000)
/* A stop that could not go out is tried again so often, so long. */
#define AGAIN_US INT64_C(500000)
#define GIVE_UP_US INT64_C(30000000)
/* From a broker's coming back until what it keeps was heard. */
#define CHECK_US INT64_C(1000000)
/* From the end of a stop to the order that releases the engines, and how long that may take. */
#define RELEASE_US INT64_C(400000)
#define RELEASED_US INT64_C(3000000)
/* An emergency stop is read back within this time, see say_stopped() of the agent. */
#define VERIFIED_US INT64_C(12000000)

typedef struct view {
    leader l; /* first: its handlers are given it */
    const web_options *options;
    const broker *b;
    http *http;
    events events;
    struct event *tick;
    based based; /* which state a request had seen */
    int broker;  /* as it was told: 1 there, -1 away, 0 not known yet */
    /* the stop that is wanted, and not out yet */
    const char *wanted; /* NULL: none */
    int64_t wanted_us;
    const char *published; /* what was said last, and when; NULL: nothing that stands */
    int64_t published_us;
    char latch_id[FLEET_ID_BYTES]; /* the one that stands, "": none */
    int64_t latched_us;            /* when it was seen first */
    int64_t check_us;              /* when a broker that came back should know it, 0: not */
    unsigned refused;              /* as the leader counts */
    int64_t release_us;            /* when the engines are to be released, 0: not */
    int64_t released_us;           /* until when their answers are awaited, 0: not */
} view;

/* ---- what agents say ------------------------------------------------------------------------- */

/* A short text, or null. */
static json_t *copy_text(const json_t *from, const char *key)
{
    const char *text = fleet_text(from, key);
    return text && strlen(text) < TEXT_BYTES ? json_string(text) : json_null();
}

static json_t *copy_number(const json_t *from, const char *key)
{
    const json_t *value = json_object_get(from, key);
    return json_is_number(value) ? json_copy((json_t *)(uintptr_t)value) : json_null();
}

/* Numbers, and null for what is none. */
static json_t *copy_numbers(const json_t *list, size_t most)
{
    json_t *copy = json_array();
    for (size_t i = 0; i < json_array_size(list) && i < most; i++) {
        json_t *value = json_array_get(list, i);
        json_array_append_new(copy, json_is_number(value) ? json_copy(value) : json_null());
    }
    return copy;
}

static json_t *copy_link(const json_t *from, const char *key)
{
    const char *url = fleet_text(from, key);
    return fleet_is_link(url) ? json_string(url) : json_null();
}

/* Those of a group that has this peer, with names that are names. */
static const json_t *robots_of(const view *v, const peer *p)
{
    return leader_has(&v->l, p) ? json_object_get(p->facts, "robots") : NULL;
}

static const char *name_of(const json_t *robot)
{
    const char *name = fleet_text(robot, "name");
    return name && fleet_is_name(name) ? name : NULL;
}

/* ---- a stop, robot by robot ------------------------------------------------------------------ */

static bool is_latched(const view *v)
{
    return json_is_true(json_object_get(v->l.latch, "stopped"));
}

/* What its agent said of this robot and this stop: 1 stopped, 0 not seen to, -1 nothing. */
static int told_of(const view *v, const peer *p, const char *name)
{
    size_t i;
    json_t *robot;
    const char *id = fleet_text(p->stopped, "id");
    if (!id || strcmp(id, v->latch_id) != 0) {
        return -1;
    }
    json_array_foreach(json_object_get(p->stopped, "robots"), i, robot)
    {
        const char *is = fleet_text(robot, "name");
        if (is && strcmp(is, name) == 0) {
            return json_is_true(json_object_get(robot, "stopped"));
        }
    }
    return -1;
}

/* Words of the interface. */
static const char *stop_of(const view *v, const peer *p, const char *name, const char *link,
                           const json_t *state)
{
    const char *how = fleet_text(v->l.latch, "how");
    bool verifies = !how || strcmp(how, "stop") != 0;
    int told = told_of(v, p, name);
    if (strcmp(link, "away") == 0) {
        return "away";
    }
    if (strcmp(link, "up") != 0) {
        return "silent";
    }
    if (!json_is_true(json_object_get(state, "stopped"))) {
        return "sent";
    }
    if (json_is_true(json_object_get(state, "moving")) || told == 0) {
        return "moving";
    }
    return told < 0 && verifies && grobo_now_us() - v->latched_us < VERIFIED_US ? "sent"
                                                                                : "stopped";
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static const char *link_of(const peer *p, const json_t *state, int64_t age_us)
{
    if (strcmp(p->state, "OFFLINE") == 0) {
        return "away";
    }
    if (strcmp(p->state, "ONLINE") != 0) {
        return "broken";
    }
    return !state || age_us > SILENT_US                 ? "silent"
           : json_is_true(json_object_get(state, "up")) ? "up"
                                                        : "down";
}

static json_t *robot_state(const view *v, const peer *p, const char *name, bool *sure)
{
    const json_t *state = json_object_get(p->states, name);
    int64_t age_us = grobo_now_us() - fleet_number(state, "heard_us", 0);
    const char *link = link_of(p, state, age_us);
    const char *stop = is_latched(v) ? stop_of(v, p, name, link, state) : NULL;
    *sure = !stop || strcmp(stop, "stopped") == 0 || strcmp(stop, "away") == 0;
    return json_pack("{s:s,s:s,s:s,s:o,s:o,s:o,s:b,s:b,s:o,s:o,s:o,s:o,s:s?}", "host", p->host,
                     "robot", name, "link", link, "age_ms",
                     state ? json_integer(age_us / 1000) : json_null(), "play",
                     copy_text(state, "play"), "motion", copy_text(state, "motion"), "moving",
                     json_is_true(json_object_get(state, "moving")), "stopped",
                     json_is_true(json_object_get(state, "stopped")), "trip",
                     copy_text(state, "trip"), "temperature_c", copy_number(state, "temperature_c"),
                     "voltage_v", copy_number(state, "voltage_v"), "angle_deg",
                     copy_numbers(json_object_get(state, "angles_deg"), JOINTS_MAX), "stop", stop);
}

static json_t *latch_json(const view *v)
{
    const json_t *latch = v->l.latch;
    if (!is_latched(v)) {
        return json_null();
    }
    const char *by = fleet_text(latch, "by");
    return json_pack("{s:o,s:b,s:o}", "kind", copy_text(latch, "how"), "ours",
                     by && strcmp(by, v->l.id) == 0, "at_ms", copy_number(latch, "at_ms"));
}

static json_t *state_json(const view *v)
{
    size_t k;
    json_t *robot, *robots = json_array();
    bool confirmed = true, sure;
    for (int i = 0; i < v->l.n; i++) {
        const peer *p = &v->l.peers[i];
        json_array_foreach(robots_of(v, p), k, robot)
        {
            const char *name = name_of(robot);
            if (name && k < LEADER_ROBOTS) {
                json_array_append_new(robots, robot_state(v, p, name, &sure));
                confirmed = confirmed && sure;
            }
        }
    }
    return json_pack("{s:I,s:I,s:b,s:I,s:o,s:b,s:b,s:o,s:i}", "sequence",
                     (json_int_t)v->based.sequence, "time_ms",
                     (json_int_t)((grobo_now_us() - v->events.began_us) / 1000), "broker", v->l.up,
                     "news", (json_int_t)v->l.news, "latch", latch_json(v), "wanted",
                     v->wanted != NULL, "confirmed", is_latched(v) && confirmed, "robots", robots,
                     "clients", http_streams(v->http));
}

/* A unit of its own, where the joint has one and tells how much it is. */
static void copy_unit(json_t *one, const json_t *joint)
{
    const json_t *zero = json_object_get(joint, "unit_zero_deg");
    const json_t *scale = json_object_get(joint, "unit_deg");
    if (json_is_string(json_object_get(joint, "unit")) && json_is_number(zero) &&
        json_is_number(scale) && json_number_value(scale) != 0) {
        json_object_set_new(one, "unit", copy_text(joint, "unit"));
        json_object_set_new(one, "unit_zero_deg", copy_number(joint, "unit_zero_deg"));
        json_object_set_new(one, "unit_deg", copy_number(joint, "unit_deg"));
    }
}

static json_t *joints_json(const json_t *robot)
{
    size_t i;
    json_t *joint, *list = json_array();
    json_array_foreach(json_object_get(robot, "joints"), i, joint)
    {
        if (i < JOINTS_MAX) {
            json_t *one = json_pack("{s:o,s:o}", "name", copy_text(joint, "name"), "limits_deg",
                                    copy_numbers(json_object_get(joint, "limits_deg"), 2));
            copy_unit(one, joint);
            json_array_append_new(list, one);
        }
    }
    return list;
}

static json_t *host_json(const view *v, const peer *p)
{
    size_t i;
    json_t *one, *groups = json_array(), *robots = json_array();
    json_array_foreach(json_object_get(p->facts, "groups"), i, one)
    {
        if (json_is_string(one) && fleet_is_name(json_string_value(one))) {
            json_array_append(groups, one);
        }
    }
    json_array_foreach(robots_of(v, p), i, one)
    {
        if (name_of(one) && i < LEADER_ROBOTS) {
            json_array_append_new(robots,
                                  json_pack("{s:s,s:o,s:o,s:o}", "name", name_of(one), "model",
                                            copy_text(one, "model"), "cockpit",
                                            copy_link(one, "cockpit"), "joints", joints_json(one)));
        }
    }
    return json_pack("{s:s,s:s,s:o,s:o}", "host", p->host, "connection", p->state, "groups", groups,
                     "robots", robots);
}

static json_t *fleet_json(const view *v)
{
    json_t *hosts = json_array();
    char place[320];
    snprintf(place, sizeof place, "%s:%d", v->b->config.host, v->b->config.port);
    for (int i = 0; i < v->l.n; i++) {
        if (robots_of(v, &v->l.peers[i])) {
            json_array_append_new(hosts, host_json(v, &v->l.peers[i]));
        }
    }
    return json_pack("{s:i,s:s,s:s,s:s,s:i,s:i,s:b,s:I,s:o}", "interface", 1, "version",
                     grobo_version(), "broker", place, "group", v->l.group, "stop_port",
                     http_stop_port(v->http), "state_hz", STATE_HZ, "token", http_is_open(v->http),
                     "news", (json_int_t)v->l.news, "hosts", hosts);
}

/* ---- stop and reset -------------------------------------------------------------------------- */

static void publish_stop(view *v)
{
    v->published_us = grobo_now_us();
    if (leader_latch(&v->l, v->wanted)) {
        v->published = v->wanted;
        v->wanted = NULL;
    }
}

/* The same again within a moment is one stop. */
static void want_stop(view *v, const char *how, const char *name)
{
    int64_t now_us = grobo_now_us();
    bool same = v->published && strcmp(v->published, how) == 0;
    based_change(&v->based, now_us, "%s of all robots by %s", how, name);
    if (same && now_us - v->published_us < AGAIN_US) {
        return;
    }
    if (!same && (!v->wanted || strcmp(v->wanted, how) != 0)) {
        events_tell(&v->events, "stop", "warning", NULL, "%s of all robots by %s", how, name);
    }
    v->wanted = how;
    v->wanted_us = now_us;
    v->release_us = v->released_us = 0;
    if (v->l.up) {
        publish_stop(v);
    }
}

static void stop_early(void *ctx, const http_request *r)
{
    want_stop(ctx, strstr(r->path, "estop") ? "estop" : "stop", "a request that is not whole");
}

static void serve_stop(view *v, http_request *r, const json_t *body)
{
    bool estop = strstr(r->path, "estop") != NULL;
    if (http_is_open(r->server) && !listener_has_token(r, body)) {
        return;
    }
    want_stop(v, estop ? "estop" : "stop", requester_of(body).name);
    if (!v->l.up) {
        http_refuse(r, 503, "unreachable",
                    "the broker is away: the stop goes out when it is back; use the switches");
    } else if (r->second) {
        http_reply_empty(r);
    } else {
        http_reply_json(r, 200,
                        json_pack("{s:b,s:I}", "done", is_latched(v), "sequence",
                                  (json_int_t)v->based.sequence));
    }
}

/* A stop that was pressed after this release was sent stands. */
static bool is_based(view *v, http_request *r, const json_t *body)
{
    char complaint[BASED_COMPLAINT_BYTES];
    bool fine = based_check(&v->based, json_object_get(body, "sequence"), grobo_now_us(), "reset",
                            complaint);
    if (!fine) {
        http_refuse(r, 409, "stale", "%s", complaint);
    }
    return fine;
}

static void serve_reset(view *v, http_request *r, const json_t *body)
{
    if (!is_based(v, r, body)) {
        return;
    }
    if (!v->l.up) {
        http_refuse(r, 503, "unreachable", "the broker is away");
    } else if (!is_latched(v)) {
        http_refuse(r, 409, "state", "no stop stands");
    } else {
        v->wanted = v->published = NULL;
        (void)leader_latch(&v->l, NULL);
        v->release_us = grobo_now_us() + RELEASE_US;
        events_tell(&v->events, "stop", "info", NULL, "the stop is released by %s",
                    requester_of(body).name);
        http_reply_json(
            r, 200,
            json_pack("{s:b,s:I}", "done", false, "sequence", (json_int_t)v->based.sequence));
    }
}

static void say_refusals(view *v)
{
    for (int i = 0; i < v->l.n; i++) {
        const peer *p = &v->l.peers[i];
        const char *why = fleet_text(p->answer, "message");
        if (p->chosen && !json_is_true(json_object_get(p->answer, "ok"))) {
            events_tell(&v->events, "stop", "error", NULL, "%s: reset: %.200s", p->host,
                        why ? why : "no answer");
        }
    }
}

/* A broker that came back may have forgotten a stop of ours: it is told again. */
static void remind_broker(view *v, int64_t now_us)
{
    const char *by = fleet_text(v->l.latch, "by"), *how = fleet_text(v->l.latch, "how");
    if (v->check_us && now_us > v->check_us && v->l.up) {
        v->check_us = 0;
        if (is_latched(v) && by && strcmp(by, v->l.id) == 0 && how && !v->wanted) {
            v->wanted = strcmp(how, "stop") == 0 ? "stop" : "estop";
            v->wanted_us = now_us;
        }
    }
}

/* What was asked for, until it is out. */
static void look_after_stop(view *v, int64_t now_us)
{
    const char *id = is_latched(v) ? fleet_text(v->l.latch, "id") : NULL;
    if (id && strcmp(id, v->latch_id) != 0) { /* of this view, or of another */
        based_change(&v->based, now_us, "a stop of the fleet");
    }
    if (!id || strcmp(id, v->latch_id) != 0) {
        snprintf(v->latch_id, sizeof v->latch_id, "%s", id ? id : "");
        v->latched_us = now_us;
    }
    if (v->refused != v->l.refused) {
        v->refused = v->l.refused;
        events_tell(&v->events, "stop", "error", NULL,
                    "the broker refused an order of this view: use the switches");
    }
    remind_broker(v, now_us);
    if (v->wanted && now_us - v->wanted_us > GIVE_UP_US) {
        events_tell(&v->events, "stop", "error", NULL,
                    "the broker did not come back for the stop: use the switches");
        v->wanted = NULL;
    } else if (v->wanted && v->l.up && now_us - v->published_us > AGAIN_US) {
        publish_stop(v);
    }
}

static void look_after_reset(view *v, int64_t now_us)
{
    if (v->release_us && now_us > v->release_us) {
        v->release_us = 0;
        v->released_us = leader_choose(&v->l) > 0 ? now_us + RELEASED_US : 0;
        leader_order(&v->l, "reset", json_object());
    } else if (v->released_us && (now_us > v->released_us || leader_answered(&v->l))) {
        v->released_us = 0;
        say_refusals(v);
    }
}

/* ---- requests -------------------------------------------------------------------------------- */

static void serve_fleet(view *v, http_request *r, const json_t *body)
{
    (void)body;
    http_reply_json(r, 200, fleet_json(v));
}

static void serve_state(view *v, http_request *r, const json_t *body)
{
    (void)body;
    http_reply_json(r, 200, state_json(v));
}

static void serve_events(view *v, http_request *r, const json_t *body)
{
    (void)body;
    events_stream(&v->events, r);
}

static const field no_fields[] = {{.name = NULL}};
static const field reset_fields[] = {
    FIELD_SEQUENCE, {.name = "name", .kind = FIELD_TEXT}, {.name = NULL}};

static const struct path {
    const char *path;
    access_rule rule;
    bool second; /* on the second port */
    void (*run)(view *v, http_request *r, const json_t *body);
    const field *fields; /* NULL: whatever its body has, it is carried out */
} paths[] = {
    {"/api/fleet", ACCESS_READ, false, serve_fleet, no_fields},
    {"/api/state", ACCESS_READ, false, serve_state, no_fields},
    {"/api/events", ACCESS_READ, false, serve_events, no_fields},
    {"/api/stop", ACCESS_STOP, false, serve_stop, NULL},
    {"/api/estop", ACCESS_STOP, false, serve_stop, NULL},
    {"/stop", ACCESS_STOP, true, serve_stop, NULL},
    {"/estop", ACCESS_STOP, true, serve_stop, NULL},
    {"/api/reset", ACCESS_ACT, false, serve_reset, reset_fields},
};

static const struct path *find_path(const http_request *r)
{
    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++) {
        if (paths[i].second == r->second && strcmp(paths[i].path, r->path) == 0) {
            return &paths[i];
        }
    }
    return NULL;
}

static bool rule_of(void *ctx, const http_request *r, access_rule *rule)
{
    const struct path *p = find_path(r);
    (void)ctx;
    *rule = p ? p->rule : ACCESS_PAGE;
    return p || (!r->second && page_has(r->path));
}

static void answer(void *ctx, http_request *r)
{
    static const char page[] = "/fleet.html";
    const struct path *p = find_path(r);
    if (!p) {
        if (strcmp(r->path, "/") == 0 || strcmp(r->path, "/index.html") == 0) {
            memcpy(r->path, page, sizeof page);
        }
        page_serve(r);
        return;
    }
    json_t *body = p->fields ? http_object(r) : http_object_if_any(r);
    char complaint[FIELDS_TEXT_BYTES];
    if (!body && p->fields) {
        return;
    }
    if (p->fields && *r->query) {
        http_refuse(r, 400, "arg", "%s: a query is not expected; the body has the fields", r->path);
    } else if (p->fields && !fields_fit(body, p->fields, strrchr(r->path, '/') + 1, complaint)) {
        http_refuse(r, 400, "arg", "%s", complaint);
    } else {
        p->run(ctx, r, body);
    }
    json_decref(body);
}

/* ---- the loop -------------------------------------------------------------------------------- */

static void on_fleet_event(leader *l, const peer *p, json_t *event)
{
    view *v = (view *)l;
    const char *kind = fleet_text(event, "kind"), *text = fleet_text(event, "message");
    const char *robot = fleet_text(event, "robot");
    bool bad = kind && (strcmp(kind, "trip") == 0 || strcmp(kind, "link_down") == 0 ||
                        strcmp(kind, "out") == 0);
    if (!kind || strcmp(kind, "stopped") == 0 || !leader_has(l, p)) {
        return; /* how a stop went is in the state */
    }
    events_tell(&v->events, "robot", bad ? "error" : "info",
                json_pack("{s:s,s:s?}", "host", p->host, "robot", robot),
                "%s%s%.63s: %.63s%s%.200s", p->host, robot ? "/" : "", robot ? robot : "", kind,
                text && *text ? ": " : "", text ? text : "");
}

/* The page is there before the broker is, and without it. */
static void look_at_broker(view *v, int64_t now_us)
{
    int is = v->l.up ? 1 : v->l.why ? -1 : 0;
    if (is == v->broker) {
        return;
    }
    v->broker = is;
    v->check_us = now_us + CHECK_US;
    events_tell(&v->events, "link", v->l.up ? "info" : "error", NULL, "%s",
                v->l.up ? "the broker is there" : "the broker is away: no stop reaches a robot");
    if (!v->l.up) {
        app_note(v->l.a, "the broker is away: %s", v->l.why);
    }
}

static void on_tick(evutil_socket_t fd, short what, void *ctx)
{
    view *v = ctx;
    int64_t now_us = grobo_now_us();
    (void)fd;
    (void)what;
    based_tell(&v->based, now_us);
    look_at_broker(v, now_us);
    look_after_stop(v, now_us);
    look_after_reset(v, now_us);
    if (http_streams(v->http) > 0) {
        events_send_state(&v->events, state_json(v));
    }
}

static int run(view *v, app *a)
{
    http_config config = {
        .base = v->l.link.base, .rule = rule_of, .serve = answer, .early = stop_early, .ctx = v};
    int status = listener_open(a, v->options, &config, &v->events);
    if (status) {
        return status;
    }
    v->http = v->events.to;
    v->tick = conn_every(v->l.link.base, 1000000 / STATE_HZ, on_tick, v);
    if (!v->tick) {
        return app_fail_error(a, EXIT_ROBOT, GROBO_ERR_NOMEM, "serve");
    }
    on_tick(-1, 0, v);
    v->l.on_event = on_fleet_event;
    leader_listen(&v->l, "state");
    listener_announce(a, v->http);
    while (!v->l.link.signal) {
        (void)leader_wait(&v->l, INT64_C(3600000000), NULL);
    }
    return EXIT_SIGNAL + v->l.link.signal;
}

int web_run_fleet(app *a, const web_options *options, const broker *b, const char *group)
{
    static view v;
    memset(&v, 0, sizeof v);
    v.options = options;
    v.b = b;
    v.events.began_us = grobo_now_us();
    int status = leader_open(&v.l, a, &b->config, group, NULL);
    if (!status) {
        status = run(&v, a);
    }
    http_free(v.events.to);
    v.events.to = NULL;
    conn_forget(v.tick);
    events_free(&v.events);
    leader_end(&v.l);
    return status;
}
