/* SPDX-License-Identifier: MIT */
/* Reads a servo model's file: numbers of the model, rates of its line, registers. */
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/text/nearest.h"
#include "src/robots/file/servo.h"

enum { ADDRESS_MAX = 1023 };

/* Counts of a span: a goal of 256 turns is a number of 32 bits. */
#define SPAN_MAX (1 << 22)

static const char *const roles[] = {[GROBO_ROLE_NONE] = "none",
                                    [GROBO_ROLE_MODEL] = "model",
                                    [GROBO_ROLE_FIRMWARE] = "firmware",
                                    [GROBO_ROLE_ID] = "id",
                                    [GROBO_ROLE_BAUD] = "baud",
                                    [GROBO_ROLE_RETURN_DELAY] = "return_delay",
                                    [GROBO_ROLE_REPLY_LEVEL] = "reply_level",
                                    [GROBO_ROLE_LOCK] = "lock",
                                    [GROBO_ROLE_WATCHDOG] = "watchdog",
                                    [GROBO_ROLE_DIRECTION] = "direction",
                                    [GROBO_ROLE_MODE] = "mode",
                                    [GROBO_ROLE_OFFSET] = "offset",
                                    [GROBO_ROLE_MIN_POSITION] = "min_position",
                                    [GROBO_ROLE_MAX_POSITION] = "max_position",
                                    [GROBO_ROLE_TEMPERATURE_LIMIT] = "temperature_limit",
                                    [GROBO_ROLE_MIN_VOLTAGE] = "min_voltage",
                                    [GROBO_ROLE_MAX_VOLTAGE] = "max_voltage",
                                    [GROBO_ROLE_MAX_TORQUE] = "max_torque",
                                    [GROBO_ROLE_CURRENT_LIMIT] = "current_limit",
                                    [GROBO_ROLE_SPEED_LIMIT] = "speed_limit",
                                    [GROBO_ROLE_SHUTDOWN] = "shutdown",
                                    [GROBO_ROLE_TORQUE] = "torque",
                                    [GROBO_ROLE_TORQUE_LIMIT] = "torque_limit",
                                    [GROBO_ROLE_GOAL] = "goal",
                                    [GROBO_ROLE_GOAL_TIME] = "goal_time",
                                    [GROBO_ROLE_SPEED] = "speed",
                                    [GROBO_ROLE_ACCELERATION] = "acceleration",
                                    [GROBO_ROLE_GOAL_SPEED] = "goal_speed",
                                    [GROBO_ROLE_GOAL_CURRENT] = "goal_current",
                                    [GROBO_ROLE_GOAL_PWM] = "goal_pwm",
                                    [GROBO_ROLE_ERROR] = "error",
                                    [GROBO_ROLE_REGISTERED] = "registered",
                                    [GROBO_ROLE_MOVING] = "moving",
                                    [GROBO_ROLE_POSITION] = "position",
                                    [GROBO_ROLE_PRESENT_SPEED] = "present_speed",
                                    [GROBO_ROLE_LOAD] = "load",
                                    [GROBO_ROLE_CURRENT] = "current",
                                    [GROBO_ROLE_VOLTAGE] = "voltage",
                                    [GROBO_ROLE_TEMPERATURE] = "temperature"};
enum { ROLES = sizeof roles / sizeof roles[0] };

const char *grobo_i_role_name(grobo_register_role role)
{
    return (unsigned)role < ROLES ? roles[role] : NULL;
}

/* ---- values -------------------------------------------------------------------------------- */

/* A short text into `to`; its place. */
static int read_text(grobo_i_events *events, const char *what, grobo_i_servo_text to,
                     grobo_i_place *place)
{
    const grobo_i_event *event;
    char *text = NULL;
    int result = grobo_i_peek(events, &event);
    *place = event->place;
    result = result < 0 ? result : grobo_i_read_string(events, what, &text);
    if (result < 0 || text == NULL) {
        return result;
    }
    bool plain = strlen(text) < sizeof(grobo_i_servo_text);
    for (const char *c = text; *c != '\0'; c++) {
        plain = plain && *c >= ' ' && *c < 0x7F && *c != '"' && *c != '\\';
    }
    if (plain) {
        memcpy(to, text, strlen(text) + 1);
    } else {
        result = grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "name", *place,
                                  "%s: a plain text of at most %d bytes is wanted", what,
                                  (int)sizeof(grobo_i_servo_text) - 1);
    }
    grobo_i_free_text(events->reader->mem, text);
    return result;
}

/* A whole number from low to high into *value, which is untouched otherwise. */
static int read_whole(grobo_i_events *events, const char *what, long low, long high, long *value)
{
    return grobo_i_read_long(events, what, low, high, value);
}

static int read_u16(grobo_i_events *events, const char *what, long low, uint16_t *value)
{
    long found = *value;
    int result = read_whole(events, what, low, UINT16_MAX, &found);
    *value = (uint16_t)found;
    return result;
}

/* One of the words; -1: complained of. */
static int word_of(grobo_i_events *events, const char *what, const char *text, grobo_i_place place,
                   const char *const *words, int n)
{
    grobo_i_nearest nearest = {NULL, 0};
    for (int i = 0; i < n; i++) {
        if (strcmp(words[i], text) == 0) {
            return i;
        }
        grobo_i_nearest_try(&nearest, text, words[i]);
    }
    (void)grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "unknown", place, "no %s '%s'%s%s%s",
                           what, text, nearest.word != NULL ? "; did you mean '" : "",
                           nearest.word != NULL ? nearest.word : "",
                           nearest.word != NULL ? "'?" : "");
    return -1;
}

/* ---- a register ---------------------------------------------------------------------------- */

static int read_at(grobo_i_events *events, void *target)
{
    grobo_i_servo_row *row = target;
    long found = row->reg.address;
    int result = read_whole(events, "at", 0, ADDRESS_MAX, &found);
    row->reg.address = (uint16_t)found;
    return result;
}

static int read_bytes(grobo_i_events *events, void *target)
{
    grobo_i_servo_row *row = target;
    const grobo_i_event *event;
    long found = row->reg.bytes;
    int result = grobo_i_peek(events, &event);
    const grobo_i_place place = event->place;
    result = result < 0 ? result : read_whole(events, "bytes", 1, 4, &found);
    if (result == 0 && found == 3) {
        result = grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "range", place,
                                  "bytes: 1, 2 or 4 are wanted");
    }
    row->reg.bytes = (uint8_t)found;
    return result;
}

/* none, twos, or the number of the bit that is the sign of a magnitude. */
static int read_sign(grobo_i_events *events, void *target)
{
    static const char *const words[] = {"none", "twos"};
    grobo_i_servo_row *row = target;
    grobo_i_servo_text text = "none";
    grobo_i_place place;
    int result = read_text(events, "sign", text, &place);
    char *end;
    long bit = strtol(text, &end, 10);
    if (result < 0) {
        return result;
    }
    if (*text != '\0' && *end == '\0' && bit > (long)GROBO_SIGN_TWOS && bit < 32) {
        row->reg.sign = (uint8_t)bit;
        return 0;
    }
    int word = word_of(events, "sign called", text, place, words, 2);
    row->reg.sign = (uint8_t)(word > 0 ? GROBO_SIGN_TWOS : GROBO_SIGN_NONE);
    return 0;
}

/* r, rw; kept: it survives power-off. */
static int read_access(grobo_i_events *events, void *target)
{
    static const char *const words[] = {"r", "rw", "kept r", "kept rw"};
    grobo_i_servo_row *row = target;
    grobo_i_servo_text text = "r";
    grobo_i_place place;
    int result = read_text(events, "access", text, &place);
    int word = result < 0 ? -1 : word_of(events, "access called", text, place, words, 4);
    if (word >= 0) {
        row->reg.flags = (uint8_t)((word % 2 != 0 ? GROBO_REGISTER_W : 0) |
                                   (word >= 2 ? GROBO_REGISTER_KEPT : 0));
    }
    return result;
}

static int read_role(grobo_i_events *events, void *target)
{
    grobo_i_servo_row *row = target;
    grobo_i_servo_text text = "none";
    grobo_i_place place;
    int result = read_text(events, "role", text, &place);
    int word = result < 0 ? -1 : word_of(events, "role called", text, place, roles, ROLES);
    row->reg.role = (uint8_t)(word >= 0 ? word : row->reg.role);
    return result;
}

static int read_unit(grobo_i_events *events, void *target)
{
    grobo_i_place place;
    return read_text(events, "unit", ((grobo_i_servo_row *)target)->unit, &place);
}

/* A list of n numbers. @return 1, 0: another list was complained of, or an error */
static int read_few(grobo_i_events *events, const char *what, double *found, int n,
                    grobo_i_place *place)
{
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);
    if (result < 0) {
        return result;
    }
    *place = event->place;
    for (int i = 0; i < n; i++) {
        found[i] = NAN; /* as it stays where the list, or this number, was complained of */
    }
    result = grobo_i_read_doubles(events, what, found, n);
    for (int i = 0; i < n && result >= 0; i++) {
        if (!isfinite(found[i])) {
            return 0;
        }
    }
    return result < 0 ? result : 1;
}

static int read_range(grobo_i_events *events, void *target)
{
    grobo_i_servo_row *row = target;
    double found[2];
    grobo_i_place place;
    int result = read_few(events, "range", found, 2, &place);
    if (result <= 0) {
        return result;
    }
    if (found[0] < INT32_MIN || found[1] > INT32_MAX || found[0] > found[1]) {
        return grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "range", place,
                                "range: two whole numbers of 32 bits, the lower one first");
    }
    row->reg.min = (int32_t)found[0];
    row->reg.max = (int32_t)found[1];
    return 0;
}

static int read_default(grobo_i_events *events, void *target)
{
    grobo_i_servo_row *row = target;
    long found = row->reg.factory;
    int result = read_whole(events, "default", INT32_MIN, INT32_MAX, &found);
    row->reg.factory = (int32_t)found;
    return result;
}

static const grobo_i_field row_fields[] = {
    {"at", NULL, read_at},         {"bytes", NULL, read_bytes},    {"sign", NULL, read_sign},
    {"access", NULL, read_access}, {"role", NULL, read_role},      {"unit", NULL, read_unit},
    {"range", NULL, read_range},   {"default", NULL, read_default}};

static int unknown_key(grobo_i_events *events, const grobo_i_fields *fields, const char *key)
{
    grobo_i_nearest nearest = {NULL, 0};
    const grobo_i_place place = events->event.place;
    for (size_t i = 0; i < fields->count; i++) {
        grobo_i_nearest_try(&nearest, key, fields->fields[i].name);
    }
    int result = grobo_i_complain(
        events->reader, GROBO_ERR_SYNTAX, "unknown", place, "no key in %s called '%.40s'%s%s%s",
        fields->what, key, nearest.word != NULL ? "; did you mean '" : "",
        nearest.word != NULL ? nearest.word : "", nearest.word != NULL ? "'?" : "");
    return result < 0 ? result : grobo_i_skip(events);
}

static int unknown_row_key(grobo_i_events *events, void *target, const char *key);
static const grobo_i_fields row_keys = {"a register", row_fields,
                                        sizeof row_fields / sizeof row_fields[0], unknown_row_key};

static int unknown_row_key(grobo_i_events *events, void *target, const char *key)
{
    (void)target;
    return unknown_key(events, &row_keys, key);
}

static grobo_i_servo_row *row_named(grobo_i_servo_draft *draft, const char *name)
{
    for (int i = 0; i < draft->n_rows; i++) {
        if (strcmp(draft->rows[i].name, name) == 0) {
            return &draft->rows[i];
        }
    }
    return NULL;
}

/* Bits of row_fields. */
enum { HAS_AT = 1 << 0, LAYOUT = HAS_AT | 1 << 1 | 1 << 2, VALUES = 1 << 6 | 1 << 7 };

static int read_row(grobo_i_events *events, void *target, const char *name)
{
    grobo_i_servo_draft *draft = target;
    grobo_i_servo_row *row = row_named(draft, name);
    const grobo_i_place place = events->event.place;
    const bool is_new = row == NULL;
    uint32_t seen = 0;
    if (is_new) {
        if (draft->n_rows == GROBO_I_SERVO_ROWS || strlen(name) >= sizeof row->name) {
            return grobo_i_refuse(events->reader, GROBO_ERR_CAP, "list-length", place,
                                  "more than %d registers, or a name of more than %d bytes",
                                  GROBO_I_SERVO_ROWS, (int)sizeof row->name - 1);
        }
        row = &draft->rows[draft->n_rows++];
        *row = (grobo_i_servo_row){
            .reg = {.bytes = 1, .max = 255}, .layout = draft->layout, .values = draft->values};
        snprintf(row->name, sizeof row->name, "%s", name);
    }
    row->place = place;
    int result = grobo_i_read_map(events, &row_keys, row, &seen);
    row->layout = (seen & LAYOUT) != 0 ? draft->layout : row->layout;
    row->values = (seen & VALUES) != 0 ? draft->values : row->values;
    if (result >= 0 && is_new && (seen & HAS_AT) == 0) {
        draft->n_rows--; /* it may be there, misspelt, which was said then */
        return events->reader->result < 0
                   ? result
                   : grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "missing", place,
                                      "register %s: it has no 'at'", name);
    }
    return result;
}

static int read_registers(grobo_i_events *events, void *target)
{
    static const grobo_i_fields fields = {"'registers'", NULL, 0, read_row};
    uint32_t seen;
    return grobo_i_read_map(events, &fields, target, &seen);
}

static int read_dropped(grobo_i_events *events, void *target)
{
    grobo_i_servo_draft *draft = target;
    grobo_i_servo_text name = "";
    grobo_i_place place;
    int result = read_text(events, "without", name, &place);
    grobo_i_servo_row *row = row_named(draft, name);
    if (result < 0) {
        return result;
    }
    if (row == NULL) {
        return grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "unknown", place,
                                "without: there is no register '%s'", name);
    }
    *row = draft->rows[--draft->n_rows];
    return 0;
}

static int read_without(grobo_i_events *events, void *target)
{
    return grobo_i_read_list(events, "without", read_dropped, target);
}

/* ---- the model ----------------------------------------------------------------------------- */

static int read_name(grobo_i_events *events, void *target)
{
    grobo_i_place place;
    return read_text(events, "name", ((grobo_i_servo_draft *)target)->name, &place);
}

static int read_like(grobo_i_events *events, void *target)
{
    grobo_i_servo_draft *draft = target;
    grobo_i_servo_text name = "";
    grobo_i_place place;
    int result = read_text(events, "like", name, &place);
    if (result < 0 || *name == '\0') {
        return result;
    }
    const grobo_servo_model *m = &draft->model;
    bool numbers = m->number > 0 || m->span_ticks > 0 || m->speed_dps > 0 || m->torque_mnm > 0 ||
                   m->current_ma > 0 || m->voltage_mv > 0 || m->firmware > 0;
    if (draft->n_rates > 0 || draft->n_rows > 0 || draft->n_indirect > 0 || numbers) {
        return grobo_i_refuse(events->reader, GROBO_ERR_SYNTAX, "order", place,
                              "like: it comes before what differs: numbers, rates, registers");
    }
    return draft->like(draft, events->reader, name, place);
}

static int read_scale(grobo_i_events *events, void *target)
{
    grobo_i_servo_draft *draft = target;
    double found[3];
    grobo_i_place place;
    int result = read_few(events, "scale", found, 3, &place);
    if (result <= 0) {
        return result;
    }
    for (int i = 0; i < 3; i++) {
        if (found[i] < (i < 2 ? 1 : 0) || found[i] > (i == 0 ? SPAN_MAX : UINT16_MAX)) {
            return grobo_i_complain(
                events->reader, GROBO_ERR_SYNTAX, "range", place,
                "scale: at least 1 count, the degrees that they are (1 or more), "
                "and the count in the middle are wanted");
        }
    }
    draft->model.span_ticks = (uint32_t)found[0];
    draft->model.span_deg = (uint16_t)found[1];
    draft->model.middle = (uint16_t)found[2];
    draft->scale = place;
    return 0;
}

#define NUMBER(field, key, low)                                                                    \
    static int read_##field(grobo_i_events *events, void *target)                                  \
    {                                                                                              \
        return read_u16(events, key, low, &((grobo_i_servo_draft *)target)->model.field);          \
    }
NUMBER(number, "number", 0)
NUMBER(speed_dps, "speed_dps", 1)
NUMBER(torque_mnm, "torque_mnm", 0)
NUMBER(current_ma, "current_ma", 1)
NUMBER(voltage_mv, "voltage_mv", 1)

static int read_version(grobo_i_events *events, const char *what, uint8_t *version)
{
    long found = *version;
    int result = read_whole(events, what, 0, UINT8_MAX, &found);
    *version = (uint8_t)found;
    return result;
}

static int read_firmware(grobo_i_events *events, void *target)
{
    grobo_i_servo_draft *draft = target;
    return read_version(events, "firmware", &draft->model.firmware);
}

/* The first firmware that answers a fast sync read. */
static int read_fast(grobo_i_events *events, void *target)
{
    grobo_i_servo_draft *draft = target;
    return read_version(events, "fast_read", &draft->model.fast_firmware);
}

static int read_keeps(grobo_i_events *events, void *target)
{
    static const char *const words[] = {"limp", "lock", "command"};
    grobo_i_servo_draft *draft = target;
    grobo_i_servo_text text = "limp";
    grobo_i_place place;
    int result = read_text(events, "keeps", text, &place);
    int word = result < 0 ? -1 : word_of(events, "way to keep called", text, place, words, 3);
    draft->keeps = (uint8_t)(word >= 0 ? word : draft->keeps);
    return result;
}

static int read_order(grobo_i_events *events, void *target)
{
    return grobo_i_read_bool(events, "big_endian", &((grobo_i_servo_draft *)target)->big_endian);
}

static int read_joint(grobo_i_events *events, void *target)
{
    grobo_i_servo_draft *draft = target;
    bool joint = !draft->no_joint;
    int result = grobo_i_read_bool(events, "joint", &joint);
    draft->no_joint = !joint;
    return result;
}

static int read_verified(grobo_i_events *events, void *target)
{
    grobo_i_servo_draft *draft = target;
    bool verified = !draft->unverified;
    int result = grobo_i_read_bool(events, "verified", &verified);
    draft->unverified = !verified;
    return result;
}

static int read_rate(grobo_i_events *events, void *target)
{
    grobo_i_servo_draft *draft = target;
    double found[2];
    grobo_i_place place;
    int result = read_few(events, "a rate", found, 2, &place);
    if (result <= 0) {
        return result;
    }
    if (draft->n_rates == GROBO_I_SERVO_RATES || found[0] < 0 || found[0] > UINT8_MAX ||
        found[1] < 300 || found[1] > 20000000) {
        return grobo_i_complain(
            events->reader, GROBO_ERR_SYNTAX, "range", place,
            "rates: a code up to 255 and its bps from 300 to 20000000 are wanted, "
            "at most %d times",
            GROBO_I_SERVO_RATES);
    }
    for (int i = 0; i < draft->n_rates; i++) {
        if (draft->rates[i].code == found[0]) {
            return grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "range", place,
                                    "rates: code %d is there twice", draft->rates[i].code);
        }
    }
    draft->rates[draft->n_rates++] =
        (grobo_servo_rate){.code = (uint8_t)found[0], .bps = (int32_t)found[1]};
    return 0;
}

static int read_rates(grobo_i_events *events, void *target)
{
    ((grobo_i_servo_draft *)target)->n_rates = 0;
    return grobo_i_read_list(events, "rates", read_rate, target);
}

static int read_run(grobo_i_events *events, void *target)
{
    grobo_i_servo_draft *draft = target;
    double found[3];
    grobo_i_place place;
    int result = read_few(events, "indirect", found, 3, &place);
    if (result <= 0) {
        return result;
    }
    bool fits = found[0] >= 0 && found[0] <= ADDRESS_MAX && found[1] >= 0 &&
                found[1] <= ADDRESS_MAX && found[2] >= 1 && found[2] <= ADDRESS_MAX;
    if (!fits || draft->n_indirect == GROBO_I_SERVO_INDIRECTS) {
        return grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "range", place,
                                "indirect: at most %d runs of an address, a place of data and a "
                                "count",
                                GROBO_I_SERVO_INDIRECTS);
    }
    draft->indirect[draft->n_indirect++] =
        (grobo_servo_indirect){(uint16_t)found[0], (uint16_t)found[1], (uint16_t)found[2]};
    return 0;
}

static int read_indirect(grobo_i_events *events, void *target)
{
    ((grobo_i_servo_draft *)target)->n_indirect = 0;
    return grobo_i_read_list(events, "indirect", read_run, target);
}

/* ---- sources ------------------------------------------------------------------------------- */

typedef struct source_list {
    grobo_i_servo_draft *draft;
    uint32_t *mask;
} source_list;

static int read_source(grobo_i_events *events, void *target)
{
    const source_list *list = target;
    grobo_i_servo_draft *draft = list->draft;
    grobo_i_servo_text text = "";
    grobo_i_place place;
    int result = read_text(events, "a source", text, &place);
    int i = 0;
    if (result < 0 || *text == '\0') {
        return result;
    }
    while (i < draft->n_sources && strcmp(draft->source[i], text) != 0) {
        i++;
    }
    if (i == GROBO_I_SERVO_SOURCES) {
        return grobo_i_refuse(events->reader, GROBO_ERR_CAP, "list-length", place,
                              "more than %d sources", GROBO_I_SERVO_SOURCES);
    }
    if (i == draft->n_sources) {
        memcpy(draft->source[draft->n_sources++], text, sizeof text);
    }
    *list->mask |= (uint32_t)1 << i;
    return 0;
}

static int read_source_list(grobo_i_events *events, grobo_i_servo_draft *draft, uint32_t *mask)
{
    source_list list = {draft, mask};
    *mask = 0;
    return grobo_i_read_list(events, "sources", read_source, &list);
}

static int read_layout(grobo_i_events *events, void *target)
{
    grobo_i_servo_draft *draft = target;
    return read_source_list(events, draft, &draft->layout);
}

static int read_values(grobo_i_events *events, void *target)
{
    grobo_i_servo_draft *draft = target;
    return read_source_list(events, draft, &draft->values);
}

static const grobo_i_field source_fields[] = {{"layout", NULL, read_layout},
                                              {"values", NULL, read_values}};
static int unknown_source_key(grobo_i_events *events, void *target, const char *key);
static const grobo_i_fields source_keys = {"'sources'", source_fields, 2, unknown_source_key};

static int unknown_source_key(grobo_i_events *events, void *target, const char *key)
{
    (void)target;
    return unknown_key(events, &source_keys, key);
}

static int read_sources(grobo_i_events *events, void *target)
{
    uint32_t seen;
    return grobo_i_read_map(events, &source_keys, target, &seen);
}

/* What other programs read: physics, notes. */
static int skip_value(grobo_i_events *events, void *target)
{
    (void)target;
    return grobo_i_skip(events);
}

static const grobo_i_field model_fields[] = {{"name", NULL, read_name},
                                             {"like", NULL, read_like},
                                             {"sources", NULL, read_sources},
                                             {"number", NULL, read_number},
                                             {"scale", NULL, read_scale},
                                             {"speed_dps", NULL, read_speed_dps},
                                             {"torque_mnm", NULL, read_torque_mnm},
                                             {"current_ma", NULL, read_current_ma},
                                             {"voltage_mv", NULL, read_voltage_mv},
                                             {"firmware", NULL, read_firmware},
                                             {"fast_read", NULL, read_fast},
                                             {"joint", NULL, read_joint},
                                             {"verified", NULL, read_verified},
                                             {"keeps", NULL, read_keeps},
                                             {"big_endian", NULL, read_order},
                                             {"rates", NULL, read_rates},
                                             {"indirect", NULL, read_indirect},
                                             {"without", NULL, read_without},
                                             {"registers", NULL, read_registers},
                                             {"physics", NULL, skip_value},
                                             {"notes", NULL, skip_value}};
static int unknown_model_key(grobo_i_events *events, void *target, const char *key);
static const grobo_i_fields model_keys = {
    "the file", model_fields, sizeof model_fields / sizeof model_fields[0], unknown_model_key};

static int unknown_model_key(grobo_i_events *events, void *target, const char *key)
{
    (void)target;
    return unknown_key(events, &model_keys, key);
}

static int read_servo(grobo_i_events *events, void *draft)
{
    uint32_t seen;
    return grobo_i_read_map(events, &model_keys, draft, &seen);
}

int grobo_i_servo_read(grobo_i_reader *reader, grobo_i_servo_draft *draft)
{
    int result = grobo_i_read_document(reader, "a servo model's file", read_servo, draft);
    return result < 0 ? result : reader->result;
}

/* ---- whole --------------------------------------------------------------------------------- */

void grobo_i_servo_copy(grobo_i_servo_draft *draft, const grobo_servo_model *model)
{
    const grobo_servo_register *reg;
    draft->model = *model;
    draft->keeps = model->table->keeps;
    draft->big_endian = model->table->big_endian;
    for (size_t i = 0; (reg = grobo_servo_register_row(model, i)) != NULL; i++) {
        if (draft->n_rows < GROBO_I_SERVO_ROWS) {
            grobo_i_servo_row *row = &draft->rows[draft->n_rows++];
            *row = (grobo_i_servo_row){.reg = *reg};
            snprintf(row->name, sizeof row->name, "%s", reg->name);
            snprintf(row->unit, sizeof row->unit, "%s", reg->unit);
        }
    }
    for (int i = 0; i < model->indirect_count && i < GROBO_I_SERVO_INDIRECTS; i++) {
        draft->indirect[draft->n_indirect++] = model->indirect[i];
    }
    for (int i = 0; i < model->table->rate_count && draft->n_rates < GROBO_I_SERVO_RATES; i++) {
        const grobo_servo_rate *rate = &model->table->rates[i];
        if (grobo_servo_baud_bps(model, rate->code) == rate->bps) {
            draft->rates[draft->n_rates++] =
                (grobo_servo_rate){.code = rate->code, .bps = rate->bps};
        }
    }
}

static int by_address(const void *a, const void *b)
{
    const grobo_i_servo_row *x = a, *y = b;
    return x->reg.address < y->reg.address ? -1 : x->reg.address > y->reg.address;
}

static int complain(grobo_i_reader *reader, const grobo_i_servo_row *row, const char *text)
{
    return grobo_i_complain(reader, GROBO_ERR_SYNTAX, "register", row->place, "register %s: %s",
                            row->name, text);
}

/* What a value of the range can be written as. */
static bool fits(const grobo_servo_register *reg)
{
    int bits = reg->sign > GROBO_SIGN_TWOS ? reg->sign : reg->bytes * 8 - (reg->sign != 0);
    int64_t most = ((int64_t)1 << bits) - 1;
    int64_t least = reg->sign == GROBO_SIGN_NONE   ? 0
                    : reg->sign == GROBO_SIGN_TWOS ? -most - 1
                                                   : -most;
    return reg->min >= least && reg->max <= most;
}

/* Told of the one that the file speaks of. */
static void overlap(grobo_i_reader *reader, const grobo_i_servo_row *a, const grobo_i_servo_row *b)
{
    const grobo_i_servo_row *told = b->place.line > 0 ? b : a, *other = told == b ? a : b;
    (void)grobo_i_complain(reader, GROBO_ERR_SYNTAX, "register", told->place,
                           "register %s: it shares a byte with %s", told->name, other->name);
}

/* A middle that no position is would turn each angle into a count that the servo does not have. */
static void check_middle(grobo_i_reader *reader, const grobo_i_servo_draft *draft)
{
    const grobo_servo_register *goal = NULL, *most = NULL;
    for (int i = 0; i < draft->n_rows; i++) {
        const grobo_servo_register *reg = &draft->rows[i].reg;
        goal = reg->role == GROBO_ROLE_GOAL ? reg : goal;
        most = reg->role == GROBO_ROLE_MAX_POSITION ? reg : most;
    }
    const grobo_servo_register *range = most != NULL ? most : goal;
    int32_t middle = draft->model.middle;
    if (range != NULL && (middle < range->min || middle > range->max)) {
        (void)grobo_i_complain(reader, GROBO_ERR_SYNTAX, "range", draft->scale,
                               "scale: the middle %d is not within the range of %s", middle,
                               range->name);
    }
}

/* What a driver or a simulated servo divides by. */
static void check_numbers(grobo_i_reader *reader, const grobo_i_servo_draft *draft)
{
    const grobo_servo_model *m = &draft->model;
    const struct {
        const char *key;
        bool given;
    } keys[] = {{"scale", m->span_ticks > 0 && m->span_deg > 0},
                {"speed_dps", m->speed_dps > 0},
                {"current_ma", m->current_ma > 0},
                {"voltage_mv", m->voltage_mv > 0}};
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        if (!keys[i].given) {
            (void)grobo_i_complain(reader, GROBO_ERR_SYNTAX, "missing", draft->place,
                                   "%s: it has no '%s'", draft->name, keys[i].key);
        }
    }
}

int grobo_i_servo_finish(grobo_i_reader *reader, grobo_i_servo_draft *draft)
{
    static const grobo_register_role needed[] = {GROBO_ROLE_ID, GROBO_ROLE_GOAL,
                                                 GROBO_ROLE_POSITION};
    int had[ROLES] = {0};
    qsort(draft->rows, (size_t)draft->n_rows, sizeof draft->rows[0], by_address);
    for (int i = 0, end = 0; i < draft->n_rows; i++) {
        grobo_i_servo_row *row = &draft->rows[i];
        bool writable = (row->reg.flags & GROBO_REGISTER_W) != 0;
        row->reg.name = row->name;
        row->reg.unit = row->unit;
        had[row->reg.role] += row->reg.role != GROBO_ROLE_NONE;
        if (row->reg.address < end) {
            overlap(reader, row - 1, row);
        }
        if (had[row->reg.role] > 1) {
            (void)complain(reader, row, "its role is that of another one too");
        }
        if (!fits(&row->reg)) {
            (void)complain(reader, row, "its range does not fit its bytes");
        }
        if (writable && (row->reg.factory < row->reg.min || row->reg.factory > row->reg.max)) {
            (void)complain(reader, row, "its default is outside its range");
        }
        end = row->reg.address + row->reg.bytes;
    }
    for (size_t i = 0; i < sizeof needed / sizeof needed[0]; i++) {
        bool wanted = needed[i] != GROBO_ROLE_POSITION || !draft->no_joint;
        if (wanted && had[needed[i]] == 0) {
            (void)grobo_i_complain(reader, GROBO_ERR_SYNTAX, "missing", draft->place,
                                   "%s: no register has the role '%s'", draft->name,
                                   roles[needed[i]]);
        }
    }
    check_numbers(reader, draft);
    check_middle(reader, draft);
    return reader->result;
}
