/* SPDX-License-Identifier: MIT */
/* What happened: the last of it is kept, for who comes later. */
#ifndef GRCTL_WEB_EVENTS_H
#define GRCTL_WEB_EVENTS_H

#include <jansson.h>

#include "tools/grctl/web/http.h"

enum { EVENTS_KEPT = 256 };

typedef struct events {
    http *to;             /* whose streams are told, NULL: there are none yet */
    int64_t began_us;     /* the beginning of the clock that is told */
    int64_t commented_us; /* when the last comment went to the streams */
    int last;             /* id of the newest, 0: none */
    char *text[EVENTS_KEPT];
} events;

/*
 * Tells all streams, and keeps it. kind and level as the interface has them; `more` is what the
 * event has besides (the reference is taken), or NULL.
 */
void events_tell(events *e, const char *kind, const char *level, json_t *more, const char *format,
                 ...) __attribute__((format(printf, 5, 6)));
/* Makes a stream of a request: with what happened behind its Last-Event-ID, then all to come. */
void events_stream(const events *e, http_request *r);
/* The state as it is now, for all streams; the reference is taken. Now and then a comment too. */
void events_send_state(events *e, json_t *state);
void events_free(events *e);

#endif
