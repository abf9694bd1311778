/* SPDX-License-Identifier: MIT */
/* What frames say. */
#include <string.h>

#include "src/servo/acme/acme.h"
#include "src/servo/families.h"
#include "src/servo/words/common.h"
#include "src/servo/words/instructions.h"

static bool answers(const grobo_words_sent *sent, const uint8_t *bytes, size_t n)
{
    grobo_reply asked;
    grobo_dxl2_packet p;
    if (grobo_i_acme_protocol.reply_to(sent->bytes, sent->n, &asked) < 0 ||
        grobo_i_acme_parse(bytes, n, NULL, 0, &p) < 0 || p.instruction != GROBO_DXL2_STATUS) {
        return false;
    }
    return asked.kind == GROBO_REPLY_ANY || (asked.kind == GROBO_REPLY_RETURN && asked.id == p.id &&
                                             (asked.length == p.data_bytes || p.error != 0));
}

static int peek(const grobo_words_look *look, grobo_words_frame *found)
{
    int size = grobo_i_acme_measure(look->bytes, look->n, grobo_i_words_accept(look));
    found->sum_ok = size != GROBO_ERR_CHECKSUM;
    size = size == GROBO_ERR_CHECKSUM ? look->bytes[2] + 4 : size;
    if (size > 0) {
        found->reply = look->bytes[0] == 0x5C;
        found->echo = !found->reply && !look->from_host;
        found->sent = found->reply ? grobo_i_words_asked(answers, look, (size_t)size) : NULL;
    }
    return size < 0 ? GROBO_ERR_FRAME : size;
}

static void explain(const uint8_t *bytes, size_t n, const grobo_words_frame *as, grobo_telegram *to)
{
    grobo_reply asked;
    grobo_dxl2_packet p;
    memcpy(to->data, bytes, n); /* a broken one is told as if it were good */
    to->sum_bytes = 1;
    to->sum = bytes[n - 1];
    to->right_sum = grobo_i_acme_sum(bytes, n);
    to->data[n - 1] = (uint8_t)to->right_sum;
    to->id = bytes[1];
    to->all = bytes[1] == ACME_ID_ALL;
    to->reply = as->reply;
    to->code = bytes[3];
    if (grobo_i_acme_parse(to->data, n, NULL, 0, &p) < 0) {
        return;
    }
    if (!as->reply) {
        grobo_i_words_instruction(to, &p, GROBO_I_WORDS_SCS);
        return;
    }
    grobo_i_words_ask_of(&grobo_i_acme_protocol, as->sent, p.id, &asked);
    grobo_i_words_reply(to, &p, &asked);
    if ((p.error & ACME_REFUSED) != 0) {
        grobo_i_words_status(to, "it refused the request");
    }
    if ((p.error & ACME_OVERHEATED) != 0) {
        grobo_i_words_status(to, "too hot");
    }
}

static const grobo_words words = {.name = "acme",
                                  .title = "Acme",
                                  .table = &grobo_i_acme_table,
                                  .protocol = &grobo_i_acme_protocol,
                                  .peek = peek,
                                  .answers = answers,
                                  .explain = explain};

const grobo_words *const grobo_i_words_acme[] = {&words, NULL};
