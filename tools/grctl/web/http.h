/* SPDX-License-Identifier: MIT */
/*
 * The HTTP side of `serve`, which knows nothing of robots: listeners, limits, replies, streams. All
 * of it belongs to the thread of the loop, and nothing in it waits.
 */
#ifndef GRCTL_WEB_HTTP_H
#define GRCTL_WEB_HTTP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <jansson.h>

#include "tools/grctl/web/access.h"

struct event_base;
struct evhttp_request;

enum {
    HTTP_CONNECTIONS_MAX = 64,
    HTTP_ADDRESS_CONNECTIONS_MAX = 16, /* of one address beyond loopback */
    HTTP_STREAMS_MAX = 32,
    HTTP_ADDRESS_STREAMS_MAX = 8, /* of one address beyond loopback */
    HTTP_HEADER_BYTES = 8 * 1024,
    HTTP_BODY_BYTES = 64 * 1024,
    HTTP_UPLOAD_BYTES = 1024 * 1024,
    HTTP_CHANGES_PER_S = 100,
    HTTP_PATH_BYTES = 512
};

typedef struct http http;

/* A request on its way to its one reply; the reply frees it. */
typedef struct http_request {
    http *server;
    struct evhttp_request *raw;
    struct http_request *next;  /* of those that wait for their reply */
    bool second;                /* it came to the second port */
    char method[8];             /* "GET", "POST", "PUT", or "" */
    char path[HTTP_PATH_BYTES]; /* decoded, without query */
    char query[HTTP_PATH_BYTES];
    /* private */
    int64_t refused_us; /* 0: it is not refused */
    access_answer refusal;
} http_request;

/* What a path is, for the access rules: false where there is no such path. Called before
 * http_serve_fn. */
typedef bool (*http_rule_fn)(void *ctx, const http_request *r, access_rule *rule);
/* Answers it by one of the replies, now or later. */
typedef void (*http_serve_fn)(void *ctx, http_request *r);
/*
 * A stop whose head alone came, and which may stop: method, path and second are known. Its body may
 * never come, or be refused; where it comes, http_serve_fn gets the same request.
 */
typedef void (*http_early_fn)(void *ctx, const http_request *r);

typedef struct http_config {
    struct event_base *base;
    const char *address; /* NULL: loopback, of IPv4 and where there is one IPv6 */
    uint16_t port;       /* 0: any two that are free; else the second is port + 1 */
    const char *name;    /* what else it may be called, or NULL */
    const char *token;   /* NULL: one is made */
    int64_t wrong_us;    /* who brings a wrong token waits so long for the answer */
    http_rule_fn rule;
    http_serve_fn serve;
    http_early_fn early; /* or NULL */
    void *ctx;
} http_config;

/* Returns 0, or an error of the library; then *complaint says why. */
int http_new(const http_config *config, http **server, const char **complaint);
/* Ends all connections; requests that wait get no reply. NULL is nothing. */
void http_free(http *server);

/* What a link to it has as its host. */
const char *http_host(const http *server);
uint16_t http_port(const http *server);
uint16_t http_stop_port(const http *server);
const char *http_token(const http *server);
bool http_is_open(const http *server);
int http_streams(const http *server);
/* Somebody is connected, whether a request came or not. */
bool http_has_clients(const http *server);

/* ---- what a request has ---------------------------------------------------------------------- */

/* A header, or NULL. */
const char *http_header(const http_request *r, const char *name);
/* The body; valid until the reply. */
const char *http_body(const http_request *r, size_t *size);
/* The same as a JSON object, to be released; NULL: it is none, and was refused. */
json_t *http_object(http_request *r);
/* The same of a request that needs none: NULL where it cannot be read. */
json_t *http_object_if_any(http_request *r);
/* The access rules' judgement of a token that stood in the body. */
access_answer http_check_token(const http_request *r, const char *token);

/* ---- replies: each ends the request ---------------------------------------------------------- */

/* Takes the reference. */
void http_reply_json(http_request *r, int status, json_t *body);
/* The same of JSON that is text already; NULL: there was no memory for it. */
void http_reply_text(http_request *r, int status, const char *text, size_t size);
/* {"error": {"code": ..., "message": ...}}. */
void http_refuse(http_request *r, int status, const char *code, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* No body. */
void http_reply_empty(http_request *r);

typedef struct http_content {
    const char *type;
    const void *bytes;
    size_t size;
    const char *etag;  /* or NULL; with its quotes */
    const char *early; /* or NULL, or "": a Link header, what to ask for along with it */
    bool gzip;         /* the bytes are compressed */
    bool lasts;        /* what this path names never changes */
    bool page;         /* of the page: a policy is sent along */
} http_content;
/* 200, or 304 where the client has that. */
void http_reply_content(http_request *r, const http_content *content);

/* Makes a stream of server-sent events of it, which gets `first` and then what is sent to all. */
void http_reply_stream(http_request *r, const char *first);

/*
 * A text of server-sent events for all streams. Who does not read misses those that may be missed
 * (a state), and is dropped where that goes on.
 */
void http_send(http *server, const char *text, size_t size, bool may_miss);

#endif
