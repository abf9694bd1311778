/* SPDX-License-Identifier: MIT */
/* DYNAMIXEL 2.0 and 1.0, and Feetech, whose frame is that of 1.0: one set of instructions. */
#include <stdio.h>
#include <string.h>

#include <grobo/dxl2.h>
#include <grobo/feetech.h>

#include "tools/grctl/decode/dialect.h"

/* Who has an instruction. */
enum { X = 1, AX_MX = 2, STS = 4, SCS = 8, FEETECH = STS | SCS, ALL = X | AX_MX | FEETECH };

static const struct {
    uint8_t code, in;
    const char *action;
} instructions[] = {
    {GROBO_DXL2_PING, ALL, "ping"},
    {GROBO_DXL2_READ, ALL, "read"},
    {GROBO_DXL2_WRITE, ALL, "write"},
    {GROBO_DXL2_REG_WRITE, ALL, "write at action"},
    {GROBO_DXL2_ACTION, ALL, "action"},
    {GROBO_DXL2_FACTORY_RESET, ALL, "factory reset"},
    {GROBO_DXL2_REBOOT, X | FEETECH, "reboot"},
    {GROBO_DXL1_RESET_TURNS, FEETECH, "forget turns"},
    {GROBO_DXL1_CALIBRATE, FEETECH, "calibrate"},
    {GROBO_DXL2_CLEAR, X, "clear"},
    {GROBO_DXL2_BACKUP, X, "backup"},
    {GROBO_DXL2_SYNC_READ, X | STS, "sync read"},
    {GROBO_DXL2_SYNC_WRITE, ALL, "sync write"},
    {GROBO_DXL2_FAST_SYNC_READ, X, "fast sync read"},
    {GROBO_DXL2_BULK_READ, X | AX_MX, "bulk read"},
    {GROBO_DXL2_BULK_WRITE, X, "bulk write"},
    {GROBO_DXL2_FAST_BULK_READ, X, "fast bulk read"},
};

static const char *action_of(unsigned code)
{
    for (size_t i = 0; i < sizeof instructions / sizeof *instructions; i++) {
        if (instructions[i].code == code) {
            return instructions[i].action;
        }
    }
    return NULL;
}

static bool lacks(unsigned code, unsigned series)
{
    for (size_t i = 0; i < sizeof instructions / sizeof *instructions; i++) {
        if (instructions[i].code == code) {
            return (instructions[i].in & series) == 0;
        }
    }
    return false;
}

static telegram_part *add_part(telegram *to, int id, int address, int length)
{
    if (to->n_parts == TELEGRAM_PARTS_MAX) {
        return NULL;
    }
    to->part[to->n_parts] = (telegram_part){id, address, length, NULL};
    return &to->part[to->n_parts++];
}

static void add_status(telegram *to, const char *text)
{
    if (to->n_status < TELEGRAM_STATUS_MAX) {
        to->status[to->n_status++] = text;
    }
}

/* ---- instructions ---------------------------------------------------------------------------- */

static void add_items(telegram *to, const grobo_dxl2_packet *p, bool write)
{
    const size_t each = write ? (size_t)p->length + 1 : 1;
    to->shares = true;
    for (size_t at = 0; at + each <= p->data_bytes; at += each) {
        telegram_part *part = add_part(to, p->data[at], p->address, p->length);
        if (part && write) {
            part->data = p->data + at + 1;
        }
    }
    if (p->data_bytes % each != 0 || p->data_bytes == 0) {
        snprintf(to->trouble, sizeof to->trouble, "its last servo is cut");
    }
}

/* Of 2.0: id, address and length of two bytes each, and the data of a write. */
static void add_bulk(telegram *to, const grobo_dxl2_packet *p, bool write)
{
    size_t at = 0;
    to->shares = true;
    while (at + 5 <= p->data_bytes) {
        const uint8_t *item = p->data + at;
        int length = item[3] | item[4] << 8;
        at += 5 + (write ? (size_t)length : 0);
        telegram_part *part =
            at <= p->data_bytes ? add_part(to, item[0], item[1] | item[2] << 8, length) : NULL;
        if (part && write) {
            part->data = item + 5;
        }
    }
    if (at != p->data_bytes || at == 0) {
        snprintf(to->trouble, sizeof to->trouble, "its last servo is cut");
    }
}

static void add_old_bulk(telegram *to, const grobo_dxl2_packet *p)
{
    to->shares = true;
    for (size_t at = 1; at + 3 <= p->data_bytes; at += 3) {
        (void)add_part(to, p->data[at + 1], p->data[at + 2], p->data[at]);
    }
}

static void add_bytes(telegram *to, const grobo_dxl2_packet *p)
{
    if (p->data_bytes > 0) {
        add_part(to, p->id, -1, (int)p->data_bytes)->data = p->data;
    }
}

static void add_all(telegram *to, const grobo_dxl2_packet *p, bool old)
{
    bool reads = p->instruction == GROBO_DXL2_READ;
    switch (p->instruction) {
    case GROBO_DXL2_SYNC_READ:
    case GROBO_DXL2_FAST_SYNC_READ:
    case GROBO_DXL2_SYNC_WRITE:
        add_items(to, p, p->instruction == GROBO_DXL2_SYNC_WRITE);
        return;
    case GROBO_DXL2_BULK_READ:
        if (old) {
            add_old_bulk(to, p);
            return;
        }
        add_bulk(to, p, false);
        return;
    case GROBO_DXL2_FAST_BULK_READ:
    case GROBO_DXL2_BULK_WRITE:
        add_bulk(to, p, p->instruction == GROBO_DXL2_BULK_WRITE);
        return;
    case GROBO_DXL2_READ:
    case GROBO_DXL2_WRITE:
    case GROBO_DXL2_REG_WRITE:
        add_part(to, p->id, p->address, reads ? p->length : (int)p->data_bytes)->data =
            reads ? NULL : p->data;
        return;
    default:
        add_bytes(to, p);
    }
}

static void explain_instruction(telegram *to, const grobo_dxl2_packet *p, unsigned series)
{
    bool lacking = lacks(p->instruction, series);
    to->action = action_of(p->instruction);
    to->code = p->instruction;
    if (lacking && p->instruction != GROBO_DXL2_SYNC_READ) {
        add_bytes(to, p);
    } else {
        add_all(to, p, series != X);
    }
    for (size_t i = 0; i < to->n_parts; i++) {
        if (to->part[i].length == 0) {
            snprintf(to->trouble, sizeof to->trouble, "it %s nothing",
                     to->part[i].data ? "writes" : "reads");
        }
    }
    if (lacking) {
        snprintf(to->trouble, sizeof to->trouble, "these servos have no %s", to->action);
    }
}

/* ---- statuses -------------------------------------------------------------------------------- */

static int asked_address(const grobo_reply *asked)
{
    return asked->kind == GROBO_REPLY_RETURN ? asked->address : -1;
}

/* A status of one servo. An instruction that asks for no registers is answered without data. */
static void explain_status(telegram *to, const grobo_dxl2_packet *p, const grobo_reply *asked)
{
    to->reply = true;
    to->action = "returns";
    to->code = p->error;
    if (p->data_bytes > 0) {
        add_part(to, p->id, asked_address(asked), (int)p->data_bytes)->data = p->data;
    }
}

/* What a request asks servo `id` for. */
static void ask_of(const grobo_protocol *protocol, const sent_frame *sent, int id,
                   grobo_reply *asked)
{
    *asked = (grobo_reply){.kind = GROBO_REPLY_NONE};
    if (!sent || protocol->reply_to(sent->bytes, sent->n, asked) < 0) {
        return;
    }
    grobo_reply at = *asked;
    for (unsigned k = 0; k < asked->count && asked->count > 1; k++) {
        protocol->reply_at(sent->bytes, sent->n, k, &at);
        if (at.id == id) {
            asked->address = at.address;
            asked->length = at.length;
            asked->id = at.id;
        }
    }
}

/* ---- DYNAMIXEL 2.0 --------------------------------------------------------------------------- */

static unsigned accepted(const dialect_look *look)
{
    return look->from_robot ? GROBO_ACCEPT_COMMANDS | GROBO_ACCEPT_RETURNS : GROBO_ACCEPT_COMMANDS;
}

static int dxl2_peek(const dialect_look *look, dialect_frame *found)
{
    int size = grobo_dxl2_measure(look->bytes, look->n, accepted(look));
    found->sum_ok = size != GROBO_ERR_CHECKSUM;
    if (size == GROBO_ERR_CHECKSUM) {
        size = 7 + (look->bytes[5] | look->bytes[6] << 8);
    }
    if (size > 0) {
        bool status = look->bytes[7] == GROBO_DXL2_STATUS;
        found->reply = status;
        found->echo = !status && !look->from_host;
        found->sent = status ? dialect_asked(&dialect_dxl2, look, (size_t)size) : NULL;
    }
    return size < 0 ? GROBO_ERR_FRAME : size;
}

static const char *dxl2_why(const uint8_t *bytes, size_t n)
{
    static const uint8_t header[] = {0xFF, 0xFF, 0xFD};
    if (n < 4 || memcmp(bytes, header, sizeof header) != 0) {
        return NULL;
    }
    if (bytes[3] != 0) {
        return "the byte behind its header is not 00";
    }
    if (n > 4 && bytes[4] > GROBO_DXL2_ID_MAX && bytes[4] != GROBO_DXL2_ID_ALL) {
        return "no servo has this id";
    }
    if (n > 6) {
        int length = bytes[5] | bytes[6] << 8;
        if (length < 3 || length > GROBO_DXL2_FRAME_MAX_BYTES - 7) {
            return "no frame has this length";
        }
    }
    return n > 7 && bytes[7] == GROBO_DXL2_STATUS ? "a header in its data is not stuffed" : NULL;
}

static bool dxl2_answers(const sent_frame *sent, const uint8_t *bytes, size_t n)
{
    uint8_t room[DIALECT_FRAME_BYTES];
    grobo_dxl2_packet p;
    grobo_reply asked;
    if (grobo_dxl2_parse(bytes, n, room, sizeof room, &p) < 0 ||
        p.instruction != GROBO_DXL2_STATUS) {
        return false;
    }
    ask_of(&grobo_dxl2_protocol, sent, p.id, &asked);
    return asked.kind == GROBO_REPLY_ANY || (asked.kind == GROBO_REPLY_RETURN && asked.id == p.id &&
                                             (p.data_bytes == asked.length || p.error != 0));
}

/* The blocks of a fast status. */
static void explain_blocks(telegram *to, const uint8_t *bytes, size_t n, const sent_frame *sent)
{
    uint8_t room[DIALECT_FRAME_BYTES];
    grobo_dxl2_packet asked, block;
    int at = 8;
    to->reply = to->shares = true;
    to->action = "return";
    to->id = -1;
    if (!sent || grobo_dxl2_parse(sent->bytes, sent->n, room, sizeof room, &asked) < 0) {
        return;
    }
    bool bulk = asked.instruction == GROBO_DXL2_FAST_BULK_READ;
    for (size_t i = 0; at > 0 && i + (bulk ? 5 : 1) <= asked.data_bytes; i += bulk ? 5 : 1) {
        const uint8_t *item = asked.data + i;
        int address = bulk ? item[1] | item[2] << 8 : asked.address;
        int length = bulk ? item[3] | item[4] << 8 : asked.length;
        at = grobo_dxl2_block(bytes, n, (size_t)at, (uint16_t)length, &block);
        telegram_part *part = at > 0 ? add_part(to, block.id, address, length) : NULL;
        if (part) {
            part->data = block.data;
        }
    }
    if (at == GROBO_ERR_CHECKSUM) {
        snprintf(to->trouble, sizeof to->trouble, "the CRC of a block is wrong");
    }
}

static void dxl2_errors(telegram *to, uint8_t error)
{
    static const char *const texts[] = {NULL,
                                        "the instruction failed",
                                        "it does not know the instruction",
                                        "the CRC of the instruction was wrong",
                                        "a value is out of range",
                                        "the length of the data is wrong",
                                        "a value is outside the limits",
                                        "the register cannot be written now"};
    uint8_t number = error & (uint8_t)~GROBO_DXL2_ALERT;
    if (number > 0) {
        add_status(to, number < sizeof texts / sizeof *texts ? texts[number] : "an unknown error");
    }
    if (error & GROBO_DXL2_ALERT) {
        add_status(to, "a hardware error");
    }
}

static void dxl2_explain(const uint8_t *bytes, size_t n, const dialect_frame *as, telegram *to)
{
    grobo_dxl2_packet p;
    grobo_reply asked;
    uint8_t copy[DIALECT_FRAME_BYTES];
    to->sum_bytes = 2;
    to->sum = bytes[n - 2] | (unsigned)bytes[n - 1] << 8;
    to->right_sum = grobo_dxl2_crc(0, bytes, n - 2);
    memcpy(copy, bytes, n); /* a broken one is told as if it were good */
    copy[n - 2] = (uint8_t)(to->right_sum & 0xFF);
    copy[n - 1] = (uint8_t)(to->right_sum >> 8);
    to->id = bytes[4];
    to->reply = as->reply;
    int result = grobo_dxl2_parse(copy, n, to->data, sizeof to->data, &p);
    if (result < 0) {
        to->action = action_of(bytes[7]);
        to->code = bytes[7];
        snprintf(to->trouble, sizeof to->trouble, "its parameters are missing");
        return;
    }
    to->all = p.id == GROBO_DXL2_ID_ALL;
    if (p.instruction != GROBO_DXL2_STATUS) {
        explain_instruction(to, &p, X);
    } else if (to->all) {
        explain_blocks(to, bytes, n, as->sent);
    } else {
        ask_of(&grobo_dxl2_protocol, as->sent, p.id, &asked);
        bool ping = asked.kind == GROBO_REPLY_ANY || (as->sent && as->sent->bytes[7] == 1);
        asked.kind = ping ? GROBO_REPLY_NONE : asked.kind;
        explain_status(to, &p, &asked);
        if (ping && p.data_bytes == 3) { /* register model, and firmware */
            to->part[0] = (telegram_part){p.id, 0, 2, p.data};
            add_part(to, p.id, 6, 1)->data = p.data + 2;
        }
        dxl2_errors(to, p.error);
    }
}

const dialect dialect_dxl2 = {
    .name = "dynamixel2",
    .family = "dynamixel2",
    .title = "DYNAMIXEL 2.0",
    .table = &grobo_dxl2_table,
    .peek = dxl2_peek,
    .why = dxl2_why,
    .protocol = &grobo_dxl2_protocol,
    .answers = dxl2_answers,
    .explain = dxl2_explain,
};

/* ---- DYNAMIXEL 1.0, Feetech ------------------------------------------------------------------ */

/* The answer to one of the requests that the bytes begin with: its size and request, as
 * grobo_dxl1_answer(). */
static int old_answer(const dialect_look *look, const sent_frame **sent)
{
    int best = GROBO_ERR_FRAME;
    for (int i = 0; i < DIALECT_SENT_MAX && look->sent && look->sent[i].n > 0; i++) {
        int size = grobo_dxl1_answer(look->sent[i].bytes, look->sent[i].n, look->bytes, look->n);
        if (size > 0 || size == GROBO_ERR_CHECKSUM) {
            *sent = &look->sent[i];
            return size;
        }
        best = size == 0 ? 0 : best;
    }
    return best;
}

/* From a robot: what answers nothing is an echo or, where requests are known, no frame. */
static int old_reply(const dialect_look *look, bool asked, int answer, int size,
                     dialect_frame *found)
{
    int echo = dialect_echo(look);
    found->echo = echo > 0;
    found->reply = echo <= 0;
    if (!asked || echo > 0) {
        return size;
    }
    return answer == 0 || echo == 0 ? 0 : GROBO_ERR_FRAME;
}

/* Nothing in a frame tells whether it is a status: what was asked decides. */
static int old_peek(const dialect_look *look, dialect_frame *found)
{
    bool asked = look->sent && look->sent[0].n > 0;
    int size = grobo_dxl1_measure(look->bytes, look->n, accepted(look));
    found->sum_ok = size != GROBO_ERR_CHECKSUM;
    size = size == GROBO_ERR_CHECKSUM ? look->bytes[3] + 4 : size;
    if (size < 0 || !look->from_robot) {
        return size < 0 ? GROBO_ERR_FRAME : size;
    }
    int answer = asked ? old_answer(look, &found->sent) : GROBO_ERR_FRAME;
    if (answer > 0 || answer == GROBO_ERR_CHECKSUM) {
        found->reply = true;
        return size;
    }
    if (look->from_host) {
        found->reply = size > 0 && !action_of(look->bytes[4]);
        return size;
    }
    return old_reply(look, asked, answer, size, found);
}

static const char *old_why(const uint8_t *bytes, size_t n)
{
    if (n < 3 || bytes[0] != 0xFF || bytes[1] != 0xFF) {
        return NULL;
    }
    if (bytes[2] > GROBO_DXL1_ID_ALL) {
        return "no servo has this id";
    }
    if (n > 3 && bytes[3] < 2) {
        return "no frame has this length";
    }
    return "nobody asked for it";
}

static bool old_answers(const sent_frame *sent, const uint8_t *bytes, size_t n)
{
    return grobo_dxl1_answer(sent->bytes, sent->n, bytes, n) == (int)n;
}

typedef const char *const bit_texts[8];

static void old_explain(const uint8_t *bytes, size_t n, const dialect_frame *as, unsigned series,
                        const bit_texts *bits, telegram *to)
{
    grobo_dxl1_packet old;
    grobo_reply asked;
    memcpy(to->data, bytes, n); /* a broken one is told as if it were good */
    dialect_sum(bytes, n, to);
    to->data[n - 1] = (uint8_t)to->right_sum;
    to->id = bytes[2];
    to->all = bytes[2] == GROBO_DXL1_ID_ALL;
    to->reply = as->reply;
    if (grobo_dxl1_parse(to->data, n, as->reply, &old) < 0) {
        to->action = action_of(bytes[4]);
        to->code = bytes[4];
        snprintf(to->trouble, sizeof to->trouble, "its parameters are missing");
        return;
    }
    const grobo_dxl2_packet p = {.id = old.id,
                                 .instruction = old.instruction,
                                 .error = old.error,
                                 .address = old.address,
                                 .length = old.length,
                                 .data = old.data,
                                 .data_bytes = old.data_bytes};
    if (!as->reply) {
        explain_instruction(to, &p, series);
        return;
    }
    ask_of(&grobo_dxl1_protocol, as->sent, p.id, &asked);
    explain_status(to, &p, &asked);
    for (int bit = 0; bit < 8; bit++) {
        if (p.error & 1u << bit) {
            add_status(to, (*bits)[bit] ? (*bits)[bit] : "an unknown error");
        }
    }
}

static void dxl1_explain(const uint8_t *bytes, size_t n, const dialect_frame *as, telegram *to)
{
    static const bit_texts bits = {"voltage out of range",
                                   "the goal is outside the limits",
                                   "too hot",
                                   "a value is out of range",
                                   "the sum of the instruction was wrong",
                                   "overload",
                                   "it does not know the instruction",
                                   NULL};
    old_explain(bytes, n, as, AX_MX, &bits, to);
}

static void feetech_explain(const uint8_t *bytes, size_t n, const dialect_frame *as,
                            unsigned series, telegram *to)
{
    static const bit_texts bits = {"voltage out of range",
                                   "its sensor fails",
                                   "too hot",
                                   "too much current",
                                   NULL,
                                   "overload",
                                   NULL,
                                   NULL};
    old_explain(bytes, n, as, series, &bits, to);
}

static void sts_explain(const uint8_t *bytes, size_t n, const dialect_frame *as, telegram *to)
{
    feetech_explain(bytes, n, as, STS, to);
}

static void scs_explain(const uint8_t *bytes, size_t n, const dialect_frame *as, telegram *to)
{
    feetech_explain(bytes, n, as, SCS, to);
}

#define OLD(name_, family_, title_, table_, explain_)                                              \
    {                                                                                              \
        .name = (name_), .family = (family_), .title = (title_), .table = (table_),                \
        .peek = old_peek, .why = old_why, .protocol = &grobo_dxl1_protocol,                        \
        .answers = old_answers, .explain = (explain_)                                              \
    }

const dialect dialect_dxl1 =
    OLD("dynamixel1", "dynamixel1", "DYNAMIXEL 1.0", &grobo_dxl1_table, dxl1_explain);
const dialect dialect_sts = OLD("feetech", "feetech", "Feetech STS", &grobo_sts_table, sts_explain);
const dialect dialect_scs = OLD("scs", "feetech", "Feetech SCS", &grobo_scs_table, scs_explain);
