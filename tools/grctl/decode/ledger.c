/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tools/grctl/decode/ledger.h"

static ledger_entry *entry_at(ledger *l, unsigned i)
{
    return &l->entries[(l->head + i) % LEDGER_ENTRIES];
}

static bool is_settled(const ledger *l, const ledger_entry *entry)
{
    for (int side = 0; side < l->n_sides; side++) {
        if (entry->answer[side].state == LEDGER_WAITING) {
            return false;
        }
    }
    return true;
}

/* Some of several replies are an answer, too. */
static void give_up(ledger_answer *answer)
{
    if (answer->state == LEDGER_WAITING) {
        answer->state = answer->frames > 0 ? LEDGER_ANSWERED : LEDGER_SILENT;
    }
}

static void give_up_all(const ledger *l, ledger_entry *entry)
{
    for (int side = 0; side < l->n_sides; side++) {
        give_up(&entry->answer[side]);
    }
}

static void settle(ledger *l)
{
    while (l->n > 0 && is_settled(l, entry_at(l, 0))) {
        const ledger_entry *entry = entry_at(l, 0);
        l->head = (l->head + 1) % LEDGER_ENTRIES;
        l->n--;
        l->settled(l->ctx, entry);
    }
}

void ledger_init(ledger *l, int n_sides, ledger_fn settled, void *ctx)
{
    memset(l, 0, sizeof *l);
    l->n_sides = n_sides;
    l->settled = settled;
    l->ctx = ctx;
}

void ledger_ask(ledger *l, const frame *f)
{
    grobo_reply reply;
    ledger_entry *entry;
    if (frame_reply(f, &reply) < 0 || reply.kind == GROBO_REPLY_NONE ||
        f->size > sizeof entry->bytes) {
        return;
    }
    if (l->n == LEDGER_ENTRIES) {
        give_up_all(l, entry_at(l, 0));
    }
    settle(l);
    entry = entry_at(l, l->n++);
    memset(entry, 0, sizeof *entry);
    entry->number = ++l->requests;
    entry->time_us = f->time_us;
    entry->size = f->size;
    memcpy(entry->bytes, f->bytes, f->size);
    entry->reply = reply;
}

static bool is_repeat(const ledger_entry *a, const ledger_entry *b)
{
    return a->size == b->size && memcmp(a->bytes, b->bytes, a->size) == 0;
}

/* The request that a frame answers: the first that fits, or its last repetition. */
static ledger_entry *find(ledger *l, int side, const frame *f)
{
    ledger_entry *found = NULL;
    for (unsigned i = 0; i < l->n; i++) {
        ledger_entry *entry = entry_at(l, i);
        if (entry->answer[side].state == LEDGER_WAITING &&
            frame_answers(f, entry->bytes, entry->size) && (!found || is_repeat(entry, found))) {
            found = entry;
        }
    }
    return found;
}

/*
 * The line keeps the order: who is answered leaves those before it without an answer. But what
 * was asked twice may be answered twice, the first time late.
 */
bool ledger_take(ledger *l, int side, const frame *f, int64_t *asked_us)
{
    ledger_entry *entry = find(l, side, f);
    ledger_answer *answer;
    if (!entry || f->size > sizeof answer->bytes) {
        return false;
    }
    answer = &entry->answer[side];
    answer->frames++;
    bool more = entry->reply.kind == GROBO_REPLY_ANY || answer->frames < entry->reply.count;
    answer->state = more ? LEDGER_WAITING : LEDGER_ANSWERED;
    answer->time_us = f->end_us;
    answer->size = f->size;
    memcpy(answer->bytes, f->bytes, f->size);
    *asked_us = entry->time_us;
    for (unsigned i = 0; entry_at(l, i) != entry; i++) {
        if (!is_repeat(entry_at(l, i), entry)) {
            give_up(&entry_at(l, i)->answer[side]);
        }
    }
    settle(l);
    return true;
}

void ledger_end(ledger *l)
{
    for (unsigned i = 0; i < l->n; i++) {
        give_up_all(l, entry_at(l, i));
    }
    settle(l);
}
