/* SPDX-License-Identifier: MIT */
/**
 * @file board.h
 * @brief Frames of GR001's controller board.
 *
 * The board sits between the host and the servo bus. It stores a relay frame and forwards the
 * packet inside it; the answer comes back as the servo sent it. Other frames are for the board
 * itself. First byte: 'A' check, 'S' relay, 'T' relay and return, 'P' play from memory.
 *
 * Sources: RPU-10 technical note p.3-4 as quoted by public drivers (S, T), the GROBO library and
 * Choreonoid's GRobotPlugin (A, P, and the frames of GR001). Functions are re-entrant.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_BOARD_H
#define GROBO_CORE_BOARD_H

#include <grobo/core/rs30x.h>

GROBO_BEGIN_DECLS

/** Bytes before the packet in a relay frame. */
#define GROBO_BOARD_HEADER_BYTES 2

/** RS30x servos behind the board. */
GROBO_API const grobo_protocol *grobo_board_protocol(void);

/** The protocol of RS30x servos over this wiring; NULL for an unknown one. */
GROBO_API const grobo_protocol *grobo_wiring_protocol(grobo_wiring wiring);

/** What a board frame is. */
typedef enum grobo_board_kind {
    GROBO_BOARD_CHECK,   /**< 41 00, answered by 07 */
    GROBO_BOARD_SEND,    /**< 53 n packet: forwarded, nothing comes back */
    GROBO_BOARD_ASK,     /**< 54 n packet r: forwarded, r raw bytes come back */
    GROBO_BOARD_SLOT,    /**< 50 4D k: play motion slot k, no known answer */
    GROBO_BOARD_SCENARIO /**< 50 53 k: play scenario k, no known answer */
} grobo_board_kind;

/** A board frame taken apart. */
typedef struct grobo_board_frame {
    grobo_board_kind kind;
    uint8_t number;        /**< SLOT, SCENARIO: k */
    uint8_t reply_bytes;   /**< ASK: r, as the frame says */
    const uint8_t *packet; /**< SEND, ASK: borrowed; what goes to the servo bus, unchecked */
    size_t packet_bytes;   /**< number of them */
} grobo_board_frame;

/* ---- builders: return the size, or GROBO_ERR_SPACE ------------------------------------------- */

/** Is the board there? */
GROBO_API int grobo_board_check(uint8_t *buf, size_t cap);

/** Plays motion slot k of the board's memory. */
GROBO_API int grobo_board_slot(uint8_t k, uint8_t *buf, size_t cap);

/** Plays scenario k of the board's memory. */
GROBO_API int grobo_board_scenario(uint8_t k, uint8_t *buf, size_t cap);

/**
 * Relays n bytes, nothing comes back. packet may lie in buf, at any offset.
 * @return size; GROBO_ERR_ARG for n = 0, GROBO_ERR_CAP above GROBO_RELAY_MAX_BYTES
 */
GROBO_API int grobo_board_send(const uint8_t *packet, size_t n, uint8_t *buf, size_t cap);

/**
 * Relays n bytes and has r bytes returned. packet may lie in buf, at any offset.
 * @return size; GROBO_ERR_ARG for n = 0 or r = 0, GROBO_ERR_CAP when n + 1 is above
 *         GROBO_RELAY_MAX_BYTES
 */
GROBO_API int grobo_board_ask(const uint8_t *packet, size_t n, uint8_t r, uint8_t *buf, size_t cap);

/**
 * Relays a whole command packet by SEND or ASK, whichever its flags call for.
 * Errors of grobo_rs30x_reply_to and of the two above.
 */
GROBO_API int grobo_board_relay(const uint8_t *packet, size_t n, uint8_t *buf, size_t cap);

/**
 * Takes one whole frame apart (n bytes, no more and no less); frame->packet points into bytes.
 * @return GROBO_OK or GROBO_ERR_FRAME
 */
GROBO_API int grobo_board_parse(const uint8_t *bytes, size_t n, grobo_board_frame *frame);

/**
 * Looks at the frame that n bytes start with, without a parser; frame->packet points into bytes.
 * @return size of the frame; 0 when more bytes are needed, GROBO_ERR_FRAME when none starts here
 *         (then nothing is written)
 */
GROBO_API int grobo_board_peek(const uint8_t *bytes, size_t n, grobo_board_frame *frame);

/* ---- device side ----------------------------------------------------------------------------- */

/** A frame that stands still for this long is abandoned, unless told otherwise. */
#define GROBO_BOARD_STALL_US 50000

/**
 * A push parser of board frames, for what plays the board and for what reads along. It finds its
 * way back after rubbish because it believes a relay frame only when its payload starts like a
 * packet (FA AF); it does not check the packet further, as the board does not. A frame that
 * stands still is abandoned, and what is whole behind its start is still found.
 * Fields are private but framer.stats and stalls.
 */
typedef struct grobo_board_parser {
    grobo_framer framer;
    uint32_t stalls; /**< frames abandoned because they stood still; read freely */
    /* private */
    uint32_t stall_us;
    int64_t last_us;
    size_t whole; /* bytes with which the frame that has begun is whole; 0: not known */
} grobo_board_parser;

/** Makes a parser ready; stall_us 0: GROBO_BOARD_STALL_US. */
GROBO_API void grobo_board_parser_init(grobo_board_parser *parser, uint32_t stall_us);

/**
 * Takes bytes that arrived at now_us. Use as grobo_rs30x_parser_feed.
 * @return bytes taken; 0 of n > 0 only while next has something left to do
 */
GROBO_API size_t grobo_board_parser_feed(grobo_board_parser *parser, const uint8_t *bytes, size_t n,
                                         int64_t now_us);

/**
 * Returns the next frame. frame->packet points into the parser, valid until the next call of
 * next, feed or reset.
 * @return 1 with a frame, 0 when more bytes are needed (frame untouched)
 */
GROBO_API int grobo_board_parser_next(grobo_board_parser *parser, int64_t now_us,
                                      grobo_board_frame *frame);

/** When next should be called though no byte came: the stall's end, or GROBO_NEVER_US. */
GROBO_API int64_t grobo_board_parser_deadline(const grobo_board_parser *parser);

/** Forgets what is buffered (it counts as dropped); counters stay. */
GROBO_API void grobo_board_parser_reset(grobo_board_parser *parser);

GROBO_END_DECLS

#endif
