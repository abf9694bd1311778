/* SPDX-License-Identifier: MIT */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/port.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/web/events.h"

enum { COMMENT_US = 900000 };

void events_tell(events *e, const char *kind, const char *level, json_t *more, const char *format,
                 ...)
{
    char message[512];
    va_list list;
    va_start(list, format);
    vsnprintf(message, sizeof message, format, list);
    va_end(list);
    json_t *event = json_pack("{s:i,s:I,s:s,s:s,s:o}", "id", ++e->last, "time_ms",
                              (json_int_t)((grobo_now_us() - e->began_us) / 1000), "kind", kind,
                              "level", level, "message", app_json_text(message));
    if (more) {
        json_object_update_missing(event, more);
        json_decref(more);
    }
    char *data = json_dumps(event, JSON_COMPACT | JSON_REAL_PRECISION(12));
    json_decref(event);
    if (!data) {
        return;
    }
    size_t size = strlen(data) + 64;
    char *text = malloc(size);
    if (text) {
        int n = snprintf(text, size, "id: %d\nevent: event\ndata: %s\n\n", e->last, data);
        free(e->text[e->last % EVENTS_KEPT]);
        e->text[e->last % EVENTS_KEPT] = text;
        if (e->to) {
            http_send(e->to, text, (size_t)n, false);
        }
    }
    free(data);
}

/* Those behind an id, to be freed; NULL: no memory. */
static char *since(const events *e, int id)
{
    size_t size = 1;
    int first = id < 0 || id > e->last ? e->last : id;
    if (first < e->last - EVENTS_KEPT) {
        first = e->last - EVENTS_KEPT;
    }
    for (int i = first + 1; i <= e->last; i++) {
        size += e->text[i % EVENTS_KEPT] ? strlen(e->text[i % EVENTS_KEPT]) : 0;
    }
    char *all = malloc(size);
    char *at = all;
    for (int i = first + 1; all && i <= e->last; i++) {
        size_t n = e->text[i % EVENTS_KEPT] ? strlen(e->text[i % EVENTS_KEPT]) : 0;
        memcpy(at, e->text[i % EVENTS_KEPT], n);
        at += n;
    }
    if (all) {
        *at = '\0';
    }
    return all;
}

void events_stream(const events *e, http_request *r)
{
    const char *last = http_header(r, "Last-Event-ID");
    double id = -1;
    if (last && (!cli_read_number(last, &id) || !(id >= 0 && id <= 1e9))) {
        id = -1;
    }
    char *text = since(e, (int)id);
    http_reply_stream(r, text && *text ? text : ": hello\n\n");
    free(text);
}

void events_send_state(events *e, json_t *state)
{
    static const char head[] = "event: state\ndata: ", comment[] = ": alive\n\n";
    char *data = json_dumps(state, JSON_COMPACT | JSON_REAL_PRECISION(12));
    size_t n = data ? strlen(data) : 0;
    char *text = malloc(sizeof head + n + 2);
    int64_t now_us = grobo_now_us();
    if (data && text) {
        memcpy(text, head, sizeof head - 1);
        memcpy(text + sizeof head - 1, data, n);
        memcpy(text + sizeof head - 1 + n, "\n\n", 2);
        http_send(e->to, text, sizeof head - 1 + n + 2, true);
    }
    free(text);
    free(data);
    json_decref(state);
    if (now_us - e->commented_us > COMMENT_US) {
        e->commented_us = now_us;
        http_send(e->to, comment, sizeof comment - 1, false);
    }
}

void events_free(events *e)
{
    for (int i = 0; i < EVENTS_KEPT; i++) {
        free(e->text[i]);
    }
    memset(e, 0, sizeof *e);
}
