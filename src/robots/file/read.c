/* SPDX-License-Identifier: MIT */
/* From the text of a robot's file to a draft: a mapping is a table of its keys. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/text/nearest.h"
#include "src/motion/text/utf8.h"
#include "src/robots/file/draft.h"

typedef enum key_kind {
    KEY_NUMBER, /* `count` of them; more than one in a list */
    KEY_WHOLE,
    KEY_NAME, /* letters, digits, _ - . */
    KEY_TEXT,
    KEY_TRUTH,
    KEY_CALL
} key_kind;

typedef struct key_row {
    const char *name;
    key_kind kind;
    int count;
    bool needed;
    size_t offset;    /* in the draft of the mapping */
    double low, high; /* of numbers */
    int (*read)(grobo_i_events *events, void *draft);
} key_row;

typedef struct keys {
    const char *what;
    const key_row *rows;
    size_t n;
} keys;

#define NUMBER(name_, type, field, low_, high_)                                                    \
    {                                                                                              \
        .name = (name_), .kind = KEY_NUMBER, .count = 1, .offset = offsetof(type, field),          \
        .low = (low_), .high = (high_)                                                             \
    }
#define NUMBERS(name_, type, field, n, low_, high_)                                                \
    {                                                                                              \
        .name = (name_), .kind = KEY_NUMBER, .count = (n), .offset = offsetof(type, field),        \
        .low = (low_), .high = (high_)                                                             \
    }
#define WHOLE(name_, type, field, low_, high_)                                                     \
    {                                                                                              \
        .name = (name_), .kind = KEY_WHOLE, .count = 1, .offset = offsetof(type, field),           \
        .low = (low_), .high = (high_)                                                             \
    }
#define NAME(name_, type, field)                                                                   \
    {                                                                                              \
        .name = (name_), .kind = KEY_NAME, .offset = offsetof(type, field)                         \
    }
#define NEEDED(name_, type, field)                                                                 \
    {                                                                                              \
        .name = (name_), .kind = KEY_NAME, .needed = true, .offset = offsetof(type, field)         \
    }
#define NEEDED_NUMBERS(name_, type, field, n, low_, high_)                                         \
    {                                                                                              \
        .name = (name_), .kind = KEY_NUMBER, .count = (n), .needed = true,                         \
        .offset = offsetof(type, field), .low = (low_), .high = (high_)                            \
    }
#define CALL(name_, fn)                                                                            \
    {                                                                                              \
        .name = (name_), .kind = KEY_CALL, .read = (fn)                                            \
    }

static int read_line(grobo_i_events *events, void *draft);
static int read_safety(grobo_i_events *events, void *draft);
static int read_usb(grobo_i_events *events, void *draft);
static int read_joints(grobo_i_events *events, void *draft);
static int read_groups(grobo_i_events *events, void *draft);
static int read_links(grobo_i_events *events, void *draft);
static int read_members(grobo_i_events *events, void *draft);
static int read_payload(grobo_i_events *events, void *draft);
static int read_feet(grobo_i_events *events, void *draft);
static int read_motor(grobo_i_events *events, void *draft);
static int read_lines(grobo_i_events *events, void *draft);

#define ROBOT grobo_i_draft
#define JOINT grobo_i_joint_draft
#define LINK grobo_i_link_draft
#define SAFETY grobo_i_safety_draft
#define MOTOR grobo_i_motor_draft

static const key_row robot_keys[] = {
    NEEDED("name", ROBOT, name),
    {.name = "title", .kind = KEY_TEXT, .offset = offsetof(ROBOT, title)},
    NAME("model", ROBOT, model),
    NAME("family", ROBOT, family),
    NAME("wiring", ROBOT, wiring),
    CALL("line", read_line),
    CALL("lines", read_lines),
    CALL("usb", read_usb),
    CALL("safety", read_safety),
    NAME("exit", ROBOT, exit),
    {.name = "arm", .kind = KEY_TRUTH, .offset = offsetof(ROBOT, arm)},
    {.name = "calibrated", .kind = KEY_TRUTH, .offset = offsetof(ROBOT, calibrated)},
    NUMBER("limit_slack_deg", ROBOT, limit_slack_deg, 0, GROBO_LIMIT_SLACK_MAX_DEG),
    {.name = "joints", .kind = KEY_CALL, .needed = true, .read = read_joints},
    CALL("groups", read_groups),
    CALL("links", read_links),
    CALL("payload", read_payload),
    CALL("feet", read_feet),
};

static const key_row line_keys[] = {WHOLE("baud", grobo_i_line_draft, baud_bps, 300, 4000000)};

#define LINES grobo_i_lines_draft
static const key_row lines_keys[] = {
    NEEDED("name", LINES, name),
    NEEDED("family", LINES, family),
    NAME("wiring", LINES, wiring),
    WHOLE("baud", LINES, baud_bps, 300, 4000000),
    {.name = "port", .kind = KEY_TEXT, .offset = offsetof(LINES, port)},
    {.name = "echo", .kind = KEY_TRUTH, .offset = offsetof(LINES, echo)},
};

static const key_row safety_keys[] = {
    WHOLE("temperature_c", SAFETY, temperature_c, 0, 150),
    WHOLE("lost_replies", SAFETY, lost_replies, 0, 1000),
    WHOLE("current_ma", SAFETY, current_ma, 0, 100000),
    WHOLE("current_ms", SAFETY, current_ms, 0, 60000),
    WHOLE("voltage_mv", SAFETY, voltage_mv, 0, 100000),
    NUMBER("approach_deg_s", SAFETY, approach_deg_s, 1, 1000),
};

static const key_row joint_keys[] = {
    NEEDED("name", JOINT, name),
    NAME("type", JOINT, type),
    {.name = "id",
     .kind = KEY_WHOLE,
     .count = 1,
     .offset = offsetof(JOINT, id),
     .high = GROBO_SERVO_ID_MAX},
    {.name = "servos",
     .kind = KEY_WHOLE,
     .count = 2,
     .offset = offsetof(JOINT, servos),
     .high = GROBO_SERVO_ID_MAX},
    {.name = "servo", .kind = KEY_TEXT, .needed = true, .offset = offsetof(JOINT, servo)},
    {.name = "limits_deg",
     .kind = KEY_NUMBER,
     .count = 2,
     .offset = offsetof(JOINT, limits_deg),
     .low = -360000,
     .high = 360000},
    {.name = "limits_mm",
     .kind = KEY_NUMBER,
     .count = 2,
     .offset = offsetof(JOINT, limits_mm),
     .low = -100000,
     .high = 100000},
    NUMBER("mm_per_turn", JOINT, mm_per_turn, 0.01, 100000),
    NUMBER("init_mm", JOINT, init_mm, -100000, 100000),
    NUMBER("rest_mm", JOINT, rest_mm, -100000, 100000),
    NUMBER("speed_mm_s", JOINT, speed_mm_s, 0.01, 100000),
    {.name = "percent_deg",
     .kind = KEY_NUMBER,
     .count = 2,
     .offset = offsetof(JOINT, percent_deg),
     .low = -360000,
     .high = 360000},
    NUMBER("init_deg", JOINT, init_deg, -360000, 360000),
    NUMBER("rest_deg", JOINT, rest_deg, -360000, 360000),
    NUMBER("speed_deg_s", JOINT, speed_deg_s, 1, 10000),
    NUMBER("accel_deg_s2", JOINT, accel_deg_s2, 1, 1000000),
    WHOLE("torque_limit_pct", JOINT, torque_limit_pct, 1, 100),
    WHOLE("free_ma", JOINT, free_ma, 0, 60000),
    WHOLE("sign", JOINT, sign, -1, 1),
    {.name = "signs",
     .kind = KEY_WHOLE,
     .count = 2,
     .offset = offsetof(JOINT, signs),
     .low = -1,
     .high = 1},
    NUMBER("apart_deg", JOINT, apart_deg, 0.5, 90),
    NAME("line", JOINT, line),
    NAME("follows", JOINT, follows),
    NUMBER("ratio", JOINT, ratio, -100, 100),
    NUMBER("zero_deg", JOINT, zero_deg, -360, 360),
    NUMBER("gear", JOINT, gear, 0.001, 1000),
    {.name = "turns", .kind = KEY_TRUTH, .offset = offsetof(JOINT, turns)},
    NAME("mirror", JOINT, mirror),
    WHOLE("mirror_sign", JOINT, mirror_sign, -1, 1),
    NUMBER("readback_deg", JOINT, readback_deg, -20, 20),
    CALL("motor", read_motor),
};

static const key_row motor_keys[] = {
    NUMBER("kt_nm_a", MOTOR, kt_nm_a, 1e-6, 1000),
    NUMBER("resistance_ohm", MOTOR, resistance_ohm, 1e-6, 1e6),
    NUMBER("armature_kgm2", MOTOR, armature_kgm2, 0, 1000),
    NUMBER("torque_max_nm", MOTOR, torque_max_nm, 0, 1000),
    NUMBER("friction_nm", MOTOR, friction_nm, 0, 1000),
    NUMBER("viscous_nms", MOTOR, viscous_nms, 0, 1000),
    NUMBER("backlash_deg", MOTOR, backlash_deg, 0, 20),
};

static const key_row group_keys[] = {
    NEEDED("name", grobo_i_group_draft, name),
    {.name = "joints", .kind = KEY_CALL, .needed = true, .read = read_members},
};

static const key_row link_keys[] = {
    NEEDED("name", LINK, name),
    NAME("parent", LINK, parent),
    NAME("joint", LINK, joint),
    NUMBERS("origin_m", LINK, origin_m, 3, -100, 100),
    NUMBERS("origin_deg", LINK, origin_deg, 3, -360, 360),
    NUMBERS("axis", LINK, axis, 3, -1, 1),
    NUMBER("mass_kg", LINK, mass_kg, 0, 10000),
    NUMBERS("com_m", LINK, com_m, 3, -100, 100),
    NUMBERS("inertia_kgm2", LINK, inertia_kgm2, 6, -1000, 1000),
};

static const key_row payload_keys[] = {
    NEEDED("link", grobo_i_payload_draft, link),
    NUMBER("max_kg", grobo_i_payload_draft, max_kg, 0, 100),
};

static const key_row foot_keys[] = {
    NEEDED("link", grobo_i_foot_draft, link),
    NEEDED_NUMBERS("sole_m", grobo_i_foot_draft, sole_m, 3, -100, 100),
    NEEDED_NUMBERS("half_m", grobo_i_foot_draft, half_m, 2, 0, 100),
};

#define KEYS(what, rows)                                                                           \
    {                                                                                              \
        what, rows, sizeof(rows) / sizeof(rows)[0]                                                 \
    }
static const keys blocks[GROBO_I_BLOCKS] = {
    [GROBO_I_BLOCK_ROBOT] = KEYS("the file", robot_keys),
    [GROBO_I_BLOCK_LINE] = KEYS("'line'", line_keys),
    [GROBO_I_BLOCK_SAFETY] = KEYS("'safety'", safety_keys),
    [GROBO_I_BLOCK_JOINT] = KEYS("a joint", joint_keys),
    [GROBO_I_BLOCK_GROUP] = KEYS("a group", group_keys),
    [GROBO_I_BLOCK_LINK] = KEYS("a link", link_keys),
    [GROBO_I_BLOCK_MOTOR] = KEYS("'motor'", motor_keys),
    [GROBO_I_BLOCK_LINES] = KEYS("a line", lines_keys),
    [GROBO_I_BLOCK_PAYLOAD] = KEYS("'payload'", payload_keys),
    [GROBO_I_BLOCK_FOOT] = KEYS("a foot", foot_keys),
};

const char *grobo_i_robot_key(grobo_i_block block, size_t index)
{
    return index < blocks[block].n ? blocks[block].rows[index].name : NULL;
}

bool grobo_i_robot_key_needed(grobo_i_block block, size_t index)
{
    return blocks[block].rows[index].needed;
}

static size_t index_of(grobo_i_block block, const char *name)
{
    size_t i = 0;
    while (i < blocks[block].n && strcmp(blocks[block].rows[i].name, name) != 0) {
        i++;
    }
    return i;
}

bool grobo_i_has_key(grobo_i_block block, const grobo_i_place *at, const char *key)
{
    return at[index_of(block, key)].line > 0;
}

grobo_i_place grobo_i_place_of(grobo_i_block block, const grobo_i_place *at, grobo_i_place whole,
                               const char *key)
{
    return grobo_i_has_key(block, at, key) ? at[index_of(block, key)] : whole;
}

int grobo_i_complain_word(grobo_i_reader *reader, grobo_i_place place, const char *what,
                          const char *word, const char *nearest)
{
    return grobo_i_complain(reader, GROBO_ERR_SYNTAX, "unknown", place, "no %s '%.*s'%s%s%s", what,
                            GROBO_NAME_MAX_BYTES, word, *nearest ? "; did you mean '" : "", nearest,
                            *nearest ? "'?" : "");
}

/* ---- values -------------------------------------------------------------------------------- */

static bool is_name(const char *text)
{
    static const char all[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789.-";
    return (*text < '0' || *text > '9') && *text != '.' && *text != '-' &&
           strspn(text, all) == strlen(text);
}

/* What find_joint() takes for a number of a motor or joint. */
static bool is_number_of(const char *text)
{
    return strchr("mMjJ", text[0]) != NULL && text[1] != '\0' &&
           strspn(text + 1, "0123456789") == strlen(text + 1);
}

static int read_text(grobo_i_events *events, const key_row *k, grobo_i_place place, char *to)
{
    grobo_i_reader *reader = events->reader;
    char *text = NULL;
    int result = grobo_i_read_string(events, k->name, &text);
    if (result < 0 || text == NULL) {
        return result;
    }
    bool fits = strlen(text) < GROBO_NAME_MAX_BYTES && grobo_i_utf8_ok(text, strlen(text));
    if (!fits || *text == '\0' || (k->kind == KEY_NAME && !is_name(text))) {
        result = grobo_i_complain(reader, GROBO_ERR_SYNTAX, "name", place,
                                  k->kind == KEY_NAME ? "%s: a name has letters, digits, _ - . and "
                                                        "begins with a letter; at most %d bytes"
                                                      : "%s: a text of 1 to %d bytes is wanted",
                                  k->name, GROBO_NAME_MAX_BYTES - 1);
    } else if (k->kind == KEY_NAME && is_number_of(text)) {
        result = grobo_i_complain(reader, GROBO_ERR_SYNTAX, "name", place,
                                  "%s: '%s' is the number of a motor or joint; choose another name",
                                  k->name, text);
    } else {
        snprintf(to, GROBO_NAME_MAX_BYTES, "%s", text);
    }
    grobo_i_free_text(reader->mem, text);
    return result;
}

static int read_numbers(grobo_i_events *events, const key_row *k, grobo_i_place place, double *to)
{
    double found[6] = {NAN, NAN, NAN, NAN, NAN, NAN};
    int result = k->count == 1 ? grobo_i_read_double(events, k->name, found)
                               : grobo_i_read_doubles(events, k->name, found, k->count);
    for (int i = 0; i < k->count && result == 0; i++) {
        if (isnan(found[i])) { /* complained of */
            return 0;
        }
        bool whole = k->kind != KEY_WHOLE || found[i] == floor(found[i]);
        if (found[i] < k->low || found[i] > k->high || !whole) {
            return grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "range", place,
                                    "%s: a %snumber from %g to %g is wanted", k->name,
                                    k->kind == KEY_WHOLE ? "whole " : "", k->low, k->high);
        }
        to[i] = found[i];
    }
    return result;
}

/* ---- mappings ------------------------------------------------------------------------------ */

/* A mapping while it is read. */
typedef struct block {
    const keys *keys;
    char *draft;
    grobo_i_place *at;
} block;

static int read_value(grobo_i_events *events, const key_row *k, grobo_i_place place, void *draft)
{
    void *to = (char *)draft + k->offset;
    switch (k->kind) {
    case KEY_NUMBER:
    case KEY_WHOLE:
        return read_numbers(events, k, place, to);
    case KEY_NAME:
    case KEY_TEXT:
        return read_text(events, k, place, to);
    case KEY_TRUTH:
        return grobo_i_read_bool(events, k->name, to);
    case KEY_CALL:
        return k->read(events, draft);
    }
    return GROBO_ERR_ARG;
}

static int take(grobo_i_events *events, void *target, const char *name)
{
    const block *b = target;
    const grobo_i_place key_place = events->event.place;
    const grobo_i_event *event;
    grobo_i_nearest nearest = {NULL, 0};
    for (size_t i = 0; i < b->keys->n; i++) {
        if (strcmp(b->keys->rows[i].name, name) == 0) {
            int result = grobo_i_peek(events, &event);
            if (result < 0) {
                return result;
            }
            b->at[i] = event->place;
            return read_value(events, &b->keys->rows[i], event->place, b->draft);
        }
        grobo_i_nearest_try(&nearest, name, b->keys->rows[i].name);
    }
    char what[64];
    snprintf(what, sizeof what, "key in %s called", b->keys->what);
    int result = grobo_i_complain_word(events->reader, key_place, what, name,
                                       nearest.word != NULL ? nearest.word : "");
    return result < 0 ? result : grobo_i_skip(events);
}

static int read_block(grobo_i_events *events, grobo_i_block which, void *draft, grobo_i_place *at,
                      grobo_i_place *place)
{
    block b = {&blocks[which], draft, at};
    const grobo_i_fields fields = {b.keys->what, NULL, 0, take};
    const grobo_i_event *event;
    uint32_t seen = 0;
    int result = grobo_i_peek(events, &event);
    if (result < 0) {
        return result;
    }
    bool is_map = event->kind == GROBO_I_MAP;
    *place = event->place;
    result = grobo_i_read_map(events, &fields, &b, &seen);
    for (size_t i = 0; i < b.keys->n && result == 0 && is_map; i++) {
        if (b.keys->rows[i].needed && at[i].line == 0) {
            result = grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "missing", *place,
                                      "%s has no '%s'", b.keys->what, b.keys->rows[i].name);
        }
    }
    return result;
}

static int read_line(grobo_i_events *events, void *draft)
{
    grobo_i_line_draft *line = &((grobo_i_draft *)draft)->line;
    return read_block(events, GROBO_I_BLOCK_LINE, line, line->at, &line->place);
}

static int read_safety(grobo_i_events *events, void *draft)
{
    grobo_i_safety_draft *safety = &((grobo_i_draft *)draft)->safety;
    return read_block(events, GROBO_I_BLOCK_SAFETY, safety, safety->at, &safety->place);
}

static int read_motor(grobo_i_events *events, void *draft)
{
    grobo_i_motor_draft *motor = &((grobo_i_joint_draft *)draft)->motor;
    return read_block(events, GROBO_I_BLOCK_MOTOR, motor, motor->at, &motor->place);
}

static int read_payload(grobo_i_events *events, void *draft)
{
    grobo_i_payload_draft *payload = &((grobo_i_draft *)draft)->payload;
    return read_block(events, GROBO_I_BLOCK_PAYLOAD, payload, payload->at, &payload->place);
}

/* ---- lists --------------------------------------------------------------------------------- */

/* Room for one more of a list; the place of what comes next. */
static int need_room(grobo_i_events *events, const char *what, int n, int most)
{
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);
    return result < 0 || n < most ? result
                                  : grobo_i_refuse(events->reader, GROBO_ERR_CAP, "list-length",
                                                   event->place, "more than %d %s", most, what);
}

static int read_one_line(grobo_i_events *events, void *target)
{
    grobo_i_draft *draft = target;
    int result = need_room(events, "lines", draft->n_lines, GROBO_LINES_MAX);
    if (result < 0) {
        return result;
    }
    grobo_i_lines_draft *line = &draft->lines[draft->n_lines++];
    return read_block(events, GROBO_I_BLOCK_LINES, line, line->at, &line->place);
}

static int read_lines(grobo_i_events *events, void *draft)
{
    return grobo_i_read_list(events, "lines", read_one_line, draft);
}

static int missing(grobo_i_events *events, const grobo_i_joint_draft *joint, const char *key)
{
    return grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "missing", joint->place,
                            "a joint has no '%s'", key);
}

/* Keys of a linear joint, and the keys in whose place they stand. */
static const char *const in_mm[][2] = {{"limits_mm", "limits_deg"},
                                       {"init_mm", "init_deg"},
                                       {"rest_mm", "rest_deg"},
                                       {"speed_mm_s", "speed_deg_s"}};
enum { N_IN_MM = sizeof in_mm / sizeof in_mm[0] };

/* A linear joint is an angle like any other from here on; what it says in millimetres takes the
 * place of what it would say in degrees. */
static int take_mm(grobo_i_events *events, grobo_i_joint_draft *joint)
{
    bool linear = grobo_i_has_key(GROBO_I_BLOCK_JOINT, joint->at, "mm_per_turn");
    const double *from[N_IN_MM] = {joint->limits_mm, &joint->init_mm, &joint->rest_mm,
                                   &joint->speed_mm_s};
    double *to[N_IN_MM] = {joint->limits_deg, &joint->init_deg, &joint->rest_deg,
                           &joint->speed_deg_s};
    int result = 0;
    for (int i = 0; i < N_IN_MM && result == 0; i++) {
        const grobo_i_place place = joint->at[index_of(GROBO_I_BLOCK_JOINT, in_mm[i][0])];
        grobo_i_place *other = &joint->at[index_of(GROBO_I_BLOCK_JOINT, in_mm[i][1])];
        if (place.line == 0) {
            continue;
        }
        if (!linear || other->line > 0) {
            result = grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "keys", place,
                                      linear ? "%s: '%s' and '%s' cannot be used together"
                                             : "%s: '%s' needs 'mm_per_turn'",
                                      joint->name, in_mm[i][0], in_mm[i][1]);
            continue;
        }
        for (int k = 0; k < (i == 0 ? 2 : 1); k++) {
            to[i][k] = from[i][k] * 360 / joint->mm_per_turn;
        }
        *other = place;
    }
    if (result == 0 && linear && grobo_i_has_key(GROBO_I_BLOCK_JOINT, joint->at, "percent_deg")) {
        result = grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "keys", joint->place,
                                  "%s: 'percent_deg' and 'mm_per_turn' cannot be used together",
                                  joint->name);
    }
    return result;
}

/* What a joint that turns on and on cannot have: it goes to no angle. */
static const char *const not_of_wheels[] = {
    "servos",      "limits_deg", "limits_mm", "mm_per_turn", "init_mm",   "rest_mm",
    "percent_deg", "init_deg",   "rest_deg",  "signs",       "apart_deg", "follows",
    "ratio",       "zero_deg",   "turns",     "readback_deg"};

static int check_type(grobo_i_events *events, const grobo_i_joint_draft *joint, bool *wheel)
{
    const size_t n = sizeof not_of_wheels / sizeof not_of_wheels[0];
    const grobo_i_place accel = joint->at[index_of(GROBO_I_BLOCK_JOINT, "accel_deg_s2")];
    bool typed = grobo_i_has_key(GROBO_I_BLOCK_JOINT, joint->at, "type");
    int result = 0;
    *wheel = typed && strcmp(joint->type, "wheel") == 0;
    if (typed && !*wheel && *joint->type != '\0') {
        return grobo_i_complain_word(events->reader,
                                     joint->at[index_of(GROBO_I_BLOCK_JOINT, "type")],
                                     "type of joint called", joint->type, "wheel");
    }
    for (size_t i = 0; *wheel && i < n && result == 0; i++) {
        const grobo_i_place at = joint->at[index_of(GROBO_I_BLOCK_JOINT, not_of_wheels[i])];
        result = at.line == 0
                     ? 0
                     : grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "keys", at,
                                        "%s: a wheel has no '%s'", joint->name, not_of_wheels[i]);
    }
    return *wheel || accel.line == 0 || result < 0
               ? result
               : grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "keys", accel,
                                  "%s: 'accel_deg_s2' needs 'type: wheel'", joint->name);
}

static int check_wheel(grobo_i_events *events, const grobo_i_joint_draft *joint)
{
    bool id = grobo_i_has_key(GROBO_I_BLOCK_JOINT, joint->at, "id");
    return id ? 0 : missing(events, joint, "id");
}

/* Keys of a joint of which one makes another needless. */
static int check_joint(grobo_i_events *events, const grobo_i_joint_draft *joint)
{
    bool id = grobo_i_has_key(GROBO_I_BLOCK_JOINT, joint->at, "id");
    bool servos = grobo_i_has_key(GROBO_I_BLOCK_JOINT, joint->at, "servos");
    bool follows = grobo_i_has_key(GROBO_I_BLOCK_JOINT, joint->at, "follows");
    bool limits = grobo_i_has_key(GROBO_I_BLOCK_JOINT, joint->at, "limits_deg");
    int result = id || servos ? 0 : missing(events, joint, "id");
    if (result == 0 && !limits && !follows) {
        result = missing(events, joint, "limits_deg");
    }
    if (result == 0 && ((id && servos) || (follows && (limits || servos)))) {
        result = grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "keys", joint->place,
                                  "a joint cannot have '%s' and '%s' together",
                                  follows ? "follows" : "servos",
                                  !follows ? "id"
                                  : servos ? "servos"
                                           : "limits_deg");
    }
    return result;
}

/* The second of two servos on one shaft is a joint that follows the first, right behind it. */
static int add_twin(grobo_i_events *events, grobo_i_draft *draft)
{
    grobo_i_joint_draft *first = &draft->joint[draft->n_joints - 1];
    int result = need_room(events, "joints", draft->n_joints, GROBO_JOINTS_MAX);
    if (result < 0) {
        return result;
    }
    grobo_i_joint_draft *second = &draft->joint[draft->n_joints++];
    bool signs = grobo_i_has_key(GROBO_I_BLOCK_JOINT, first->at, "signs");
    first->id = first->servos[0];
    first->sign = signs ? first->signs[0] : first->sign;
    *second = *first;
    second->id = first->servos[1];
    second->sign = signs ? first->signs[1] : -first->sign;
    second->zero_deg = first->sign * second->sign < 0 ? -first->zero_deg : first->zero_deg;
    second->twin = draft->n_joints - 2;
    second->mirror[0] = '\0';
    second->mirror_sign = 1;
    second->at[index_of(GROBO_I_BLOCK_JOINT, "readback_deg")].line = 0;
    size_t length = strlen(first->name);
    if (length + 2 >= GROBO_NAME_MAX_BYTES) {
        return grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "name", first->place,
                                "%s: too long for a joint of two servos: at most %d bytes",
                                first->name, GROBO_NAME_MAX_BYTES - 3);
    }
    memcpy(second->name + length, ".2", sizeof ".2");
    return 0;
}

static int read_joint(grobo_i_events *events, void *target)
{
    grobo_i_draft *draft = target;
    int result = need_room(events, "joints", draft->n_joints, GROBO_JOINTS_MAX);
    if (result < 0) {
        return result;
    }
    grobo_i_joint_draft *joint = &draft->joint[draft->n_joints++];
    joint->sign = joint->mirror_sign = joint->ratio = 1;
    joint->twin = -1;
    result = read_block(events, GROBO_I_BLOCK_JOINT, joint, joint->at, &joint->place);
    result = result == 0 ? take_mm(events, joint) : result;
    bool wheel = false;
    result = result == 0 ? check_type(events, joint, &wheel) : result;
    result = result != 0 ? result : wheel ? check_wheel(events, joint) : check_joint(events, joint);
    bool two = result == 0 && grobo_i_has_key(GROBO_I_BLOCK_JOINT, joint->at, "servos");
    return two ? add_twin(events, draft) : result;
}

static int read_joints(grobo_i_events *events, void *draft)
{
    return grobo_i_read_list(events, "joints", read_joint, draft);
}

/* A joint, or a group that stands above. */
static int read_member(grobo_i_events *events, void *target)
{
    static const key_row member = {.name = "a joint's name", .kind = KEY_NAME};
    grobo_i_group_draft *group = target;
    const grobo_i_draft *draft = group->of;
    const grobo_i_event *event;
    grobo_i_nearest nearest = {NULL, 0};
    grobo_i_name name = "";
    int result = grobo_i_peek(events, &event);
    const grobo_i_place place = event->place;
    result = result < 0 ? result : read_text(events, &member, place, name);
    if (result < 0 || *name == '\0') {
        return result;
    }
    for (int i = 0; i < draft->n_groups; i++) {
        if (&draft->group[i] != group && strcmp(draft->group[i].name, name) == 0) {
            group->joints |= draft->group[i].joints;
            return 0;
        }
        grobo_i_nearest_try(&nearest, name, draft->group[i].name);
    }
    for (int j = 0; j < draft->n_joints; j++) {
        if (strcmp(draft->joint[j].name, name) == 0) {
            group->joints |= GROBO_JOINT_BIT(j);
            return 0;
        }
        grobo_i_nearest_try(&nearest, name, draft->joint[j].name);
    }
    return grobo_i_complain_word(events->reader, place, "joint or group above called", name,
                                 nearest.word != NULL ? nearest.word : "");
}

static int read_members(grobo_i_events *events, void *group)
{
    return grobo_i_read_list(events, "joints", read_member, group);
}

static int read_group(grobo_i_events *events, void *target)
{
    grobo_i_draft *draft = target;
    int result = need_room(events, "groups", draft->n_groups, GROBO_ROBOT_GROUPS_MAX);
    if (result < 0) {
        return result;
    }
    grobo_i_group_draft *group = &draft->group[draft->n_groups++];
    group->of = draft;
    return read_block(events, GROBO_I_BLOCK_GROUP, group, group->at, &group->place);
}

static int read_groups(grobo_i_events *events, void *target)
{
    const grobo_i_draft *draft = target;
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);
    if (result == 0 && draft->n_joints == 0) {
        return grobo_i_refuse(events->reader, GROBO_ERR_SYNTAX, "order", event->place,
                              "groups come below the joints");
    }
    return result < 0 ? result : grobo_i_read_list(events, "groups", read_group, target);
}

static int read_link(grobo_i_events *events, void *target)
{
    grobo_i_draft *draft = target;
    int result = need_room(events, "links", draft->n_links, GROBO_ROBOT_LINKS_MAX);
    if (result < 0) {
        return result;
    }
    grobo_i_link_draft *link = &draft->link[draft->n_links++];
    return read_block(events, GROBO_I_BLOCK_LINK, link, link->at, &link->place);
}

static int read_links(grobo_i_events *events, void *draft)
{
    return grobo_i_read_list(events, "links", read_link, draft);
}

static int read_foot(grobo_i_events *events, void *target)
{
    grobo_i_draft *draft = target;
    int result = need_room(events, "feet", draft->n_feet, 2);
    if (result < 0) {
        return result;
    }
    grobo_i_foot_draft *foot = &draft->foot[draft->n_feet++];
    return read_block(events, GROBO_I_BLOCK_FOOT, foot, foot->at, &foot->place);
}

static int read_feet(grobo_i_events *events, void *draft)
{
    return grobo_i_read_list(events, "feet", read_foot, draft);
}

/* Four digits of a hexadecimal number. */
static bool read_hex(const char *text, uint16_t *value)
{
    static const char digits[] = "0123456789abcdef";
    unsigned found = 0;
    for (int i = 0; i < 4; i++) {
        char low = text[i] >= 'A' && text[i] <= 'F' ? (char)(text[i] - 'A' + 'a') : text[i];
        const char *digit = low != '\0' ? strchr(digits, low) : NULL;
        if (digit == NULL) {
            return false;
        }
        found = found * 16 + (unsigned)(digit - digits);
    }
    *value = (uint16_t)found;
    return true;
}

static int read_usb_id(grobo_i_events *events, void *target)
{
    static const key_row id = {.name = "a USB id", .kind = KEY_TEXT};
    grobo_i_draft *draft = target;
    const grobo_i_event *event;
    grobo_i_name text = "";
    int result = need_room(events, "USB ids", draft->n_usb, GROBO_ROBOT_USB_MAX);
    if (result == 0) {
        result = grobo_i_peek(events, &event);
    }
    if (result < 0) {
        return result;
    }
    const grobo_i_place place = event->place;
    result = read_text(events, &id, place, text);
    if (result < 0 || *text == '\0') {
        return result;
    }
    grobo_usb_id *to = &draft->usb[draft->n_usb];
    if (strlen(text) != 9 || text[4] != ':' || !read_hex(text, &to->vendor) ||
        !read_hex(text + 5, &to->product)) {
        return grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "usb", place,
                                "'%s' is no USB id; as 0403:6001", text);
    }
    draft->n_usb++;
    return 0;
}

static int read_usb(grobo_i_events *events, void *draft)
{
    return grobo_i_read_list(events, "usb", read_usb_id, draft);
}

/* ---- all of it ----------------------------------------------------------------------------- */

static int read_robot(grobo_i_events *events, void *target)
{
    grobo_i_draft *draft = target;
    return read_block(events, GROBO_I_BLOCK_ROBOT, draft, draft->at, &draft->place);
}

int grobo_i_read_draft(grobo_i_reader *reader, grobo_i_draft *draft)
{
    return grobo_i_read_document(reader, "a robot's file", read_robot, draft);
}
