/* SPDX-License-Identifier: MIT */
/* Frames of GR001's controller board. The push parser, which only its stand-ins need, is apart. */
#include <string.h>

#include <grobo/core/board.h>

#include "src/servo/rs30x/packet.h"
#include "src/servo/tables.h"

enum {
    CHECK = 0x41,
    SEND = 0x53,
    ASK = 0x54,
    PLAY = 0x50,
    PLAY_SLOT = 0x4D,
    PLAY_SCENARIO = 0x53,
    CHECK_BYTES = 2,
    PLAY_BYTES = 3,
    PACKET_MIN_BYTES = 2 /* enough to see how a packet starts */
};

int grobo_board_check(uint8_t *buf, size_t cap)
{
    if (buf == NULL) {
        return GROBO_ERR_ARG;
    }
    if (cap < CHECK_BYTES) {
        return GROBO_ERR_SPACE;
    }
    buf[0] = CHECK;
    buf[1] = 0;
    return CHECK_BYTES;
}

static int build_play(uint8_t what, uint8_t k, uint8_t *buf, size_t cap)
{
    if (cap < PLAY_BYTES) {
        return GROBO_ERR_SPACE;
    }
    buf[0] = PLAY;
    buf[1] = what;
    buf[2] = k;
    return PLAY_BYTES;
}

int grobo_board_slot(uint8_t k, uint8_t *buf, size_t cap)
{
    return buf == NULL ? GROBO_ERR_ARG : build_play(PLAY_SLOT, k, buf, cap);
}

int grobo_board_scenario(uint8_t k, uint8_t *buf, size_t cap)
{
    return buf == NULL ? GROBO_ERR_ARG : build_play(PLAY_SCENARIO, k, buf, cap);
}

/* r is the byte behind the packet, or < 0 for none. */
static int build_relay(const uint8_t *packet, size_t n, int r, uint8_t *buf, size_t cap)
{
    size_t counted = n + (r < 0 ? 0 : 1);
    if (n == 0 || r == 0) {
        return GROBO_ERR_ARG;
    }
    if (counted > GROBO_RELAY_MAX_BYTES) {
        return GROBO_ERR_CAP;
    }
    if (GROBO_BOARD_HEADER_BYTES + counted > cap) {
        return GROBO_ERR_SPACE;
    }
    memmove(buf + GROBO_BOARD_HEADER_BYTES, packet, n);
    buf[0] = r < 0 ? SEND : ASK;
    buf[1] = (uint8_t)counted;
    if (r > 0) {
        buf[GROBO_BOARD_HEADER_BYTES + n] = (uint8_t)r;
    }
    return (int)(GROBO_BOARD_HEADER_BYTES + counted);
}

int grobo_board_send(const uint8_t *packet, size_t n, uint8_t *buf, size_t cap)
{
    return packet == NULL || buf == NULL ? GROBO_ERR_ARG : build_relay(packet, n, -1, buf, cap);
}

int grobo_board_ask(const uint8_t *packet, size_t n, uint8_t r, uint8_t *buf, size_t cap)
{
    return packet == NULL || buf == NULL ? GROBO_ERR_ARG : build_relay(packet, n, r, buf, cap);
}

int grobo_board_relay(const uint8_t *packet, size_t n, uint8_t *buf, size_t cap)
{
    if (buf == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_reply reply;
    int r = grobo_rs30x_reply_to(packet, n, &reply);
    return r < 0 ? r : build_relay(packet, n, r == 0 ? -1 : r, buf, cap);
}

static int measure_relay(const uint8_t *bytes, size_t n)
{
    size_t trailer = bytes[0] == ASK ? 1 : 0;
    if (n < GROBO_BOARD_HEADER_BYTES) {
        return 0;
    }
    size_t counted = bytes[1];
    if (counted < PACKET_MIN_BYTES + trailer || counted > GROBO_RELAY_MAX_BYTES) {
        return GROBO_ERR_FRAME;
    }
    const uint8_t *packet = bytes + GROBO_BOARD_HEADER_BYTES;
    size_t have = n - GROBO_BOARD_HEADER_BYTES;
    if ((have >= 1 && packet[0] != 0xFA) || (have >= 2 && packet[1] != 0xAF)) {
        return GROBO_ERR_FRAME;
    }
    return have < counted ? 0 : (int)(GROBO_BOARD_HEADER_BYTES + counted);
}

/* Size of the frame that starts here; 0 when more bytes are needed; GROBO_ERR_FRAME. */
static int measure(const uint8_t *bytes, size_t n)
{
    switch (bytes[0]) {
    case CHECK:
        if (n < CHECK_BYTES) {
            return 0;
        }
        return bytes[1] == 0 ? CHECK_BYTES : GROBO_ERR_FRAME;
    case PLAY:
        if (n >= 2 && bytes[1] != PLAY_SLOT && bytes[1] != PLAY_SCENARIO) {
            return GROBO_ERR_FRAME;
        }
        return n < PLAY_BYTES ? 0 : PLAY_BYTES;
    case SEND:
    case ASK:
        return measure_relay(bytes, n);
    default:
        return GROBO_ERR_FRAME;
    }
}

/* Takes a whole frame of n bytes apart. */
static void unpack(const uint8_t *bytes, size_t n, grobo_board_frame *frame)
{
    memset(frame, 0, sizeof *frame);
    if (bytes[0] == CHECK) {
        frame->kind = GROBO_BOARD_CHECK;
    } else if (bytes[0] == PLAY) {
        frame->kind = bytes[1] == PLAY_SLOT ? GROBO_BOARD_SLOT : GROBO_BOARD_SCENARIO;
        frame->number = bytes[2];
    } else {
        bool ask = bytes[0] == ASK;
        frame->kind = ask ? GROBO_BOARD_ASK : GROBO_BOARD_SEND;
        frame->reply_bytes = ask ? bytes[n - 1] : 0;
        frame->packet = bytes + GROBO_BOARD_HEADER_BYTES;
        frame->packet_bytes = n - GROBO_BOARD_HEADER_BYTES - (ask ? 1 : 0);
    }
}

int grobo_board_peek(const uint8_t *bytes, size_t n, grobo_board_frame *frame)
{
    if ((bytes == NULL && n > 0) || frame == NULL) {
        return GROBO_ERR_ARG;
    }
    int size = n > 0 ? measure(bytes, n) : 0;
    if (size > 0) {
        unpack(bytes, (size_t)size, frame);
    }
    return size;
}

int grobo_board_parse(const uint8_t *bytes, size_t n, grobo_board_frame *frame)
{
    if ((bytes == NULL && n > 0) || frame == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_board_frame found;
    int size = grobo_board_peek(bytes, n, &found);
    if (size <= 0 || (size_t)size != n) {
        return GROBO_ERR_FRAME;
    }
    *frame = found;
    return GROBO_OK;
}

/* ---- for the bus and the drivers ----------------------------------------------------------- */

static int unwrap(const uint8_t *bytes, size_t n, const uint8_t **packet)
{
    grobo_board_frame frame;
    if (grobo_board_parse(bytes, n, &frame) < 0 || frame.kind == GROBO_BOARD_SLOT ||
        frame.kind == GROBO_BOARD_SCENARIO) {
        return GROBO_ERR_UNSUPPORTED;
    }
    *packet = frame.packet;
    return (int)frame.packet_bytes;
}

static size_t forwarded(const uint8_t *frame, size_t n)
{
    if (n < GROBO_BOARD_HEADER_BYTES) {
        return 0;
    }
    size_t counted = frame[1];
    if (frame[0] == SEND) {
        return counted;
    }
    return frame[0] == ASK && counted > 0 ? counted - 1 : 0;
}

static int build_stored(bool scenario, uint8_t number, uint8_t *buf, size_t cap)
{
    return build_play(scenario ? PLAY_SCENARIO : PLAY_SLOT, number, buf, cap);
}

/* A SEND is never answered. An ASK must want as many bytes as its packet will return. */
static int reply_to(const uint8_t *bytes, size_t n, grobo_reply *reply)
{
    grobo_board_frame frame;
    grobo_reply found = {.kind = GROBO_REPLY_NONE};
    int result = grobo_board_parse(bytes, n, &frame);
    if (result >= 0 && frame.packet_bytes > 0) {
        result = grobo_rs30x_reply_to(frame.packet, frame.packet_bytes, &found);
    }
    if (result < 0) {
        return result;
    }
    if (frame.kind != GROBO_BOARD_ASK) {
        bool check = frame.kind == GROBO_BOARD_CHECK;
        found.kind = check ? GROBO_REPLY_ACK : GROBO_REPLY_NONE;
        found.count = check;
        found.bytes = check;
    } else if (frame.reply_bytes != result) {
        return GROBO_ERR_FRAME;
    }
    *reply = found;
    return (int)found.bytes;
}

static const grobo_relay relay = {
    .packet_max_bytes = GROBO_RELAY_MAX_BYTES,
    .wrap = grobo_board_relay,
    .unwrap = unwrap,
    .forwarded = forwarded,
    .check = grobo_board_check,
    .stored = build_stored,
};

const grobo_protocol grobo_i_board_protocol =
    GROBO_TABLE(grobo_protocol, .name = "GR001", .measure = grobo_i_rs30x_measure,
                .unpack = grobo_i_rs30x_unpack, .reply_to = reply_to,
                .return_delay_us = GROBO_RS30X_DELAY_US(0), .id_min = 1,
                .id_max = GROBO_RS30X_ID_MAX, .relay = &relay);

const grobo_protocol *grobo_board_protocol(void)
{
    return &grobo_i_board_protocol;
}

const grobo_protocol *grobo_wiring_protocol(grobo_wiring wiring)
{
    static const grobo_protocol *const tables[] = {
        [GROBO_WIRING_BOARD] = &grobo_i_board_protocol,
        [GROBO_WIRING_BUS] = &grobo_i_rs30x_protocol,
    };
    return wiring == GROBO_WIRING_BOARD || wiring == GROBO_WIRING_BUS ? tables[wiring] : NULL;
}
