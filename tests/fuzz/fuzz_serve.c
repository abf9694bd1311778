/* SPDX-License-Identifier: MIT */
/*
 * Any bytes from a client of `serve`, over a connection of this machine: the request is refused or
 * answered once, what a handler sees is within its bounds, and the connection ends. Where the bytes
 * say PORT! there stands the number of the port, so that a request can pass the access rules.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include <event2/buffer.h>
#include <event2/bufferevent.h>
#include <event2/event.h>

#include <grobo/core/port.h>

#include "tests/fuzz/target.h"
#include "tests/support/tables.h"
#include "tools/grctl/web/edit.h"
#include "tools/grctl/web/http.h"
#include "tools/grctl/web/library.h"

static struct event_base *base;
static grobo_motion *drawn; /* what keys may be taken from */
static http *server;
static bool closed;

static bool rule_of(void *ctx, const http_request *r, access_rule *rule)
{
    static const char *const paths[] = {"/", "/read", "/stop", "/plain", "/act", "/save", "/draft"};
    (void)ctx;
    MUST(r->path[0] == '/' && strlen(r->path) < HTTP_PATH_BYTES);
    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++) {
        if (strcmp(r->path, paths[i]) == 0) {
            *rule = (access_rule)i;
            return true;
        }
    }
    *rule = ACCESS_READ;
    return strcmp(r->path, "/stream") == 0;
}

static grobo_motion *edited(const json_t *body, const grobo_motion *from)
{
    edit_result made = {.motion = NULL};
    char *bytes = NULL;
    size_t size;
    if (edit_apply(body, &grobo_i_gr001_model, from, GROBO_FORMAT_PSEQ, &made) < 0) {
        return NULL;
    }
    MUST(grobo_motion_size(made.motion) == json_array_size(json_object_get(body, "keys")));
    if (edit_write(made.motion, GROBO_FORMAT_PSEQ, &grobo_i_gr001_model, NULL, &bytes, &size) ==
        0) {
        free(bytes);
    }
    return made.motion;
}

/* What passed the access rules: as much as the interface reads of any body. */
static void answer(void *ctx, http_request *r)
{
    size_t size;
    const char *text = http_body(r, &size);
    (void)ctx;
    MUST(strcmp(http_header(r, "Host"), "evil.example") != 0);
    MUST(size <= HTTP_UPLOAD_BYTES);
    (void)library_is_name(r->path + 1);
    if (strcmp(r->path, "/stream") == 0) {
        http_reply_stream(r, ": hello\n\n");
        http_send(server, "event: state\ndata: 1\n\n", 22, true);
        return;
    }
    json_t *body = json_loadb(text, size, JSON_REJECT_DUPLICATES, NULL);
    grobo_motion_free(edited(body, NULL));
    grobo_motion_free(edited(body, drawn));
    http_reply_json(r, 200, json_pack("{s:b}", "read", body != NULL));
    json_decref(body);
}

/* A stop whose body has not come. */
static void stop_early(void *ctx, const http_request *r)
{
    (void)ctx;
    MUST(strcmp(r->path, "/stop") == 0 && strcmp(r->method, "POST") == 0);
    http_send(server, "event: stop\ndata: 1\n\n", 21, false);
}

static void start(void)
{
    const char *complaint;
    http_config config = {.token = "0123456789abcdef", .rule = rule_of, .serve = answer};
    config.early = stop_early;
    config.base = base = event_base_new();
    MUST(base && http_new(&config, &server, &complaint) == GROBO_OK);
    json_t *keys =
        json_pack("{s:[{s:i,s:{s:i},s:[{s:s,s:[i,i,f],s:b},{s:s,s:[i,i,i]}]},{s:i,s:s}]}", "keys",
                  "time_ms", 0, "angle_deg", "CHEST_P", -5, "links", "link", "WAIST", "p_m", 0, 0,
                  0.2, "base", 1, "link", "R_ANKLE_R", "p_m", 0, 0, 0, "time_ms", 500, "name", "b");
    drawn = edited(keys, NULL);
    json_decref(keys);
    MUST(drawn);
}

/* The bytes with the port in its places. */
static void put(struct evbuffer *to, const uint8_t *data, size_t size)
{
    char port[8];
    int digits = snprintf(port, sizeof port, "%u", http_port(server));
    for (size_t i = 0; i < size; i++) {
        if (size - i >= 5 && memcmp(data + i, "PORT!", 5) == 0) {
            evbuffer_add(to, port, (size_t)digits);
            i += 4;
        } else {
            evbuffer_add(to, data + i, 1);
        }
    }
}

static void on_written(struct bufferevent *bev, void *ctx)
{
    (void)ctx;
    if (evbuffer_get_length(bufferevent_get_output(bev)) == 0) {
        shutdown(bufferevent_getfd(bev), 1); /* nothing more comes */
    }
}

static void on_read(struct bufferevent *bev, void *ctx)
{
    struct evbuffer *input = bufferevent_get_input(bev);
    (void)ctx;
    evbuffer_drain(input, evbuffer_get_length(input));
}

static void on_event(struct bufferevent *bev, short what, void *ctx)
{
    if (what & BEV_EVENT_CONNECTED) {
        on_written(bev, ctx); /* there may be nothing to write */
    }
    closed |= (what & (BEV_EVENT_EOF | BEV_EVENT_ERROR)) != 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct sockaddr_storage at;
    int at_size = sizeof at;
    char address[32];
    if (!base) {
        start();
    }
    snprintf(address, sizeof address, "127.0.0.1:%u", http_port(server));
    MUST(evutil_parse_sockaddr_port(address, (struct sockaddr *)&at, &at_size) == 0);
    struct bufferevent *client = bufferevent_socket_new(base, -1, BEV_OPT_CLOSE_ON_FREE);
    MUST(client);
    bufferevent_setcb(client, on_read, on_written, on_event, NULL);
    bufferevent_enable(client, EV_READ | EV_WRITE);
    put(bufferevent_get_output(client), data, size);
    MUST(bufferevent_socket_connect(client, (struct sockaddr *)&at, at_size) == 0);
    closed = false;
    int64_t until_us = grobo_now_us() + 10000000; /* who says nothing is dropped before */
    while (!closed && grobo_now_us() < until_us) {
        event_base_loop(base, EVLOOP_ONCE);
    }
    MUST(closed);
    bufferevent_free(client);
    event_base_loop(base, EVLOOP_NONBLOCK);
    return 0;
}
