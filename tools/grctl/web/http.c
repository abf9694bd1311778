/* SPDX-License-Identifier: MIT */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <event2/buffer.h>
#include <event2/bufferevent.h>
#include <event2/event.h>
#include <event2/http.h>
#include <event2/http_struct.h>
#include <event2/keyvalq_struct.h>
#include <event2/listener.h>

#include <grobo/core/port.h>

#include "tools/grctl/cli/heap.h"
#include "tools/grctl/os/net.h"
#include "tools/grctl/web/head.h"
#include "tools/grctl/web/http.h"

enum {
    IDLE_S = 5,          /* a silent connection, or half a request */
    SEND_BYTES = 32768,  /* of the system for a stream: what a client may lag behind unseen */
    SKIP_BYTES = 16384,  /* waiting for a stream's client: it misses the next state */
    EVENT_BYTES = 65536, /* and the next event */
    DROP_US = 3000000,   /* so long without reading */
    SWEEP_US = 100000,
    LISTENERS = 2,
    SPARE = 8, /* accepted while others that were ended are going */
    GUESTS = 2 * (HTTP_CONNECTIONS_MAX + SPARE)
};
/* A whole request comes within this time, however slowly. */
#define REQUEST_US INT64_C(20000000)

/* Who has made no whole request for so long may have to make room for who comes. */
#define HALF_OPEN_US INT64_C(1000000)

/* One of the two ports. */
typedef struct port {
    http *of;
    struct evhttp *server;
    struct evconnlistener *listeners[LISTENERS];
    int n_listeners;
    wall wall;
} port;

/*
 * A connection. libevent does not tell when one ends that never made a request: such a one is gone
 * when its socket is, or is that of another connection.
 */
typedef struct guest {
    port *at;                /* NULL: this place is free */
    struct bufferevent *bev; /* for when it is heard or was just accepted, as it is there then */
    const struct evbuffer *input;
    struct evhttp_connection *connection; /* from the first request on */
    evutil_socket_t fd;                   /* -1 until it is known */
    char words[80];                       /* of its connection */
    char address[64];                     /* "" on loopback, and until it is known */
    int64_t heard_us;                     /* when it sent something, or came */
    int64_t began_us;                     /* a request that is not whole, 0: none */
    size_t head_bytes, got;               /* of the request that is not whole: kept, and came */
    bool ended, judged;                   /* judged: its head is whole, and was looked at */
} guest;

typedef struct stream {
    struct stream *next;
    http *of;
    struct evhttp_request *raw;
    struct evhttp_connection *connection;
    char address[64];
    int64_t behind_us; /* since when it does not read, 0: it does */
    bool ends;
} stream;

struct http {
    http_config config;
    port first, second;
    guest guests[GUESTS];
    char heads[GUESTS][HTTP_HEADER_BYTES + 1]; /* of requests that are not whole */
    stream *streams;
    http_request *waiting;
    struct event *sweep, *reap, *greet;
    int64_t second_us; /* the second in which changes are counted */
    int changes;
};

/* ---- connections ----------------------------------------------------------------------------- */

static int guests_of(const port *p, const char *address)
{
    int n = 0;
    for (int i = 0; i < GUESTS; i++) {
        const guest *g = &p->of->guests[i];
        n += g->at == p && (!address || strcmp(g->address, address) == 0);
    }
    return n;
}

static guest *find_guest(http *h, const struct evbuffer *input,
                         const struct evhttp_connection *connection)
{
    for (int i = 0; i < GUESTS; i++) {
        guest *g = &h->guests[i];
        if (g->at &&
            ((input && g->input == input) || (connection && g->connection == connection))) {
            return g;
        }
    }
    return NULL;
}

static void open_door(port *p, bool open)
{
    for (int i = 0; i < p->n_listeners; i++) {
        (void)(open ? evconnlistener_enable(p->listeners[i])
                    : evconnlistener_disable(p->listeners[i]));
    }
}

/* A request of it waits for its reply: true where that is a refusal which only lets it wait. */
static bool is_waiting(const guest *g, bool *refused)
{
    for (const http_request *r = g->at->of->waiting; r; r = r->next) {
        if (evhttp_request_get_connection(r->raw) == g->connection) {
            *refused = r->refused_us != 0;
            return true;
        }
    }
    return false;
}

static bool is_stream(const guest *g)
{
    for (const stream *s = g->at->of->streams; s; s = s->next) {
        if (s->connection == g->connection) {
            return true;
        }
    }
    return false;
}

/* How well it can be spared; STAYS: it is served. */
enum { STAYS, NEW, IDLE, WAITS_IN_VAIN };

/*
 * One that had its reply and is kept for a next request may come again. One that has not made a
 * whole request for a second is spared first: it is half open.
 */
static int spare(const guest *g, int64_t now_us)
{
    bool refused = false;
    if (g->ended || g->fd < 0) {
        return STAYS;
    }
    if (!g->connection || g->began_us) {
        int64_t since_us = g->began_us ? g->began_us : g->heard_us;
        return now_us - since_us > HALF_OPEN_US ? WAITS_IN_VAIN : NEW;
    }
    if (is_waiting(g, &refused)) {
        return refused ? WAITS_IN_VAIN : STAYS;
    }
    struct bufferevent *bev = evhttp_connection_get_bufferevent(g->connection);
    bool idle = !is_stream(g) && evbuffer_get_length(bufferevent_get_output(bev)) == 0;
    return idle ? IDLE : STAYS;
}

/* The order in which guests make room: the address that has most, how well, how long. */
static bool goes_before(const guest *a, const guest *b, int64_t now_us)
{
    int of_a = guests_of(a->at, a->address), of_b = guests_of(b->at, b->address);
    int how_a = spare(a, now_us), how_b = spare(b, now_us);
    int64_t since_a = a->began_us ? a->began_us : a->heard_us;
    int64_t since_b = b->began_us ? b->began_us : b->heard_us;
    return of_a != of_b ? of_a > of_b : how_a != how_b ? how_a > how_b : since_a < since_b;
}

/* The guest of a port that makes room first, of one address or of any (NULL). NULL: none can. */
static guest *first_to_go(port *p, const char *address)
{
    int64_t now_us = grobo_now_us();
    guest *first = NULL;
    for (int i = 0; i < GUESTS; i++) {
        guest *g = &p->of->guests[i];
        bool asked = g->at == p && (!address || strcmp(g->address, address) == 0);
        if (asked && spare(g, now_us) != STAYS && (!first || goes_before(g, first, now_us))) {
            first = g;
        }
    }
    return first;
}

/* Its socket is that of its connection still; one with a whole request says when it ends. */
static bool is_there(const guest *g)
{
    char words[sizeof g->words];
    return g->connection || g->fd < 0 ||
           (net_connection(g->fd, words, sizeof words) && strcmp(words, g->words) == 0);
}

static void end_guest(guest *g)
{
    g->ended = true;
    if (is_there(g)) {
        net_end(g->fd); /* libevent sees that, and frees it */
    }
}

/* Forgets those that have gone without a word. */
static void forget_gone(port *p)
{
    for (int i = 0; i < GUESTS; i++) {
        guest *g = &p->of->guests[i];
        if (g->at == p && !is_there(g)) {
            g->at = NULL;
        }
    }
}

static int served(const port *p)
{
    int n = 0;
    for (int i = 0; i < GUESTS; i++) {
        n += p->of->guests[i].at == p && !p->of->guests[i].ended;
    }
    return n;
}

/* There is a place for who comes next: nobody who has one without using it keeps it. */
static void make_room(port *p)
{
    guest *g;
    if (guests_of(p, NULL) >= HTTP_CONNECTIONS_MAX) {
        forget_gone(p);
    }
    while (served(p) >= HTTP_CONNECTIONS_MAX && (g = first_to_go(p, NULL)) != NULL) {
        end_guest(g);
    }
    open_door(p, served(p) < HTTP_CONNECTIONS_MAX &&
                     guests_of(p, NULL) < HTTP_CONNECTIONS_MAX + SPARE);
}

static void sweep_guests(http *h)
{
    forget_gone(&h->first);
    forget_gone(&h->second);
    make_room(&h->first);
    make_room(&h->second);
}

static guest *take_place(port *p, const struct evbuffer *input)
{
    guest *g = find_guest(p->of, input, NULL); /* of one that has gone: its memory is used again */
    for (int i = 0; !g && i < GUESTS; i++) {
        g = p->of->guests[i].at ? NULL : &p->of->guests[i];
    }
    if (g) {
        *g = (guest){.at = p, .input = input, .fd = -1, .heard_us = grobo_now_us()};
    }
    return g;
}

/* Where it comes from, which is known from the moment after it was accepted. */
static void name_guest(guest *g)
{
    g->fd = bufferevent_getfd(g->bev);
    if (!net_connection(g->fd, g->words, sizeof g->words)) {
        *g->words = '\0';
    }
    net_peer(g->fd, g->address, sizeof g->address);
    if (*g->address && guests_of(g->at, g->address) > HTTP_ADDRESS_CONNECTIONS_MAX) {
        guest *first = first_to_go(g->at, g->address);
        end_guest(first ? first : g);
    }
}

/* Right behind the accepting of connections: none of them has been read or freed. */
static void on_greet(evutil_socket_t fd, short what, void *ctx)
{
    http *h = ctx;
    (void)fd;
    (void)what;
    for (int i = 0; i < GUESTS; i++) {
        if (h->guests[i].at && h->guests[i].fd < 0) {
            name_guest(&h->guests[i]);
        }
    }
    make_room(&h->first);
    make_room(&h->second);
}

/* Whose request never gets whole. */
static bool is_rude(guest *g)
{
    g->heard_us = grobo_now_us();
    if (g->fd < 0) {
        name_guest(g);
    }
    if (g->began_us == 0) {
        g->began_us = g->heard_us;
    }
    return g->heard_us - g->began_us > REQUEST_US;
}

static void end_stream_of(http *h, const struct evhttp_connection *connection);
static void hear_head(guest *g, const struct evbuffer *input, size_t added);

/* A connection has sent something. */
static void on_input(struct evbuffer *input, const struct evbuffer_cb_info *info, void *ctx)
{
    port *p = ctx;
    guest *g = info->n_added > 0 ? find_guest(p->of, input, NULL) : NULL;
    if (!g) {
        return;
    }
    if (g->began_us == 0) {
        g->head_bytes = g->got = 0;
        g->judged = false;
    }
    if (is_rude(g)) {
        end_guest(g);
    }
    hear_head(g, input, info->n_added);
    if (g->connection) {
        end_stream_of(p->of, g->connection); /* nobody would read it there */
    }
}

/* At each connection that is accepted. Who comes when all places are taken waits in the system. */
static struct bufferevent *on_connection(struct event_base *base, void *ctx)
{
    port *p = ctx;
    struct bufferevent *bev = bufferevent_socket_new(base, -1, 0);
    guest *g = bev ? take_place(p, bufferevent_get_input(bev)) : NULL;
    if (g) {
        g->bev = bev;
        evbuffer_add_cb(bufferevent_get_input(bev), on_input, p);
        event_active(p->of->greet, 0, 0);
    }
    make_room(p);
    return bev;
}

/* ---- replies --------------------------------------------------------------------------------- */

static void drop_request(http_request *r)
{
    http_request **link = &r->server->waiting;
    while (*link != r) {
        link = &(*link)->next;
    }
    *link = r->next;
    free(r);
}

static port *port_of(const http_request *r)
{
    return r->second ? &r->server->second : &r->server->first;
}

static wall_request as_wall(const http_request *r)
{
    return (wall_request){.method = *r->method ? r->method : NULL,
                          .uri = evhttp_request_get_uri(r->raw),
                          .headers = evhttp_request_get_input_headers(r->raw)};
}

static void add(const http_request *r, const char *name, const char *value)
{
    evhttp_add_header(evhttp_request_get_output_headers(r->raw), name, value);
}

static void add_policy(const http_request *r)
{
    char text[640];
    wall_request q = as_wall(r);
    const char *host = wall_host(&port_of(r)->wall, &q);
    snprintf(text, sizeof text,
             "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
             "connect-src 'self' http://%s:%u; worker-src 'self'; manifest-src 'self'; "
             "base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
             host ? host : "127.0.0.1", http_stop_port(r->server));
    add(r, "Content-Security-Policy", text);
}

/* What every reply has. */
static void add_headers(const http_request *r)
{
    add(r, "X-Content-Type-Options", "nosniff");
    add(r, "Referrer-Policy", "no-referrer");
    add(r, "X-Frame-Options", "DENY");
    add(r, "Cross-Origin-Opener-Policy", "same-origin");
    /* Chromium takes two ports of an IP address for different sites, and then hides even that an
     * answer came; what a no-cors request sees of it is nothing but that. */
    add(r, "Cross-Origin-Resource-Policy", r->second ? "cross-origin" : "same-origin");
}

static void send_reply(http_request *r, int status, const void *bytes, size_t size)
{
    struct evbuffer *body = evbuffer_new();
    if (size && (!body || evbuffer_add(body, bytes, size) != 0)) {
        status = status < 400 ? 503 : status; /* what was done is done, but cannot be told */
    }
    evhttp_send_reply(r->raw, status, head_reason(status), body);
    if (body) {
        evbuffer_free(body);
    }
    drop_request(r);
}

void http_reply_text(http_request *r, int status, const char *text, size_t size)
{
    add_headers(r);
    add(r, "Cache-Control", "no-store");
    if (text) {
        add(r, "Content-Type", "application/json");
    }
    send_reply(r, text ? status : 503, text, size);
}

void http_reply_json(http_request *r, int status, json_t *body)
{
    heap text = {0};
    heap_json(&text, body);
    http_reply_text(r, status, text.bytes, text.size);
    free(text.bytes);
}

void http_refuse(http_request *r, int status, const char *code, const char *format, ...)
{
    char text[512];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    http_reply_json(r, status, json_pack("{s:{s:s,s:s}}", "error", "code", code, "message", text));
}

void http_reply_empty(http_request *r)
{
    add_headers(r);
    add(r, "Cache-Control", "no-store");
    send_reply(r, 204, NULL, 0);
}

void http_reply_content(http_request *r, const http_content *content)
{
    const char *known = http_header(r, "If-None-Match");
    add_headers(r);
    add(r, "Cache-Control", content->lasts ? "max-age=31536000, immutable" : "no-cache");
    if (content->page) {
        add_policy(r);
    }
    if (content->etag) {
        add(r, "ETag", content->etag);
    }
    if (content->etag && known && strstr(known, content->etag)) {
        send_reply(r, 304, NULL, 0);
        return;
    }
    if (content->early && *content->early) {
        add(r, "Link", content->early);
    }
    add(r, "Content-Type", content->type);
    add(r, "Vary", "Accept-Encoding");
    if (content->gzip) {
        add(r, "Content-Encoding", "gzip");
    }
    send_reply(r, 200, content->bytes, content->size);
}

/* ---- streams --------------------------------------------------------------------------------- */

static struct evbuffer *waiting_bytes(const stream *s)
{
    return bufferevent_get_output(evhttp_connection_get_bufferevent(s->connection));
}

/* A stream whose connection is gone, by the client or by us. */
static void forget_stream(http *h, const struct evhttp_connection *connection)
{
    for (stream **link = &h->streams; *link; link = &(*link)->next) {
        stream *s = *link;
        if (s->connection == connection) {
            *link = s->next;
            if (!evhttp_request_get_connection(s->raw)) { /* libevent gave it to us */
                evhttp_request_free(s->raw);
            }
            free(s);
            return;
        }
    }
}

/* Of every connection that has made a request. */
static void on_closed(struct evhttp_connection *connection, void *ctx)
{
    http *h = ctx;
    guest *g = find_guest(h, NULL, connection);
    port *p = g ? g->at : NULL;
    if (g) {
        g->at = NULL;
    }
    forget_stream(h, connection);
    if (p) {
        make_room(p);
    }
}

/* Not from within its own callbacks. */
static void end_stream(stream *s)
{
    s->ends = true;
    event_active(s->of->reap, 0, 0);
}

static void end_stream_of(http *h, const struct evhttp_connection *connection)
{
    for (stream *s = h->streams; s; s = s->next) {
        if (s->connection == connection) {
            end_stream(s);
        }
    }
}

static void reap_streams(http *h)
{
    stream *s = h->streams;
    while (s) {
        stream *next = s->next;
        if (s->ends) {
            evhttp_connection_free(s->connection); /* which calls on_closed() */
        }
        s = next;
    }
}

static void on_reap(evutil_socket_t fd, short what, void *ctx)
{
    (void)fd;
    (void)what;
    reap_streams(ctx);
}

static int streams_of(const http *h, const char *address)
{
    int n = 0;
    for (const stream *s = h->streams; s; s = s->next) {
        n += !address || strcmp(s->address, address) == 0;
    }
    return n;
}

int http_streams(const http *server)
{
    return streams_of(server, NULL);
}

static void send_chunk(stream *s, const char *text, size_t size)
{
    struct evbuffer *chunk = evbuffer_new();
    if (chunk && evbuffer_add(chunk, text, size) == 0) {
        evhttp_send_reply_chunk(s->raw, chunk);
    } else {
        end_stream(s); /* its page asks for another one, which misses nothing */
    }
    if (chunk) {
        evbuffer_free(chunk);
    }
}

void http_reply_stream(http_request *r, const char *first)
{
    http *h = r->server;
    struct evhttp_connection *connection = evhttp_request_get_connection(r->raw);
    stream *s = connection ? calloc(1, sizeof *s) : NULL;
    if (!s) {
        http_refuse(r, 503, "nomem", "no memory for a stream");
        return;
    }
    struct bufferevent *bev = evhttp_connection_get_bufferevent(connection);
    net_peer(bufferevent_getfd(bev), s->address, sizeof s->address);
    if (http_streams(h) >= HTTP_STREAMS_MAX ||
        (*s->address && streams_of(h, s->address) >= HTTP_ADDRESS_STREAMS_MAX)) {
        free(s);
        http_refuse(r, 503, "too_many", "too many streams are open");
        return;
    }
    s->of = h;
    s->raw = r->raw;
    s->connection = connection;
    s->next = h->streams;
    h->streams = s;
    add_headers(r);
    add(r, "Cache-Control", "no-store");
    add(r, "Content-Type", "text/event-stream");
    net_keep_little(bufferevent_getfd(bev), SEND_BYTES); /* what waits there is the past */
    evhttp_send_reply_start(r->raw, 200, NULL);
    if (evbuffer_get_length(bufferevent_get_input(bev)) > 0) { /* it came with the request */
        end_stream(s);
    }
    send_chunk(s, first, strlen(first));
    drop_request(r);
}

void http_send(http *server, const char *text, size_t size, bool may_miss)
{
    int64_t now_us = grobo_now_us();
    for (stream *s = server->streams; s; s = s->next) {
        size_t waits = evbuffer_get_length(waiting_bytes(s));
        if (waits <= (may_miss ? SKIP_BYTES : EVENT_BYTES)) {
            send_chunk(s, text, size);
        }
        if (waits <= SKIP_BYTES) {
            s->behind_us = 0;
        } else if (s->behind_us == 0) {
            s->behind_us = now_us;
        } else if (now_us - s->behind_us > DROP_US) {
            end_stream(s);
        }
    }
}

/* ---- requests -------------------------------------------------------------------------------- */

const char *http_header(const http_request *r, const char *name)
{
    return evhttp_find_header(evhttp_request_get_input_headers(r->raw), name);
}

const char *http_body(const http_request *r, size_t *size)
{
    struct evbuffer *body = evhttp_request_get_input_buffer(r->raw);
    *size = evbuffer_get_length(body);
    return *size ? (const char *)evbuffer_pullup(body, -1) : "";
}

static json_t *read_object(http_request *r)
{
    size_t size;
    json_error_t error;
    const char *text = http_body(r, &size);
    json_t *body = size ? json_loadb(text, size, JSON_REJECT_DUPLICATES, &error) : json_object();
    if (!json_is_object(body)) {
        json_decref(body);
        return NULL;
    }
    return body;
}

json_t *http_object(http_request *r)
{
    json_t *body = read_object(r);
    if (!body) {
        http_refuse(r, 400, "syntax", "the body is no JSON object");
    }
    return body;
}

json_t *http_object_if_any(http_request *r)
{
    size_t size;
    http_body(r, &size);
    return size <= HTTP_BODY_BYTES ? read_object(r) : NULL;
}

wall_answer http_check_token(const http_request *r, const char *token)
{
    return wall_check_token(&port_of(r)->wall, token);
}

/* One that changes something, and is one too many in this second? */
static bool is_flood(http *h)
{
    int64_t now_us = grobo_now_us();
    if (now_us - h->second_us >= 1000000) {
        h->second_us = now_us;
        h->changes = 0;
    }
    return ++h->changes > HTTP_CHANGES_PER_S;
}

static void refuse(http_request *r, wall_answer no)
{
    http_refuse(r, no.status, no.code, "%s", no.message);
}

/* What is wrong with it by where it comes from, its path and what it may. */
static wall_answer judge(http_request *r, wall_rule *rule)
{
    const wall *w = &port_of(r)->wall;
    wall_request q = as_wall(r);
    wall_answer no = wall_check_source(w, &q);
    if (!no.status && (!head_split(q.uri, r->path, r->query) ||
                       !r->server->config.rule(r->server->config.ctx, r, rule))) {
        no = (wall_answer){404, "notfound", "there is no such path"};
    }
    return no.status ? no : wall_check_right(w, &q, *rule);
}

/* By how much there is of it. */
static wall_answer judge_amount(http_request *r, wall_rule rule)
{
    size_t size;
    http_body(r, &size);
    if (size > HTTP_BODY_BYTES && rule != WALL_SAVE && rule != WALL_DRAFT && rule != WALL_STOP) {
        return (wall_answer){413, "too_large", "the body is larger than 64 kB"};
    }
    if ((rule == WALL_ACT || rule == WALL_SAVE || rule == WALL_DRAFT) && is_flood(r->server)) {
        return (wall_answer){429, "too_many", "more than 100 requests a second"};
    }
    return (wall_answer){0};
}

/* ---- a stop before its body ------------------------------------------------------------------ */

/* A stop that comes from where it may come. */
static bool may_stop(http_request *r, const char *uri, struct evkeyvalq *headers)
{
    const wall *w = &port_of(r)->wall;
    wall_request q = {.method = "POST", .uri = uri, .headers = headers};
    wall_rule rule = WALL_PAGE;
    return wall_check_source(w, &q).status == 0 && head_split(uri, r->path, r->query) &&
           r->server->config.rule(r->server->config.ctx, r, &rule) && rule == WALL_STOP &&
           (!w->open ||
            wall_check_token(w, evhttp_find_header(headers, "X-Grobo-Token")).status == 0);
}

static void judge_head(guest *g, char *text, size_t body_bytes)
{
    http *h = g->at->of;
    struct evkeyvalq headers = {.tqh_first = NULL};
    http_request r = {.server = h, .second = g->at == &h->second, .method = "POST"};
    char *uri = NULL;
    headers.tqh_last = &headers.tqh_first;
    if (head_read(text, &uri, &headers) && !head_has_body(&headers, body_bytes) &&
        may_stop(&r, uri, &headers)) {
        h->config.early(h->config.ctx, &r);
    }
    evhttp_clear_headers(&headers);
}

/*
 * Has what came of a request beside libevent, which hands over nothing before the body is there and
 * refuses what it cannot read. A stop needs no body.
 */
static void hear_head(guest *g, const struct evbuffer *input, size_t added)
{
    http *h = g->at->of;
    char *text = h->heads[g - h->guests];
    size_t take = HTTP_HEADER_BYTES - g->head_bytes, length = evbuffer_get_length(input);
    struct evbuffer_ptr at;
    g->got += added;
    take = take < added ? take : added;
    if (g->judged || !h->config.early || added > length ||
        evbuffer_ptr_set((struct evbuffer *)(uintptr_t)input, &at, length - added,
                         EVBUFFER_PTR_SET) < 0 ||
        evbuffer_copyout_from((struct evbuffer *)(uintptr_t)input, &at, text + g->head_bytes,
                              take) < 0) {
        return;
    }
    g->head_bytes += take;
    text[g->head_bytes] = '\0';
    size_t size = head_end(text);
    g->judged = size > 0 || g->head_bytes == HTTP_HEADER_BYTES;
    if (size > 0) {
        judge_head(g, text, g->got - size);
    }
}

/* ---- whole requests -------------------------------------------------------------------------- */

static void serve_or_refuse(http_request *r)
{
    http *h = r->server;
    wall_rule rule = WALL_PAGE;
    wall_answer no = judge(r, &rule);
    if (!no.status) {
        no = judge_amount(r, rule);
    }
    if (no.status == 401 && h->config.wrong_us > 0) { /* who guesses has to wait */
        r->refused_us = grobo_now_us();
        r->refusal = no;
    } else if (no.status) {
        refuse(r, no);
    } else {
        h->config.serve(h->config.ctx, r);
    }
}

/* The connection has a whole request; from now on libevent tells when it ends. */
static void know_guest(port *p, struct evhttp_connection *connection)
{
    const struct evbuffer *input =
        bufferevent_get_input(evhttp_connection_get_bufferevent(connection));
    guest *g = find_guest(p->of, input, NULL);
    if (g) {
        g->connection = connection;
        g->began_us = 0;
    }
    evhttp_connection_set_closecb(connection, on_closed, p->of);
}

static void on_request(struct evhttp_request *raw, void *ctx)
{
    port *p = ctx;
    know_guest(p, evhttp_request_get_connection(raw));
    http_request *r = calloc(1, sizeof *r);
    if (!r) {
        evhttp_send_reply(raw, 503, NULL, NULL);
        return;
    }
    r->server = p->of;
    r->raw = raw;
    r->second = p == &p->of->second;
    r->next = p->of->waiting;
    p->of->waiting = r;
    snprintf(r->method, sizeof r->method, "%s", head_method((int)evhttp_request_get_command(raw)));
    serve_or_refuse(r);
}

/* ---- the whole of it ------------------------------------------------------------------------- */

/* Tells those whose token was wrong. */
static void answer_late(http *h)
{
    int64_t now_us = grobo_now_us();
    http_request *r = h->waiting;
    while (r) {
        http_request *next = r->next;
        if (r->refused_us && now_us - r->refused_us > h->config.wrong_us) {
            refuse(r, r->refusal);
        }
        r = next;
    }
}

static void on_sweep(evutil_socket_t fd, short what, void *ctx)
{
    (void)fd;
    (void)what;
    answer_late(ctx);
    sweep_guests(ctx);
}

static bool listen_at(port *p, const char *address, uint16_t number)
{
    struct evhttp_bound_socket *bound = evhttp_bind_socket_with_handle(p->server, address, number);
    if (!bound) {
        return false;
    }
    p->wall.port = net_port(evhttp_bound_socket_get_fd(bound));
    p->listeners[p->n_listeners++] = evhttp_bound_socket_get_listener(bound);
    return true;
}

static bool open_port(http *h, port *p, uint16_t number)
{
    p->of = h;
    p->server = evhttp_new(h->config.base);
    if (!p->server) {
        return false;
    }
    evhttp_set_bevcb(p->server, on_connection, p);
    evhttp_set_gencb(p->server, on_request, p);
    evhttp_set_allowed_methods(p->server, 0xffff); /* the wall has its own answer to others */
    evhttp_set_max_headers_size(p->server, HTTP_HEADER_BYTES);
    evhttp_set_max_body_size(p->server, p == &h->first ? HTTP_UPLOAD_BYTES : HTTP_BODY_BYTES);
    evhttp_set_timeout(p->server, IDLE_S);
    evhttp_set_default_content_type(p->server, NULL);
    if (h->config.address) {
        return listen_at(p, h->config.address, number);
    }
    bool open = listen_at(p, "127.0.0.1", number);
    if (open) {
        (void)listen_at(p, "::1", p->wall.port); /* where there is IPv6 */
    }
    return open;
}

/* The address where it listens as a link has it; NULL: loopback or every one. */
static const char *own_address(const http *h, char text[WALL_NAME_BYTES])
{
    const char *address = h->config.address;
    if (!address || address[strspn(address, "0.:")] == '\0') {
        return NULL;
    }
    bool six = strchr(address, ':') != NULL;
    snprintf(text, WALL_NAME_BYTES, "%s%s%s", six ? "[" : "", address, six ? "]" : "");
    return text;
}

static void set_walls(http *h)
{
    char text[WALL_NAME_BYTES];
    const char *address = own_address(h, text), *name = h->config.name ? h->config.name : address;
    const char *names[WALL_HOSTS] = {name ? name : "127.0.0.1", "127.0.0.1", "[::1]", "localhost",
                                     address};
    wall *w = &h->first.wall;
    w->open = h->config.address && !net_is_loopback(h->config.address);
    w->page_port = w->port;
    for (int i = 0; i < WALL_HOSTS && names[i]; i++) {
        snprintf(w->hosts[w->n_hosts++], WALL_NAME_BYTES, "%s", names[i]);
    }
    if (h->config.token) {
        snprintf(w->token, sizeof w->token, "%s", h->config.token);
    } else {
        wall_make_secret(w->token);
    }
    uint16_t number = h->second.wall.port;
    h->second.wall = *w;
    h->second.wall.port = number;
}

int http_new(const http_config *config, http **server, const char **complaint)
{
    const struct timeval period = {0, SWEEP_US};
    http *h = calloc(1, sizeof *h);
    *complaint = "no memory";
    if (!h) {
        return GROBO_ERR_NOMEM;
    }
    h->config = *config;
    h->sweep = event_new(config->base, -1, EV_PERSIST, on_sweep, h);
    h->reap = event_new(config->base, -1, 0, on_reap, h);
    h->greet = event_new(config->base, -1, 0, on_greet, h);
    if (!h->sweep || !h->reap || !h->greet || event_add(h->sweep, &period) != 0) {
        http_free(h);
        return GROBO_ERR_NOMEM;
    }
    *complaint = config->address ? "the port is in use, or --listen is no address of this machine"
                                 : "the port is in use, or is not ours; --port chooses another";
    if (!open_port(h, &h->first, config->port) ||
        !open_port(h, &h->second, config->port ? (uint16_t)(config->port + 1) : 0)) {
        http_free(h);
        return GROBO_ERR_BUSY;
    }
    set_walls(h);
    *server = h;
    return GROBO_OK;
}

void http_free(http *server)
{
    if (!server) {
        return;
    }
    server->first.n_listeners = server->second.n_listeners = 0; /* they go before the connections */
    for (stream *s = server->streams; s; s = s->next) {
        s->ends = true;
    }
    reap_streams(server);
    if (server->first.server) {
        evhttp_free(server->first.server);
    }
    if (server->second.server) {
        evhttp_free(server->second.server);
    }
    while (server->waiting) {
        drop_request(server->waiting);
    }
    if (server->sweep) {
        event_free(server->sweep);
    }
    if (server->reap) {
        event_free(server->reap);
    }
    if (server->greet) {
        event_free(server->greet);
    }
    free(server);
}

const char *http_host(const http *server)
{
    return server->first.wall.hosts[0];
}

uint16_t http_port(const http *server)
{
    return server->first.wall.port;
}

uint16_t http_stop_port(const http *server)
{
    return server->second.wall.port;
}

const char *http_token(const http *server)
{
    return server->first.wall.token;
}

bool http_is_open(const http *server)
{
    return server->first.wall.open;
}
