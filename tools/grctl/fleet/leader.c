/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/fleet/leader.h"
#include "tools/grctl/fleet/wire.h"
#include "tools/grctl/lang/lang.h"

enum {
    CONNECT_US = 5000000, /* a broker that is not there is tried so long */
    SAY_US = 1000000,     /* one that does not answer is spoken of after this */
    SEEN_US = 200000,
    UNKNOWN_US = 1000000, /* an agent says what it has before it says that it is there */
    ORDER_EXPIRY_S = 2
};

/* ---- agents ---------------------------------------------------------------------------------- */

static peer *peer_of(leader *l, const char *host)
{
    for (int i = 0; i < l->n; i++) {
        if (strcmp(l->peers[i].host, host) == 0) {
            return &l->peers[i];
        }
    }
    if (l->n == LEADER_PEERS) {
        return NULL;
    }
    peer *p = &l->peers[l->n++];
    snprintf(p->host, sizeof p->host, "%s", host);
    p->told_us = -1;
    return p;
}

/* The state of a robot, with the time when it came. */
static void take_state(peer *p, const char *robot, json_t *state)
{
    p->states = p->states ? p->states : json_object();
    if (json_object_size(p->states) < LEADER_ROBOTS || json_object_get(p->states, robot)) {
        json_object_set_new(state, "heard_us", json_integer(grobo_now_us()));
        json_object_set(p->states, robot, state);
    }
}

/* Keeps an object in place of the one before. */
static void keep(json_t **where, json_t *object)
{
    json_decref(*where);
    *where = json_incref(object);
}

static void take_connection(peer *p, const json_t *said)
{
    const char *state = fleet_text(said, "state"), *epoch = fleet_text(said, "epoch");
    if (state && epoch) {
        /* A will of an earlier life says nothing of this one. */
        bool old =
            strcmp(state, "CONNECTIONBROKEN") == 0 && *p->epoch && strcmp(p->epoch, epoch) != 0;
        if (!old) {
            p->gone = p->gone || strcmp(state, "ONLINE") != 0 || strcmp(p->epoch, epoch) != 0;
            snprintf(p->state, sizeof p->state, "%s", state);
            snprintf(p->epoch, sizeof p->epoch, "%s", epoch);
        }
    }
}

static void take_event(leader *l, peer *p, json_t *event)
{
    const char *kind = fleet_text(event, "kind"), *id = fleet_text(event, "id");
    if (kind && id && strcmp(kind, "ended") == 0 && strcmp(id, p->prepared) == 0) {
        keep(&p->ended, event);
    }
    if (kind && id && strcmp(kind, "stopping") == 0 && strcmp(id, l->stop) == 0) {
        p->told_us = grobo_now_us() - l->stop_us;
    }
    if (kind && id && strcmp(kind, "stopped") == 0 && strcmp(id, l->stop) == 0) {
        keep(&p->stopped, event);
    }
    if (l->on_event) {
        l->on_event(l, p, event);
    }
}

static void take_answer(leader *l, json_t *answer)
{
    const char *host = fleet_text(answer, "host"), *id = fleet_text(answer, "id");
    peer *p = host && fleet_is_name(host) ? peer_of(l, host) : NULL;
    if (p && id && *p->waiting && strcmp(p->waiting, id) == 0) {
        keep(&p->answer, answer);
        *p->waiting = '\0';
        p->took_us = grobo_now_us() - p->asked_us;
    }
}

/* An agent asks for our time. */
static void take_ping(leader *l, const json_t *ping)
{
    const char *host = fleet_text(ping, "host");
    if (host && fleet_is_name(host)) {
        json_t *pong =
            json_pack("{s:i,s:s,s:I,s:I}", "v", FLEET_VERSION, "leader", l->id, "n",
                      (json_int_t)fleet_number(ping, "n", 0), "t_us", (json_int_t)grobo_now_us());
        (void)wire_tell(l->m, "time", host, "pong", pong, WIRE_ONCE);
    }
}

static void take_of_host(leader *l, char part[4][FLEET_NAME_BYTES], int n, json_t *object)
{
    peer *p = peer_of(l, part[0]);
    if (!p) {
        return;
    }
    if (n == 2 && strcmp(part[1], "connection") == 0) {
        take_connection(p, object);
        l->news++;
    } else if (n == 2 && strcmp(part[1], "factsheet") == 0) {
        keep(&p->facts, object);
        l->news++;
    } else if (n == 2 && strcmp(part[1], "event") == 0) {
        take_event(l, p, object);
    } else if (n == 3 && (strcmp(part[2], "state") == 0 || strcmp(part[2], "last") == 0)) {
        take_state(p, part[1], object);
    }
}

/* retained: it stood before we came. */
static void take_latch(leader *l, json_t *latch, bool retained)
{
    const char *id = fleet_text(latch, "id");
    keep(&l->latch, latch);
    if (retained && l->ups == 1 && id && json_is_true(json_object_get(latch, "stopped"))) {
        snprintf(l->stood, sizeof l->stood, "%s", id);
    }
}

static void on_message(void *ctx, const mqtt_message *message)
{
    leader *l = ctx;
    char part[4][FLEET_NAME_BYTES];
    int n = fleet_parts(message->topic, part);
    l->kept += message->retained;
    json_t *object = fleet_read(message->payload, message->size);
    if (!object || n < 2) {
        json_decref(object);
        return;
    }
    if (strcmp(part[0], "ack") == 0) {
        take_answer(l, object);
    } else if (strcmp(part[0], "time") == 0) {
        take_ping(l, object);
    } else if (strcmp(part[0], "group") == 0) {
        if (n == 3 && strcmp(part[2], "latch") == 0 && strcmp(part[1], l->group) == 0) {
            take_latch(l, object, message->retained);
        }
    } else {
        take_of_host(l, part, n, object);
    }
    json_decref(object);
}

/* ---- the connection -------------------------------------------------------------------------- */

/* The latch of l->stop. False: it is not out. */
static bool publish_latch(leader *l, const char *how)
{
    json_t *latch = json_pack("{s:i,s:b,s:s,s:s,s:I}", "v", FLEET_VERSION, "stopped", how != NULL,
                              "id", l->stop, "by", l->id, "at_ms", (json_int_t)wire_wall_ms());
    if (how) {
        json_object_set_new(latch, "how", json_string(how));
    }
    l->stop_taken = l->stop_refused = false;
    l->stop_number =
        wire_tell(l->m, "group", l->group, "latch", json_incref(latch), WIRE_SURE | WIRE_KEPT);
    if (l->stop_number > 0) {
        keep(&l->latch, latch); /* the broker tells us nothing of our own */
    }
    json_decref(latch);
    return l->stop_number > 0;
}

/* As a connection before could not bring it there, the same again: it is one stop. */
static void stop_first(leader *l)
{
    if (l->first && !l->stop_taken) {
        if (!*l->stop) {
            fleet_make_id(l->stop);
            l->stop_us = grobo_now_us();
        }
        (void)publish_latch(l, l->first);
    }
}

static void on_up(void *ctx)
{
    leader *l = ctx;
    l->up = true;
    l->ups++;
    stop_first(l);
    wire_subscribe(l->m, "ack", l->id, NULL, false);
    wire_subscribe(l->m, "time", l->id, "ping", false);
    wire_subscribe(l->m, "group", l->group, "latch", true);
    wire_subscribe(l->m, "+", "factsheet", NULL, true);
    wire_subscribe(l->m, "+", "event", NULL, false);
    wire_subscribe(l->m, "+", "connection", NULL, true);
    if (l->listens) {
        wire_subscribe(l->m, "+", "+", l->listens, false);
    }
}

static void on_down(void *ctx, const char *why)
{
    leader *l = ctx;
    l->lost = l->lost || (l->up && l->permits);
    l->up = false;
    l->why = why;
}

static void on_refused(void *ctx, const char *why)
{
    leader *l = ctx;
    l->refused++;
    app_note(l->a, "the broker refuses: %s", why);
}

static void on_taken(void *ctx, int number, bool taken)
{
    leader *l = ctx;
    if (number == l->stop_number) {
        l->stop_taken = taken;
        l->stop_refused = !taken;
    }
}

static void on_tick(evutil_socket_t fd, short what, void *ctx)
{
    leader *l = ctx;
    (void)fd;
    (void)what;
    if (l->permits) {
        (void)wire_tell(l->m, "group", l->group, "permit",
                        json_pack("{s:i,s:s,s:I}", "v", FLEET_VERSION, "leader", l->id, "seq",
                                  (json_int_t)l->permit_seq++),
                        WIRE_ONCE);
    }
}

static void on_time(evutil_socket_t fd, short what, void *ctx)
{
    (void)fd;
    (void)what;
    (void)ctx; /* it only ends a round of the loop */
}

static bool is_done(const leader *l, bool (*done)(const leader *l))
{
    return done && done(l);
}

bool leader_wait(leader *l, int64_t bound_us, bool (*done)(const leader *l))
{
    int64_t until_us = grobo_now_us() + bound_us;
    struct event *timer = evtimer_new(l->link.base, on_time, NULL);
    while (timer && !is_done(l, done) && !l->link.signal && !l->lost) {
        int64_t rest_us = until_us - grobo_now_us();
        const struct timeval rest = conn_timeval(rest_us);
        if (rest_us <= 0 || evtimer_add(timer, &rest) != 0 ||
            event_base_loop(l->link.base, EVLOOP_ONCE) != 0) {
            break;
        }
    }
    conn_forget(timer);
    return is_done(l, done);
}

bool leader_is_unknown(const peer *p)
{
    return strcmp(p->state, "ONLINE") == 0 && !p->facts;
}

static bool anybody_unknown(const leader *l)
{
    for (int i = 0; i < l->n; i++) {
        if (leader_is_unknown(&l->peers[i])) {
            return true;
        }
    }
    return false;
}

/* Until nothing of what the broker retains has come for a while: nobody is left out of a stop. */
static void hear_retained(leader *l)
{
    int64_t began_us = grobo_now_us(), took_us = 0;
    unsigned before;
    bool more;
    do {
        before = l->kept;
        (void)leader_wait(l, SEEN_US, NULL);
        took_us = grobo_now_us() - began_us;
        more = l->kept != before || (anybody_unknown(l) && took_us < UNKNOWN_US);
    } while (more && l->up && !l->link.signal && took_us < CONNECT_US);
}

static bool is_up(const leader *l)
{
    return l->up;
}

static bool is_up_or_not(const leader *l)
{
    return l->up || l->why;
}

/* What is said of a broker that is not there. The exit status. */
static int fail_broker(leader *l, const char *so)
{
    return app_fail(l->a, EXIT_ROBOT, "UNREACHABLE", "fleet: %s: %s%s", l->broker,
                    l->why ? l->why : _("the broker does not answer"), so);
}

/* Who stops is told at once that this way does not lead to the robots; it is tried on meanwhile. */
static int await_broker(leader *l)
{
    (void)leader_wait(l, l->first ? SAY_US : CONNECT_US, is_up_or_not);
    if (!l->up && l->first && !l->link.signal) {
        (void)fail_broker(l, _(": nothing is stopped; use the switches; it is tried for 5 s"));
        (void)leader_wait(l, CONNECT_US, is_up);
    }
    return l->up ? EXIT_DONE : fail_broker(l, l->first ? _(": use the switches") : "");
}

static int connect_it(leader *l, const mqtt_config *with)
{
    mqtt_config config = *with;
    const char *why;
    config.base = l->link.base;
    config.id = l->id;
    config.on_up = on_up;
    config.on_down = on_down;
    config.on_message = on_message;
    config.on_refused = on_refused;
    config.on_taken = on_taken;
    config.ctx = l;
    l->broker = with->host;
    l->m = mqtt_new(&config, &why);
    if (!l->m) {
        return app_fail(l->a, EXIT_ROBOT, "IO", "fleet: %s: %s", config.host, why);
    }
    l->tick = conn_every(l->link.base, LEADER_PERMIT_US, on_tick, l);
    if (!l->tick) {
        return app_fail_error(l->a, EXIT_ROBOT, GROBO_ERR_NOMEM, "fleet");
    }
    mqtt_start(l->m);
    return EXIT_DONE;
}

int leader_open(leader *l, app *a, const mqtt_config *broker, const char *group, const char *stop)
{
    memset(l, 0, sizeof *l);
    l->a = a;
    l->group = group;
    l->first = stop;
    fleet_make_id(l->id);
    l->peers = calloc(LEADER_PEERS, sizeof *l->peers);
    if (!l->peers || !fleet_topic(l->ack, "ack", l->id, NULL, NULL) ||
        conn_link_init(&l->link) < 0) {
        return app_fail_error(a, EXIT_ROBOT, GROBO_ERR_NOMEM, "fleet");
    }
    conn_link_watch(&l->link);
    return connect_it(l, broker);
}

static int meet(leader *l)
{
    int status = await_broker(l);
    if (!status) {
        hear_retained(l);
        status = l->up ? EXIT_DONE : fail_broker(l, l->first ? _(": use the switches") : "");
    }
    return l->first && l->ups ? EXIT_DONE : status; /* who stops goes on trying */
}

int leader_begin(leader *l, app *a, const mqtt_config *broker, const char *group, const char *host,
                 const char *stop)
{
    int status = leader_open(l, a, broker, group, stop);
    l->host = host;
    return status ? status : meet(l);
}

void leader_end(leader *l)
{
    conn_forget(l->tick);
    mqtt_free(l->m);
    for (int i = 0; i < l->n; i++) {
        json_decref(l->peers[i].facts);
        json_decref(l->peers[i].states);
        json_decref(l->peers[i].answer);
        json_decref(l->peers[i].ended);
        json_decref(l->peers[i].stopped);
    }
    json_decref(l->latch);
    free(l->peers);
    conn_link_deinit(&l->link);
}

/* ---- orders ---------------------------------------------------------------------------------- */

bool leader_has(const leader *l, const peer *p)
{
    size_t i;
    json_t *one;
    json_array_foreach(json_object_get(p->facts, "groups"), i, one)
    {
        if (json_is_string(one) && strcmp(json_string_value(one), l->group) == 0) {
            return !l->host || strcmp(l->host, p->host) == 0;
        }
    }
    return false;
}

int leader_choose(leader *l)
{
    int n = 0;
    for (int i = 0; i < l->n; i++) {
        peer *p = &l->peers[i];
        p->chosen = strcmp(p->state, "ONLINE") == 0 && leader_has(l, p);
        p->gone = false;
        n += p->chosen;
    }
    return n;
}

static void send_order(leader *l, peer *p, const char *verb, const json_t *body)
{
    char topic[FLEET_TOPIC_BYTES];
    json_t *order = json_deep_copy(body);
    int64_t now_us = grobo_now_us();
    fleet_make_id(p->waiting);
    p->asked_us = now_us;
    keep(&p->answer, NULL);
    json_t *head = json_pack("{s:i,s:s,s:s,s:s,s:I,s:I}", "v", FLEET_VERSION, "id", p->waiting,
                             "from", l->id, "epoch", p->epoch, "issued_us", (json_int_t)now_us,
                             "deadline_us", (json_int_t)(now_us + FLEET_ORDER_LIFE_US));
    if (strcmp(verb, "prepare") == 0) {
        snprintf(p->prepared, sizeof p->prepared, "%s", p->waiting);
        keep(&p->ended, NULL);
    } else if (*p->prepared) {
        json_object_set_new(head, "of", json_string(p->prepared));
    }
    json_object_update(order, head);
    json_decref(head);
    (void)fleet_topic(topic, p->host, "cmd", verb, NULL);
    const mqtt_message message = {.topic = topic, .response = l->ack};
    (void)wire_publish(l->m, &message, order, 1, ORDER_EXPIRY_S);
}

void leader_order(leader *l, const char *verb, json_t *body)
{
    for (int i = 0; i < l->n; i++) {
        if (l->peers[i].chosen) {
            send_order(l, &l->peers[i], verb, body);
        }
    }
    json_decref(body);
}

bool leader_answered(const leader *l)
{
    for (int i = 0; i < l->n; i++) {
        if (l->peers[i].chosen && !l->peers[i].gone && *l->peers[i].waiting) {
            return false;
        }
    }
    return true;
}

bool leader_lacks(const leader *l)
{
    for (int i = 0; i < l->n; i++) {
        if (l->peers[i].chosen && l->peers[i].gone) {
            return true;
        }
    }
    return false;
}

bool leader_latch(leader *l, const char *how)
{
    const char *before = l->latch ? fleet_text(l->latch, "id") : NULL;
    if (how || !before) {
        fleet_make_id(l->stop);
    } else {
        snprintf(l->stop, sizeof l->stop, "%s", before);
    }
    l->stop_us = grobo_now_us();
    return publish_latch(l, how);
}

void leader_listen(leader *l, const char *what)
{
    l->listens = what;
    wire_subscribe(l->m, "+", "+", what, false);
}
