/* SPDX-License-Identifier: MIT */
/* Streams of server-sent events: what is sent to all, and who lags behind. */
#include <stdlib.h>
#include <string.h>

#include <event2/buffer.h>
#include <event2/bufferevent.h>
#include <event2/event.h>
#include <event2/http.h>
#include <event2/http_struct.h>

#include <grobo/core/port.h>

#include "tools/grctl/os/net.h"
#include "tools/grctl/web/http_own.h"

enum {
    SEND_BYTES = 32768,  /* of the system for a stream: what a client may lag behind unseen */
    SKIP_BYTES = 16384,  /* waiting for a stream's client: it misses the next state */
    EVENT_BYTES = 65536, /* and the next event */
    DROP_US = 3000000    /* so long without reading */
};

static struct evbuffer *waiting_bytes(const stream *s)
{
    return bufferevent_get_output(evhttp_connection_get_bufferevent(s->connection));
}

/* A stream whose connection is gone, by the client or by us. */
void streams_forget(http *h, const struct evhttp_connection *connection)
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

/* Not from within its own callbacks. */
static void end_stream(stream *s)
{
    s->ends = true;
    event_active(s->of->reap, 0, 0);
}

void streams_end_of(http *h, const struct evhttp_connection *connection)
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

void streams_on_reap(evutil_socket_t fd, short what, void *ctx)
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
    http_add_headers(r);
    http_add(r, "Cache-Control", "no-store");
    http_add(r, "Content-Type", "text/event-stream");
    net_keep_little(bufferevent_getfd(bev), SEND_BYTES); /* what waits there is the past */
    evhttp_send_reply_start(r->raw, 200, NULL);
    if (evbuffer_get_length(bufferevent_get_input(bev)) > 0) { /* it came with the request */
        end_stream(s);
    }
    send_chunk(s, first, strlen(first));
    http_drop_request(r);
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

void streams_free(http *h)
{
    for (stream *s = h->streams; s; s = s->next) {
        s->ends = true;
    }
    reap_streams(h);
}
