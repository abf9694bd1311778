/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/format/events.h"

static grobo_i_place place_of(yaml_mark_t mark)
{
    return (grobo_i_place){(uint32_t)mark.line + 1, (uint32_t)mark.column + 1};
}

/* ---- reading ------------------------------------------------------------------------------ */

/* libyaml asks for bytes; 0 tells it to stop. */
static int on_read(void *data, unsigned char *buffer, size_t size, size_t *size_read)
{
    grobo_i_events *events = data;
    grobo_i_input *input = &events->reader->input;

    if (input->first == input->last) {
        int got = grobo_i_input_fill(input);
        if (got < 0) {
            events->source_result = got;
            return 0;
        }
    }
    size_t count = input->last - input->first;
    count = count < size ? count : size;
    if (input->total_bytes - (input->last - input->first) >
        events->event_bytes + GROBO_YAML_GAP_MAX_BYTES) {
        events->gap_too_long = true;
        return 0;
    }
    memcpy(buffer, input->buffer + input->first, count);
    input->first += count;
    *size_read = count;
    return 1;
}

/* Where reading failed: behind what is decoded and not yet scanned. */
static grobo_i_place read_place(const yaml_parser_t *parser)
{
    grobo_i_place place = place_of(parser->mark);

    for (const yaml_char_t *c = parser->buffer.pointer; c < parser->buffer.last; c++) {
        if (*c == '\n') {
            place.line++;
            place.column = 1;
        } else if ((*c & 0xC0) != 0x80) { /* not for the rest of a character */
            place.column++;
        }
    }
    return place;
}

static int refuse_parser(grobo_i_events *events)
{
    const yaml_parser_t *parser = &events->parser;
    int result = events->source_result;

    if (parser->error == YAML_MEMORY_ERROR) {
        return GROBO_ERR_NOMEM;
    }
    if (events->gap_too_long) {
        return grobo_i_refuse(events->reader, GROBO_ERR_CAP, "length", place_of(parser->mark),
                              "no end of this within %d bytes", GROBO_YAML_GAP_MAX_BYTES);
    }
    if (result < 0) {
        return grobo_i_refuse(events->reader, result, "read", place_of(parser->mark), "%s",
                              grobo_error_text(result));
    }
    bool reading = parser->error == YAML_READER_ERROR;
    return grobo_i_refuse(events->reader, GROBO_ERR_SYNTAX, reading ? "encoding" : "yaml",
                          reading ? read_place(parser) : place_of(parser->problem_mark), "%s",
                          parser->problem != NULL ? parser->problem : "malformed YAML");
}

static int parse_live(grobo_i_events *events)
{
    if (events->live_to_delete) {
        yaml_event_delete(&events->live);
        events->live_to_delete = false;
    }
    if (!yaml_parser_parse(&events->parser, &events->live)) {
        return refuse_parser(events);
    }
    events->live_to_delete = true;
    events->event_bytes = events->reader->input.total_bytes -
                          (events->reader->input.last - events->reader->input.first);
    return 0;
}

/* ---- anchored nodes ----------------------------------------------------------------------- */

/* The array with room for what is needed, doubled if need be; NULL without memory. */
static void *grow(const grobo_mem *mem, void *array, size_t *room, size_t needed, size_t item_bytes)
{
    size_t more = *room == 0 ? 64 : *room;

    if (needed <= *room) {
        return array;
    }
    while (more < needed) {
        more *= 2;
    }
    void *grown = mem->resize(mem->ctx, array, *room * item_bytes, more * item_bytes);
    if (grown != NULL) {
        *room = more;
    }
    return grown;
}

/* Room for an event more, and for the bytes of its text. */
static int grow_store(grobo_i_store *store, const grobo_mem *mem, size_t text_bytes)
{
    grobo_i_stored *stored =
        grow(mem, store->events, &store->event_room, store->n_events + 1, sizeof *stored);
    if (stored == NULL) {
        return GROBO_ERR_NOMEM;
    }
    store->events = stored;
    if (text_bytes > 0) {
        char *text = grow(mem, store->text, &store->text_room, store->text_bytes + text_bytes, 1);
        if (text == NULL) {
            return GROBO_ERR_NOMEM;
        }
        store->text = text;
    }
    return 0;
}

static int store_event(grobo_i_events *events)
{
    grobo_i_store *store = &events->store;
    const grobo_i_event *event = &events->event;
    size_t bytes = event->kind == GROBO_I_SCALAR ? event->length + 1 : 0;

    if (store->n_events >= GROBO_YAML_ANCHORED_EVENTS_MAX ||
        store->text_bytes + bytes > GROBO_YAML_ANCHORED_MAX_BYTES) {
        return grobo_i_refuse(events->reader, GROBO_ERR_CAP, "anchor-size", event->place,
                              "too much in nodes with an anchor");
    }
    int result = grow_store(store, events->reader->mem, bytes);
    if (result < 0) {
        return result;
    }
    grobo_i_stored *stored = &store->events[store->n_events++];
    stored->event = *event;
    stored->event.text = NULL;
    stored->offset = store->text_bytes;
    if (bytes > 0) {
        memcpy(store->text + store->text_bytes, event->text, bytes);
        store->text_bytes += bytes;
    }
    return 0;
}

static int add_anchor(grobo_i_events *events, const char *name)
{
    grobo_i_store *store = &events->store;
    const grobo_mem *mem = events->reader->mem;

    if (store->n_anchors >= GROBO_YAML_ANCHORS_MAX) {
        return grobo_i_refuse(events->reader, GROBO_ERR_CAP, "anchors", events->event.place,
                              "more than %d anchors", GROBO_YAML_ANCHORS_MAX);
    }
    grobo_i_anchor *anchors =
        grow(mem, store->anchors, &store->anchor_room, store->n_anchors + 1, sizeof *anchors);
    if (anchors == NULL) {
        return GROBO_ERR_NOMEM;
    }
    store->anchors = anchors;
    char *copy = grobo_i_copy_text(mem, name, strlen(name));
    if (copy == NULL) {
        return GROBO_ERR_NOMEM;
    }
    store->anchors[store->n_anchors++] = (grobo_i_anchor){copy, store->n_events, 0};
    return 0;
}

/* Remembers a live event if it is in an anchored node or begins one. */
static int remember(grobo_i_events *events, const char *anchor)
{
    grobo_i_store *store = &events->store;
    grobo_i_event_kind kind = events->event.kind;
    int result = anchor != NULL ? add_anchor(events, anchor) : 0;

    if (result == 0 && anchor != NULL && kind != GROBO_I_SCALAR) {
        /* Bounded by the depth, which is counted already. */
        store->open[store->n_open].anchor = store->n_anchors - 1;
        store->open[store->n_open++].depth = events->depth;
    }
    if (result == 0 && (anchor != NULL || store->n_open > 0)) {
        result = store_event(events);
    }
    if (result < 0) {
        return result;
    }
    if (anchor != NULL && kind == GROBO_I_SCALAR) {
        store->anchors[store->n_anchors - 1].last = store->n_events;
    }
    /* At the end of a node the depth is already that outside it. */
    bool ends = kind == GROBO_I_LIST_END || kind == GROBO_I_MAP_END;
    if (ends && store->n_open > 0 && store->open[store->n_open - 1].depth == events->depth + 1) {
        store->anchors[store->open[--store->n_open].anchor].last = store->n_events;
    }
    return 0;
}

static int find_anchor(grobo_i_events *events, const char *name, grobo_i_place place, int *found)
{
    const grobo_i_store *store = &events->store;

    for (size_t i = store->n_anchors; i-- > 0;) {
        if (strcmp(store->anchors[i].name, name) != 0) {
            continue;
        }
        if (store->anchors[i].last == 0) {
            return grobo_i_refuse(events->reader, GROBO_ERR_SYNTAX, "alias", place,
                                  "the alias '%s' is within its own anchor", name);
        }
        *found = (int)i;
        return 0;
    }
    return grobo_i_refuse(events->reader, GROBO_ERR_SYNTAX, "alias", place,
                          "no anchor '%s' before this alias", name);
}

int grobo_i_follow(grobo_i_events *events, int anchor, grobo_i_place place)
{
    const grobo_i_anchor *node = &events->store.anchors[anchor];

    if (events->refuses_aliases) {
        return grobo_i_refuse(events->reader, GROBO_ERR_SYNTAX, "alias", place,
                              "aliases are not known here; write it out");
    }
    if (++events->n_aliases > GROBO_YAML_ALIASES_MAX) {
        return grobo_i_refuse(events->reader, GROBO_ERR_CAP, "aliases", place,
                              "more than %d aliases", GROBO_YAML_ALIASES_MAX);
    }
    if (events->n_replays == GROBO_YAML_DEPTH_MAX) {
        return grobo_i_refuse(events->reader, GROBO_ERR_CAP, "depth", place,
                              "aliases in aliases deeper than %d", GROBO_YAML_DEPTH_MAX);
    }
    events->replays[events->n_replays].next = node->first;
    events->replays[events->n_replays++].last = node->last;
    return 0;
}

/* ---- events ------------------------------------------------------------------------------- */

static int count_depth(grobo_i_events *events)
{
    switch (events->event.kind) {
    case GROBO_I_LIST:
    case GROBO_I_MAP:
        if (++events->depth > GROBO_YAML_DEPTH_MAX) {
            return grobo_i_refuse(events->reader, GROBO_ERR_CAP, "depth", events->event.place,
                                  "nested deeper than %d", GROBO_YAML_DEPTH_MAX);
        }
        return 0;
    case GROBO_I_LIST_END:
    case GROBO_I_MAP_END:
        events->depth--;
        return 0;
    case GROBO_I_SCALAR:
    case GROBO_I_ALIAS:
    case GROBO_I_DOCUMENT_END:
        return 0;
    }
    return 0;
}

static int take_scalar(grobo_i_events *events)
{
    const yaml_event_t *live = &events->live;

    events->event.text = (const char *)live->data.scalar.value;
    events->event.length = live->data.scalar.length;
    events->event.plain = live->data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
    if (events->event.length > GROBO_YAML_SCALAR_MAX_BYTES) {
        return grobo_i_refuse(events->reader, GROBO_ERR_CAP, "length", events->event.place,
                              "a text longer than %d bytes", GROBO_YAML_SCALAR_MAX_BYTES);
    }
    return 0;
}

/* The live event in our words. */
static int take_live(grobo_i_events *events)
{
    const yaml_event_t *live = &events->live;
    const yaml_char_t *anchor = NULL;
    int result = 0;

    events->event.place = place_of(live->start_mark);
    events->event.length = 0;
    /* By far the most frequent: a scalar and nothing else to be done. */
    if (live->type == YAML_SCALAR_EVENT && live->data.scalar.anchor == NULL &&
        events->store.n_open == 0) {
        events->event.kind = GROBO_I_SCALAR;
        return take_scalar(events);
    }
    switch (live->type) {
    case YAML_SCALAR_EVENT:
        events->event.kind = GROBO_I_SCALAR;
        anchor = live->data.scalar.anchor;
        result = take_scalar(events);
        break;
    case YAML_SEQUENCE_START_EVENT:
        events->event.kind = GROBO_I_LIST;
        anchor = live->data.sequence_start.anchor;
        break;
    case YAML_SEQUENCE_END_EVENT:
        events->event.kind = GROBO_I_LIST_END;
        break;
    case YAML_MAPPING_START_EVENT:
        events->event.kind = GROBO_I_MAP;
        anchor = live->data.mapping_start.anchor;
        break;
    case YAML_MAPPING_END_EVENT:
        events->event.kind = GROBO_I_MAP_END;
        break;
    case YAML_ALIAS_EVENT:
        events->event.kind = GROBO_I_ALIAS;
        result = find_anchor(events, (const char *)live->data.alias.anchor, events->event.place,
                             &events->event.anchor);
        break;
    case YAML_NO_EVENT:
    case YAML_STREAM_START_EVENT:
    case YAML_STREAM_END_EVENT:
    case YAML_DOCUMENT_START_EVENT:
    case YAML_DOCUMENT_END_EVENT:
        events->event.kind = GROBO_I_DOCUMENT_END;
        return 0;
    }
    if (result == 0) {
        result = count_depth(events);
    }
    if (result == 0 && (anchor != NULL || events->store.n_open > 0)) {
        result = remember(events, (const char *)anchor);
    }
    return result;
}

static int take_stored(grobo_i_events *events)
{
    const grobo_i_stored *stored =
        &events->store.events[events->replays[events->n_replays - 1].next++];

    if (++events->n_replayed > GROBO_YAML_REPLAYED_EVENTS_MAX) {
        return grobo_i_refuse(events->reader, GROBO_ERR_CAP, "aliases", stored->event.place,
                              "aliases make it too large");
    }
    events->event = stored->event;
    if (stored->event.kind == GROBO_I_SCALAR) {
        events->event.text = events->store.text + stored->offset;
    }
    return count_depth(events);
}

static int advance(grobo_i_events *events, bool follow)
{
    for (;;) {
        int result;
        while (events->n_replays > 0 && events->replays[events->n_replays - 1].next ==
                                            events->replays[events->n_replays - 1].last) {
            events->n_replays--;
        }
        if (events->n_replays > 0) {
            result = take_stored(events);
        } else {
            result = parse_live(events);
            result = result < 0 ? result : take_live(events);
        }
        if (result < 0 || events->event.kind != GROBO_I_ALIAS || !follow) {
            return result;
        }
        result = grobo_i_follow(events, events->event.anchor, events->event.place);
        if (result < 0) {
            return result;
        }
    }
}

int grobo_i_peek(grobo_i_events *events, const grobo_i_event **event)
{
    *event = &events->event;
    if (!events->have) {
        int result = advance(events, true);
        if (result < 0) {
            return result;
        }
        events->have = true;
    }
    return 0;
}

int grobo_i_next(grobo_i_events *events, const grobo_i_event **event)
{
    int result = events->have ? 0 : advance(events, true);

    events->have = false;
    *event = &events->event;
    return result;
}

int grobo_i_next_unfollowed(grobo_i_events *events, const grobo_i_event **event)
{
    *event = &events->event;
    return advance(events, false);
}

/* ---- beginning and end -------------------------------------------------------------------- */

int grobo_i_events_begin(grobo_i_events *events, grobo_i_reader *reader)
{
    memset(events, 0, sizeof *events);
    events->reader = reader;
    if (!yaml_parser_initialize(&events->parser)) {
        return GROBO_ERR_NOMEM;
    }
    yaml_parser_set_input(&events->parser, on_read, events);
    int result = parse_live(events); /* the stream's start */
    if (result == 0) {
        result = parse_live(events);
    }
    if (result == 0 && events->live.type == YAML_STREAM_END_EVENT) {
        result = grobo_i_refuse(reader, GROBO_ERR_SYNTAX, "empty", (grobo_i_place){1, 1},
                                "an empty file");
    }
    if (result < 0) {
        grobo_i_events_end(events);
    }
    return result;
}

void grobo_i_events_end(grobo_i_events *events)
{
    const grobo_mem *mem = events->reader->mem;
    grobo_i_store *store = &events->store;

    if (events->live_to_delete) {
        yaml_event_delete(&events->live);
    }
    yaml_parser_delete(&events->parser);
    for (size_t i = 0; i < store->n_anchors; i++) {
        grobo_i_free_text(mem, store->anchors[i].name);
    }
    grobo_i_free(mem, store->anchors, store->anchor_room * sizeof *store->anchors);
    grobo_i_free(mem, store->events, store->event_room * sizeof *store->events);
    grobo_i_free(mem, store->text, store->text_room);
}

int grobo_i_another_document(grobo_i_events *events)
{
    int result = parse_live(events);

    return result < 0 ? result : events->live.type == YAML_DOCUMENT_START_EVENT;
}
