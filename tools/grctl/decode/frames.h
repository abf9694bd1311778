/* SPDX-License-Identifier: MIT */
/*
 * A line's bytes as frames, for those who read along: good ones, those with a wrong sum, frames
 * cut off, and rubbish. What is a frame, the words of the talk's family say.
 * Every byte that goes in comes out in exactly one of them, in order. It believes what the
 * library's parsers believe, and finds its way back as they do.
 */
#ifndef GRCTL_FRAMES_H
#define GRCTL_FRAMES_H

#include <grobo/core/board.h>

#include "tools/grctl/decode/talk.h"

/* Who speaks: decides what is believed. */
typedef enum frames_side {
    FRAMES_EITHER, /* not known: everything */
    FRAMES_HOST,   /* board frames and commands */
    FRAMES_ROBOT   /* return packets, ACK, NACK; of an adapter with an echo commands too */
} frames_side;

/* What of a host's bytes is believed: GROBO_WORDS_BOARD, GROBO_WORDS_BUS, or both. */
#define FRAMES_ANY_WIRING (GROBO_WORDS_BOARD | GROBO_WORDS_BUS)

typedef enum frame_kind {
    FRAME_BOARD,  /* a frame of a board, with or without a servo packet in it */
    FRAME_PACKET, /* a servo packet, ACK or NACK */
    FRAME_ECHO,   /* a host's packet that comes back from a bus of one wire */
    FRAME_CUT,    /* begins like a frame whose rest never came */
    FRAME_RUBBISH /* no frame */
} frame_kind;

typedef struct frame {
    frame_kind kind;
    frames_side side;
    int64_t time_us, end_us; /* of its first and last byte */
    const uint8_t *bytes;    /* valid during the callback */
    size_t size;
    bool sum_ok;          /* of the packet, where there is one */
    const talk *talk;     /* whose words it is read by */
    grobo_words_frame as; /* what they found */
} frame;

/*
 * The frame that n bytes begin with, whatever its sum; its times are 0. Returns its size, 0 when
 * more bytes are needed, GROBO_ERR_FRAME when none begins here.
 */
int frame_peek(const talk *t, frames_side side, unsigned wiring, const uint8_t *bytes, size_t n,
               frame *out);

/* The reply that a host's frame calls for. Errors as grobo_frame_reply(). */
int frame_reply(const frame *f, grobo_reply *reply);

/* True if this frame answers a request of these bytes. */
bool frame_answers(const frame *f, const uint8_t *request, size_t n);

typedef void (*frames_fn)(void *ctx, const frame *f);

/* A pause inside a frame after which it is over, as the board has it. */
#define FRAMES_STALL_US GROBO_BOARD_STALL_US
/* On a bus an adapter may hand on 64 bytes at a time: 67 ms at 9600 bps. */
#define FRAMES_BUS_STALL_US 100000

/*
 * To look behind a packet with a wrong sum takes two packets; rubbish is handed out in pieces.
 */
enum { FRAMES_BUFFER_BYTES = 2 * GROBO_WORDS_FRAME_BYTES, FRAMES_RUBBISH_MAX_BYTES = 64 };

typedef struct frames {
    /* private */
    frames_side side;
    unsigned wiring;
    frames_fn use;
    void *ctx;
    talk *talk;
    size_t used;
    size_t rubbish; /* bytes at the front known to be none */
    bool ending;
    uint8_t bytes[FRAMES_BUFFER_BYTES];
    int64_t time_us[FRAMES_BUFFER_BYTES];
} frames;

/* t: who is on the line; lines of one talk share it. */
void frames_init(frames *f, talk *t, frames_side side, unsigned wiring, frames_fn use, void *ctx);

/* Bytes that came at this time; frames are handed out as soon as they are known. */
void frames_feed(frames *f, int64_t time_us, const uint8_t *bytes, size_t n);

/* Time passes: what stands still is over. */
void frames_pass(frames *f, int64_t now_us);

/* Nothing more comes: hands out what is left. */
void frames_end(frames *f);

#endif
