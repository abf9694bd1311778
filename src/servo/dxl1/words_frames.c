/* SPDX-License-Identifier: MIT */
/* What frames of Protocol 1.0 say. Only what was asked tells whether one is a status. */
#include <stdio.h>
#include <string.h>

#include <grobo/core/dxl1.h>

#include "src/servo/dxl1/words_frames.h"
#include "src/servo/tables.h"
#include "src/servo/words/common.h"
#include "src/servo/words/instructions.h"

/* The answer to one of the requests that the bytes begin with: its size and request, as
 * grobo_dxl1_answer(). */
static int old_answer(const grobo_words_look *look, const grobo_words_sent **sent)
{
    int best = GROBO_ERR_FRAME;
    for (int i = 0; i < GROBO_WORDS_SENT_MAX && look->sent && look->sent[i].n > 0; i++) {
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
static int old_reply(const grobo_words_look *look, bool asked, int answer, int size,
                     grobo_words_frame *found)
{
    int echo = grobo_i_words_echo(look);
    found->echo = echo > 0;
    found->reply = echo <= 0;
    if (!asked || echo > 0) {
        return size;
    }
    return answer == 0 || echo == 0 ? 0 : GROBO_ERR_FRAME;
}

/* Nothing in a frame tells whether it is a status: what was asked decides. */
int grobo_i_dxl1_words_peek(const grobo_words_look *look, grobo_words_frame *found)
{
    bool asked = look->sent && look->sent[0].n > 0;
    int size = grobo_dxl1_measure(look->bytes, look->n, grobo_i_words_accept(look));
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
        found->reply = size > 0 && !grobo_i_words_action(look->bytes[4]);
        return size;
    }
    return old_reply(look, asked, answer, size, found);
}

const char *grobo_i_dxl1_words_why(const uint8_t *bytes, size_t n)
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

bool grobo_i_dxl1_words_answers(const grobo_words_sent *sent, const uint8_t *bytes, size_t n)
{
    return grobo_dxl1_answer(sent->bytes, sent->n, bytes, n) == (int)n;
}

void grobo_i_dxl1_words_explain(const uint8_t *bytes, size_t n, const grobo_words_frame *as,
                                unsigned series, const grobo_i_dxl1_bits *bits, grobo_telegram *to)
{
    grobo_dxl1_packet old;
    grobo_reply asked;
    memcpy(to->data, bytes, n); /* a broken one is told as if it were good */
    grobo_i_words_sum(bytes, n, to);
    to->data[n - 1] = (uint8_t)to->right_sum;
    to->id = bytes[2];
    to->all = bytes[2] == GROBO_DXL1_ID_ALL;
    to->reply = as->reply;
    if (grobo_dxl1_parse(to->data, n, as->reply, &old) < 0) {
        to->action = grobo_i_words_action(bytes[4]);
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
        grobo_i_words_instruction(to, &p, series);
        return;
    }
    grobo_i_words_ask_of(&grobo_i_dxl1_protocol, as->sent, p.id, &asked);
    grobo_i_words_reply(to, &p, &asked);
    for (int bit = 0; bit < 8; bit++) {
        if (p.error & 1u << bit) {
            grobo_i_words_status(to, (*bits)[bit] ? (*bits)[bit] : "an unknown error");
        }
    }
}
