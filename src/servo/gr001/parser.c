/* SPDX-License-Identifier: MIT */
/* The push parser of board frames: for who stands in for the board. */
#include <grobo/core/board.h>

#include "src/bus/framer.h"

/* A grobo_i_measure. */
static int measure(const uint8_t *bytes, size_t n, unsigned accept)
{
    grobo_board_frame frame;
    (void)accept;
    return grobo_board_peek(bytes, n, &frame);
}

/* Once a relay frame's payload starts like a packet, nothing but its end is looked for: whoever
 * feeds it byte by byte need not have it measured each time. */
static size_t whole_of(const grobo_framer *framer)
{
    bool relays = framer->buf[0] == 'S' || framer->buf[0] == 'T';
    return relays && framer->used >= GROBO_BOARD_HEADER_BYTES + 2
               ? (size_t)GROBO_BOARD_HEADER_BYTES + framer->buf[1]
               : 0;
}

void grobo_board_parser_init(grobo_board_parser *parser, uint32_t stall_us)
{
    if (parser == NULL) {
        return;
    }
    grobo_i_framer_init(&parser->framer);
    parser->stalls = 0;
    parser->stall_us = stall_us != 0 ? stall_us : GROBO_BOARD_STALL_US;
    parser->last_us = 0;
    parser->whole = 0;
}

static void abandon_what_stands_still(grobo_board_parser *parser, int64_t now_us)
{
    if (!parser->framer.ending && now_us >= grobo_board_parser_deadline(parser)) {
        parser->stalls++;
        grobo_i_framer_end(&parser->framer);
    }
}

size_t grobo_board_parser_feed(grobo_board_parser *parser, const uint8_t *bytes, size_t n,
                               int64_t now_us)
{
    if ((bytes == NULL && n > 0) || parser == NULL) {
        return 0;
    }
    abandon_what_stands_still(parser, now_us);
    size_t took = grobo_i_framer_feed(&parser->framer, bytes, n);
    if (took > 0) {
        parser->last_us = now_us;
    }
    return took;
}

int grobo_board_parser_next(grobo_board_parser *parser, int64_t now_us, grobo_board_frame *frame)
{
    if (frame == NULL || parser == NULL) {
        return GROBO_ERR_ARG;
    }
    abandon_what_stands_still(parser, now_us);
    const grobo_framer *framer = &parser->framer;
    if (!framer->ending && grobo_i_framer_pending(framer) < parser->whole) {
        return 0;
    }
    size_t size = grobo_i_framer_next(&parser->framer, measure, 0);
    parser->whole = size == 0 ? whole_of(framer) : 0;
    if (size == 0) {
        return 0;
    }
    return grobo_board_peek(parser->framer.buf, size, frame) > 0;
}

int64_t grobo_board_parser_deadline(const grobo_board_parser *parser)
{
    if (parser == NULL || grobo_i_framer_pending(&parser->framer) == 0) {
        return GROBO_NEVER_US;
    }
    return parser->last_us + parser->stall_us;
}

void grobo_board_parser_reset(grobo_board_parser *parser)
{
    if (parser != NULL) {
        grobo_i_framer_reset(&parser->framer);
        parser->whole = 0;
    }
}
