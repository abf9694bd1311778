/* SPDX-License-Identifier: MIT */
/* Kondo ICS: no header, length or sum; what comes back is known by what was asked. */
#include <stdio.h>
#include <string.h>

#include <grobo/core/ics.h>

#include "src/servo/families.h"
#include "src/servo/tables.h"
#include "src/servo/words/common.h"

/* Values are told like registers: of two bytes, the low one first, of one, the EEPROM. */
enum { AT_GOAL = 0, AT_POSITION = 2, AT_ITEMS = 4, AT_ID = 8 };

#define FIELD(name_, address_, bytes_, role_, unit_, min_, max_)                                   \
    {                                                                                              \
        .name = (name_), .unit = (unit_), .min = (min_), .max = (max_), .address = (address_),     \
        .bytes = (bytes_), .role = GROBO_ROLE_##role_, .flags = GROBO_REGISTER_W                   \
    }

static const grobo_servo_register fields[] = {
    FIELD("position", AT_GOAL, 2, GOAL, "0.034 deg", GROBO_ICS_POSITION_MIN,
          GROBO_ICS_POSITION_MAX),
    FIELD("present_position", AT_POSITION, 2, POSITION, "0.034 deg", 0, 16383),
    FIELD("stretch", AT_ITEMS, 1, NONE, "", 1, 127),
    FIELD("speed", AT_ITEMS + 1, 1, SPEED, "", 1, 127),
    FIELD("current", AT_ITEMS + 2, 1, CURRENT, "", 0, 127),
    FIELD("temperature", AT_ITEMS + 3, 1, TEMPERATURE, "", 0, 127),
    FIELD("id", AT_ID, 1, ID, "", 0, 31),
};

static const grobo_servo_table table;

static const grobo_servo_model models[] = {{.name = "KRS",
                                            .span_ticks = 8000,
                                            .span_deg = 270,
                                            .middle = GROBO_ICS_POSITION_MIDDLE,
                                            .table = &table}};

static const uint64_t one_model[] = {1};

static const grobo_servo_table table = {.name = "Kondo KRS",
                                        .registers = fields,
                                        .models = models,
                                        .sets = one_model,
                                        .register_count = sizeof fields / sizeof *fields,
                                        .model_count = 1};

/* The request that a reply without one must have had; its values do not count. */
static const grobo_words_sent *guess(const uint8_t *bytes, size_t n)
{
    static grobo_words_sent made;
    uint8_t item = n > 1 ? bytes[1] : 0;
    made = (grobo_words_sent){.bytes = {(uint8_t)(bytes[0] | 0x80), item}, .n = 2};
    if ((made.bytes[0] & 0xE0) == GROBO_ICS_WRITE) {
        made.n = item == GROBO_ICS_EEPROM ? GROBO_ICS_FRAME_MAX_BYTES : 3;
    } else if ((made.bytes[0] & 0xE0) == GROBO_ICS_POSITION) {
        made.n = 3;
    } else if (made.bytes[0] >= GROBO_ICS_ID) {
        made.bytes[1] = 0;
        made.n = 4;
    }
    return &made;
}

static bool has_asked(const grobo_words_look *look)
{
    return look->sent && look->sent[0].n > 0;
}

static int find_answer(const grobo_words_look *look, grobo_words_frame *found)
{
    int best = GROBO_ERR_FRAME;
    bool asked = has_asked(look);
    for (int i = 0; asked && i < GROBO_WORDS_SENT_MAX && look->sent[i].n > 0; i++) {
        int size = grobo_ics_answer(look->sent[i].bytes, look->sent[i].n, look->bytes, look->n);
        if (size > 0) {
            found->sent = &look->sent[i];
            return size;
        }
        best = size == 0 ? 0 : best;
    }
    if (asked || (look->bytes[0] & 0x80)) {
        return best;
    }
    const grobo_words_sent *made = guess(look->bytes, look->n);
    return grobo_ics_answer(made->bytes, made->n, look->bytes, look->n);
}

static int no_frame(int size)
{
    return size < 0 ? GROBO_ERR_FRAME : size;
}

/* From a robot, marked as a command: an echo, or its id. */
static int peek_marked(const grobo_words_look *look, grobo_words_frame *found)
{
    int echo = has_asked(look) ? grobo_i_words_echo(look) : grobo_ics_measure(look->bytes, look->n);
    if (!has_asked(look) && look->bytes[0] >= GROBO_ICS_ID) {
        found->reply = true;
        return 1;
    }
    if (echo > 0) {
        found->echo = true;
        return echo;
    }
    found->reply = true;
    int size = find_answer(look, found);
    return size < 0 && echo == 0 ? 0 : no_frame(size);
}

static int peek(const grobo_words_look *look, grobo_words_frame *found)
{
    bool marked = (look->bytes[0] & 0x80) != 0;
    bool tells_id = has_asked(look) && look->sent[0].bytes[0] >= GROBO_ICS_ID &&
                    look->sent[0].bytes[0] != look->bytes[0];
    found->sum_ok = true;
    if (marked && !look->from_host) {
        return peek_marked(look, found);
    }
    if (look->from_robot && (!marked || tells_id)) {
        found->reply = true;
        return no_frame(find_answer(look, found));
    }
    return look->from_host ? no_frame(grobo_ics_measure(look->bytes, look->n)) : GROBO_ERR_FRAME;
}

static const char *why(const uint8_t *bytes, size_t n)
{
    (void)n;
    return bytes[0] & 0x80 ? "no command goes on like this" : "nobody asked for it";
}

static int reply_to(const uint8_t *frame, size_t n, grobo_reply *reply)
{
    grobo_ics_packet p;
    int result = grobo_ics_parse(NULL, 0, frame, n, &p);
    if (result < 0) {
        return result;
    }
    uint32_t bytes = p.command == GROBO_ICS_POSITION ? 3
                     : p.command == GROBO_ICS_ID     ? 1
                     : p.command == GROBO_ICS_WRITE  ? (p.item == GROBO_ICS_EEPROM ? 2 : 3)
                     : p.item == GROBO_ICS_EEPROM    ? GROBO_ICS_FRAME_MAX_BYTES
                                                     : (p.item == GROBO_ICS_POSITION_ITEM ? 4 : 3);
    *reply = (grobo_reply){
        .kind = GROBO_REPLY_RETURN, .id = p.id, .count = 1, .length = 1, .bytes = bytes};
    return (int)bytes;
}

static bool answers(const grobo_words_sent *sent, const uint8_t *bytes, size_t n)
{
    return grobo_ics_answer(sent->bytes, sent->n, bytes, n) == (int)n;
}

static void add(grobo_telegram *to, int address, int length, bool data, int value)
{
    to->data[0] = (uint8_t)(value & 0xFF);
    to->data[1] = (uint8_t)(value >> 8);
    to->part[0] = (grobo_telegram_part){to->id, address, length, data ? to->data : NULL};
    to->n_parts = 1;
}

static void explain_item(const grobo_ics_packet *p, bool data, grobo_telegram *to)
{
    bool position = p->item == GROBO_ICS_POSITION_ITEM;
    if (p->item > GROBO_ICS_POSITION_ITEM) {
        snprintf(to->trouble, sizeof to->trouble, "no servo has item %u", p->item);
    } else if (p->item != GROBO_ICS_EEPROM) {
        add(to, position ? AT_POSITION : AT_ITEMS + p->item - 1, position ? 2 : 1, data, p->value);
    } else {
        to->action = to->reply ? to->action : data ? "write EEPROM" : "read EEPROM";
        if (p->data) {
            memcpy(to->data, p->data, GROBO_ICS_EEPROM_BYTES);
            to->part[0] = (grobo_telegram_part){to->id, -1, GROBO_ICS_EEPROM_BYTES, to->data};
            to->n_parts = 1;
        }
    }
}

static bool asks(const grobo_ics_packet *p)
{
    return p->command == GROBO_ICS_READ || (p->command == GROBO_ICS_ID && p->item == 0);
}

static void explain(const uint8_t *bytes, size_t n, const grobo_words_frame *as, grobo_telegram *to)
{
    grobo_ics_packet p;
    const grobo_words_sent *sent = !as->reply ? NULL : as->sent ? as->sent : guess(bytes, n);
    to->id = bytes[0] & 0x1F;
    to->reply = as->reply;
    to->code = bytes[0];
    if (grobo_ics_parse(sent ? sent->bytes : NULL, sent ? sent->n : 0, bytes, n, &p) < 0) {
        return;
    }
    bool reads = asks(&p);
    to->action = as->reply ? "returns" : reads ? "read" : "write";
    if (p.command == GROBO_ICS_ID) {
        add(to, AT_ID, 1, !reads || as->reply, to->id);
        to->all = !as->reply;
    } else if (p.command != GROBO_ICS_POSITION) {
        explain_item(&p, !reads || as->reply, to);
    } else if (as->reply || p.value != GROBO_ICS_FREE) {
        add(to, as->reply ? AT_POSITION : AT_GOAL, 2, true, p.value);
    } else {
        to->action = "free";
    }
}

static const grobo_words words = {.name = "ics",
                                  .title = "Kondo ICS",
                                  .table = &table,
                                  .peek = peek,
                                  .why = why,
                                  .protocol = &grobo_i_ics_protocol,
                                  .reply_to = reply_to,
                                  .answers = answers,
                                  .explain = explain};

const grobo_words *const grobo_i_words_ics[] = {&words, NULL};
