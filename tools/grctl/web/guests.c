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

/* Who has made no whole request for so long may have to make room for who comes. */
#define HALF_OPEN_US INT64_C(1000000)

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

void guests_end(guest *g)
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
        guests_end(g);
    }
    open_door(p, served(p) < HTTP_CONNECTIONS_MAX &&
                     guests_of(p, NULL) < HTTP_CONNECTIONS_MAX + SPARE);
}

void guests_sweep(http *h)
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
        guests_end(first ? first : g);
    }
}

/* Right behind the accepting of connections: none of them has been read or freed. */
void guests_name(evutil_socket_t fd, short what, void *ctx)
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
        guests_end(g);
    }
    g->at->of->hear(g, input, info->n_added);
    if (g->connection) {
        streams_end_of(p->of, g->connection); /* nobody would read it there */
    }
}

/* At each connection that is accepted. Who comes when all places are taken waits in the system. */
struct bufferevent *guests_accept(struct event_base *base, void *ctx)
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

/* Of every connection that has made a request. */
static void on_closed(struct evhttp_connection *connection, void *ctx)
{
    http *h = ctx;
    guest *g = find_guest(h, NULL, connection);
    port *p = g ? g->at : NULL;
    if (g) {
        g->at = NULL;
    }
    streams_forget(h, connection);
    if (p) {
        make_room(p);
    }
}

/* The connection has a whole request; from now on libevent tells when it ends. */
void guests_know(port *p, struct evhttp_connection *connection)
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
