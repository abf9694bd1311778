/* SPDX-License-Identifier: MIT */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/port.h>

#include "tools/grctl/web/serve.h"

void events_tell(serve *s, const char *kind, const char *level, json_t *more, const char *format,
                 ...)
{
    events *e = &s->events;
    char message[512];
    va_list list;
    va_start(list, format);
    vsnprintf(message, sizeof message, format, list);
    va_end(list);
    json_t *event = json_pack("{s:i,s:I,s:s,s:s,s:o}", "id", ++e->last, "time_ms",
                              (json_int_t)serve_ms(s, grobo_now_us()), "kind", kind, "level", level,
                              "message", app_json_text(message));
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
        if (s->http) {
            http_send(s->http, text, (size_t)n, false);
        }
    }
    free(data);
}

char *events_since(const events *e, int id)
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

void events_free(events *e)
{
    for (int i = 0; i < EVENTS_KEPT; i++) {
        free(e->text[i]);
    }
    memset(e, 0, sizeof *e);
}
