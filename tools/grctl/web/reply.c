/* SPDX-License-Identifier: MIT */
/* Replies of the HTTP side of `serve`: what all of them have, JSON, refusals. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <event2/buffer.h>
#include <event2/http.h>
#include <jansson.h>

#include "tools/grctl/cli/heap.h"
#include "tools/grctl/web/head.h"
#include "tools/grctl/web/http_own.h"

void http_drop_request(http_request *r)
{
    http_request **link = &r->server->waiting;
    while (*link != r) {
        link = &(*link)->next;
    }
    *link = r->next;
    free(r);
}

void http_add(const http_request *r, const char *name, const char *value)
{
    evhttp_add_header(evhttp_request_get_output_headers(r->raw), name, value);
}

void http_add_headers(const http_request *r)
{
    http_add(r, "X-Content-Type-Options", "nosniff");
    http_add(r, "Referrer-Policy", "no-referrer");
    http_add(r, "X-Frame-Options", "DENY");
    http_add(r, "Cross-Origin-Opener-Policy", "same-origin");
    /* Chromium takes two ports of an IP address for different sites, and then hides even that an
     * answer came; what a no-cors request sees of it is nothing but that. */
    http_add(r, "Cross-Origin-Resource-Policy", r->second ? "cross-origin" : "same-origin");
}

void http_answer(http_request *r, int status, const void *bytes, size_t size)
{
    struct evbuffer *body = evbuffer_new();
    if (size && (!body || evbuffer_add(body, bytes, size) != 0)) {
        status = status < 400 ? 503 : status; /* what was done is done, but cannot be told */
    }
    evhttp_send_reply(r->raw, status, head_reason(status), body);
    if (body) {
        evbuffer_free(body);
    }
    http_drop_request(r);
}

void http_reply_text(http_request *r, int status, const char *text, size_t size)
{
    http_add_headers(r);
    http_add(r, "Cache-Control", "no-store");
    if (text) {
        http_add(r, "Content-Type", "application/json");
    }
    http_answer(r, text ? status : 503, text, size);
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
    http_add_headers(r);
    http_add(r, "Cache-Control", "no-store");
    http_answer(r, 204, NULL, 0);
}
