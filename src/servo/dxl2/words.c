/* SPDX-License-Identifier: MIT */
/* What frames of DYNAMIXEL 2.0 say. */
#include <stdio.h>
#include <string.h>

#include <grobo/core/dxl2.h>

#include "src/servo/families.h"
#include "src/servo/tables.h"
#include "src/servo/words/common.h"
#include "src/servo/words/instructions.h"

static bool answers(const grobo_words_sent *sent, const uint8_t *bytes, size_t n);

static int peek(const grobo_words_look *look, grobo_words_frame *found)
{
    int size = grobo_dxl2_measure(look->bytes, look->n, grobo_i_words_accept(look));
    found->sum_ok = size != GROBO_ERR_CHECKSUM;
    if (size == GROBO_ERR_CHECKSUM) {
        size = 7 + (look->bytes[5] | look->bytes[6] << 8);
    }
    if (size > 0) {
        bool status = look->bytes[7] == GROBO_DXL2_STATUS;
        found->reply = status;
        found->echo = !status && !look->from_host;
        found->sent = status ? grobo_i_words_asked(answers, look, (size_t)size) : NULL;
    }
    return size < 0 ? GROBO_ERR_FRAME : size;
}

static const char *why(const uint8_t *bytes, size_t n)
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

static bool answers(const grobo_words_sent *sent, const uint8_t *bytes, size_t n)
{
    uint8_t room[GROBO_WORDS_FRAME_BYTES];
    grobo_dxl2_packet p;
    grobo_reply asked;
    if (grobo_dxl2_parse(bytes, n, room, sizeof room, &p) < 0 ||
        p.instruction != GROBO_DXL2_STATUS) {
        return false;
    }
    grobo_i_words_ask_of(&grobo_i_dxl2_protocol, sent, p.id, &asked);
    return asked.kind == GROBO_REPLY_ANY || (asked.kind == GROBO_REPLY_RETURN && asked.id == p.id &&
                                             (p.data_bytes == asked.length || p.error != 0));
}

/* The blocks of a fast status. */
static void explain_blocks(grobo_telegram *to, const uint8_t *bytes, size_t n,
                           const grobo_words_sent *sent)
{
    uint8_t room[GROBO_WORDS_FRAME_BYTES];
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
        grobo_telegram_part *part =
            at > 0 ? grobo_i_words_part(to, block.id, address, length) : NULL;
        if (part) {
            part->data = block.data;
        }
    }
    if (at == GROBO_ERR_CHECKSUM) {
        snprintf(to->trouble, sizeof to->trouble, "the CRC of a block is wrong");
    }
}

static void add_errors(grobo_telegram *to, uint8_t error)
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
        grobo_i_words_status(to, number < sizeof texts / sizeof *texts ? texts[number]
                                                                       : "an unknown error");
    }
    if (error & GROBO_DXL2_ALERT) {
        grobo_i_words_status(to, "a hardware error");
    }
}

static void explain(const uint8_t *bytes, size_t n, const grobo_words_frame *as, grobo_telegram *to)
{
    grobo_dxl2_packet p;
    grobo_reply asked;
    uint8_t copy[GROBO_WORDS_FRAME_BYTES];
    to->sum_bytes = 2;
    to->sum = bytes[n - 2] | (unsigned)bytes[n - 1] << 8;
    to->right_sum = (int)grobo_dxl2_crc(0, bytes, n - 2);
    memcpy(copy, bytes, n); /* a broken one is told as if it were good */
    copy[n - 2] = (uint8_t)(to->right_sum & 0xFF);
    copy[n - 1] = (uint8_t)(to->right_sum >> 8);
    to->id = bytes[4];
    to->reply = as->reply;
    int result = grobo_dxl2_parse(copy, n, to->data, sizeof to->data, &p);
    if (result < 0) {
        to->action = grobo_i_words_action(bytes[7]);
        to->code = bytes[7];
        snprintf(to->trouble, sizeof to->trouble, "its parameters are missing");
        return;
    }
    to->all = p.id == GROBO_DXL2_ID_ALL;
    if (p.instruction != GROBO_DXL2_STATUS) {
        grobo_i_words_instruction(to, &p, GROBO_I_WORDS_X);
    } else if (to->all) {
        explain_blocks(to, bytes, n, as->sent);
    } else {
        grobo_i_words_ask_of(&grobo_i_dxl2_protocol, as->sent, p.id, &asked);
        bool ping = asked.kind == GROBO_REPLY_ANY || (as->sent && as->sent->bytes[7] == 1);
        asked.kind = ping ? GROBO_REPLY_NONE : asked.kind;
        grobo_i_words_reply(to, &p, &asked);
        if (ping && p.data_bytes == 3) { /* register model, and firmware */
            to->part[0] = (grobo_telegram_part){p.id, 0, 2, p.data};
            grobo_i_words_part(to, p.id, 6, 1)->data = p.data + 2;
        }
        add_errors(to, p.error);
    }
}

static const grobo_words words = {
    .name = "dynamixel2",
    .title = "DYNAMIXEL 2.0",
    .table = &grobo_i_dxl2_table,
    .protocol = &grobo_i_dxl2_protocol,
    .peek = peek,
    .why = why,
    .answers = answers,
    .explain = explain,
};

const grobo_words *const grobo_i_words_dxl2[] = {&words, NULL};
