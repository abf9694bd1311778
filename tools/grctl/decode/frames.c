/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tools/grctl/decode/frames.h"

int frame_peek(const talk *t, frames_side side, unsigned wiring, const uint8_t *bytes, size_t n,
               frame *out)
{
    const grobo_words_look look = {.bytes = bytes,
                                   .n = n,
                                   .from_host = side != FRAMES_ROBOT,
                                   .from_robot = side != FRAMES_HOST,
                                   .wiring = wiring,
                                   .sent = t->sent};
    memset(out, 0, sizeof *out);
    int size = t->words->peek(&look, &out->as);
    out->kind = out->as.relay ? FRAME_BOARD : out->as.echo ? FRAME_ECHO : FRAME_PACKET;
    out->side = side;
    out->bytes = bytes;
    out->size = size > 0 ? (size_t)size : 0;
    out->sum_ok = out->as.sum_ok;
    out->talk = t;
    return size;
}

/* What begins at offset `at`. */
static int look(const frames *f, size_t at, frame *out)
{
    return frame_peek(f->talk, f->side, f->wiring, f->bytes + at, f->used - at, out);
}

static void drop(frames *f, size_t n)
{
    f->used -= n;
    memmove(f->bytes, f->bytes + n, f->used);
    memmove(f->time_us, f->time_us + n, f->used * sizeof f->time_us[0]);
}

/* Where nobody told who speaks, the frame itself tells. */
static frames_side speaker(const frame *f)
{
    if (f->kind == FRAME_BOARD) {
        return FRAMES_HOST;
    }
    if (f->kind != FRAME_PACKET) {
        return FRAMES_EITHER;
    }
    return f->as.reply ? FRAMES_ROBOT : FRAMES_HOST;
}

/* Hands out the first n bytes as what *out says. */
static void hand_out(frames *f, frame *out, size_t n)
{
    out->side = f->side == FRAMES_EITHER ? speaker(out) : f->side;
    out->bytes = f->bytes;
    out->size = n;
    out->time_us = f->time_us[0];
    out->end_us = f->time_us[n - 1];
    out->talk = f->talk;
    f->use(f->ctx, out);
    if (out->kind <= FRAME_PACKET && out->side == FRAMES_HOST && out->sum_ok) {
        talk_ask(f->talk, out->bytes, out->size);
    }
    drop(f, n);
}

static void hand_out_rubbish(frames *f)
{
    frame out = {.kind = FRAME_RUBBISH};
    size_t n = f->rubbish;
    f->rubbish = 0;
    if (n > 0) {
        hand_out(f, &out, n);
    }
}

/* A single byte proves nothing inside of something else. */
static bool is_whole(const frame *f, int size)
{
    return size > 1 && f->sum_ok;
}

/*
 * Where a good frame begins inside the `size` bytes at `at`, which are none: its offset, `size`
 * where there is none, 0 where more bytes are needed to know.
 */
static size_t next_start(const frames *f, size_t at, size_t size)
{
    bool open = false;
    for (size_t i = 1; i < size; i++) {
        frame inner;
        int found = look(f, at + i, &inner);
        if (is_whole(&inner, found)) {
            return open && !f->ending ? 0 : i;
        }
        open = open || found == 0;
    }
    return open && !f->ending ? 0 : size;
}

/* Judges what stands behind the rubbish. False: more bytes are needed. */
static bool judge(frames *f)
{
    frame out;
    size_t left = f->used - f->rubbish;
    int size = look(f, f->rubbish, &out);
    if (size == 0 && !f->ending) {
        return false;
    }
    if (size < 0) {
        f->rubbish++;
        if (f->rubbish == FRAMES_RUBBISH_MAX_BYTES) {
            hand_out_rubbish(f);
        }
        return true;
    }
    if (size > 0 && out.sum_ok) {
        size_t n = (size_t)size;
        hand_out_rubbish(f);
        look(f, 0, &out); /* it has moved */
        hand_out(f, &out, n);
        return true;
    }
    /* A packet with a wrong sum, or one whose rest never came: a good one may begin inside. */
    size_t end = size > 0 ? (size_t)size : left;
    size_t n = next_start(f, f->rubbish, end);
    if (n == 0) {
        return false;
    }
    hand_out_rubbish(f);
    if (size > 0 && n == end) {
        look(f, 0, &out);
    } else {
        memset(&out, 0, sizeof out);
        out.kind = FRAME_CUT;
    }
    hand_out(f, &out, n);
    return true;
}

static void scan(frames *f)
{
    while (f->rubbish < f->used && judge(f)) {
    }
}

void frames_init(frames *f, talk *t, frames_side side, unsigned wiring, frames_fn use, void *ctx)
{
    memset(f, 0, sizeof *f);
    f->talk = t;
    f->side = side;
    f->wiring = wiring;
    f->use = use;
    f->ctx = ctx;
}

void frames_pass(frames *f, int64_t now_us)
{
    int64_t stall_us = f->wiring == GROBO_WORDS_BOARD ? FRAMES_STALL_US : FRAMES_BUS_STALL_US;
    if (f->used > 0 && now_us - f->time_us[f->used - 1] >= stall_us) {
        frames_end(f);
    }
}

void frames_feed(frames *f, int64_t time_us, const uint8_t *bytes, size_t n)
{
    frames_pass(f, time_us);
    for (size_t i = 0; i < n; i++) {
        f->bytes[f->used] = bytes[i];
        f->time_us[f->used] = time_us;
        f->used++;
        scan(f);
        if (f->used == FRAMES_BUFFER_BYTES) {
            frames_end(f);
        }
    }
    if (f->rubbish == f->used) {
        hand_out_rubbish(f);
    }
}

void frames_end(frames *f)
{
    f->ending = true;
    scan(f);
    hand_out_rubbish(f);
    f->ending = false;
}

int frame_reply(const frame *f, grobo_reply *reply)
{
    const grobo_words *words = f->talk->words;
    if (f->kind > FRAME_ECHO || f->as.reply) {
        return GROBO_ERR_FRAME;
    }
    return words->reply_to ? words->reply_to(f->bytes, f->size, reply)
                           : words->protocol->reply_to(f->bytes, f->size, reply);
}

bool frame_answers(const frame *f, const uint8_t *request, size_t n)
{
    static grobo_words_sent sent;
    if (f->kind != FRAME_PACKET) {
        return false;
    }
    if (!f->talk->words->says_request) { /* it was found when the frame came */
        return f->as.sent && f->as.sent->n == n && memcmp(f->as.sent->bytes, request, n) == 0;
    }
    memcpy(sent.bytes, request, n);
    sent.n = n;
    return f->talk->words->answers(&sent, f->bytes, f->size);
}
