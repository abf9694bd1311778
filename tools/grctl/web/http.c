/* SPDX-License-Identifier: MIT */
/* The HTTP side of `serve`: its two ports, requests as they come whole, replies. */
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

#include "tools/grctl/os/net.h"
#include "tools/grctl/web/head.h"
#include "tools/grctl/web/http_own.h"

enum {
    IDLE_S = 5, /* a silent connection, or half a request */
};

/* ---- replies --------------------------------------------------------------------------------- */

static port *port_of(const http_request *r)
{
    return r->second ? &r->server->second : &r->server->first;
}

static access_request as_wall(const http_request *r)
{
    return (access_request){.method = *r->method ? r->method : NULL,
                            .uri = evhttp_request_get_uri(r->raw),
                            .headers = evhttp_request_get_input_headers(r->raw)};
}

static void add_policy(const http_request *r)
{
    char text[640];
    access_request q = as_wall(r);
    const char *host = access_host(&port_of(r)->access, &q);
    snprintf(text, sizeof text,
             "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
             "connect-src 'self' http://%s:%u; worker-src 'self'; manifest-src 'self'; "
             "base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
             host ? host : "127.0.0.1", http_stop_port(r->server));
    http_add(r, "Content-Security-Policy", text);
}

void http_reply_content(http_request *r, const http_content *content)
{
    const char *known = http_header(r, "If-None-Match");
    http_add_headers(r);
    http_add(r, "Cache-Control", content->lasts ? "max-age=31536000, immutable" : "no-cache");
    if (content->page) {
        add_policy(r);
    }
    if (content->etag) {
        http_add(r, "ETag", content->etag);
    }
    if (content->etag && known && strstr(known, content->etag)) {
        http_answer(r, 304, NULL, 0);
        return;
    }
    if (content->early && *content->early) {
        http_add(r, "Link", content->early);
    }
    http_add(r, "Content-Type", content->type);
    http_add(r, "Vary", "Accept-Encoding");
    if (content->gzip) {
        http_add(r, "Content-Encoding", "gzip");
    }
    http_answer(r, 200, content->bytes, content->size);
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

access_answer http_check_token(const http_request *r, const char *token)
{
    return access_check_token(&port_of(r)->access, token);
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

/* The methods that a path has, as the header Allow lists them. */
static void add_methods(const http_request *r)
{
    static const char *const methods[] = {"GET", "POST", "PUT"};
    char text[32] = "";
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        http_request other = *r;
        access_rule rule = ACCESS_PAGE;
        snprintf(other.method, sizeof other.method, "%s", methods[i]);
        if (r->server->config.rule(r->server->config.ctx, &other, &rule) &&
            strcmp(access_method(rule), methods[i]) == 0) {
            size_t n = strlen(text);
            snprintf(text + n, sizeof text - n, "%s%s", n ? ", " : "", methods[i]);
        }
    }
    http_add(r, "Allow", text);
}

static void refuse(http_request *r, access_answer no)
{
    if (no.status == 405) {
        add_methods(r);
    }
    http_refuse(r, no.status, no.code, "%s", no.message);
}

/* What is wrong with it by where it comes from, its path and what it may. */
static access_answer judge(http_request *r, access_rule *rule)
{
    const access_rules *w = &port_of(r)->access;
    access_request q = as_wall(r);
    access_answer no = head_is_framed(q.headers)
                           ? access_check_source(w, &q)
                           : (access_answer){400, "syntax", "the length of the body is not clear"};
    if (!no.status && (!head_split(q.uri, r->path, r->query) ||
                       !r->server->config.rule(r->server->config.ctx, r, rule))) {
        no = (access_answer){404, "notfound", "there is no such path"};
    }
    return no.status ? no : access_check_right(w, &q, *rule);
}

/* By how much there is of it. */
static access_answer judge_amount(http_request *r, access_rule rule)
{
    size_t size;
    http_body(r, &size);
    if (size > HTTP_BODY_BYTES && rule != ACCESS_SAVE && rule != ACCESS_DRAFT &&
        rule != ACCESS_STOP) {
        return (access_answer){413, "too_large", "the body is larger than 64 kB"};
    }
    if ((rule == ACCESS_ACT || rule == ACCESS_SAVE || rule == ACCESS_DRAFT) &&
        is_flood(r->server)) {
        return (access_answer){429, "too_many", "more than 100 requests a second"};
    }
    return (access_answer){0};
}

/* ---- whole requests -------------------------------------------------------------------------- */

static void serve_or_refuse(http_request *r)
{
    http *h = r->server;
    access_rule rule = ACCESS_PAGE;
    access_answer no = judge(r, &rule);
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

static void on_request(struct evhttp_request *raw, void *ctx)
{
    port *p = ctx;
    clients_know(p, evhttp_request_get_connection(raw));
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
    if (!*r->method || !head_is_framed(evhttp_request_get_input_headers(raw))) {
        http_add(r, "Connection", "close"); /* what libevent left of a body is no next request */
    }
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
    http *h = ctx;
    answer_late(h);
    clients_sweep(h);
    if (!clients_are_there(h) && !h->waiting) {
        event_del(h->sweep);
    }
}

bool http_has_clients(const http *server)
{
    return clients_are_there(server);
}

static bool listen_at(port *p, const char *address, uint16_t number)
{
    struct evhttp_bound_socket *bound = evhttp_bind_socket_with_handle(p->server, address, number);
    if (!bound) {
        return false;
    }
    p->access.port = net_port(evhttp_bound_socket_get_fd(bound));
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
    evhttp_set_bevcb(p->server, clients_accept, p);
    evhttp_set_gencb(p->server, on_request, p);
    evhttp_set_allowed_methods(p->server,
                               0xffff); /* the access rules have their own answer to others */
    evhttp_set_max_headers_size(p->server, HTTP_HEADER_BYTES);
    evhttp_set_max_body_size(p->server, (ev_ssize_t)early_body_max(p));
    evhttp_set_timeout(p->server, IDLE_S);
    evhttp_set_default_content_type(p->server, NULL);
    if (h->config.address) {
        return listen_at(p, h->config.address, number);
    }
    bool open = listen_at(p, "127.0.0.1", number);
    if (open) {
        (void)listen_at(p, "::1", p->access.port); /* where there is IPv6 */
    }
    return open;
}

/* The address where it listens as a link has it; NULL: loopback or every one. */
static const char *own_address(const http *h, char text[ACCESS_NAME_BYTES])
{
    const char *address = h->config.address;
    if (!address || address[strspn(address, "0.:")] == '\0') {
        return NULL;
    }
    bool six = strchr(address, ':') != NULL;
    snprintf(text, ACCESS_NAME_BYTES, "%s%s%s", six ? "[" : "", address, six ? "]" : "");
    return text;
}

static void set_walls(http *h)
{
    char text[ACCESS_NAME_BYTES];
    const char *address = own_address(h, text), *name = h->config.name ? h->config.name : address;
    const char *names[ACCESS_HOSTS] = {name ? name : "127.0.0.1", "127.0.0.1", "[::1]", "localhost",
                                       address};
    access_rules *w = &h->first.access;
    w->open = h->config.address && !net_is_loopback(h->config.address);
    w->page_port = w->port;
    for (int i = 0; i < ACCESS_HOSTS && names[i]; i++) {
        snprintf(w->hosts[w->n_hosts++], ACCESS_NAME_BYTES, "%s", names[i]);
    }
    if (h->config.token) {
        snprintf(w->token, sizeof w->token, "%s", h->config.token);
    } else {
        access_make_secret(w->token);
    }
    uint16_t number = h->second.access.port;
    h->second.access = *w;
    h->second.access.port = number;
}

int http_new(const http_config *config, http **server, const char **complaint)
{
    http *h = calloc(1, sizeof *h);
    *complaint = "no memory";
    if (!h) {
        return GROBO_ERR_NOMEM;
    }
    h->config = *config;
    h->hear = early_hear;
    h->sweep = event_new(config->base, -1, EV_PERSIST, on_sweep, h);
    h->reap = event_new(config->base, -1, 0, streams_on_reap, h);
    h->greet = event_new(config->base, -1, 0, clients_name, h);
    if (!h->sweep || !h->reap || !h->greet) {
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
    streams_free(server);
    if (server->first.server) {
        evhttp_free(server->first.server);
    }
    if (server->second.server) {
        evhttp_free(server->second.server);
    }
    while (server->waiting) {
        http_drop_request(server->waiting);
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
    return server->first.access.hosts[0];
}

uint16_t http_port(const http *server)
{
    return server->first.access.port;
}

uint16_t http_stop_port(const http *server)
{
    return server->second.access.port;
}

const char *http_token(const http *server)
{
    return server->first.access.token;
}

bool http_is_open(const http *server)
{
    return server->first.access.open;
}
