/* SPDX-License-Identifier: MIT */
/* The head of a request before its body: a stop is heard, and what is malformed is refused. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <event2/buffer.h>
#include <event2/bufferevent.h>
#include <event2/http.h>
#include <event2/keyvalq_struct.h>
#include <jansson.h>

#include "tools/grctl/cli/heap.h"
#include "tools/grctl/web/head.h"
#include "tools/grctl/web/http_own.h"

/* A stop that comes from where it may come. */
static bool may_stop(const port *p, http_request *r, const char *uri, struct evkeyvalq *headers)
{
    const access_rules *w = &p->access;
    access_request q = {.method = "POST", .uri = uri, .headers = headers};
    access_rule rule = ACCESS_PAGE;
    return access_check_source(w, &q).status == 0 && head_split(uri, r->path, r->query) &&
           r->server->config.rule(r->server->config.ctx, r, &rule) && rule == ACCESS_STOP &&
           (!w->open ||
            access_check_token(w, evhttp_find_header(headers, "X-Grobo-Token")).status == 0);
}

/* Cuts the text to pieces. */
static void hear_stop(const client *c, char *text, size_t body_bytes)
{
    http *h = c->at->of;
    struct evkeyvalq headers = {.tqh_first = NULL};
    http_request r = {.server = h, .second = c->at == &h->second, .method = "POST"};
    char *uri = NULL;
    headers.tqh_last = &headers.tqh_first;
    if (head_read(text, &uri, &headers) && !head_has_body(&headers, body_bytes) &&
        may_stop(c->at, &r, uri, &headers)) {
        h->config.early(h->config.ctx, &r);
    }
    evhttp_clear_headers(&headers);
}

/* Past libevent, which has not seen the head: the reply is the connection's last. */
static void refuse(client *c, struct evbuffer *input, access_answer no)
{
    heap body = {0};
    heap_json(&body, json_pack("{s:{s:s,s:s}}", "error", "code", no.code, "message", no.message));
    struct evbuffer *reply = evbuffer_new();
    bool idle =
        evbuffer_get_length(bufferevent_get_output(c->bev)) == 0; /* no reply is before it */
    if (reply && body.bytes && idle &&
        evbuffer_add_printf(reply,
                            "HTTP/1.1 %d %s\r\nContent-Type: application/json\r\n"
                            "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n"
                            "Connection: close\r\nContent-Length: %zu\r\n\r\n",
                            no.status, head_reason(no.status), body.size) > 0 &&
        evbuffer_add(reply, body.bytes, body.size) == 0) {
        (void)evbuffer_write(reply, c->fd); /* a few hundred bytes: they fit, or nobody reads */
    }
    if (reply) {
        evbuffer_free(reply);
    }
    free(body.bytes);
    evbuffer_drain(input, evbuffer_get_length(input));
    clients_end(c);
}

size_t early_body_max(const port *p)
{
    return p == &p->of->first ? HTTP_UPLOAD_BYTES : HTTP_BODY_BYTES;
}

/* Keeps what came behind what is kept of the head; false: it cannot be had. */
static bool keep(client *c, struct evbuffer *input, size_t added, char *text)
{
    size_t take = HTTP_HEADER_BYTES - c->head_bytes, length = evbuffer_get_length(input);
    struct evbuffer_ptr at;
    take = take < added ? take : added;
    if (added > length || evbuffer_ptr_set(input, &at, length - added, EVBUFFER_PTR_SET) < 0 ||
        evbuffer_copyout_from(input, &at, text + c->head_bytes, take) < 0) {
        return false;
    }
    c->head_bytes += take;
    text[c->head_bytes] = '\0';
    return true;
}

void early_hear(client *c, struct evbuffer *input, size_t added)
{
    http *h = c->at->of;
    char *text = h->heads[c - h->clients];
    c->got += added;
    if (c->judged || !keep(c, input, added, text)) {
        return;
    }
    size_t size = head_end(text);
    bool whole = size > 0;
    c->judged = whole || c->head_bytes == HTTP_HEADER_BYTES || strlen(text) < c->head_bytes;
    if (!c->judged) {
        return;
    }
    access_answer no = head_judge(text, whole ? size : c->head_bytes, early_body_max(c->at));
    if (whole && h->config.early) {
        hear_stop(c, text, c->got - size);
    }
    if (no.status) {
        refuse(c, input, no);
    }
}
