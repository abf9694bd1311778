/* SPDX-License-Identifier: MIT */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <grobo/model.h>
#include <grobo/serial.h>

#include "tools/grctl/decode/words.h"
#include "tools/grctl/decode/words_i.h"

#include "tools/grctl/decode/registers.h"

/* Text that grows up to a cap; what does not fit is left out. */
typedef struct text {
    char *to;
    size_t capacity, used;
    bool color;
} text;

static void say(text *t, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void say(text *t, const char *format, ...)
{
    va_list list;
    int n;
    va_start(list, format);
    n = vsnprintf(t->to + t->used, t->capacity - t->used, format, list);
    va_end(list);
    if (n > 0)
        t->used += (size_t)n < t->capacity - t->used ? (size_t)n : t->capacity - t->used - 1;
}

static void say_bad(text *t, const char *what)
{
    say(t, "%s%s%s", t->color ? "\033[31m" : "", what, t->color ? "\033[0m" : "");
}

static void say_hex(text *t, const uint8_t *bytes, size_t n)
{
    for (size_t i = 0; i < n; i++)
        say(t, " %02X", bytes[i]);
}

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

/* ---- what both kinds of output share ------------------------------------------------------- */

const char *words_i_joint(uint8_t id)
{
    const grobo_model *model = &grobo_gr001_model;
    for (int j = 0; j < model->n_joints; j++)
        if (model->joints[j].motor == id)
            return model->joints[j].name;
    return NULL;
}

int words_i_share(const grobo_rs30x_packet *p, int index, words_i_part *part)
{
    if (p->kind == GROBO_RS30X_LONG) {
        const uint8_t *entry = p->data + (size_t)index * p->length;
        if (index >= p->count)
            return 0;
        *part = (words_i_part){entry[0], p->address, entry + 1, (size_t)p->length - 1};
        return 1;
    }
    if (index > 0 || p->data_bytes == 0)
        return 0;
    *part = (words_i_part){p->id, p->address, p->data, p->data_bytes};
    return 1;
}

size_t words_i_value(const words_i_part *part, size_t at, words_i_item *item)
{
    unsigned address = part->address + (unsigned)at;
    const grobo_rs30x_register *reg =
        address < GROBO_REGISTERS ? grobo_rs30x_register_at((uint8_t)address) : NULL;
    item->reg = reg;
    item->address = address;
    item->whole = reg && reg->address == address && at + reg->bytes <= part->n;
    item->value = item->whole ? grobo_rs30x_register_get(reg, part->data + at) : part->data[at];
    return item->whole ? reg->bytes : 1;
}

const char *words_i_action(const grobo_rs30x_packet *p)
{
    if (p->kind == GROBO_RS30X_RETURN)
        return "return";
    if (p->flags & GROBO_RS30X_FACTORY)
        return "factory reset";
    if ((p->flags & GROBO_RS30X_FLASH) && (p->flags & GROBO_RS30X_REBOOT))
        return "flash and reboot";
    if (p->flags & GROBO_RS30X_FLASH)
        return "flash";
    if (p->flags & GROBO_RS30X_REBOOT)
        return "reboot";
    if (p->data_bytes > 0)
        return "write";
    if ((p->flags & 0x0F) == GROBO_RS30X_WANT_ACK)
        return "ping";
    return (p->flags & 0x0F) == GROBO_RS30X_WANT_NOTHING ? "nothing" : "read";
}

const words_i_flag words_i_status[] = {
    {GROBO_RS30X_STATUS_OVERHEATED, "overheated", "too hot, torque was cut"},
    {GROBO_RS30X_STATUS_HOT, "hot", "temperature alarm"},
    {GROBO_RS30X_STATUS_FLASH_ERROR, "flash_error", "writing to flash failed"},
    {GROBO_RS30X_STATUS_REFUSED, "refused", "the command could not be processed"},
};
const size_t words_i_n_status = sizeof words_i_status / sizeof words_i_status[0];

int words_i_right_sum(const grobo_rs30x_packet *p)
{
    uint8_t bytes[GROBO_RS30X_PACKET_MAX_BYTES];
    int n = grobo_rs30x_build(p, bytes, sizeof bytes);
    return n > 0 ? bytes[n - 1] : -1;
}

/* ---- text ---------------------------------------------------------------------------------- */

static void say_servo(text *t, uint8_t id)
{
    const char *name = words_i_joint(id);
    if (id == GROBO_RS30X_ID_ALL)
        say(t, "all servos");
    else if (name)
        say(t, "servo %u (%s)", id, name);
    else
        say(t, "servo %u", id);
}

static void say_span(text *t, unsigned address, unsigned length)
{
    if (length > 1)
        say(t, "No.%u-%u", address, address + length - 1);
    else
        say(t, "No.%u", address);
}

/* Registers of a servo; reserved bytes are said where they are not 0. */
static void say_registers(text *t, const words_i_part *part)
{
    const char *comma = "";
    for (size_t at = 0; at < part->n;) {
        char value[REGISTERS_TEXT_BYTES];
        words_i_item item;
        size_t size = words_i_value(part, at, &item);
        at += size;
        if (!item.reg && item.value == 0)
            continue;
        if (item.whole) {
            registers_text(item.reg, item.value, value, sizeof value);
            say(t, "%s%s %s", comma, item.reg->name, value);
            if (item.reg->address == GROBO_RS30X_GOAL_TIME && item.value == 0)
                say(t, " (full speed)");
        } else {
            say(t, "%sNo.%u = %02X%s%s%s", comma, item.address, (unsigned)item.value,
                item.reg ? " (half of " : "", item.reg ? item.reg->name : "", item.reg ? ")" : "");
        }
        comma = ", ";
    }
    if (!*comma)
        say(t, "nothing but zeros");
}

/* Names of the registers that a long packet writes. */
static void say_names(text *t, const grobo_rs30x_packet *p)
{
    const char *comma = "";
    words_i_part part;
    if (words_i_share(p, 0, &part) == 0)
        return;
    for (size_t at = 0; at < part.n;) {
        words_i_item item;
        at += words_i_value(&part, at, &item);
        if (item.whole)
            say(t, "%s%s", comma, item.reg->name);
        else
            say(t, "%sNo.%u", comma, item.address);
        comma = ", ";
    }
}

/* What a command without data wants to see, or does. */
static void say_bare(text *t, const grobo_rs30x_packet *p, const grobo_reply *reply, int known)
{
    const char *action = words_i_action(p);
    if (strcmp(action, "read") != 0) {
        say(t, "%s ", strcmp(action, "nothing") == 0 ? "nothing for" : action);
        say_servo(t, p->id);
        return;
    }
    say(t, "read ");
    if (known >= 0 && reply->kind == GROBO_REPLY_RETURN)
        say_span(t, reply->address, reply->length);
    else
        say_span(t, p->address, p->length);
    say(t, " of ");
    say_servo(t, p->id);
}

static void say_command(text *t, const frame *f, const grobo_reply *reply, int known)
{
    const grobo_rs30x_packet *p = &f->packet;
    const char *action = words_i_action(p);
    bool only_writes = strcmp(action, "write") == 0;
    words_i_part part;
    if (p->kind == GROBO_RS30X_LONG) {
        say(t, "write %u servos: ", p->count);
        say_names(t, p);
    } else if ((only_writes || p->address < GROBO_REGISTERS) && words_i_share(p, 0, &part)) {
        say(t, "write ");
        say_servo(t, p->id);
        say(t, ": ");
        say_registers(t, &part);
        if (!only_writes)
            say(t, ", then %s", action);
    } else {
        say_bare(t, p, reply, known);
    }
    if (p->flags & 0x80)
        say(t, ", unknown flag 80");
}

static void say_return(text *t, const frame *f)
{
    const grobo_rs30x_packet *p = &f->packet;
    const char *comma = "; ";
    words_i_part part;
    say_servo(t, p->id);
    say(t, " returns");
    if (words_i_share(p, 0, &part)) {
        say(t, " ");
        say_span(t, p->address, p->length);
        say(t, ": ");
        say_registers(t, &part);
    }
    for (size_t i = 0; i < words_i_n_status; i++) {
        if (p->flags & words_i_status[i].bit) {
            say(t, "%s", comma);
            say_bad(t, words_i_status[i].text);
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
        int right = words_i_right_sum(&f->packet);
        if (right >= 0)
            snprintf(bad, sizeof bad, "sum %02X wrong, should be %02X", sum, (unsigned)right);
        else
            snprintf(bad, sizeof bad, "sum %02X wrong", sum);
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
    return f->kind == FRAME_BOARD || f->kind == FRAME_ECHO ||
           (f->kind == FRAME_PACKET &&
            (f->packet.kind == GROBO_RS30X_SHORT || f->packet.kind == GROBO_RS30X_LONG));
}

int words_i_expects(const frame *f, grobo_reply *reply)
{
    grobo_reply inner;
    int known;
    *reply = (grobo_reply){.kind = GROBO_REPLY_NONE};
    if (!is_command(f))
        return GROBO_ERR_TYPE;
    known = frame_reply(f, reply);
    if (known == GROBO_ERR_FRAME && f->kind == FRAME_BOARD && f->has_packet && f->sum_ok &&
        grobo_rs30x_reply_to(f->board.packet, f->board.packet_bytes, &inner) >= 0) {
        *reply = inner; /* the board was told another number of bytes */
        return GROBO_ERR_MISMATCH;
    }
    return known;
}

static void say_reply(text *t, const grobo_reply *reply, int known)
{
    if (known == GROBO_ERR_TYPE || known == GROBO_ERR_CHECKSUM || known == GROBO_ERR_FRAME)
        return;
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
    words_i_part part;
    for (int i = 0; words_i_share(p, i, &part); i++) {
        say(t, "    ");
        say_servo(t, part.id);
        say(t, ": ");
        say_registers(t, &part);
        say(t, "\n");
    }
}

void words_say(const frame *f, bool color, const char *note, char *to, size_t capacity)
{
    text t = {to, capacity, 0, color};
    grobo_reply reply;
    int known = words_i_expects(f, &reply);
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
        break;
    }
    if (f->kind != FRAME_ECHO)
        say_reply(&t, &reply, known);
    say(&t, "%s\n", note);
    if (f->has_packet && f->packet.kind == GROBO_RS30X_LONG && f->kind != FRAME_ECHO)
        say_shares(&t, &f->packet);
}
