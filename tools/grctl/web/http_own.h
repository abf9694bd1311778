/* SPDX-License-Identifier: MIT */
/* What the files of the HTTP side have in common: ports, connections, streams. */
#ifndef GRCTL_WEB_HTTP_OWN_H
#define GRCTL_WEB_HTTP_OWN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <event2/util.h>

#include "tools/grctl/web/http.h"

struct bufferevent;
struct evbuffer;
struct evbuffer_cb_info;
struct event;
struct evconnlistener;
struct evhttp;
struct evhttp_connection;

enum {
    LISTENERS = 2,
    SPARE = 8, /* accepted while others that were ended are going */
    CLIENTS = 2 * (HTTP_CONNECTIONS_MAX + SPARE)
};

/* One of the two ports. */
typedef struct port {
    http *of;
    struct evhttp *server;
    struct evconnlistener *listeners[LISTENERS];
    int n_listeners;
    access_rules access;
} port;

/*
 * A connection. libevent does not tell when one ends that never made a request: such a one is gone
 * when its socket is, or is that of another connection.
 */
typedef struct client {
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
} client;

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
    /* What came of a request: early_hear(), which the connections know by this alone. */
    void (*hear)(client *c, struct evbuffer *input, size_t added);
    port first, second;
    client clients[CLIENTS];
    char heads[CLIENTS][HTTP_HEADER_BYTES + 1]; /* of requests that are not whole */
    stream *streams;
    http_request *waiting;
    struct event *sweep, *reap, *greet; /* sweep: while somebody is connected */
    int64_t second_us;                  /* the second in which changes are counted */
    int changes;
};

/* ---- connections (clients.c) ----------------------------------------------------------------- */

/* At each connection that is accepted, for evhttp_set_bevcb(). Who comes when all places are taken
 * waits in the system. */
struct bufferevent *clients_accept(struct event_base *base, void *port_of_it);
/* An event's callback right behind the accepting of connections: none has been read or freed. */
void clients_name(evutil_socket_t fd, short what, void *server);
/* The connection has a whole request; from now on libevent tells when it ends. */
void clients_know(port *p, struct evhttp_connection *connection);
/* Forgets those that have gone without a word, and makes room. */
void clients_sweep(http *h);
/* Whether there is a connection. */
bool clients_are_there(const http *h);
/* Ends a connection; libevent sees that, and frees it. */
void clients_end(client *c);

/* ---- heads (early.c) ------------------------------------------------------------------------- */

/*
 * Has what came of a request beside libevent, which hands over nothing before the body is there. A
 * stop needs no body: it is carried out. A head that is malformed is refused here, with its
 * connection.
 */
void early_hear(client *c, struct evbuffer *input, size_t added);
/* How large the body of a request to this port may be. */
size_t early_body_max(const port *p);

/* ---- streams (streams.c) --------------------------------------------------------------------- */

/* Ends the stream of a connection: an event's callback does it, not one of the stream's own. */
void streams_end_of(http *h, const struct evhttp_connection *connection);
void streams_on_reap(evutil_socket_t fd, short what, void *server);
/* A stream whose connection is gone, by the client or by us. */
void streams_forget(http *h, const struct evhttp_connection *connection);
/* Ends all. */
void streams_free(http *h);

/* ---- what replies share (reply.c) ------------------------------------------------------------ */

/* The headers that every reply has. */
void http_add_headers(const http_request *r);
void http_add(const http_request *r, const char *name, const char *value);
/* Forgets a request that has its reply. */
void http_drop_request(http_request *r);
/* Sends the reply, its body last; size 0: it has none. The request is gone then. */
void http_answer(http_request *r, int status, const void *bytes, size_t size);

#endif
