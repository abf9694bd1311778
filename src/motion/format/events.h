/* SPDX-License-Identifier: MIT */
/*
 * A YAML document as a stream of events: libyaml's, with caps, one at a time, aliases followed.
 *
 * What libyaml 0.2.5 leaves open is closed here: nesting, aliases and lengths are bounded, and no
 * input costs more than linear time. libyaml looks ahead while a bracket may yet prove to be a
 * key, 1024 characters at most, and each token of it costs the depth: because events come out
 * before the whole text is scanned, counting depth here stops a nest of brackets early.
 */
#ifndef GROBO_MOTION_EVENTS_H
#define GROBO_MOTION_EVENTS_H

#include <yaml.h>

#include "src/motion/format/reader.h"

typedef enum grobo_i_event_kind {
    GROBO_I_SCALAR = 0,
    GROBO_I_LIST,     /* a sequence begins */
    GROBO_I_LIST_END, /* and ends */
    GROBO_I_MAP,      /* a mapping begins */
    GROBO_I_MAP_END,  /* and ends */
    GROBO_I_ALIAS,    /* of a merge only: others are followed */
    GROBO_I_DOCUMENT_END
} grobo_i_event_kind;

typedef struct grobo_i_event {
    const char *text; /* of a scalar, with a NUL behind; valid until the event after is looked at */
    size_t length;
    grobo_i_place place;
    grobo_i_event_kind kind;
    int anchor; /* of an alias: which anchor */
    bool plain; /* a scalar without quotes */
} grobo_i_event;

/* An event remembered because it lies in an anchored node. */
typedef struct grobo_i_stored {
    grobo_i_event event; /* its text NULL: see offset */
    size_t offset;       /* of the text in the store's text */
} grobo_i_stored;

typedef struct grobo_i_anchor {
    char *name;
    size_t first, last; /* events first..last-1 of the store; last 0 while it is open */
} grobo_i_anchor;

typedef struct grobo_i_store {
    grobo_i_stored *events;
    char *text;
    grobo_i_anchor *anchors;
    size_t n_events, event_room, text_bytes, text_room, n_anchors, anchor_room;
    struct {
        size_t anchor;
        int depth;
    } open[GROBO_YAML_DEPTH_MAX]; /* anchored nodes that we are in */
    int n_open;
} grobo_i_store;

typedef struct grobo_i_events {
    grobo_i_reader *reader;
    yaml_parser_t parser;
    yaml_event_t live; /* what libyaml gave last */
    grobo_i_event event;
    grobo_i_store store;
    struct {
        size_t next, last;
    } replays[GROBO_YAML_DEPTH_MAX]; /* anchored nodes being given again */
    int n_replays;
    size_t n_aliases, n_replayed;
    int depth;
    int source_result;    /* what the source failed with */
    uint64_t event_bytes; /* of the input when the last event came */
    bool refuses_aliases; /* set by who has no use for them */
    bool have;            /* event is looked at and not yet taken */
    bool live_to_delete;
    bool gap_too_long;
} grobo_i_events;

/* Begins: everything up to the document's first event. After an error there is nothing to end. */
int grobo_i_events_begin(grobo_i_events *events, grobo_i_reader *reader);
void grobo_i_events_end(grobo_i_events *events);
/*
 * Looks at the next event without taking it. @return 0 or an error, said already; even then *event
 * points to an event, of which only the place may be looked at.
 */
int grobo_i_peek(grobo_i_events *events, const grobo_i_event **event);
/* Takes it. */
int grobo_i_next(grobo_i_events *events, const grobo_i_event **event);
/* As grobo_i_next(), but an alias is given as it is, not followed. */
int grobo_i_next_unfollowed(grobo_i_events *events, const grobo_i_event **event);
/* The next events are those of an anchored node. */
int grobo_i_follow(grobo_i_events *events, int anchor, grobo_i_place place);
/* After the document: 1 if another one follows, 0 if none. */
int grobo_i_another_document(grobo_i_events *events);

#endif
