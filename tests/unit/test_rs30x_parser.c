/* SPDX-License-Identifier: MIT */
/* The push parser of servo packets, in both directions. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/rs30x.h>

#include "src/bus/framer.h"
#include "tests/support/test.h"
#include "tests/support/vectors.h"

enum { MAX = GROBO_RS30X_PACKET_MAX_BYTES };

#define ANY (GROBO_ACCEPT_COMMANDS | GROBO_ACCEPT_RETURNS | GROBO_ACCEPT_ACKS)
#define HOST (GROBO_ACCEPT_RETURNS | GROBO_ACCEPT_ACKS)

/* The vectors that go over the servo bus, for those who have no reference material. */
static const char *const packets[] = {
    "FA AF 01 0F 2A 02 00 26",
    "FA AF 00 00 1E 03 03 01 64 00 02 64 00 05 F4 01 ED",
    "FA AF 01 10 FF FF 00 FF EE",
    "FA AF 01 10 FF FF 00 11",
    "FA AF 01 60 FF 00 00 9E",
    "FA AF 01 03 00 00 01 03",
    "FA AF FF 00 1E 02 01 00 00 E2",
    "FA AF 01 01 FF 01 00 FE",
    "FA AF 01 09 24 01 01 01 2D",
    "FD DF 01 00 2A 12 01 84 03 00 00 00 00 06 00 BA 03 00 00 00 00 00 00 00 00 00",
    "FD DF 01 00 2A 12 01 5C FF 37 02 00 00 07 00 BA 03 00 00 00 00 00 00 00 00 10",
    "FD DF 01 00 2A 08 01 28 FF 00 00 3E 00 0C 00 C7",
    "07",
    "08",
};

enum { PACKETS = (int)(sizeof packets / sizeof packets[0]) };

/* Everything handed out, put together again and strung together. */
typedef struct heard {
    uint8_t bytes[4096];
    size_t n;
    int packets;
} heard;

static void hear(grobo_rs30x_parser *parser, heard *h)
{
    grobo_rs30x_packet p;
    while (grobo_rs30x_parser_next(parser, &p) > 0) {
        int n = grobo_rs30x_build(&p, h->bytes + h->n, sizeof h->bytes - h->n);
        assert_true(n > 0);
        h->n += (size_t)n;
        h->packets++;
    }
}

static void push(grobo_rs30x_parser *parser, const uint8_t *bytes, size_t n, heard *h)
{
    while (n > 0) {
        size_t took = grobo_rs30x_parser_feed(parser, bytes, n);
        assert_true(took > 0);
        bytes += took;
        n -= took;
        hear(parser, h);
    }
}

static void expect_heard(const heard *h, const uint8_t *bytes, size_t n)
{
    assert_int_equal(h->n, n);
    assert_memory_equal(h->bytes, bytes, n);
}

TEST(every_split_of_every_packet_gives_it_back)
{
    for (int i = 0; i < PACKETS; i++) {
        uint8_t b[MAX];
        size_t n = (size_t)vector_from_hex(packets[i], b, MAX);
        for (size_t first = 0; first <= n; first++) {
            for (size_t second = first; second <= n; second++) {
                grobo_rs30x_parser parser;
                heard h = {.n = 0};
                grobo_rs30x_parser_init(&parser, ANY);
                push(&parser, b, first, &h);
                push(&parser, b + first, second - first, &h);
                push(&parser, b + second, n - second, &h);
                expect_heard(&h, b, n);
                assert_int_equal(h.packets, 1);
                assert_int_equal(parser.framer.stats.dropped_bytes, 0);
            }
        }
    }
}

TEST(rubbish_before_and_behind_is_dropped_and_counted)
{
    static const uint8_t rubbish[] = {0x00, 0xFA, 0xFD, 0xAF, 0xFA, 0xAF, 0xFD, 0xDF, 0x01, 0xFF};
    for (int i = 0; i < PACKETS; i++) {
        uint8_t b[MAX];
        size_t n = (size_t)vector_from_hex(packets[i], b, MAX);
        grobo_rs30x_parser parser;
        heard h = {.n = 0};
        grobo_rs30x_parser_init(&parser, ANY);
        push(&parser, rubbish, sizeof rubbish, &h);
        push(&parser, b, n, &h);
        push(&parser, rubbish, sizeof rubbish, &h);
        push(&parser, b, n, &h);
        grobo_rs30x_parser_end(&parser);
        hear(&parser, &h);
        assert_int_equal(h.packets, 2);
        assert_int_equal(h.n, 2 * n);
        assert_memory_equal(h.bytes, b, n);
        assert_int_equal(parser.framer.stats.dropped_bytes, 2 * sizeof rubbish);
        assert_int_equal(parser.framer.stats.frame_bytes, 2 * n);
    }
}

/* A header in rubbish announces 140 bytes: the packets inside and behind them are all found. */
TEST(packets_behind_a_false_start_are_found)
{
    uint8_t b[1024], wanted[1024];
    size_t n = (size_t)vector_from_hex("FD DF 01 00 00 8C 01", b, sizeof b);
    size_t rubbish = n;
    size_t size = 0;
    for (int i = 0; i < 8; i++) {
        int got = vector_from_hex(packets[9], b + n, sizeof b - n);
        memcpy(wanted + size, b + n, (size_t)got);
        n += (size_t)got;
        size += (size_t)got;
    }
    grobo_rs30x_parser parser;
    heard h = {.n = 0};
    grobo_rs30x_parser_init(&parser, GROBO_ACCEPT_RETURNS);
    push(&parser, b, n, &h);
    expect_heard(&h, wanted, size);
    assert_int_equal(parser.framer.stats.dropped_bytes, rubbish);
    assert_int_equal(parser.framer.stats.bad_sums, 1);
}

/* Any single flipped bit: either nothing is heard, or the packet is not the sent one by header. */
TEST(no_flipped_bit_is_believed)
{
    uint8_t b[MAX];
    size_t n = (size_t)vector_from_hex(packets[9], b, MAX);
    for (size_t bit = 0; bit < n * 8; bit++) {
        uint8_t broken[MAX];
        memcpy(broken, b, n);
        broken[bit / 8] = (uint8_t)(broken[bit / 8] ^ 1u << bit % 8);
        grobo_rs30x_parser parser;
        heard h = {.n = 0};
        grobo_rs30x_parser_init(&parser, GROBO_ACCEPT_RETURNS);
        push(&parser, broken, n, &h);
        grobo_rs30x_parser_end(&parser);
        hear(&parser, &h);
        assert_int_equal(h.packets, 0);
        assert_int_equal(parser.framer.stats.dropped_bytes, n);
    }
}

TEST(only_what_is_accepted_is_heard)
{
    for (unsigned accept = 0; accept <= ANY; accept++) {
        grobo_rs30x_parser parser;
        heard h = {.n = 0};
        grobo_rs30x_parser_init(&parser, accept);
        int wanted = 0;
        for (int i = 0; i < PACKETS; i++) {
            uint8_t b[MAX];
            size_t n = (size_t)vector_from_hex(packets[i], b, MAX);
            unsigned what = b[0] == 0xFA   ? GROBO_ACCEPT_COMMANDS
                            : b[0] == 0xFD ? GROBO_ACCEPT_RETURNS
                                           : GROBO_ACCEPT_ACKS;
            wanted += (accept & what) != 0;
            push(&parser, b, n, &h);
        }
        if ((accept & GROBO_ACCEPT_ACKS) == 0 || accept == ANY) {
            assert_int_equal(h.packets, wanted); /* else 07 in refused packets counts as ACK */
        }
    }
}

/* A 07 inside a return packet is data, and stays data when the packet comes in pieces. */
TEST(an_ack_inside_a_packet_is_data)
{
    uint8_t b[MAX];
    size_t n = (size_t)vector_from_hex(packets[10], b, MAX);
    grobo_rs30x_parser parser;
    heard h = {.n = 0};
    grobo_rs30x_parser_init(&parser, HOST);
    for (size_t i = 0; i < n; i++) {
        push(&parser, b + i, 1, &h);
        assert_int_equal(h.packets, i + 1 == n);
    }
    static const uint8_t acks[] = {7, 8, 7};
    push(&parser, acks, sizeof acks, &h);
    assert_int_equal(h.packets, 4);
}

TEST(impossible_headers_are_given_up_early)
{
    static const char *const hopeless[] = {
        "FA AF 80",             /* id above 127 */
        "FD DF 00",             /* nobody returns as 0 */
        "FD DF FF",             /* nor as all */
        "FD DF 01 00 2A 8C 01", /* No.42 + 140 registers */
        "FD DF 01 00 2A 02 02", /* count 2 in a return */
        "FA AF 01 00 1E 02 02", /* count 2 in a short packet */
        "FA AF 01 00 1E 8D 01", /* more data than registers */
        "FA AF 00 01 1E 05 14", /* flags in a long packet */
        "FA AF 00 00 1E 01 05", /* an id without data */
        "FA AF 00 00 1E 05 00", /* no servo */
        "FA AF 00 00 1E 05 1D", /* 145 bytes */
    };
    for (size_t i = 0; i < sizeof hopeless / sizeof hopeless[0]; i++) {
        uint8_t b[MAX];
        size_t n = (size_t)vector_from_hex(hopeless[i], b, MAX);
        grobo_rs30x_parser parser;
        heard h = {.n = 0};
        grobo_rs30x_parser_init(&parser, ANY);
        push(&parser, b, n, &h);
        assert_int_equal(h.packets, 0);
        assert_int_equal(grobo_rs30x_parser_pending(&parser), 0);
        assert_int_equal(parser.framer.stats.dropped_bytes, n);
    }
}

TEST(the_longest_packets_fit)
{
    uint8_t data[MAX], b[MAX];
    for (size_t i = 0; i < MAX; i++) {
        data[i] = (uint8_t)i;
    }
    const grobo_rs30x_packet longest[] = {
        {GROBO_RS30X_RETURN, 127, 0, 0, 140, 1, data, 140},
        {GROBO_RS30X_SHORT, 127, 0, 0, 140, 1, data, 140},
        {GROBO_RS30X_LONG, 0, 0, 30, 5, 28, data, 140},
    };
    for (size_t i = 0; i < sizeof longest / sizeof longest[0]; i++) {
        grobo_rs30x_parser parser;
        heard h = {.n = 0};
        assert_int_equal(grobo_rs30x_build(&longest[i], b, MAX), MAX);
        grobo_rs30x_parser_init(&parser, ANY);
        push(&parser, b, MAX, &h);
        push(&parser, b, MAX, &h);
        assert_int_equal(h.packets, 2);
        assert_memory_equal(h.bytes, b, MAX);
    }
}

TEST(an_end_hands_out_what_hides_behind_a_stump)
{
    uint8_t b[MAX];
    size_t stump = (size_t)vector_from_hex("FD DF 01 00 00 8C 01 00", b, MAX);
    size_t n = (size_t)vector_from_hex(packets[11], b + stump, MAX - stump);
    grobo_rs30x_parser parser;
    heard h = {.n = 0};
    grobo_rs30x_parser_init(&parser, HOST);
    push(&parser, b, stump + n, &h);
    assert_int_equal(h.packets, 0);
    assert_int_equal(grobo_rs30x_parser_pending(&parser), stump + n);
    grobo_rs30x_parser_end(&parser);
    assert_int_equal(grobo_rs30x_parser_feed(&parser, b, 1), 0); /* next first */
    hear(&parser, &h);
    expect_heard(&h, b + stump, n);
    assert_int_equal(parser.framer.stats.dropped_bytes, stump);
    push(&parser, b + stump, n, &h); /* goes on as before */
    assert_int_equal(h.packets, 2);
}

TEST(a_reset_forgets_and_counts)
{
    uint8_t b[MAX];
    size_t n = (size_t)vector_from_hex(packets[11], b, MAX);
    grobo_rs30x_parser parser;
    heard h = {.n = 0};
    grobo_rs30x_parser_init(&parser, HOST);
    push(&parser, b, n - 1, &h);
    grobo_rs30x_parser_reset(&parser);
    assert_int_equal(parser.framer.stats.dropped_bytes, n - 1);
    assert_int_equal(grobo_rs30x_parser_pending(&parser), 0);
    push(&parser, b, n, &h);
    expect_heard(&h, b, n);
    grobo_rs30x_packet packet; /* behind a packet that was handed out, too */
    assert_int_equal(grobo_rs30x_parser_feed(&parser, b, n), n);
    assert_int_equal(grobo_rs30x_parser_next(&parser, &packet), 1);
    grobo_rs30x_parser_reset(&parser);
    assert_int_equal(grobo_rs30x_parser_pending(&parser), 0);
    assert_int_equal(parser.framer.stats.dropped_bytes, n - 1);
}

static void refused_vectors(const vector *v)
{
    grobo_rs30x_parser parser;
    heard h = {.n = 0};
    grobo_rs30x_parser_init(&parser, ANY);
    push(&parser, v->bytes, v->n, &h);
    grobo_rs30x_parser_end(&parser);
    hear(&parser, &h);
    assert_int_equal(h.packets, 0);
}

static bool check_vector(const vector *v)
{
    if (strcmp(v->layer, "servo") != 0) {
        return false;
    }
    if (!v->valid) {
        refused_vectors(v);
        return true;
    }
    grobo_rs30x_parser parser;
    heard h = {.n = 0};
    grobo_rs30x_parser_init(&parser, ANY);
    push(&parser, v->bytes, v->n, &h);
    assert_int_equal(h.packets, 1);
    expect_heard(&h, v->bytes, v->n);
    return true;
}

TEST(collected_vectors_parse_and_build_byte_for_byte)
{
    vectors_check(check_vector, 40);
}

/* What a protocol of one's own may say of rubbish, for ever. */
static int always_more(const uint8_t *bytes, size_t n, unsigned accept)
{
    (void)bytes;
    (void)n;
    (void)accept;
    return 0;
}

TEST(a_full_buffer_waits_for_nothing)
{
    static const uint8_t bytes[4 * GROBO_FRAME_MAX_BYTES];
    static grobo_framer framer;
    size_t at = 0;
    grobo_i_framer_init(&framer);
    while (at < sizeof bytes) {
        size_t took = grobo_i_framer_feed(&framer, bytes + at, sizeof bytes - at);
        assert_true(took > 0);
        at += took;
        assert_int_equal(grobo_i_framer_next(&framer, always_more, 0), 0);
    }
    assert_int_equal(framer.stats.dropped_bytes + grobo_i_framer_pending(&framer), sizeof bytes);
}
