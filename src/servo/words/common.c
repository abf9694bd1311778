/* SPDX-License-Identifier: MIT */
/* What families have in common that read along: requests and their replies, sums, echoes. */
#include <string.h>

#include "src/servo/words/common.h"

unsigned grobo_i_words_accept(const grobo_words_look *look)
{
    return look->from_robot ? GROBO_ACCEPT_COMMANDS | GROBO_ACCEPT_RETURNS : GROBO_ACCEPT_COMMANDS;
}

void grobo_i_words_status(grobo_telegram *to, const char *text)
{
    if (to->n_status < GROBO_TELEGRAM_STATUS_MAX) {
        to->status[to->n_status++].text = text;
    }
}

void grobo_i_words_sum(const uint8_t *bytes, size_t n, grobo_telegram *to)
{
    unsigned sum = 0;
    for (size_t i = 2; i + 1 < n; i++) {
        sum += bytes[i];
    }
    to->sum_bytes = 1;
    to->sum = bytes[n - 1];
    to->right_sum = (int)(~sum & 0xFF);
}

const grobo_words_sent *grobo_i_words_asked(grobo_i_words_answers answers,
                                            const grobo_words_look *look, size_t size)
{
    for (int i = 0; i < GROBO_WORDS_SENT_MAX && look->sent; i++) {
        if (look->sent[i].n > 0 && answers(&look->sent[i], look->bytes, size)) {
            return &look->sent[i];
        }
    }
    return NULL;
}

int grobo_i_words_echo(const grobo_words_look *look)
{
    int open = -1;
    for (int i = 0; i < GROBO_WORDS_SENT_MAX && look->sent; i++) {
        const grobo_words_sent *sent = &look->sent[i];
        size_t n = look->n < sent->n ? look->n : sent->n;
        if (sent->n == 0 || memcmp(sent->bytes, look->bytes, n) != 0) {
            continue;
        }
        if (n == sent->n) {
            return (int)n;
        }
        open = 0;
    }
    return open;
}
