/* SPDX-License-Identifier: MIT */
/* What happened: the last of it is kept, for who comes later. */
#ifndef GRCTL_WEB_EVENTS_H
#define GRCTL_WEB_EVENTS_H

#include <jansson.h>

enum { EVENTS_KEPT = 256 };

typedef struct serve serve;

typedef struct events {
    int last; /* id of the newest, 0: none */
    char *text[EVENTS_KEPT];
} events;

/*
 * Tells all streams, and keeps it. kind and level as the interface has them; `more` is what the
 * event has besides (the reference is taken), or NULL.
 */
void events_tell(serve *s, const char *kind, const char *level, json_t *more, const char *format,
                 ...) __attribute__((format(printf, 5, 6)));
/* Those behind an id, as a text of server-sent events to be freed; NULL: no memory. */
char *events_since(const events *e, int id);
void events_free(events *e);

#endif
