/* SPDX-License-Identifier: MIT */
/*
 * What frames of RS30x say, straight on a bus or through GR001's board: a frame of the board may
 * carry a packet, and then says what the packet says.
 */
#include <stdio.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/rs30x.h>

#include "src/servo/families.h"
#include "src/servo/tables.h"
#include "src/servo/words/common.h"

/* A frame taken apart. */
typedef struct parts {
    bool board, has_packet, sum_ok;
    grobo_board_frame frame;   /* board */
    grobo_rs30x_packet packet; /* has_packet */
    const uint8_t *bytes;      /* of the packet */
    size_t n;                  /* of them */
} parts;

enum { EVERYTHING = GROBO_ACCEPT_COMMANDS | GROBO_ACCEPT_RETURNS | GROBO_ACCEPT_ACKS };

/* ---- where a frame ends ---------------------------------------------------------------------- */

/* A frame of the board; its packet is there if it carries exactly one. */
static int take_board(const uint8_t *bytes, size_t n, parts *to)
{
    int size = grobo_board_peek(bytes, n, &to->frame);
    to->board = true;
    to->sum_ok = true;
    if (size > 0) {
        int inner = grobo_rs30x_peek(to->frame.packet, to->frame.packet_bytes,
                                     GROBO_ACCEPT_COMMANDS, &to->packet, &to->sum_ok);
        to->has_packet = inner > 0 && (size_t)inner == to->frame.packet_bytes;
        to->bytes = to->frame.packet;
        to->n = to->has_packet ? (size_t)inner : 0;
    }
    return size;
}

static int take(const uint8_t *bytes, size_t n, unsigned accept, bool board, parts *to)
{
    memset(to, 0, sizeof *to);
    int size = board ? take_board(bytes, n, to) : GROBO_ERR_FRAME;
    if (size < 0) {
        to->board = false;
        size = grobo_rs30x_peek(bytes, n, accept, &to->packet, &to->sum_ok);
        to->has_packet = size > 0;
        to->bytes = bytes;
        to->n = size > 0 ? (size_t)size : 0;
    }
    return size;
}

static bool is_command(const grobo_rs30x_packet *p)
{
    return p->kind == GROBO_RS30X_SHORT || p->kind == GROBO_RS30X_LONG;
}

static int reply_to(const uint8_t *frame, size_t n, grobo_reply *reply)
{
    grobo_board_frame board;
    return grobo_board_peek(frame, n, &board) > 0 ? grobo_i_board_protocol.reply_to(frame, n, reply)
                                                  : grobo_rs30x_reply_to(frame, n, reply);
}

static int carried(const uint8_t *frame, size_t n, grobo_reply *reply)
{
    parts p;
    return take(frame, n, GROBO_ACCEPT_COMMANDS, true, &p) > 0 && p.board && p.has_packet &&
                   p.sum_ok
               ? grobo_rs30x_reply_to(p.bytes, p.n, reply)
               : GROBO_ERR_FRAME;
}

static bool answers(const grobo_words_sent *sent, const uint8_t *bytes, size_t n)
{
    parts p;
    grobo_reply asked;
    if (take(bytes, n, GROBO_ACCEPT_RETURNS | GROBO_ACCEPT_ACKS, false, &p) <= 0 || !p.sum_ok ||
        reply_to(sent->bytes, sent->n, &asked) < 0) {
        return false;
    }
    switch (asked.kind) {
    case GROBO_REPLY_ACK:
        return p.packet.kind == GROBO_RS30X_ACK_BYTE || p.packet.kind == GROBO_RS30X_NACK_BYTE;
    case GROBO_REPLY_RETURN:
        return p.packet.kind == GROBO_RS30X_RETURN && p.packet.id == asked.id &&
               p.packet.address == asked.address && p.packet.length == asked.length;
    case GROBO_REPLY_NONE:
    case GROBO_REPLY_ANY: /* RS30x knows no such question */
        break;
    }
    return false;
}

static int peek(const grobo_words_look *look, grobo_words_frame *found)
{
    parts p;
    bool bus = (look->wiring & GROBO_WORDS_BUS) != 0;
    unsigned accept = look->from_robot ? EVERYTHING : GROBO_ACCEPT_COMMANDS;
    accept &= bus ? EVERYTHING : ~(unsigned)GROBO_ACCEPT_COMMANDS;
    bool board = look->from_host && (look->wiring & GROBO_WORDS_BOARD) != 0;
    int size = take(look->bytes, look->n, accept, board, &p);
    found->relay = p.board;
    found->sum_ok = p.sum_ok;
    if (!p.board) {
        bool own = size > 0 && is_command(&p.packet);
        found->echo = !look->from_host && look->bytes[0] == 0xFA;
        found->reply = size > 0 && !own;
        found->sent = found->reply ? grobo_i_words_asked(answers, look, (size_t)size) : NULL;
    }
    return size;
}

/* ---- what a packet says ---------------------------------------------------------------------- */

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
    grobo_telegram_status status;
} status_flags[] = {
    {GROBO_RS30X_STATUS_OVERHEATED, {"overheated", "too hot, torque was cut"}},
    {GROBO_RS30X_STATUS_HOT, {"hot", "temperature alarm"}},
    {GROBO_RS30X_STATUS_FLASH_ERROR, {"flash_error", "writing to flash failed"}},
    {GROBO_RS30X_STATUS_REFUSED, {"refused", "the command could not be processed"}},
};

/* The sum that a packet should have, or -1 for one that cannot be built. */
static int right_sum(const grobo_rs30x_packet *p)
{
    uint8_t bytes[GROBO_RS30X_PACKET_MAX_BYTES];
    int n = grobo_rs30x_build(p, bytes, sizeof bytes);
    return n > 0 ? bytes[n - 1] : -1;
}

static void add_parts(const grobo_rs30x_packet *p, grobo_telegram *to)
{
    to->shares = p->kind == GROBO_RS30X_LONG;
    for (int i = 0; to->shares && i < p->count && i < GROBO_TELEGRAM_PARTS_MAX; i++) {
        const uint8_t *entry = p->data + (size_t)i * p->length;
        to->part[to->n_parts++] =
            (grobo_telegram_part){entry[0], p->address, p->length - 1, entry + 1};
    }
    if (!to->shares && p->data_bytes > 0) {
        to->part[to->n_parts++] =
            (grobo_telegram_part){p->id, p->address, (int)p->data_bytes, p->data};
    }
}

/* What a command asks for, or does behind what it writes. */
static void add_command(const parts *from, grobo_telegram *to)
{
    const grobo_rs30x_packet *p = &from->packet;
    grobo_reply reply;
    bool writes =
        to->n_parts > 0 && (strcmp(to->action, "write") == 0 || p->address < GROBO_REGISTERS);
    if (writes && strcmp(to->action, "write") != 0) {
        to->then = to->action;
    }
    to->bare = !writes && !to->shares;
    if (grobo_rs30x_reply_to(from->bytes, from->n, &reply) >= 0 &&
        reply.kind == GROBO_REPLY_RETURN) {
        to->address = reply.address;
        to->length = reply.length;
    }
    to->remark = (p->flags & 0x80) != 0 ? "unknown flag 80" : NULL;
}

static void explain_packet(const parts *from, grobo_telegram *to)
{
    static const char *const kinds[] = {"short", "long", "return", "ack", "nack"};
    const grobo_rs30x_packet *p = &from->packet;
    to->kind = kinds[p->kind];
    to->id = p->id;
    to->all = p->id == GROBO_RS30X_ID_ALL;
    to->code = p->flags;
    to->action = action_of(p);
    to->headed = true;
    to->header[0] = (uint8_t)p->address;
    to->header[1] = (uint8_t)p->length;
    to->header[2] = (uint8_t)p->count;
    to->address = p->address;
    to->length = p->length;
    to->sum_bytes = 1;
    to->sum = from->bytes[from->n - 1];
    to->right_sum = right_sum(p);
    add_parts(p, to);
    if (p->kind != GROBO_RS30X_RETURN) {
        add_command(from, to);
        return;
    }
    to->reply = true;
    for (size_t i = 0; i < sizeof status_flags / sizeof status_flags[0]; i++) {
        if (p->flags & status_flags[i].bit) {
            to->status[to->n_status++] = status_flags[i].status;
        }
    }
}

/* ---- what a frame says ----------------------------------------------------------------------- */

static void say_board(const parts *from, grobo_telegram *to)
{
    static const char *const kinds[] = {"check", "relay", "relay_return", "slot", "scenario"};
    const grobo_board_frame *b = &from->frame;
    size_t cap = sizeof to->relay.lead;
    to->relay.kind = kinds[b->kind];
    to->relay.number = -1;
    to->relay.asked_bytes = -1;
    switch (b->kind) {
    case GROBO_BOARD_CHECK:
        to->plain = "check the board";
        return;
    case GROBO_BOARD_SLOT:
    case GROBO_BOARD_SCENARIO:
        to->relay.number = b->number;
        snprintf(to->relay.lead, cap, "play %s %u",
                 b->kind == GROBO_BOARD_SLOT ? "motion slot" : "scenario", b->number);
        to->plain = "";
        return;
    case GROBO_BOARD_SEND:
        snprintf(to->relay.lead, cap, "relay %zu: ", b->packet_bytes);
        break;
    case GROBO_BOARD_ASK:
        to->relay.asked_bytes = b->reply_bytes;
        snprintf(to->relay.lead, cap, "relay %zu, return %u: ", b->packet_bytes, b->reply_bytes);
        break;
    }
    if (!from->has_packet) {
        to->plain = "no whole packet:";
        to->bad = true;
        to->rest = b->packet;
        to->n_rest = b->packet_bytes;
    }
}

static void explain(const uint8_t *bytes, size_t n, const grobo_words_frame *as, grobo_telegram *to)
{
    parts p;
    to->id = -1;
    if (take(bytes, n, EVERYTHING, as->relay || (!as->reply && !as->echo && bytes[0] != 0xFA),
             &p) <= 0) {
        return;
    }
    if (p.board) {
        say_board(&p, to);
    }
    if (!p.has_packet) {
        return;
    }
    if (p.packet.kind == GROBO_RS30X_ACK_BYTE || p.packet.kind == GROBO_RS30X_NACK_BYTE) {
        to->reply = true;
        to->bad = p.packet.kind == GROBO_RS30X_NACK_BYTE;
        to->kind = to->bad ? "nack" : "ack";
        to->plain = to->bad ? "NACK: refused" : "ACK";
        return;
    }
    explain_packet(&p, to);
}

static const char *remark(const grobo_servo_register *reg, int32_t value)
{
    return reg->address == GROBO_RS30X_GOAL_TIME && value == 0 ? "full speed" : NULL;
}

/* ---- what no servo can do -------------------------------------------------------------------- */

/* Of a packet: ids and addresses; values are judged by the registers. */
static const char *packet_offence(const parts *from, char *why, size_t cap)
{
    const grobo_rs30x_packet *p = &from->packet;
    grobo_reply reply;
    bool many = p->kind == GROBO_RS30X_LONG;
    size_t step = many ? p->length : p->data_bytes;
    size_t skip = many ? 1 : 0;
    bool writes = p->address < GROBO_REGISTERS; /* No.255 stands in commands */
    if (p->kind == GROBO_RS30X_SHORT && grobo_rs30x_reply_to(from->bytes, from->n, &reply) < 0) {
        snprintf(why, cap, "it asks for what no servo returns (flags %02X)", p->flags);
        return "request";
    }
    for (size_t at = 0; writes && step > 0 && at + step <= p->data_bytes; at += step) {
        if (skip && (p->data[at] < 1 || p->data[at] > GROBO_RS30X_ID_MAX)) {
            snprintf(why, cap, "id %d is outside 1..%d", p->data[at], GROBO_RS30X_ID_MAX);
            return "range";
        }
        if (p->address + step - skip > GROBO_REGISTERS) {
            snprintf(why, cap, "it writes No.%d, behind the last register",
                     (int)(p->address + step - skip - 1));
            return "range";
        }
    }
    return NULL;
}

/* A frame of the board asks for as many bytes as its packet is answered by. */
static const char *relay_offence(const parts *from, char *why, size_t cap)
{
    grobo_reply reply;
    int bytes = grobo_rs30x_reply_to(from->bytes, from->n, &reply);
    int asked = from->frame.kind == GROBO_BOARD_ASK ? from->frame.reply_bytes : 0;
    if (from->frame.kind > GROBO_BOARD_ASK || bytes < 0 || bytes == asked) {
        return NULL;
    }
    snprintf(why, cap, "it asks the board for %d bytes, the servo returns %d", asked, bytes);
    return "relay";
}

static const char *offence(const uint8_t *bytes, size_t n, char *why, size_t cap)
{
    parts p;
    if (take(bytes, n, GROBO_ACCEPT_COMMANDS, true, &p) <= 0 || !p.has_packet) {
        return NULL;
    }
    const char *code = packet_offence(&p, why, cap);
    return code == NULL && p.board ? relay_offence(&p, why, cap) : code;
}

static const grobo_words words = {.name = "rs30x",
                                  .title = "Futaba RS30x",
                                  .table = &grobo_i_rs30x_table,
                                  .protocol = &grobo_i_rs30x_protocol,
                                  .last_model = true,
                                  .numbered = true,
                                  .says_request = true,
                                  .peek = peek,
                                  .reply_to = reply_to,
                                  .carried = carried,
                                  .answers = answers,
                                  .explain = explain,
                                  .offence = offence,
                                  .remark = remark};

const grobo_words *const grobo_i_words_rs30x[] = {&words, NULL};
