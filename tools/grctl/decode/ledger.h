/* SPDX-License-Identifier: MIT */
/*
 * Who was asked and who answered: keeps the requests of a host that call for a reply, and finds
 * for each reply the request that it answers. Up to two robots may answer the same requests, to
 * be compared.
 */
#ifndef GRCTL_LEDGER_H
#define GRCTL_LEDGER_H

#include "tools/grctl/decode/frames.h"

enum {
    LEDGER_ENTRIES = 64, /* requests open at a time; more push the oldest out, unanswered */
    LEDGER_SIDES = 2
};

typedef enum ledger_state {
    LEDGER_WAITING,
    LEDGER_ANSWERED,
    LEDGER_SILENT /* no answer came before a later request was answered, or at all */
} ledger_state;

typedef struct ledger_answer {
    ledger_state state;
    int64_t time_us; /* of its last byte */
    unsigned frames; /* that came: a request may have several */
    size_t size;
    uint8_t bytes[GROBO_WORDS_FRAME_BYTES];
} ledger_answer;

typedef struct ledger_entry {
    uint64_t number; /* of the request, from 1 */
    int64_t time_us; /* of its first byte */
    size_t size;
    uint8_t bytes[GROBO_WORDS_FRAME_BYTES];
    grobo_reply reply;
    ledger_answer answer[LEDGER_SIDES];
} ledger_entry;

/* All sides are done with a request. Called in the order of the requests. */
typedef void (*ledger_fn)(void *ctx, const ledger_entry *entry);

typedef struct ledger {
    /* private */
    int n_sides;
    ledger_fn settled;
    void *ctx;
    uint64_t requests;
    unsigned head, n;
    ledger_entry entries[LEDGER_ENTRIES];
} ledger;

void ledger_init(ledger *l, int n_sides, ledger_fn settled, void *ctx);

/* A frame of the host; it is kept if it calls for a reply. */
void ledger_ask(ledger *l, const frame *f);

/* A frame of a robot. True with the time of the request it answers; false: nobody asked. */
bool ledger_take(ledger *l, int side, const frame *f, int64_t *asked_us);

/* Nothing more comes: what waits is silent. */
void ledger_end(ledger *l);

#endif
