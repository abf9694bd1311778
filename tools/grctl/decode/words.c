/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include <grobo/serial.h>

#include "tools/grctl/decode/explain.h"
#include "tools/grctl/decode/saytext.h"
#include "tools/grctl/decode/words.h"
#include "tools/grctl/servo/registers.h"

const char *words_side(frames_side side)
{
    switch (side) {
    case FRAMES_HOST:
        return "host";
    case FRAMES_ROBOT:
        return "robot";
    case FRAMES_EITHER:
        break;
    }
    return "unknown";
}

/* ---- what text and JSON share -------------------------------------------------------------- */

/* Part number `index` of a packet: 1, or 0 behind the last. */
static int find_part(const grobo_rs30x_packet *p, int index, telegram_part *part)
{
    if (p->kind == GROBO_RS30X_LONG) {
        const uint8_t *entry = p->data + (size_t)index * p->length;
        if (index >= p->count) {
            return 0;
        }
        *part = (telegram_part){entry[0], p->address, p->length - 1, entry + 1};
        return 1;
    }
    if (index > 0 || p->data_bytes == 0) {
        return 0;
    }
    *part = (telegram_part){p->id, p->address, (int)p->data_bytes, p->data};
    return 1;
}

/* "write", "read", "ping", "flash", "reboot", "flash and reboot", "factory reset", "return". */
static const char *action_of(const grobo_rs30x_packet *p)
{
    if (p->kind == GROBO_RS30X_RETURN) {
        return "return";
    }
    if (p->flags & GROBO_RS30X_FACTORY) {
        return "factory reset";
    }
    if ((p->flags & GROBO_RS30X_FLASH) && (p->flags & GROBO_RS30X_REBOOT)) {
        return "flash and reboot";
    }
    if (p->flags & GROBO_RS30X_FLASH) {
        return "flash";
    }
    if (p->flags & GROBO_RS30X_REBOOT) {
        return "reboot";
    }
    if (p->data_bytes > 0) {
        return "write";
    }
    if ((p->flags & 0x0F) == GROBO_RS30X_WANT_ACK) {
        return "ping";
    }
    return (p->flags & 0x0F) == GROBO_RS30X_WANT_NOTHING ? "nothing" : "read";
}

/* The flags of a return packet. */
static const struct {
    uint8_t bit;
    const char *key, *text;
} status_flags[] = {
    {GROBO_RS30X_STATUS_OVERHEATED, "overheated", "too hot, torque was cut"},
    {GROBO_RS30X_STATUS_HOT, "hot", "temperature alarm"},
    {GROBO_RS30X_STATUS_FLASH_ERROR, "flash_error", "writing to flash failed"},
    {GROBO_RS30X_STATUS_REFUSED, "refused", "the command could not be processed"},
};
enum { N_STATUS = sizeof status_flags / sizeof status_flags[0] };

/* The sum that a packet should have, or -1 for one that cannot be built. */
static int right_sum(const grobo_rs30x_packet *p)
{
    uint8_t bytes[GROBO_RS30X_PACKET_MAX_BYTES];
    int n = grobo_rs30x_build(p, bytes, sizeof bytes);
    return n > 0 ? bytes[n - 1] : -1;
}

/* ---- text ---------------------------------------------------------------------------------- */

static void say_who(text *t, uint8_t id)
{
    if (id == GROBO_RS30X_ID_ALL) {
        say(t, "all servos");
    } else {
        say_servo(t, id);
    }
}

static void say_span(text *t, unsigned address, unsigned length)
{
    if (length > 1) {
        say(t, "No.%u-%u", address, address + length - 1);
    } else {
        say(t, "No.%u", address);
    }
}

/* Registers of a servo; reserved bytes are said where they are not 0. */
static void say_registers(text *t, const telegram_part *part)
{
    const char *comma = "";
    for (int at = 0; at < part->length;) {
        char value[REGISTERS_TEXT_BYTES];
        const explain_item item = explain_item_at(EXPLAIN_RS30X, part, at);
        at += item.bytes;
        if (!item.reg && item.value == 0) {
            continue;
        }
        if (item.whole) {
            registers_text(EXPLAIN_RS30X, item.reg, item.value, value, sizeof value);
            say(t, "%s%s %s", comma, item.reg->name, value);
            if (item.reg->address == GROBO_RS30X_GOAL_TIME && item.value == 0) {
                say(t, " (full speed)");
            }
        } else {
            say(t, "%sNo.%d = %02X%s%s%s", comma, item.address, (unsigned)item.value,
                item.reg ? " (half of " : "", item.reg ? item.reg->name : "", item.reg ? ")" : "");
        }
        comma = ", ";
    }
    if (!*comma) {
        say(t, "nothing but zeros");
    }
}

/* Names of the registers that a long packet writes. */
static void say_names(text *t, const grobo_rs30x_packet *p)
{
    const char *comma = "";
    telegram_part part;
    if (find_part(p, 0, &part) == 0) {
        return;
    }
    for (int at = 0; at < part.length;) {
        const explain_item item = explain_item_at(EXPLAIN_RS30X, &part, at);
        at += item.bytes;
        if (item.whole) {
            say(t, "%s%s", comma, item.reg->name);
        } else {
            say(t, "%sNo.%d", comma, item.address);
        }
        comma = ", ";
    }
}

/* What a command without data wants to see, or does. */
static void say_bare(text *t, const grobo_rs30x_packet *p, const grobo_reply *reply, int known)
{
    const char *action = action_of(p);
    if (strcmp(action, "read") != 0) {
        say(t, "%s ", strcmp(action, "nothing") == 0 ? "nothing for" : action);
        say_who(t, p->id);
        return;
    }
    say(t, "read ");
    if (known >= 0 && reply->kind == GROBO_REPLY_RETURN) {
        say_span(t, reply->address, reply->length);
    } else {
        say_span(t, p->address, p->length);
    }
    say(t, " of ");
    say_who(t, p->id);
}

static void say_command(text *t, const frame *f, const grobo_reply *reply, int known)
{
    const grobo_rs30x_packet *p = &f->packet;
    const char *action = action_of(p);
    bool only_writes = strcmp(action, "write") == 0;
    telegram_part part;
    if (p->kind == GROBO_RS30X_LONG) {
        say(t, "write %u servos: ", p->count);
        say_names(t, p);
    } else if ((only_writes || p->address < GROBO_REGISTERS) && find_part(p, 0, &part)) {
        say(t, "write ");
        say_who(t, p->id);
        say(t, ": ");
        say_registers(t, &part);
        if (!only_writes) {
            say(t, ", then %s", action);
        }
    } else {
        say_bare(t, p, reply, known);
    }
    if (p->flags & 0x80) {
        say(t, ", unknown flag 80");
    }
}

static void say_return(text *t, const frame *f)
{
    const grobo_rs30x_packet *p = &f->packet;
    const char *comma = "; ";
    telegram_part part;
    say_who(t, p->id);
    say(t, " returns");
    if (find_part(p, 0, &part)) {
        say(t, " ");
        say_span(t, p->address, p->length);
        say(t, ": ");
        say_registers(t, &part);
    }
    for (int i = 0; i < N_STATUS; i++) {
        if (p->flags & status_flags[i].bit) {
            say(t, "%s", comma);
            say_bad(t, status_flags[i].text);
            comma = ", ";
        }
    }
}

static void say_sum(text *t, const frame *f)
{
    unsigned sum =
        f->kind == FRAME_BOARD ? f->board.packet[f->packet_size - 1] : f->bytes[f->packet_size - 1];
    char bad[64];
    if (f->sum_ok) {
        say(t, "; sum %02X right", sum);
    } else {
        int right = right_sum(&f->packet);
        if (right >= 0) {
            snprintf(bad, sizeof bad, "sum %02X wrong, should be %02X", sum, (unsigned)right);
        } else {
            snprintf(bad, sizeof bad, "sum %02X wrong", sum);
        }
        say(t, "; ");
        say_bad(t, bad);
    }
}

static void say_packet(text *t, const frame *f, const grobo_reply *reply, int known)
{
    switch (f->packet.kind) {
    case GROBO_RS30X_ACK_BYTE:
        say(t, "ACK");
        return;
    case GROBO_RS30X_NACK_BYTE:
        say_bad(t, "NACK: refused");
        return;
    case GROBO_RS30X_RETURN:
        say_return(t, f);
        break;
    case GROBO_RS30X_SHORT:
    case GROBO_RS30X_LONG:
        say_command(t, f, reply, known);
        break;
    }
    say_sum(t, f);
}

static void say_board(text *t, const frame *f, const grobo_reply *reply, int known)
{
    const grobo_board_frame *b = &f->board;
    switch (b->kind) {
    case GROBO_BOARD_CHECK:
        say(t, "check the board");
        return;
    case GROBO_BOARD_SLOT:
        say(t, "play motion slot %u", b->number);
        return;
    case GROBO_BOARD_SCENARIO:
        say(t, "play scenario %u", b->number);
        return;
    case GROBO_BOARD_SEND:
        say(t, "relay %zu: ", b->packet_bytes);
        break;
    case GROBO_BOARD_ASK:
        say(t, "relay %zu, return %u: ", b->packet_bytes, b->reply_bytes);
        break;
    }
    if (f->has_packet) {
        say_packet(t, f, reply, known);
    } else {
        say_bad(t, "no whole packet:");
        say_hex(t, b->packet, b->packet_bytes);
    }
}

static bool is_command(const frame *f)
{
    if (f->talk && f->talk->dialect) {
        return f->kind <= FRAME_ECHO && !f->as.reply;
    }
    return f->kind == FRAME_BOARD || f->kind == FRAME_ECHO ||
           (f->kind == FRAME_PACKET &&
            (f->packet.kind == GROBO_RS30X_SHORT || f->packet.kind == GROBO_RS30X_LONG));
}

/*
 * As frame_reply(); GROBO_ERR_TYPE for what is no command, GROBO_ERR_MISMATCH (with *reply) for a
 * relay frame that wants another number of bytes than its packet will return.
 */
static int expects(const frame *f, grobo_reply *reply)
{
    grobo_reply inner;
    *reply = (grobo_reply){.kind = GROBO_REPLY_NONE};
    if (!is_command(f)) {
        return GROBO_ERR_TYPE;
    }
    int known = frame_reply(f, reply);
    if (known == GROBO_ERR_FRAME && f->kind == FRAME_BOARD && f->has_packet && f->sum_ok &&
        grobo_rs30x_reply_to(f->board.packet, f->board.packet_bytes, &inner) >= 0) {
        *reply = inner; /* the board was told another number of bytes */
        return GROBO_ERR_MISMATCH;
    }
    return known;
}

static void say_reply(text *t, const grobo_reply *reply, int known)
{
    if (known == GROBO_ERR_TYPE || known == GROBO_ERR_CHECKSUM || known == GROBO_ERR_FRAME) {
        return;
    }
    say(t, "; ");
    if (known == GROBO_ERR_MISMATCH) {
        char bad[80];
        snprintf(bad, sizeof bad, "but the packet is answered by %u bytes", reply->bytes);
        say_bad(t, bad);
    } else if (known < 0) {
        say_bad(t, "asks for registers that do not exist");
    } else if (reply->kind == GROBO_REPLY_NONE) {
        say(t, "no reply");
    } else if (reply->kind == GROBO_REPLY_ACK) {
        say(t, "reply: ACK");
    } else {
        say(t, "reply: %u bytes", reply->bytes);
    }
}

static void say_shares(text *t, const grobo_rs30x_packet *p)
{
    telegram_part part;
    for (int i = 0; find_part(p, i, &part); i++) {
        say(t, "    ");
        say_who(t, (uint8_t)part.id);
        say(t, ": ");
        say_registers(t, &part);
        say(t, "\n");
    }
}

/* ---- frames of a dialect ------------------------------------------------------------------- */

static bool is_telegram(const frame *f)
{
    return f->talk && f->talk->dialect && (f->kind == FRAME_PACKET || f->kind == FRAME_ECHO);
}

static const telegram *telegram_of(const frame *f)
{
    static telegram said;
    memset(&said, 0, sizeof said);
    f->talk->dialect->explain(f->bytes, f->size, &f->as, &said);
    return &said;
}

static void say_telegram(text *t, const frame *f, const char *note)
{
    const telegram *said = telegram_of(f);
    *t->to = '\0';
    say(t, "%s", f->kind == FRAME_ECHO ? "echo: " : "");
    explain_say(t, f, said);
    say(t, "%s\n", note);
    if (f->kind != FRAME_ECHO) {
        explain_shares(t, said);
    }
}

/* Why no frame begins where rubbish looks like one. */
static void say_why(text *t, const frame *f)
{
    const char *why = NULL;
    for (size_t i = 0; f->talk && f->talk->dialect && i < f->size && !why; i++) {
        why = f->talk->dialect->why(f->bytes + i, f->size - i);
    }
    if (why) {
        say(t, " (");
        say_bad(t, why);
        say(t, ")");
    }
}

/* ---- text of any frame --------------------------------------------------------------------- */

void words_say(const frame *f, bool color, const char *note, char *to, size_t capacity)
{
    text t = {to, capacity, 0, color, f->talk};
    grobo_reply reply;
    if (is_telegram(f)) {
        say_telegram(&t, f, note);
        return;
    }
    int known = expects(f, &reply);
    *to = '\0';
    switch (f->kind) {
    case FRAME_BOARD:
        say_board(&t, f, &reply, known);
        break;
    case FRAME_PACKET:
        say_packet(&t, f, &reply, known);
        break;
    case FRAME_ECHO:
        say(&t, "echo: ");
        say_packet(&t, f, &reply, known);
        break;
    case FRAME_CUT:
        say_bad(&t, "cut off:");
        say_hex(&t, f->bytes, f->size);
        break;
    case FRAME_RUBBISH:
        say_bad(&t, "rubbish:");
        say_hex(&t, f->bytes, f->size);
        say_why(&t, f);
        break;
    }
    if (f->kind != FRAME_ECHO) {
        say_reply(&t, &reply, known);
    }
    say(&t, "%s\n", note);
    if (f->has_packet && f->packet.kind == GROBO_RS30X_LONG && f->kind != FRAME_ECHO) {
        say_shares(&t, &f->packet);
    }
}

/* ---- JSON ---------------------------------------------------------------------------------- */

static const char *kind_of(const frame *f)
{
    static const char *const board[] = {"check", "relay", "relay_return", "slot", "scenario"};
    static const char *const packet[] = {"packet", "packet", "return", "ack", "nack"};
    switch (f->kind) {
    case FRAME_BOARD:
        return board[f->board.kind];
    case FRAME_PACKET:
        if (is_telegram(f)) {
            return f->as.reply ? "return" : "packet";
        }
        return packet[f->packet.kind];
    case FRAME_ECHO:
        return "echo";
    case FRAME_CUT:
        return "cut";
    case FRAME_RUBBISH:
        return "rubbish";
    }
    return "rubbish";
}

static json_t *status_json(const grobo_rs30x_packet *p)
{
    json_t *list = json_array();
    for (int i = 0; i < N_STATUS; i++) {
        if (p->flags & status_flags[i].bit) {
            json_array_append_new(list, json_string(status_flags[i].key));
        }
    }
    return list;
}

static json_t *packet_json(const frame *f)
{
    static const char *const kinds[] = {"short", "long", "return", "ack", "nack"};
    const grobo_rs30x_packet *p = &f->packet;
    const uint8_t *bytes = f->kind == FRAME_BOARD ? f->board.packet : f->bytes;
    int right = right_sum(p);
    json_t *servos = json_array();
    telegram_part part;
    for (int i = 0; find_part(p, i, &part); i++) {
        json_array_append_new(servos, explain_part(f->talk, EXPLAIN_RS30X, &part));
    }
    return json_pack("{s:s,s:s,s:i,s:i,s:i,s:i,s:i,s:i,s:b,s:o*,s:o*,s:o}", "kind", kinds[p->kind],
                     "action", action_of(p), "id", p->id, "flags", p->flags, "address", p->address,
                     "length", p->length, "count", p->count, "sum", bytes[f->packet_size - 1],
                     "sum_ok", f->sum_ok, "right_sum",
                     !f->sum_ok && right >= 0 ? json_integer(right) : NULL, "status",
                     p->kind == GROBO_RS30X_RETURN ? status_json(p) : NULL, "servos", servos);
}

static json_t *reply_json(const frame *f, const grobo_reply *reply, int known)
{
    static const char *const kinds[] = {"none", "ack", "return", "any"};
    if (known < 0 && known != GROBO_ERR_MISMATCH) {
        return json_pack("{s:o}", "error", app_json_code(grobo_error_name(known)));
    }
    bool returns = reply->kind == GROBO_REPLY_RETURN, differs = known == GROBO_ERR_MISMATCH;
    return json_pack("{s:s,s:I,s:o*,s:o*,s:o*,s:o*}", "kind", kinds[reply->kind], "bytes",
                     (json_int_t)reply->bytes, "id", returns ? json_integer(reply->id) : NULL,
                     "address", returns ? json_integer(reply->address) : NULL, "length",
                     returns ? json_integer(reply->length) : NULL, "asked_bytes",
                     differs ? json_integer(f->board.reply_bytes) : NULL);
}

json_t *words_json(const frame *f)
{
    char hex[3 * FRAMES_BUFFER_BYTES + 1];
    grobo_reply reply;
    int known = expects(f, &reply);
    if (grobo_hex(f->bytes, f->size, hex, sizeof hex) < 0) {
        hex[0] = '\0';
    }
    bool numbered = f->kind == FRAME_BOARD &&
                    (f->board.kind == GROBO_BOARD_SLOT || f->board.kind == GROBO_BOARD_SCENARIO);
    bool replies = known != GROBO_ERR_TYPE && f->kind != FRAME_ECHO;
    json_t *said = is_telegram(f)                        ? explain_packet(f, telegram_of(f))
                   : f->has_packet && f->packet_size > 1 ? packet_json(f)
                                                         : NULL;
    return json_pack("{s:s,s:s,s:I,s:s,s:o*,s:o*,s:o*}", "from", words_side(f->side), "kind",
                     kind_of(f), "bytes", (json_int_t)f->size, "hex", hex, "number",
                     numbered ? json_integer(f->board.number) : NULL, "packet", said, "reply",
                     replies ? reply_json(f, &reply, known) : NULL);
}
