/* SPDX-License-Identifier: MIT */
/*
 * Any bytes in any split into the push parsers of servo packets and of board frames.
 *
 * Input: byte 0 what is accepted (bits 0-2) and whether the line ends after each piece (bit 7);
 * byte 1 size of a piece minus 1; byte 2 milliseconds between pieces; then the bytes.
 */
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/rs30x.h>

#include "tests/fuzz/target.h"

enum { OPTIONS = 3 };

typedef struct input {
    const uint8_t *bytes;
    size_t n, piece;
    unsigned accept;
    bool end_each;
    int64_t step_us;
} input;

/* Nothing is lost and nothing is made up: what went in came out, was dropped, or is buffered. */
static void check_sum(const grobo_framer *framer, size_t fed, size_t pending)
{
    const grobo_framer_stats *s = &framer->stats;
    MUST((size_t)s->frame_bytes + s->dropped_bytes + pending == fed);
    MUST(s->bad_sums <= s->dropped_bytes);
}

static size_t drain_packets(grobo_rs30x_parser *parser)
{
    size_t heard = 0;
    grobo_rs30x_packet p;
    uint8_t built[GROBO_RS30X_PACKET_MAX_BYTES];
    while (grobo_rs30x_parser_next(parser, &p) > 0) {
        int n = grobo_rs30x_build(&p, built, sizeof built);
        MUST(n > 0);
        MUST(p.data == NULL || memcmp(p.data - 7, built, (size_t)n) == 0);
        heard += (size_t)n;
        grobo_reply reply;
        int r = grobo_rs30x_reply_to(built, (size_t)n, &reply);
        MUST(r < 0 || (size_t)r == reply.bytes);
        grobo_rs30x_state state;
        if (p.kind == GROBO_RS30X_RETURN) {
            MUST(grobo_rs30x_state_decode(p.address, p.data, p.data_bytes, &state) <= 7);
        }
    }
    return heard;
}

static void run_packets(const input *in)
{
    grobo_rs30x_parser parser;
    size_t fed = 0;
    size_t heard = 0;
    grobo_rs30x_parser_init(&parser, in->accept);
    while (fed < in->n) {
        size_t piece = in->n - fed < in->piece ? in->n - fed : in->piece;
        size_t took = grobo_rs30x_parser_feed(&parser, in->bytes + fed, piece);
        MUST(took > 0 && took <= piece);
        fed += took;
        if (in->end_each) {
            grobo_rs30x_parser_end(&parser);
        }
        heard += drain_packets(&parser);
        check_sum(&parser.framer, fed, grobo_rs30x_parser_pending(&parser));
    }
    grobo_rs30x_parser_end(&parser);
    heard += drain_packets(&parser);
    MUST(grobo_rs30x_parser_pending(&parser) == 0);
    MUST(parser.framer.stats.frame_bytes == heard);
    check_sum(&parser.framer, fed, 0);
}

static void drain_frames(grobo_board_parser *parser, int64_t now_us)
{
    grobo_board_frame f;
    while (grobo_board_parser_next(parser, now_us, &f) > 0) {
        MUST(f.packet_bytes <= GROBO_RELAY_MAX_BYTES);
        MUST((f.packet_bytes > 0) == (f.kind == GROBO_BOARD_SEND || f.kind == GROBO_BOARD_ASK));
    }
}

static void run_frames(const input *in)
{
    grobo_board_parser parser;
    size_t fed = 0;
    int64_t now_us = 0;
    grobo_board_parser_init(&parser, 0);
    while (fed < in->n) {
        size_t piece = in->n - fed < in->piece ? in->n - fed : in->piece;
        size_t took = grobo_board_parser_feed(&parser, in->bytes + fed, piece, now_us);
        fed += took;
        drain_frames(&parser, now_us);
        size_t pending = (size_t)(parser.framer.used - parser.framer.taken);
        MUST(took > 0 || pending == 0);
        check_sum(&parser.framer, fed, pending);
        now_us += in->step_us;
    }
    drain_frames(&parser, now_us + GROBO_BOARD_STALL_US);
    MUST(grobo_board_parser_deadline(&parser) == GROBO_NEVER_US);
    check_sum(&parser.framer, fed, 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size < OPTIONS) {
        return 0;
    }
    const input in = {
        .bytes = data + OPTIONS,
        .n = size - OPTIONS,
        .piece = (size_t)data[1] + 1,
        .accept = data[0] & 7u,
        .end_each = (data[0] & 0x80) != 0,
        .step_us = (int64_t)data[2] * 1000,
    };
    run_packets(&in);
    run_frames(&in);
    return 0;
}
