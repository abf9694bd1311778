/* SPDX-License-Identifier: MIT */
/* Instructions of DYNAMIXEL and Feetech: one set, of which each series has a part. */
#include <stdio.h>
#include <string.h>

#include "src/servo/words/common.h"
#include "src/servo/words/instructions.h"

enum {
    X = GROBO_I_WORDS_X,
    AX_MX = GROBO_I_WORDS_AX_MX,
    STS = GROBO_I_WORDS_STS,
    FEETECH = GROBO_I_WORDS_STS | GROBO_I_WORDS_SCS,
    ALL = X | AX_MX | FEETECH
};

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

const char *grobo_i_words_action(unsigned code)
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

grobo_telegram_part *grobo_i_words_part(grobo_telegram *to, int id, int address, int length)
{
    if (to->n_parts == GROBO_TELEGRAM_PARTS_MAX) {
        return NULL;
    }
    to->part[to->n_parts] = (grobo_telegram_part){id, address, length, NULL};
    return &to->part[to->n_parts++];
}

/* ---- instructions ---------------------------------------------------------------------------- */

static void add_items(grobo_telegram *to, const grobo_dxl2_packet *p, bool write)
{
    const size_t each = write ? (size_t)p->length + 1 : 1;
    to->shares = true;
    for (size_t at = 0; at + each <= p->data_bytes; at += each) {
        grobo_telegram_part *part = grobo_i_words_part(to, p->data[at], p->address, p->length);
        if (part && write) {
            part->data = p->data + at + 1;
        }
    }
    if (p->data_bytes % each != 0 || p->data_bytes == 0) {
        snprintf(to->trouble, sizeof to->trouble, "its last servo is cut");
    }
}

/* Of 2.0: id, address and length of two bytes each, and the data of a write. */
static void add_bulk(grobo_telegram *to, const grobo_dxl2_packet *p, bool write)
{
    size_t at = 0;
    to->shares = true;
    while (at + 5 <= p->data_bytes) {
        const uint8_t *item = p->data + at;
        int length = item[3] | item[4] << 8;
        at += 5 + (write ? (size_t)length : 0);
        grobo_telegram_part *part =
            at <= p->data_bytes ? grobo_i_words_part(to, item[0], item[1] | item[2] << 8, length)
                                : NULL;
        if (part && write) {
            part->data = item + 5;
        }
    }
    if (at != p->data_bytes || at == 0) {
        snprintf(to->trouble, sizeof to->trouble, "its last servo is cut");
    }
}

static void add_old_bulk(grobo_telegram *to, const grobo_dxl2_packet *p)
{
    to->shares = true;
    for (size_t at = 1; at + 3 <= p->data_bytes; at += 3) {
        (void)grobo_i_words_part(to, p->data[at + 1], p->data[at + 2], p->data[at]);
    }
}

static void add_bytes(grobo_telegram *to, const grobo_dxl2_packet *p)
{
    if (p->data_bytes > 0) {
        grobo_i_words_part(to, p->id, -1, (int)p->data_bytes)->data = p->data;
    }
}

static void add_all(grobo_telegram *to, const grobo_dxl2_packet *p, bool old)
{
    uint8_t code = p->instruction;
    bool reads = code == GROBO_DXL2_READ;
    if (code == GROBO_DXL2_SYNC_READ || code == GROBO_DXL2_FAST_SYNC_READ ||
        code == GROBO_DXL2_SYNC_WRITE) {
        add_items(to, p, code == GROBO_DXL2_SYNC_WRITE);
    } else if (code == GROBO_DXL2_BULK_READ && old) {
        add_old_bulk(to, p);
    } else if (code == GROBO_DXL2_BULK_READ || code == GROBO_DXL2_FAST_BULK_READ ||
               code == GROBO_DXL2_BULK_WRITE) {
        add_bulk(to, p, code == GROBO_DXL2_BULK_WRITE);
    } else if (reads || code == GROBO_DXL2_WRITE || code == GROBO_DXL2_REG_WRITE) {
        grobo_i_words_part(to, p->id, p->address, reads ? p->length : (int)p->data_bytes)->data =
            reads ? NULL : p->data;
    } else {
        add_bytes(to, p);
    }
}

void grobo_i_words_instruction(grobo_telegram *to, const grobo_dxl2_packet *p, unsigned series)
{
    bool lacking = lacks(p->instruction, series);
    to->action = grobo_i_words_action(p->instruction);
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
void grobo_i_words_reply(grobo_telegram *to, const grobo_dxl2_packet *p, const grobo_reply *asked)
{
    to->reply = true;
    to->action = "returns";
    to->code = p->error;
    if (p->data_bytes > 0) {
        grobo_i_words_part(to, p->id, asked_address(asked), (int)p->data_bytes)->data = p->data;
    }
}

/* What a request asks servo `id` for. */
void grobo_i_words_ask_of(const grobo_protocol *protocol, const grobo_words_sent *sent, int id,
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
