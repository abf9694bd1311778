/* SPDX-License-Identifier: MIT */
/* Which path is what, and what every request has to bring along. */
#include <string.h>

#include <grobo/core/port.h>

#include "tools/grctl/web/fields.h"
#include "tools/grctl/web/listener.h"
#include "tools/grctl/web/page.h"
#include "tools/grctl/web/pose.h"
#include "tools/grctl/web/serve.h"

/* ---- what a body has ------------------------------------------------------------------------- */

enum { NAME_MOST = LIBRARY_NAME_BYTES - 1, TIME_MOST_MS = 163830 };

#define FIELD_MOTION                                                                               \
    {                                                                                              \
        .name = "motion", .kind = FIELD_TEXT, .needed = true                                       \
    }
#define FIELD_SPEED                                                                                \
    {                                                                                              \
        .name = "speed_pct", .kind = FIELD_WHOLE, .least = 1, .most = GROBO_PLAY_SPEED_MAX_PCT     \
    }
#define FIELD_TIME                                                                                 \
    {                                                                                              \
        .name = "time_ms", .kind = FIELD_NUMBER, .least = 0, .most = TIME_MOST_MS                  \
    }
/* Of how a motion is played. */
#define FIELDS_OF_PLAY                                                                             \
    FIELD_MOTION, FIELD_SEQUENCE, FIELD_SPEED, {.name = "mirror", .kind = FIELD_FLAG},             \
        {.name = "reverse", .kind = FIELD_FLAG}, {.name = "loop", .kind = FIELD_FLAG},             \
        {.name = "repeat", .kind = FIELD_WHOLE, .least = 1, .most = 1e6},                          \
        {.name = "clamp", .kind = FIELD_FLAG}, {.name = "force", .kind = FIELD_FLAG},              \
    {                                                                                              \
        .name = "by_keys", .kind = FIELD_FLAG                                                      \
    }

static const field no_fields[] = {{.name = NULL}};
static const field sequence_fields[] = {FIELD_SEQUENCE, {.name = NULL}};
static const field play_fields[] = {
    FIELDS_OF_PLAY,
    {.name = "from_ms", .kind = FIELD_NUMBER, .least = 0, .most = 1e9},
    {.name = "on_lost", .kind = FIELD_WORD, .words = "stop, finish, exit"},
    {.name = NULL}};
static const field queue_fields[] = {FIELDS_OF_PLAY, {.name = NULL}};
static const field seek_fields[] = {
    {.name = "t_ms", .kind = FIELD_NUMBER, .needed = true, .least = 0, .most = 1e10},
    FIELD_SEQUENCE,
    {.name = NULL}};
static const field speed_fields[] = {{.name = "speed_pct",
                                      .kind = FIELD_WHOLE,
                                      .needed = true,
                                      .least = 1,
                                      .most = GROBO_PLAY_SPEED_MAX_PCT},
                                     FIELD_SEQUENCE,
                                     {.name = NULL}};
static const field move_fields[] = {{.name = "angle_deg", .kind = FIELD_ANGLES},
                                    {.name = "pose", .kind = FIELD_WORD, .words = "init"},
                                    FIELD_TIME,
                                    FIELD_SEQUENCE,
                                    {.name = NULL}};
static const field jog_fields[] = {{.name = "angle_deg", .kind = FIELD_ANGLES, .needed = true},
                                   FIELD_TIME,
                                   FIELD_SEQUENCE,
                                   {.name = NULL}};
static const field drive_fields[] = {
    {.name = "speed_dps", .kind = FIELD_ANGLES, .needed = true}, FIELD_SEQUENCE, {.name = NULL}};
static const field torque_fields[] = {
    {.name = "joints", .kind = FIELD_JOINTS, .needed = true},
    {.name = "mode", .kind = FIELD_WORD, .needed = true, .words = "on, off, brake, limp, hold"},
    FIELD_SEQUENCE,
    {.name = NULL}};
static const field capture_fields[] = {{.name = "joints", .kind = FIELD_JOINTS}, {.name = NULL}};
static const field ik_fields[] = {
    {.name = "angle_deg",
     .kind = FIELD_NUMBERS,
     .needed = true,
     .least = 1,
     .most = GROBO_JOINTS_MAX},
    {.name = "handle", .kind = FIELD_WORD, .needed = true, .words = "right_foot, left_foot, waist"},
    {.name = "p_m", .kind = FIELD_NUMBERS, .needed = true, .least = 3, .most = 3},
    {.name = "rotation", .kind = FIELD_NUMBERS, .least = 9, .most = 9},
    {.name = "root", .kind = FIELD_OBJECT},
    {.name = NULL}};
/* Lease and token stand in the body where no header can be set. */
static const field lease_fields[] = {
    {.name = "action", .kind = FIELD_WORD, .needed = true, .words = "take, ask, give, deny"},
    {.name = "name", .kind = FIELD_TEXT},
    {.name = "lease", .kind = FIELD_TEXT},
    {.name = "token", .kind = FIELD_TEXT},
    {.name = NULL}};
static const field heartbeat_fields[] = {
    {.name = "lease", .kind = FIELD_TEXT, .needed = true},
    {.name = "drawn", .kind = FIELD_WHOLE, .needed = true, .least = 0, .most = FIELD_NO_END},
    {.name = "token", .kind = FIELD_TEXT},
    {.name = NULL}};

/* ---- what a verb needs ----------------------------------------------------------------------- */

/* What a verb asks for. */
enum {
    NEEDS_LEASE = 1,
    NEEDS_LINE = 2,
    BASED = 4, /* refused where its state is old, or where something happened since */
    MOVES = 8  /* the same, and refused after a stop */
};

typedef struct verb {
    const char *path;
    serve_verb_fn run;
    unsigned needs;
    const field *fields;
} verb;

static const verb verbs[] = {
    {"/api/play", verb_play, NEEDS_LEASE | NEEDS_LINE | MOVES, play_fields},
    {"/api/queue", verb_queue, NEEDS_LEASE | NEEDS_LINE | MOVES, queue_fields},
    {"/api/pause", verb_pause, NEEDS_LEASE | NEEDS_LINE, no_fields},
    {"/api/resume", verb_resume, NEEDS_LEASE | NEEDS_LINE | MOVES, sequence_fields},
    {"/api/seek", verb_seek, NEEDS_LEASE | NEEDS_LINE | MOVES, seek_fields},
    {"/api/speed", verb_speed, NEEDS_LEASE | NEEDS_LINE | BASED, speed_fields},
    {"/api/halt", verb_halt, NEEDS_LEASE | NEEDS_LINE, no_fields},
    {"/api/move", verb_move, NEEDS_LEASE | NEEDS_LINE | MOVES, move_fields},
    {"/api/jog", verb_jog, NEEDS_LEASE | NEEDS_LINE | MOVES, jog_fields},
    {"/api/drive", verb_drive, NEEDS_LEASE | NEEDS_LINE | MOVES, drive_fields},
    {"/api/torque", verb_torque, NEEDS_LEASE | NEEDS_LINE | BASED, torque_fields},
    {"/api/capture", verb_capture, NEEDS_LINE, capture_fields},
    {"/api/reset", verb_reset, BASED, sequence_fields},
};

static void refuse_lease(serve *s, http_request *r)
{
    const lease_page *holder = &s->lease.holder;
    json_t *refusal;
    if (!lease_is_held(&s->lease)) {
        http_refuse(r, 409, "lease", "this needs the lease: POST /api/lease");
        return;
    }
    refusal = json_pack("{s:s,s:o,s:{s:o,s:s,s:I}}", "code", "lease", "message",
                        json_sprintf("%s drives since %lld s", holder->name,
                                     (long long)((grobo_now_us() - holder->since_us) / 1000000)),
                        "holder", "name", app_json_text(holder->name), "id", holder->id, "since_ms",
                        (json_int_t)serve_ms(s, holder->since_us));
    http_reply_json(r, 409, json_pack("{s:o}", "error", refusal));
}

static bool is_granted(serve *s, http_request *r, const json_t *body, const verb *v)
{
    const char *doing = strrchr(v->path, '/') + 1;
    unsigned needs = v->needs;
    if ((needs & NEEDS_LINE) && !s->c.up) {
        serve_refuse(s, r, GROBO_ERR_CLOSED, "robot");
    } else if ((needs & NEEDS_LEASE) &&
               !lease_is_holder(&s->lease, http_header(r, "X-Grobo-Lease"))) {
        refuse_lease(s, r);
    } else if (needs & MOVES) {
        return stops_may_move(s, r, body, doing);
    } else {
        return !(needs & BASED) || serve_is_based(s, r, body, doing);
    }
    return false;
}

/* ---- lease and stop -------------------------------------------------------------------------- */

static json_t *lease_answer(const lease_page *page, bool held)
{
    return json_pack("{s:b,s:s,s:s}", "held", held, "lease", page->secret, "id", page->id);
}

static void take(serve *s, http_request *r, const json_t *body)
{
    const char *secret = header_or_body(r, body, "X-Grobo-Lease", "lease");
    bool was_held = lease_is_held(&s->lease);
    if (!lease_take(&s->lease, requester_of(body).name, secret, s->options->takes_over,
                    grobo_now_us())) {
        refuse_lease(s, r);
        return;
    }
    if (was_held) { /* what the one before was doing with a finger */
        if (s->jogs) {
            stops_halt(s);
        }
    }
    events_tell(&s->events, "lease", "info", NULL, "%s drives", s->lease.holder.name);
    http_reply_json(r, 200, lease_answer(&s->lease.holder, true));
}

static void ask(serve *s, http_request *r, const json_t *body)
{
    if (!lease_ask(&s->lease, requester_of(body).name, grobo_now_us())) {
        http_refuse(r, 409, "state", "nobody drives: take it");
        return;
    }
    events_tell(&s->events, "lease", "info", NULL, "%s asks to drive", s->lease.asker.name);
    json_t *answer = lease_answer(&s->lease.asker, false);
    json_object_set_new(answer, "granted_ms",
                        json_integer(serve_ms(s, s->lease.asker.since_us + LEASE_ASK_US)));
    http_reply_json(r, 200, answer);
}

static void serve_lease(serve *s, http_request *r, const json_t *body)
{
    const char *action = body_text(body, "action");
    const char *secret = header_or_body(r, body, "X-Grobo-Lease", "lease");
    if (!listener_has_token(r, body)) {
        return;
    }
    if (strcmp(action, "take") == 0) {
        take(s, r, body);
    } else if (strcmp(action, "ask") == 0) {
        ask(s, r, body);
    } else { /* give, deny */
        bool gives = *action == 'g';
        if (gives && lease_is_holder(&s->lease, secret) && s->jogs) {
            stops_halt(s);
        }
        if (!(gives ? lease_give(&s->lease, secret, grobo_now_us())
                    : lease_deny(&s->lease, secret))) {
            refuse_lease(s, r);
            return;
        }
        s->left_us = gives && !lease_is_held(&s->lease) ? grobo_now_us() : 0;
        events_tell(&s->events, "lease", "info", NULL, "%s",
                    !gives                     ? "to drive was refused"
                    : lease_is_held(&s->lease) ? "the lease was handed over"
                                               : "nobody drives");
        http_reply_json(r, 200, json_pack("{s:b}", "held", !gives));
    }
}

void serve_early(void *ctx, const http_request *r)
{
    serve_wake(ctx);
    (void)stops_ask(ctx, NULL, strstr(r->path, "estop") != NULL);
}

/* From anybody; beyond loopback from who has the token. */
static void serve_stop(serve *s, http_request *r, const json_t *body)
{
    bool estop = strstr(r->path, "estop") != NULL;
    if (http_is_open(r->server) && !listener_has_token(r, body)) {
        return;
    }
    int result = stops_ask(s, requester_of(body).name, estop);
    if (result < 0 && result != GROBO_ERR_CLOSED) {
        serve_refuse(s, r, result, estop ? "estop" : "stop");
    } else if (r->second) {
        http_reply_empty(r);
    } else {
        serve_accept(s, r, result > 0 ? result : 0, "stop");
    }
}

static void serve_heartbeat(serve *s, http_request *r, const json_t *body)
{
    if (http_is_open(r->server) && !listener_has_token(r, body)) {
        return;
    }
    const char *secret = body_text(body, "lease");
    if (!lease_is_holder(&s->lease, secret)) {
        refuse_lease(s, r);
    } else if (!based_is_fresh(&s->based, json_object_get(body, "drawn"), grobo_now_us())) {
        http_refuse(r, 409, "stale", "the page draws nothing: this counts as no heartbeat");
    } else {
        lease_beat(&s->lease, secret, grobo_now_us());
        http_reply_empty(r);
    }
}

/* ---- paths ----------------------------------------------------------------------------------- */

typedef struct plain {
    const char *path;
    access_rule rule;
    bool second; /* on the second port */
    void (*run)(serve *s, http_request *r, const json_t *body);
    const field *fields; /* NULL: whatever its body has, it is carried out */
} plain;

static void serve_robot(serve *s, http_request *r, const json_t *body)
{
    (void)body;
    http_reply_json(r, 200, serve_robot_json(s));
}

static void serve_state(serve *s, http_request *r, const json_t *body)
{
    (void)body;
    http_reply_json(r, 200, serve_state_json(s));
}

static void serve_events(serve *s, http_request *r, const json_t *body)
{
    (void)body;
    events_stream(&s->events, r);
}

static void serve_motions(serve *s, http_request *r, const json_t *body)
{
    (void)body;
    library_list(s, r);
}

static const plain plains[] = {
    {"/api/motions", ACCESS_READ, false, serve_motions, no_fields},
    {"/api/preview", ACCESS_DRAFT, false, NULL, NULL}, /* its body is read by the worker */
    {"/api/ik", ACCESS_ACT, false, pose_ik, ik_fields},
    {"/api/robot", ACCESS_READ, false, serve_robot, no_fields},
    {"/api/state", ACCESS_READ, false, serve_state, no_fields},
    {"/api/events", ACCESS_READ, false, serve_events, no_fields},
    {"/api/lease", ACCESS_PLAIN, false, serve_lease, lease_fields},
    {"/api/stop", ACCESS_STOP, false, serve_stop, NULL},
    {"/api/estop", ACCESS_STOP, false, serve_stop, NULL},
    {"/stop", ACCESS_STOP, true, serve_stop, NULL},
    {"/estop", ACCESS_STOP, true, serve_stop, NULL},
    {"/heartbeat", ACCESS_PLAIN, true, serve_heartbeat, heartbeat_fields},
};

static const plain *find_plain(const http_request *r)
{
    for (size_t i = 0; i < sizeof plains / sizeof plains[0]; i++) {
        if (plains[i].second == r->second && strcmp(plains[i].path, r->path) == 0) {
            return &plains[i];
        }
    }
    return NULL;
}

static const verb *find_verb(const http_request *r)
{
    for (size_t i = 0; !r->second && i < sizeof verbs / sizeof verbs[0]; i++) {
        if (strcmp(verbs[i].path, r->path) == 0) {
            return &verbs[i];
        }
    }
    return NULL;
}

/* "/api/motions/NAME" or "/api/motions/NAME/file"; false: neither. */
static bool find_motion(const http_request *r, char name[LIBRARY_NAME_BYTES], bool *file)
{
    static const char folder[] = "/api/motions/", tail[] = "/file";
    size_t n = strlen(r->path);
    if (r->second || strncmp(r->path, folder, sizeof folder - 1) != 0) {
        return false;
    }
    const char *begin = r->path + sizeof folder - 1;
    n -= sizeof folder - 1;
    *file = n > sizeof tail - 1 && strcmp(begin + n - (sizeof tail - 1), tail) == 0;
    n -= *file ? sizeof tail - 1 : 0;
    if (n == 0 || n >= LIBRARY_NAME_BYTES) {
        return false;
    }
    memcpy(name, begin, n);
    name[n] = '\0';
    return true;
}

/* "rate=50" of a query; 0: it is none. */
static double rate_of(const http_request *r)
{
    double rate_hz = 30;
    if (*r->query &&
        (strncmp(r->query, "rate=", 5) != 0 || !cli_read_number(r->query + 5, &rate_hz))) {
        return 0;
    }
    return rate_hz >= 1 && rate_hz <= 100 ? rate_hz : 0;
}

static void serve_motion(serve *s, http_request *r, const char *name, bool file)
{
    double rate_hz = rate_of(r);
    if (strcmp(r->method, "PUT") == 0) {
        library_put(s, r, name, file);
    } else if (file) {
        library_get_file(s, r, name);
    } else if (rate_hz > 0) {
        library_get(s, r, name, rate_hz);
    } else {
        http_refuse(r, 400, "arg", "motions: unknown query; expected rate=1 to rate=100");
    }
}

bool serve_rule(void *ctx, const http_request *r, access_rule *rule)
{
    const plain *p = find_plain(r);
    char name[LIBRARY_NAME_BYTES];
    bool file;
    (void)ctx;
    if (find_motion(r, name, &file)) {
        *rule = strcmp(r->method, "PUT") == 0 ? ACCESS_SAVE : ACCESS_READ;
        return true;
    }
    if (p) {
        *rule = p->rule;
        return true;
    }
    *rule = find_verb(r) ? ACCESS_ACT : ACCESS_PAGE;
    return *rule == ACCESS_ACT || (!r->second && page_has(r->path));
}

/* Its body is whole and as it should be: it is carried out. */
static void carry_out(serve *s, http_request *r, json_t *body, const plain *p, const verb *v)
{
    if (p) {
        p->run(s, r, body);
    } else if (is_granted(s, r, body, v)) {
        v->run(s, r, body);
    }
}

/* Of a verb, or a plain path whose body is read here. */
static void take_body(serve *s, http_request *r, const plain *p, const verb *v)
{
    const field *fields = p ? p->fields : v->fields;
    json_t *body = fields ? http_object(r) : http_object_if_any(r);
    char complaint[FIELDS_TEXT_BYTES];
    if (fields && !body) {
        return;
    }
    if (fields && *r->query) {
        http_refuse(r, 400, "arg", "%s: a query is not expected; the body has the fields", r->path);
    } else if (fields && !fields_fit(body, fields, strrchr(r->path, '/') + 1, complaint)) {
        http_refuse(r, 400, "arg", "%s", complaint);
    } else {
        carry_out(s, r, body, p, v);
    }
    json_decref(body);
}

void serve_request(void *ctx, http_request *r)
{
    serve *s = ctx;
    const plain *p = find_plain(r);
    const verb *v = find_verb(r);
    char name[LIBRARY_NAME_BYTES];
    bool file, motion = find_motion(r, name, &file);
    serve_wake(s);
    if (!s->ready && (motion || v || (p && p->rule != ACCESS_STOP))) {
        http_refuse(r, 503, "closed", "serve: the robot is being opened; a stop is heard already");
        return;
    }
    if (motion) {
        serve_motion(s, r, name, file);
        return;
    }
    if (!p && !v) {
        page_serve(r);
        return;
    }
    if (p && !p->run) {
        library_preview(s, r);
        return;
    }
    take_body(s, r, p, v);
}
