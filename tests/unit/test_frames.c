/* SPDX-License-Identifier: MIT */
/* What grctl makes of a line's bytes: frames, what is cut off, rubbish; and who answered whom. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/tables.h"
#include "tests/support/test.h"
#include "tests/support/vectors.h"
#include "tools/grctl/decode/ledger.h"

/* What came out, as text: "board 14, rubbish 2, " and the bytes one after the other. */
typedef struct heard {
    char text[1024];
    uint8_t bytes[1024];
    size_t used;
    int64_t last_us;
} heard;

static void note(void *ctx, const frame *f)
{
    static const char *const kinds[] = {"board", "packet", "echo", "cut", "rubbish"};
    heard *h = ctx;
    size_t used = strlen(h->text);
    snprintf(h->text + used, sizeof h->text - used, "%s%s%s %zu", used ? ", " : "",
             f->sum_ok || f->kind >= FRAME_CUT ? "" : "bad ", kinds[f->kind], f->size);
    assert_true(h->used + f->size <= sizeof h->bytes);
    memcpy(h->bytes + h->used, f->bytes, f->size);
    h->used += f->size;
    assert_true(f->time_us <= f->end_us);
    h->last_us = f->end_us;
}

#define GOAL "53 0C FA AF 03 00 1E 04 01 F6 FF 00 00 11"
#define READ "54 09 FA AF 01 0F 24 12 00 38 1A"
#define BACK "FD DF 01 00 24 01 01 01 24"

static const struct {
    const char *hex, *expected;
    frames_side side;
    unsigned wiring;
} rows[] = {
    {"41 00", "board 2", FRAMES_HOST, GROBO_WORDS_BOARD},
    {GOAL READ "50 4D 02", "board 14, board 11, board 3", FRAMES_HOST, GROBO_WORDS_BOARD},
    {"FA AF 03 00 24 01 01 01 26", "rubbish 9", FRAMES_HOST, GROBO_WORDS_BOARD},
    {"FA AF 03 00 24 01 01 01 26", "packet 9", FRAMES_HOST, GROBO_WORDS_BUS},
    {"FA AF 03 00 24 01 01 01 27", "bad packet 9", FRAMES_HOST, GROBO_WORDS_BUS},
    {"53 09 FA AF 03 00 24 01 01 01 27", "bad board 11", FRAMES_HOST, GROBO_WORDS_BOARD},
    {GOAL BACK "07", "board 14, packet 9, packet 1", FRAMES_EITHER, FRAMES_ANY_WIRING},
    {BACK "07" BACK, "packet 9, packet 1, packet 9", FRAMES_ROBOT, GROBO_WORDS_BOARD},
    {GOAL, "rubbish 14", FRAMES_ROBOT, GROBO_WORDS_BOARD},
    {"FA AF 01 0F 24 01 00 2B" BACK, "echo 8, packet 9", FRAMES_ROBOT, GROBO_WORDS_BUS},
    {"FA AF 07 01 24 01 01 01 23 07", "echo 9, packet 1", FRAMES_ROBOT, GROBO_WORDS_BUS},
    {"FA AF 03 00 24 01 01 01 27", "bad echo 9", FRAMES_ROBOT, GROBO_WORDS_BUS},
    {"FA AF 01 0F 24" BACK, "rubbish 5, packet 9", FRAMES_ROBOT, GROBO_WORDS_BUS},
    {"12 34" BACK "99", "rubbish 2, packet 9, rubbish 1", FRAMES_ROBOT, GROBO_WORDS_BOARD},
    {"FD DF 01 00 24 01 01 02 24", "bad packet 9", FRAMES_ROBOT, GROBO_WORDS_BOARD},
    {"FD DF 01 00", "cut 4", FRAMES_ROBOT, GROBO_WORDS_BOARD},
    /* a byte was lost: the packet with the wrong sum holds the start of a good one */
    {"FD DF 01 00 24 01 01 24" BACK, "cut 8, packet 9", FRAMES_ROBOT, GROBO_WORDS_BOARD},
    /* a false start claims more than follows, a true frame is in it */
    {"53 40 FA AF" GOAL, "cut 4, board 14", FRAMES_HOST, GROBO_WORDS_BOARD},
    {"53 40 FA AF 53 0C FA", "cut 7", FRAMES_HOST, GROBO_WORDS_BOARD},
};

enum { ROWS = (int)(sizeof rows / sizeof rows[0]) };

static talk *rs30x(void)
{
    static talk t;
    t = (talk){.words = talk_named("rs30x")};
    return &t;
}

TEST(bytes_come_out_as_what_they_are)
{
    for (int i = 0; i < ROWS; i++) {
        uint8_t bytes[256];
        char hex[512];
        size_t n = 0;
        /* Vectors stand next to each other: blanks between them. */
        for (const char *c = rows[i].hex; *c; c++) {
            if (*c != ' ') {
                n += (size_t)snprintf(hex + n, sizeof hex - n, n % 3 == 2 ? " %c" : "%c", *c);
            }
        }
        int size = vector_from_hex(hex, bytes, sizeof bytes);
        assert_true(size > 0);
        for (int cut = 0; cut <= size; cut++) {
            static frames f;
            heard h = {.used = 0};
            frames_init(&f, rs30x(), rows[i].side, rows[i].wiring, note, &h);
            frames_feed(&f, 100, bytes, (size_t)cut);
            frames_feed(&f, 200, bytes + cut, (size_t)(size - cut));
            frames_end(&f);
            assert_int_equal(h.used, size);
            assert_memory_equal(h.bytes, bytes, (size_t)size);
            if (cut == 0) {
                assert_string_equal(h.text, rows[i].expected);
            }
        }
    }
}

TEST(a_frame_that_stands_still_is_over)
{
    static const uint8_t start[] = {0x53, 0x0C, 0xFA};
    static const uint8_t check[] = {0x41, 0x00};
    static frames f;
    heard h = {.used = 0};
    frames_init(&f, rs30x(), FRAMES_HOST, GROBO_WORDS_BOARD, note, &h);
    frames_feed(&f, 1000, start, sizeof start);
    frames_pass(&f, 1000 + FRAMES_STALL_US - 1);
    assert_string_equal(h.text, "");
    frames_feed(&f, 1000 + FRAMES_STALL_US, check, sizeof check);
    assert_string_equal(h.text, "cut 3, board 2");
    assert_int_equal(h.last_us, 1000 + FRAMES_STALL_US);
}

/* Nothing is lost, whatever comes: bytes by a fixed generator, those of frames more often. */
TEST(every_byte_comes_out_once)
{
    static const uint8_t likely[] = {0x53, 0x0C, 0xFA, 0xAF, 0xFD, 0xDF, 0x54, 0x01,
                                     0x00, 0x24, 0x41, 0x50, 0x07, 0x09, 0x12, 0x4D};
    uint32_t random = 12345;
    for (int round = 0; round < 300; round++) {
        static frames f;
        heard h = {.used = 0};
        uint8_t bytes[200];
        frames_side side = (frames_side)(round % 3);
        frames_init(&f, rs30x(), side, FRAMES_ANY_WIRING, note, &h);
        for (size_t i = 0; i < sizeof bytes; i++) {
            random = random * 1664525u + 1013904223u;
            bytes[i] = random >> 31 ? (uint8_t)(random >> 16) : likely[random >> 20 & 15];
        }
        for (size_t i = 0; i < sizeof bytes; i += 10) {
            frames_feed(&f, (int64_t)i, bytes + i, 10);
        }
        frames_end(&f);
        assert_int_equal(h.used, sizeof bytes);
        assert_memory_equal(h.bytes, bytes, sizeof bytes);
    }
}

/* ---- who answered whom ----------------------------------------------------------------------- */

typedef struct book {
    char text[512];
} book;

static void note_settled(void *ctx, const ledger_entry *entry)
{
    static const char states[] = {'?', 'a', 's'};
    book *b = ctx;
    size_t used = strlen(b->text);
    snprintf(b->text + used, sizeof b->text - used, "%s%d%c%c", used ? " " : "", (int)entry->number,
             states[entry->answer[0].state], states[entry->answer[1].state]);
}

static void ask(ledger *l, uint8_t id, int64_t now_us)
{
    uint8_t bytes[32];
    frame f;
    int n = grobo_frame_read(&grobo_i_board_protocol, id, 36, 1, bytes, sizeof bytes);
    assert_int_equal(frame_peek(rs30x(), FRAMES_HOST, GROBO_WORDS_BOARD, bytes, (size_t)n, &f), n);
    f.time_us = now_us;
    ledger_ask(l, &f);
}

static bool answer(ledger *l, int side, uint8_t id, int64_t *asked_us)
{
    uint8_t bytes[] = {0xFD, 0xDF, id, 0, 36, 1, 1, 1, (uint8_t)(id ^ 36 ^ 1)};
    frame f;
    assert_int_equal(frame_peek(rs30x(), FRAMES_ROBOT, 0, bytes, sizeof bytes, &f), sizeof bytes);
    return ledger_take(l, side, &f, asked_us);
}

TEST(answers_find_their_requests)
{
    static ledger l;
    book b = {.text = ""};
    int64_t asked_us = 0;
    ledger_init(&l, 2, note_settled, &b);
    ask(&l, 1, 10);
    ask(&l, 2, 20);
    ask(&l, 3, 30);
    assert_true(answer(&l, 0, 1, &asked_us));
    assert_int_equal(asked_us, 10);
    assert_false(answer(&l, 0, 1, &asked_us));
    assert_false(answer(&l, 0, 9, &asked_us));
    assert_string_equal(b.text, "");
    assert_true(answer(&l, 1, 1, &asked_us));
    assert_string_equal(b.text, "1aa");
    /* Three is answered, so two will not be any more. */
    assert_true(answer(&l, 0, 3, &asked_us));
    assert_int_equal(asked_us, 30);
    assert_false(answer(&l, 0, 2, &asked_us));
    assert_true(answer(&l, 1, 2, &asked_us));
    assert_string_equal(b.text, "1aa 2sa");
    ledger_end(&l);
    assert_string_equal(b.text, "1aa 2sa 3as");
    assert_int_equal(l.requests, 3);
}

/* A reply goes to the last repetition; if another comes, it was asked for as well. */
TEST(asked_twice_may_be_answered_twice)
{
    static ledger l;
    book b = {.text = ""};
    int64_t asked_us = 0;
    ledger_init(&l, 1, note_settled, &b);
    ask(&l, 1, 10);
    ask(&l, 1, 500);
    assert_true(answer(&l, 0, 1, &asked_us));
    assert_int_equal(asked_us, 500);
    assert_true(answer(&l, 0, 1, &asked_us));
    assert_int_equal(asked_us, 10);
    assert_string_equal(b.text, "1a? 2a?");
    ask(&l, 1, 600);
    ask(&l, 1, 700);
    ask(&l, 2, 800);
    assert_true(answer(&l, 0, 1, &asked_us));
    assert_true(answer(&l, 0, 2, &asked_us));
    assert_string_equal(b.text, "1a? 2a? 3s? 4a? 5a?");
    assert_false(answer(&l, 0, 1, &asked_us));
}

TEST(a_full_ledger_pushes_the_oldest_out)
{
    static ledger l;
    book b = {.text = ""};
    int64_t asked_us = 0;
    ledger_init(&l, 1, note_settled, &b);
    for (int id = 1; id <= LEDGER_ENTRIES + 1; id++) {
        ask(&l, (uint8_t)id, id);
    }
    assert_string_equal(b.text, "1s?");
    assert_false(answer(&l, 0, 1, &asked_us));
    assert_true(answer(&l, 0, LEDGER_ENTRIES + 1, &asked_us));
    assert_int_equal(l.requests, LEDGER_ENTRIES + 1);
}
