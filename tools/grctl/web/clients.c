/* SPDX-License-Identifier: MIT */
/* The connections of the HTTP side: who has a place, and who makes room for a newcomer. */
#include <string.h>

#include <event2/buffer.h>
#include <event2/bufferevent.h>
#include <event2/event.h>
#include <event2/http.h>
#include <event2/listener.h>

#include <grobo/core/port.h>

#include "tools/grctl/os/net.h"
#include "tools/grctl/web/http_own.h"

/* A whole request comes within this time, however slowly. */
#define REQUEST_US INT64_C(20000000)

/* How often is looked who has gone. */
enum { SWEEP_US = 100000 };

/* Who has made no whole request for so long may have to make room for who comes. */
#define HALF_OPEN_US INT64_C(1000000)

static int clients_of(const port *p, const char *address)
{
    int n = 0;
    for (int i = 0; i < CLIENTS; i++) {
        const client *c = &p->of->clients[i];
        n += c->at == p && (!address || strcmp(c->address, address) == 0);
    }
    return n;
}

static client *find_client(http *h, const struct evbuffer *input,
                           const struct evhttp_connection *connection)
{
    for (int i = 0; i < CLIENTS; i++) {
        client *c = &h->clients[i];
        if (c->at &&
            ((input && c->input == input) || (connection && c->connection == connection))) {
            return c;
        }
    }
    return NULL;
}

static void open_listener(port *p, bool open)
{
    for (int i = 0; i < p->n_listeners; i++) {
        (void)(open ? evconnlistener_enable(p->listeners[i])
                    : evconnlistener_disable(p->listeners[i]));
    }
}

/* A request of it waits for its reply: true where that is a refusal which only lets it wait. */
static bool is_waiting(const client *c, bool *refused)
{
    for (const http_request *r = c->at->of->waiting; r; r = r->next) {
        if (evhttp_request_get_connection(r->raw) == c->connection) {
            *refused = r->refused_us != 0;
            return true;
        }
    }
    return false;
}

static bool is_stream(const client *c)
{
    for (const stream *s = c->at->of->streams; s; s = s->next) {
        if (s->connection == c->connection) {
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
static int spare(const client *c, int64_t now_us)
{
    bool refused = false;
    if (c->ended || c->fd < 0) {
        return STAYS;
    }
    if (!c->connection || c->began_us) {
        int64_t since_us = c->began_us ? c->began_us : c->heard_us;
        return now_us - since_us > HALF_OPEN_US ? WAITS_IN_VAIN : NEW;
    }
    if (is_waiting(c, &refused)) {
        return refused ? WAITS_IN_VAIN : STAYS;
    }
    struct bufferevent *bev = evhttp_connection_get_bufferevent(c->connection);
    bool idle = !is_stream(c) && evbuffer_get_length(bufferevent_get_output(bev)) == 0;
    return idle ? IDLE : STAYS;
}

/* The order in which clients make room: the address that has most, how well, how long. */
static bool goes_before(const client *a, const client *b, int64_t now_us)
{
    int of_a = clients_of(a->at, a->address), of_b = clients_of(b->at, b->address);
    int how_a = spare(a, now_us), how_b = spare(b, now_us);
    int64_t since_a = a->began_us ? a->began_us : a->heard_us;
    int64_t since_b = b->began_us ? b->began_us : b->heard_us;
    return of_a != of_b ? of_a > of_b : how_a != how_b ? how_a > how_b : since_a < since_b;
}

/* The client of a port that makes room first, of one address or of any (NULL). NULL: none can. */
static client *first_to_go(port *p, const char *address)
{
    int64_t now_us = grobo_now_us();
    client *first = NULL;
    for (int i = 0; i < CLIENTS; i++) {
        client *c = &p->of->clients[i];
        bool asked = c->at == p && (!address || strcmp(c->address, address) == 0);
        if (asked && spare(c, now_us) != STAYS && (!first || goes_before(c, first, now_us))) {
            first = c;
        }
    }
    return first;
}

/* Its socket is that of its connection still; one with a whole request says when it ends. */
static bool is_there(const client *c)
{
    char words[sizeof c->words];
    return c->connection || c->fd < 0 ||
           (net_connection(c->fd, words, sizeof words) && strcmp(words, c->words) == 0);
}

void clients_end(client *c)
{
    c->ended = true;
    if (is_there(c)) {
        net_end(c->fd); /* libevent sees that, and frees it */
    }
}

/* Forgets those that have gone without a word. */
static void forget_gone(port *p)
{
    for (int i = 0; i < CLIENTS; i++) {
        client *c = &p->of->clients[i];
        if (c->at == p && !is_there(c)) {
            c->at = NULL;
        }
    }
}

static int served(const port *p)
{
    int n = 0;
    for (int i = 0; i < CLIENTS; i++) {
        n += p->of->clients[i].at == p && !p->of->clients[i].ended;
    }
    return n;
}

/* There is a place for who comes next: nobody who has one without using it keeps it. */
static void make_room(port *p)
{
    client *c;
    if (clients_of(p, NULL) >= HTTP_CONNECTIONS_MAX) {
        forget_gone(p);
    }
    while (served(p) >= HTTP_CONNECTIONS_MAX && (c = first_to_go(p, NULL)) != NULL) {
        clients_end(c);
    }
    open_listener(p, served(p) < HTTP_CONNECTIONS_MAX &&
                         clients_of(p, NULL) < HTTP_CONNECTIONS_MAX + SPARE);
}

bool clients_are_there(const http *h)
{
    for (int i = 0; i < CLIENTS; i++) {
        if (h->clients[i].at) {
            return true;
        }
    }
    return false;
}

void clients_sweep(http *h)
{
    forget_gone(&h->first);
    forget_gone(&h->second);
    make_room(&h->first);
    make_room(&h->second);
}

/* They are looked at from now on, until none is there. */
static void begin_sweeps(http *h)
{
    const struct timeval period = {0, SWEEP_US};
    if (!event_pending(h->sweep, EV_TIMEOUT, NULL)) {
        (void)event_add(h->sweep, &period);
    }
}

static client *take_place(port *p, const struct evbuffer *input)
{
    client *c =
        find_client(p->of, input, NULL); /* of one that has gone: its memory is used again */
    for (int i = 0; !c && i < CLIENTS; i++) {
        c = p->of->clients[i].at ? NULL : &p->of->clients[i];
    }
    if (c) {
        *c = (client){.at = p, .input = input, .fd = -1, .heard_us = grobo_now_us()};
    }
    return c;
}

/* Where it comes from, which is known from the moment after it was accepted. */
static void name_client(client *c)
{
    c->fd = bufferevent_getfd(c->bev);
    if (!net_connection(c->fd, c->words, sizeof c->words)) {
        *c->words = '\0';
    }
    net_peer(c->fd, c->address, sizeof c->address);
    if (*c->address && clients_of(c->at, c->address) > HTTP_ADDRESS_CONNECTIONS_MAX) {
        client *first = first_to_go(c->at, c->address);
        clients_end(first ? first : c);
    }
}

/* Right behind the accepting of connections: none of them has been read or freed. */
void clients_name(evutil_socket_t fd, short what, void *ctx)
{
    http *h = ctx;
    (void)fd;
    (void)what;
    for (int i = 0; i < CLIENTS; i++) {
        if (h->clients[i].at && h->clients[i].fd < 0) {
            name_client(&h->clients[i]);
        }
    }
    make_room(&h->first);
    make_room(&h->second);
}

/* Whose request never gets whole. */
static bool is_rude(client *c)
{
    c->heard_us = grobo_now_us();
    if (c->fd < 0) {
        name_client(c);
    }
    if (c->began_us == 0) {
        c->began_us = c->heard_us;
    }
    return c->heard_us - c->began_us > REQUEST_US;
}

/* A connection has sent something. */
static void on_input(struct evbuffer *input, const struct evbuffer_cb_info *info, void *ctx)
{
    port *p = ctx;
    client *c = info->n_added > 0 ? find_client(p->of, input, NULL) : NULL;
    if (!c) {
        return;
    }
    if (c->began_us == 0) {
        c->head_bytes = c->got = 0;
        c->judged = false;
    }
    if (is_rude(c)) {
        clients_end(c);
    }
    c->at->of->hear(c, input, info->n_added);
    if (c->connection) {
        streams_end_of(p->of, c->connection); /* nobody would read it there */
    }
}

/* At each connection that is accepted. Who comes when all places are taken waits in the system. */
struct bufferevent *clients_accept(struct event_base *base, void *ctx)
{
    port *p = ctx;
    struct bufferevent *bev = bufferevent_socket_new(base, -1, 0);
    client *c = bev ? take_place(p, bufferevent_get_input(bev)) : NULL;
    if (c) {
        c->bev = bev;
        evbuffer_add_cb(bufferevent_get_input(bev), on_input, p);
        event_active(p->of->greet, 0, 0);
        begin_sweeps(p->of);
    }
    make_room(p);
    return bev;
}

/* Of every connection that has made a request. */
static void on_closed(struct evhttp_connection *connection, void *ctx)
{
    http *h = ctx;
    client *c = find_client(h, NULL, connection);
    port *p = c ? c->at : NULL;
    if (c) {
        c->at = NULL;
    }
    streams_forget(h, connection);
    if (p) {
        make_room(p);
    }
}

/* The connection has a whole request; from now on libevent tells when it ends. */
void clients_know(port *p, struct evhttp_connection *connection)
{
    const struct evbuffer *input =
        bufferevent_get_input(evhttp_connection_get_bufferevent(connection));
    client *c = find_client(p->of, input, NULL);
    if (c) {
        c->connection = connection;
        c->began_us = 0;
    }
    evhttp_connection_set_closecb(connection, on_closed, p->of);
}
