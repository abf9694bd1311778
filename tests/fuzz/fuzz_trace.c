/* SPDX-License-Identifier: MIT */
/* Traces, which anybody may have written: reading ends, every byte of a chunk comes out as part of
 * some frame exactly once, and every frame can be said in words that fit. */
#include <stddef.h>
#include <string.h>

#include "tests/fuzz/target.h"
#include "tests/support/tables.h"
#include "tools/grctl/conn/pcapng.h"
#include "tools/grctl/decode/ledger.h"
#include "tools/grctl/decode/words.h"

typedef struct input {
    const uint8_t *data;
    size_t left;
} input;

typedef struct heard {
    size_t bytes;
    ledger asked;
} heard;

static size_t take(void *ctx, void *buffer, size_t size)
{
    input *in = ctx;
    size_t n = in->left < size ? in->left : size;
    memcpy(buffer, in->data, n);
    in->data += n;
    in->left -= n;
    return n;
}

static void on_frame(void *ctx, const frame *f)
{
    static char text[WORDS_BYTES];
    heard *h = ctx;
    int64_t asked_us;
    h->bytes += f->size;
    MUST(f->size > 0 && f->end_us >= f->time_us);
    words_say(f, true, "", text, sizeof text);
    json_decref(words_json(f));
    MUST(strlen(text) >= 4 && text[strlen(text) - 1] == '\n');
    if (f->side == FRAMES_HOST && f->sum_ok) {
        ledger_ask(&h->asked, f);
    } else if (f->side == FRAMES_ROBOT) {
        (void)ledger_take(&h->asked, 0, f, &asked_us);
    }
}

static void on_settled(void *ctx, const ledger_entry *entry)
{
    (void)ctx;
    MUST(entry->answer[0].state != LEDGER_WAITING && entry->size > 0);
}

static void run(const uint8_t *data, size_t size, const grobo_words *d)
{
    static talk who;
    static pcapng_reader reader;
    static frames sides[3];
    static heard h;
    input in = {data, size};
    pcapng_chunk chunk;
    size_t fed = 0;
    int64_t now_us = 0;
    int result;
    h.bytes = 0;
    who = (talk){.words = d, .model = &grobo_i_gr001_model};
    ledger_init(&h.asked, 1, on_settled, &h);
    for (int side = FRAMES_EITHER; side <= FRAMES_ROBOT; side++) {
        frames_init(&sides[side], &who, (frames_side)side, FRAMES_ANY_WIRING, on_frame, &h);
    }
    pcapng_reader_init(&reader, take, &in);
    while ((result = pcapng_read(&reader, &chunk)) > 0) {
        frames_side side = chunk.direction == PCAPNG_OUT  ? FRAMES_HOST
                           : chunk.direction == PCAPNG_IN ? FRAMES_ROBOT
                                                          : FRAMES_EITHER;
        fed += chunk.size;
        now_us += chunk.time_us & 0xFFFF; /* time that goes on */
        frames_feed(&sides[side], now_us, chunk.bytes, chunk.size);
    }
    MUST((result < 0) == (*reader.problem != '\0'));
    for (int side = FRAMES_EITHER; side <= FRAMES_ROBOT; side++) {
        frames_end(&sides[side]);
    }
    ledger_end(&h.asked);
    MUST(h.bytes == fed);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    for (const grobo_family *f = grobo_families(); f->robot != NULL; f++) {
        for (const grobo_words *const *words = f->words; *words != NULL; words++) {
            run(data, size, *words);
        }
    }
    return 0;
}
