/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/format/fields.h"
#include "src/motion/text/number.h"
#include "src/motion/text/out.h"

/* ---- single values ------------------------------------------------------------------------ */

static bool is_text(const grobo_i_event *event, const char *text)
{
    return event->kind == GROBO_I_SCALAR && strlen(text) == event->length &&
           memcmp(event->text, text, event->length) == 0;
}

bool grobo_i_is_null(const grobo_i_event *event)
{
    return event->kind == GROBO_I_SCALAR && event->plain &&
           (event->length == 0 || is_text(event, "~") || is_text(event, "null") ||
            is_text(event, "Null") || is_text(event, "NULL"));
}

static const char *kind_name(const grobo_i_event *event)
{
    static const char *const names[] = {
        "a text", "a list", "the end of a list", "a mapping", "its end", "an alias", "the end"};

    return grobo_i_is_null(event) ? "nothing" : names[event->kind];
}

/* Complains of a node of the wrong kind and skips it. */
static int complain_kind(grobo_i_events *events, const char *what, const char *wanted)
{
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);

    if (result == 0) {
        result = grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "type", event->place,
                                  "%s: %s where %s belongs", what, kind_name(event), wanted);
    }
    return result < 0 ? result : grobo_i_skip(events);
}

/* The next node if it is a scalar; if not it is complained about and skipped, and *event NULL. */
static int next_scalar(grobo_i_events *events, const char *what, const char *wanted,
                       const grobo_i_event **event)
{
    int result = grobo_i_peek(events, event);

    if (result == 0 && (*event)->kind != GROBO_I_SCALAR) {
        *event = NULL;
        return complain_kind(events, what, wanted);
    }
    return result < 0 ? result : grobo_i_next(events, event);
}

static int complain_value(grobo_i_events *events, const grobo_i_event *event, const char *what,
                          const char *wanted)
{
    int shown = event->length < 32 ? (int)event->length : 32;

    return grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "type", event->place,
                            "%s: '%.*s' is not %s", what, shown, event->text, wanted);
}

/* nan and inf, however spelled, have an error of their own. */
static bool is_not_finite(const grobo_i_event *event)
{
    static const char *const names[] = {"nan", "inf", "infinity"};
    char word[10];
    size_t length = 0;
    size_t i = 0;

    while (i < event->length && strchr("+-.", event->text[i]) != NULL) {
        i++;
    }
    for (; i < event->length && length < sizeof word - 1; i++) {
        char c = event->text[i];
        word[length++] = c >= 'A' && c <= 'Z' ? (char)(c + ('a' - 'A')) : c;
    }
    word[length] = '\0';
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        if (i == event->length && strcmp(word, names[k]) == 0) {
            return true;
        }
    }
    return false;
}

static int take_number(grobo_i_events *events, const grobo_i_event *event, const char *what,
                       double *value)
{
    if (grobo_i_parse_number(event->text, event->length, value)) {
        return 0;
    }
    if (is_not_finite(event)) {
        return grobo_i_complain(events->reader, GROBO_ERR_NAN, "not-finite", event->place,
                                "%s: %s is not a finite number", what, event->text);
    }
    return complain_value(events, event, what, "a number");
}

int grobo_i_read_double(grobo_i_events *events, const char *what, double *value)
{
    const grobo_i_event *event;
    int result = next_scalar(events, what, "a number", &event);

    return result < 0 || event == NULL ? result : take_number(events, event, what, value);
}

int grobo_i_read_long(grobo_i_events *events, const char *what, long low, long high, long *value)
{
    const grobo_i_event *event;
    int result = next_scalar(events, what, "a whole number", &event);

    if (result < 0 || event == NULL ||
        grobo_i_parse_int(event->text, event->length, low, high, value)) {
        return result;
    }
    return complain_value(events, event, what, "a whole number in range");
}

int grobo_i_read_bool(grobo_i_events *events, const char *what, bool *value)
{
    static const char *const words[] = {
        "false", "False", "FALSE", "no",  "No",  "NO",  "off", "Off", "OFF", "n", "N",
        "true",  "True",  "TRUE",  "yes", "Yes", "YES", "on",  "On",  "ON",  "y", "Y"};
    size_t n_words = sizeof words / sizeof words[0];
    const grobo_i_event *event;
    int result = next_scalar(events, what, "true or false", &event);

    if (result < 0 || event == NULL) {
        return result;
    }
    for (size_t i = 0; i < n_words; i++) {
        if (is_text(event, words[i])) {
            *value = i >= n_words / 2;
            return 0;
        }
    }
    return complain_value(events, event, what, "true or false");
}

int grobo_i_read_string(grobo_i_events *events, const char *what, char **value)
{
    const grobo_mem *mem = events->reader->mem;
    const grobo_i_event *event;
    int result = next_scalar(events, what, "a text", &event);

    if (result < 0 || event == NULL) {
        return result;
    }
    if (memchr(event->text, 0, event->length) != NULL) {
        return grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "type", event->place,
                                "%s: a text with a NUL in it", what);
    }
    char *copy = grobo_i_copy_text(mem, event->text, grobo_i_is_null(event) ? 0 : event->length);
    if (copy == NULL) {
        return GROBO_ERR_NOMEM;
    }
    grobo_i_free_text(mem, *value);
    *value = copy;
    return 0;
}

/* ---- lists -------------------------------------------------------------------------------- */

int grobo_i_read_list(grobo_i_events *events, const char *what,
                      int (*read)(grobo_i_events *events, void *target), void *target)
{
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);

    if (result < 0) {
        return result;
    }
    if (grobo_i_is_null(event)) {
        return grobo_i_next(events, &event);
    }
    if (event->kind != GROBO_I_LIST) {
        return complain_kind(events, what, "a list");
    }
    result = grobo_i_next(events, &event);
    while (result == 0) {
        result = grobo_i_peek(events, &event);
        if (result < 0 || event->kind == GROBO_I_LIST_END) {
            break;
        }
        result = read(events, target);
    }
    return result < 0 ? result : grobo_i_next(events, &event);
}

/* The rest of a node, of which so many lists and mappings have begun. */
static int skip_rest(grobo_i_events *events, int depth)
{
    while (depth > 0) {
        const grobo_i_event *event;
        int result = grobo_i_next(events, &event);
        if (result < 0) {
            return result;
        }
        depth += event->kind == GROBO_I_LIST || event->kind == GROBO_I_MAP;
        depth -= event->kind == GROBO_I_LIST_END || event->kind == GROBO_I_MAP_END;
    }
    return 0;
}

int grobo_i_skip(grobo_i_events *events)
{
    const grobo_i_event *event;
    int result = grobo_i_next(events, &event);
    bool begins = event->kind == GROBO_I_LIST || event->kind == GROBO_I_MAP;

    return result < 0 || !begins ? result : skip_rest(events, 1);
}

/* An entry that has been taken and is no end of a list. */
static int add_number(grobo_i_events *events, const char *what, grobo_i_numbers *list,
                      const grobo_i_event *event)
{
    if (list->count == list->cap) {
        return grobo_i_refuse(events->reader, GROBO_ERR_CAP, "list-length", event->place,
                              "more than %d numbers in %s", list->cap, what);
    }
    double *value = &list->values[list->count];
    *value = list->bad;
    if (list->places != NULL) {
        list->places[list->count] = event->place;
    }
    list->count++;
    if (event->kind == GROBO_I_SCALAR) {
        return take_number(events, event, what, value);
    }
    int result = grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "type", event->place,
                                  "%s: %s where a number belongs", what, kind_name(event));
    return result < 0 ? result : skip_rest(events, 1);
}

int grobo_i_read_numbers(grobo_i_events *events, const char *what, grobo_i_numbers *list)
{
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);

    list->count = 0;
    if (result < 0) {
        return result;
    }
    if (event->kind != GROBO_I_LIST && !grobo_i_is_null(event)) {
        return complain_kind(events, what, "a list of numbers");
    }
    bool more = event->kind == GROBO_I_LIST;
    result = grobo_i_next(events, &event);
    while (more && result == 0) {
        result = grobo_i_next(events, &event);
        if (result < 0 || event->kind == GROBO_I_LIST_END) {
            break;
        }
        result = add_number(events, what, list, event);
    }
    return result;
}

int grobo_i_read_doubles(grobo_i_events *events, const char *what, double *values, int count)
{
    double found[16];
    grobo_i_numbers list = {found, NULL, 0, sizeof found / sizeof found[0], NAN};
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);

    if (result < 0) {
        return result;
    }
    grobo_i_place place = event->place;
    bool is_list = event->kind == GROBO_I_LIST;
    if (!is_list) {
        return complain_kind(events, what, "a list of numbers");
    }
    result = grobo_i_read_numbers(events, what, &list);
    if (result == 0 && list.count != count) {
        return grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "list-length", place,
                                "%s has %d number%s, not %d", what, list.count,
                                list.count == 1 ? "" : "s", count);
    }
    if (result == 0) {
        memcpy(values, found, (size_t)count * sizeof *values);
    }
    return result;
}

/* ---- mappings ----------------------------------------------------------------------------- */

uint64_t grobo_i_hash(const char *text)
{
    uint64_t hash = 14695981039346656037U; /* FNV-1a */

    for (; *text != '\0'; text++) {
        hash = (hash ^ (unsigned char)*text) * 1099511628211U;
    }
    return hash;
}

/* What is known of a mapping while it is read. */
typedef struct map_state {
    const grobo_i_fields *fields;
    void *target;
    uint32_t seen;
    int n_unknown, n_merges;
    uint64_t unknown[GROBO_YAML_UNKNOWN_KEYS_MAX]; /* hashes of the other keys */
    int merges[GROBO_YAML_MERGES_MAX];             /* anchors */
    grobo_i_place merge_place;
} map_state;

/* The value of a merge key: an alias or a list of them. */
static int read_merge(grobo_i_events *events, map_state *map)
{
    const grobo_i_event *event;
    bool list = false;

    do {
        int result = grobo_i_next_unfollowed(events, &event);
        if (result < 0) {
            return result;
        }
        if (event->kind == GROBO_I_LIST && !list) {
            list = true;
        } else if (event->kind == GROBO_I_ALIAS && map->n_merges < GROBO_YAML_MERGES_MAX) {
            map->merges[map->n_merges++] = event->anchor;
            map->merge_place = event->place;
        } else if (event->kind == GROBO_I_LIST_END && list) {
            list = false;
        } else {
            return grobo_i_refuse(events->reader, GROBO_ERR_SYNTAX, "merge", event->place,
                                  "<< takes an alias or a list of at most %d",
                                  GROBO_YAML_MERGES_MAX);
        }
    } while (list);
    return 0;
}

static int complain_twice(grobo_i_events *events, const map_state *map, const char *key,
                          grobo_i_place place)
{
    int result = grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "key-twice", place,
                                  "'%s' is there twice in %s", key, map->fields->what);

    return result < 0 ? result : grobo_i_skip(events);
}

static int read_unknown(grobo_i_events *events, map_state *map, const char *key,
                        grobo_i_place place, bool merged)
{
    uint64_t hash = grobo_i_hash(key);

    for (int i = 0; i < map->n_unknown; i++) {
        if (map->unknown[i] == hash) {
            return merged ? grobo_i_skip(events) : complain_twice(events, map, key, place);
        }
    }
    if (map->n_unknown == GROBO_YAML_UNKNOWN_KEYS_MAX) {
        return grobo_i_refuse(events->reader, GROBO_ERR_CAP, "keys", place,
                              "more than %d unknown keys in %s", GROBO_YAML_UNKNOWN_KEYS_MAX,
                              map->fields->what);
    }
    map->unknown[map->n_unknown++] = hash;
    return map->fields->unknown(events, map->target, key);
}

/* The value of one key, which has been taken. */
static int read_value(grobo_i_events *events, map_state *map, const char *key, grobo_i_place place,
                      bool merged)
{
    const grobo_i_fields *fields = map->fields;

    for (size_t i = 0; i < fields->count; i++) {
        const grobo_i_field *field = &fields->fields[i];
        if (strcmp(key, field->name) != 0 &&
            (field->other == NULL || strcmp(key, field->other) != 0)) {
            continue;
        }
        uint32_t bit = (uint32_t)1 << i;
        if ((map->seen & bit) != 0) {
            return merged ? grobo_i_skip(events) : complain_twice(events, map, key, place);
        }
        map->seen |= bit;
        return field->read(events, map->target);
    }
    return read_unknown(events, map, key, place, merged);
}

/* A copy of the key that is next, which is taken. */
static int next_key(grobo_i_events *events, const map_state *map,
                    char key[GROBO_YAML_KEY_MAX_BYTES], grobo_i_place *place)
{
    const grobo_i_event *event;
    int result = grobo_i_next(events, &event);

    if (result < 0) {
        return result;
    }
    *place = event->place;
    if (event->kind != GROBO_I_SCALAR || memchr(event->text, 0, event->length) != NULL) {
        return grobo_i_refuse(events->reader, GROBO_ERR_SYNTAX, "key", event->place,
                              "a key of %s that is not a plain text", map->fields->what);
    }
    if (event->length >= GROBO_YAML_KEY_MAX_BYTES) {
        return grobo_i_refuse(events->reader, GROBO_ERR_CAP, "key-length", event->place,
                              "a key of %s longer than %d bytes", map->fields->what,
                              GROBO_YAML_KEY_MAX_BYTES - 1);
    }
    memcpy(key, event->text, event->length + 1);
    return 0;
}

static int read_pairs(grobo_i_events *events, map_state *map, bool merged)
{
    const grobo_i_event *event;
    char key[GROBO_YAML_KEY_MAX_BYTES];
    grobo_i_place place;
    int result = grobo_i_next(events, &event);

    if (result == 0 && event->kind != GROBO_I_MAP) {
        return grobo_i_refuse(events->reader, GROBO_ERR_SYNTAX, "merge", event->place,
                              "<< of something that is no mapping");
    }
    while (result == 0) {
        result = grobo_i_peek(events, &event);
        if (result < 0 || event->kind == GROBO_I_MAP_END) {
            break;
        }
        result = next_key(events, map, key, &place);
        if (result < 0) {
            break;
        }
        result = strcmp(key, "<<") == 0 ? read_merge(events, map)
                                        : read_value(events, map, key, place, merged);
    }
    return result < 0 ? result : grobo_i_next(events, &event);
}

int grobo_i_read_map(grobo_i_events *events, const grobo_i_fields *fields, void *target,
                     uint32_t *seen)
{
    map_state map;
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);

    if (result < 0) {
        return result;
    }
    if (event->kind != GROBO_I_MAP) {
        return complain_kind(events, fields->what, "a mapping");
    }
    map.fields = fields;
    map.target = target;
    map.seen = 0;
    map.n_unknown = map.n_merges = 0;
    result = read_pairs(events, &map, false);
    /* Merged mappings may merge others themselves: the list grows while it is gone through. */
    for (int i = 0; i < map.n_merges && result == 0; i++) {
        result = grobo_i_follow(events, map.merges[i], map.merge_place);
        if (result == 0) {
            result = read_pairs(events, &map, true);
        }
    }
    if (result == 0) {
        *seen = map.seen;
    }
    return result;
}

/* ---- keeping what has no meaning here ----------------------------------------------------- */

/* One level of what is being captured. */
typedef struct capture_level {
    bool map;
    bool at_value; /* a key has been put, its value follows */
    bool first;    /* nothing has been put yet */
} capture_level;

/* What stands between the entry before and event. */
static const char *separator(const grobo_i_event *event, const capture_level *level, bool inside)
{
    bool ends = event->kind == GROBO_I_LIST_END || event->kind == GROBO_I_MAP_END;

    if (level->at_value) {
        return ": ";
    }
    if (ends || level->first) {
        return inside ? " " : "";
    }
    return ", ";
}

static void put_event(grobo_i_out *out, const grobo_i_event *event)
{
    static const char *const brackets[] = {NULL, "[", "]", "{", "}"};

    if (event->kind != GROBO_I_SCALAR) {
        grobo_i_put_text(out, brackets[event->kind]);
    } else if (!event->plain) {
        grobo_i_put_quoted(out, event->text, event->length);
    } else if (event->length == 0) {
        grobo_i_put_text(out, "~");
    } else {
        grobo_i_put_scalar(out, event->text, event->length);
    }
}

/* One node as flow-style text on one line. */
static int capture(grobo_i_events *events, grobo_i_text *text)
{
    grobo_sink sink = {grobo_i_text_write, text};
    capture_level levels[GROBO_YAML_DEPTH_MAX + 1] = {{false, false, true}};
    grobo_i_out out;
    int depth = 0;

    grobo_i_out_begin(&out, &sink);
    do {
        const grobo_i_event *event;
        int result = grobo_i_next(events, &event);
        result = result < 0 ? result : out.result;
        if (result < 0) {
            return result;
        }
        capture_level *level = &levels[depth];
        grobo_i_put_text(&out, separator(event, level, depth > 0));
        put_event(&out, event);
        if (event->kind == GROBO_I_LIST_END || event->kind == GROBO_I_MAP_END) {
            depth--;
            continue;
        }
        level->first = false;
        level->at_value = level->map && !level->at_value;
        if (event->kind != GROBO_I_SCALAR) {
            levels[++depth] = (capture_level){event->kind == GROBO_I_MAP, false, true};
        }
    } while (depth > 0);
    return grobo_i_out_end(&out);
}

int grobo_i_keep_value(grobo_i_events *events, grobo_i_kept **list, const grobo_kept *where)
{
    grobo_i_reader *reader = events->reader;
    grobo_i_text text = {.mem = reader->mem, .cap = GROBO_YAML_SCALAR_MAX_BYTES};
    grobo_kept kept = *where;
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);
    grobo_i_place place = event->place;

    if (result == 0) {
        result = capture(events, &text);
    }
    if (result == 0) {
        result = grobo_i_text_write(&text, "", 1);
    }
    if (result == 0) {
        kept.value = text.data;
        result = grobo_i_kept_add(reader->mem, list, &kept);
    }
    grobo_i_text_free(&text);
    if (result == GROBO_ERR_CAP) {
        return grobo_i_refuse(reader, result, "kept-size", place,
                              "'%s' is larger than unknown keys may be", where->key);
    }
    return result;
}

/* ---- a whole file -------------------------------------------------------------------------- */

static int read_whole(grobo_i_events *events, const char *what,
                      int (*read)(grobo_i_events *events, void *target), void *target)
{
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);
    if (result == 0 && event->kind != GROBO_I_MAP) {
        return grobo_i_refuse(events->reader, GROBO_ERR_SYNTAX, "type", event->place,
                              "not %s: no mapping at the top", what);
    }
    result = result < 0 ? result : read(events, target);
    result = result < 0 ? result : grobo_i_next(events, &event); /* the document's end */
    if (result < 0) {
        return result;
    }
    const grobo_i_place end = event->place;
    result = grobo_i_another_document(events);
    return result > 0 ? grobo_i_refuse(events->reader, GROBO_ERR_SYNTAX, "documents", end,
                                       "another document behind the first")
                      : result;
}

int grobo_i_read_document(grobo_i_reader *reader, const char *what,
                          int (*read)(grobo_i_events *events, void *target), void *target)
{
    grobo_i_events events;
    int result = grobo_i_input_fill(&reader->input);
    if (result < 0) {
        return grobo_i_refuse(reader, result, "read", (grobo_i_place){0, 0}, "%s",
                              grobo_error_text(result));
    }
    result = grobo_i_events_begin(&events, reader);
    if (result < 0) {
        return result;
    }
    events.refuses_aliases = true;
    result = read_whole(&events, what, read, target);
    grobo_i_events_end(&events);
    return result;
}
