/* SPDX-License-Identifier: MIT */
/* What grctl decode makes of the frames of other families: the vectors of the reference, each
 * explained, broken ones called broken. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/next_random.h"
#include "tests/support/test.h"
#include "tests/support/vectors.h"
#include "tests/support/wire_vectors.h"
#include "tools/grctl/decode/words.h"

/* What came out of a line: the good frames, and all of it in words. */
typedef struct heard {
    wire_bytes good[WIRE_LIST_MAX];
    size_t n_good;
    char text[4 * WORDS_BYTES];
    size_t used, bytes;
    bool asked, unasked; /* a request is known; a reply is none to it */
} heard;

static void note(void *ctx, const frame *f)
{
    static char text[WORDS_BYTES];
    heard *h = ctx;
    words_say(f, true, "", text, sizeof text);
    json_decref(words_json(f));
    h->used += (size_t)snprintf(h->text + h->used, sizeof h->text - h->used, "%s", text);
    h->bytes += f->size;
    h->unasked |= h->asked && f->as.reply && !f->as.sent;
    if (f->kind <= FRAME_ECHO && f->sum_ok) {
        assert_true(h->n_good < WIRE_LIST_MAX && f->size <= WIRE_BYTES_MAX);
        memcpy(h->good[h->n_good].bytes, f->bytes, f->size);
        h->good[h->n_good++].n = f->size;
    }
}

static heard h;

/* Every byte is in one frame, and every frame is told. */
static void count(void *ctx, const frame *f)
{
    static char text[WORDS_BYTES];
    heard *to = ctx;
    words_say(f, true, "", text, sizeof text);
    json_decref(words_json(f));
    assert_true(strlen(text) > 3);
    to->bytes += f->size;
}

static void hear(const grobo_words *d, const wire_vector *v)
{
    static talk t;
    static frames line;
    t = (talk){.words = d};
    memset(&h, 0, sizeof h);
    if (v->sent.n > 0) {
        talk_ask(&t, v->sent.bytes, v->sent.n);
        h.asked = true;
    }
    frames_init(&line, &t, v->from_servo ? FRAMES_ROBOT : FRAMES_HOST, GROBO_WORDS_BUS, note, &h);
    for (size_t i = 0; i < v->chunk_count; i++) {
        frames_feed(&line, (int64_t)i, v->chunks[i].bytes, v->chunks[i].n);
    }
    frames_end(&line);
    assert_int_equal(h.bytes, v->whole.n);
    print_message("    %s", h.text);
}

/* Faults that bytes alone do not show, or that leave good frames only. */
static bool shows(const wire_vector *v)
{
    static const char *const quiet[] = {"split",         "stream",    "echo",          "joined",
                                        "undetectable",  "pattern",   "special",       "byte order",
                                        "not supported", "collision", "echo ambiguity"};
    for (size_t i = 0; i < sizeof quiet / sizeof *quiet; i++) {
        if (strcmp(v->fault, quiet[i]) == 0) {
            return false;
        }
    }
    return !v->valid;
}

static void check(const grobo_words *d, const wire_vector *v)
{
    hear(d, v);
    bool named = h.unasked || strstr(h.text, "\033[31m") != NULL;
    if (v->valid) {
        assert_int_equal(h.n_good, 1);
        assert_int_equal(h.good[0].n, v->whole.n);
        return;
    }
    size_t found = 0; /* the good ones are there, in order */
    for (size_t i = 0; i < h.n_good && found < v->frame_count; i++) {
        found += h.good[i].n == v->frames[found].n &&
                 memcmp(h.good[i].bytes, v->frames[found].bytes, h.good[i].n) == 0;
    }
    assert_int_equal(found, v->frame_count);
    assert_true(named || !shows(v));
}

static void check_dxl2(const wire_vector *v)
{
    check(talk_named("dynamixel2"), v);
}

static void check_dxl1(const wire_vector *v)
{
    check(talk_named("dynamixel1"), v);
}

static void check_feetech(const wire_vector *v)
{
    check(talk_named(strcmp(v->series, "SCS") == 0 ? "scs" : "feetech"), v);
}

static void check_lx16a(const wire_vector *v)
{
    check(talk_named("lx16a"), v);
}

static void check_ics(const wire_vector *v)
{
    if (strstr(v->name, "general") != NULL) {
        return; /* of devices that are no servos */
    }
    check(talk_named("ics"), v);
}

TEST(dynamixel2_is_explained)
{
    wire_vectors_check("dynamixel2.json", check_dxl2, 100);
}

TEST(dynamixel1_is_explained)
{
    wire_vectors_check("dynamixel1.json", check_dxl1, 90);
}

TEST(feetech_is_explained)
{
    wire_vectors_check("feetech.json", check_feetech, 90);
}

TEST(lx16a_is_explained)
{
    wire_vectors_check("lx16a.json", check_lx16a, 60);
}

TEST(ics_is_explained)
{
    wire_vectors_check("ics.json", check_ics, 60);
}

/* Series number k of all that there are, again and again. */
static const grobo_words *series(int k)
{
    for (;;) {
        for (const grobo_family *f = grobo_families(); f->robot != NULL; f++) {
            for (const grobo_words *const *words = f->words; *words != NULL; words++) {
                if (k-- == 0) {
                    return *words;
                }
            }
        }
    }
}

/* Bytes with faults, as what a host or a robot says, and as nobody knows whose. */
static void garble(const wire_vector *v)
{
    static uint32_t seed = 1;
    static talk t;
    static frames line;
    for (int round = 0; round < 28; round++) {
        uint8_t bytes[2 * WIRE_BYTES_MAX];
        size_t n = v->whole.n;
        memcpy(bytes, v->whole.bytes, n);
        memcpy(bytes + n, v->whole.bytes, n);
        n *= 2;
        for (int i = 0; i < 2; i++) {
            bytes[next_random(&seed) % n] = (uint8_t)next_random(&seed);
        }
        memset(&h, 0, sizeof h);
        t = (talk){.words = series(round)};
        frames_init(&line, &t, (frames_side)(round % 4 % 3), FRAMES_ANY_WIRING, count, &h);
        frames_feed(&line, 0, bytes, n);
        frames_end(&line);
        assert_int_equal(h.bytes, n);
    }
}

TEST(whatever_comes_is_told)
{
    wire_vectors_check("dynamixel2.json", garble, 100);
    wire_vectors_check("feetech.json", garble, 90);
    wire_vectors_check("ics.json", garble, 60);
}
