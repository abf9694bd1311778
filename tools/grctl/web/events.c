/* SPDX-License-Identifier: MIT */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/port.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/cli/heap.h"
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
    heap text = {0};
    heap_print(&text, "id: %d\nevent: event\ndata: ", e->last);
    heap_json(&text, event);
    heap_print(&text, "\n\n");
    if (!text.bytes) {
        return;
    }
    free(e->text[e->last % EVENTS_KEPT]);
    e->text[e->last % EVENTS_KEPT] = text.bytes;
    if (e->to) {
        http_send(e->to, text.bytes, text.size, false);
    }
}

/* Those behind an id, to be freed; NULL or "": none. */
static char *since(const events *e, int id)
{
    heap all = {0};
    int first = id < 0 || id > e->last ? e->last : id;
    if (first < e->last - EVENTS_KEPT) {
        first = e->last - EVENTS_KEPT;
    }
    for (int i = first + 1; i <= e->last; i++) {
        const char *text = e->text[i % EVENTS_KEPT];
        heap_print(&all, "%s", text ? text : "");
    }
    return all.bytes;
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
    static const char comment[] = ": alive\n\n";
    int64_t now_us = grobo_now_us();
    heap text = {0};
    heap_print(&text, "event: state\ndata: ");
    heap_json(&text, state);
    heap_print(&text, "\n\n");
    if (text.bytes) {
        http_send(e->to, text.bytes, text.size, true);
    }
    free(text.bytes);
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
