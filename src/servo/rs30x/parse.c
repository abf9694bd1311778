/* SPDX-License-Identifier: MIT */
/* Packets of RS30x servos: their form, the push parser, what a command is answered by; and the
 * protocol, for the bus. */
#include <string.h>

#include "src/base/bytes.h"
#include "src/bus/framer.h"
#include "src/servo/rs30x/packet.h"
#include "src/servo/tables.h"

enum { RESET_DATA = 0xFF };

static bool is_servo(uint8_t id)
{
    return id >= 1 && id <= GROBO_RS30X_ID_MAX;
}

bool grobo_i_rs30x_is_reset(const uint8_t *header)
{
    return header[0] == 0xFA && (header[GROBO_I_AT_FLAGS] & 0xF0) == GROBO_RS30X_FACTORY &&
           header[GROBO_I_AT_ADDRESS] == 0xFF && header[GROBO_I_AT_LENGTH] == 0xFF &&
           header[GROBO_I_AT_COUNT] == 0;
}

static int announced_by_return(const uint8_t *header)
{
    int length = header[GROBO_I_AT_LENGTH];
    bool good = is_servo(header[GROBO_I_AT_ID]) && header[GROBO_I_AT_COUNT] == 1 &&
                header[GROBO_I_AT_ADDRESS] + length <= GROBO_REGISTERS;
    return good ? length : GROBO_ERR_FRAME;
}

static int announced_by_long(const uint8_t *header)
{
    int length = header[GROBO_I_AT_LENGTH];
    int data = length * header[GROBO_I_AT_COUNT];
    bool good = header[GROBO_I_AT_FLAGS] == 0 && length >= 2 && data > 0 &&
                data <= GROBO_RS30X_PACKET_MAX_BYTES - GROBO_RS30X_OVERHEAD_BYTES;
    return good ? data : GROBO_ERR_FRAME;
}

/* Without data the length is free: it says how much to return, or is a filler. */
static int announced_by_short(const uint8_t *header)
{
    uint8_t id = header[GROBO_I_AT_ID];
    int length = header[GROBO_I_AT_LENGTH];
    int count = header[GROBO_I_AT_COUNT];
    if ((!is_servo(id) && id != GROBO_RS30X_ID_ALL) || count > 1) {
        return GROBO_ERR_FRAME;
    }
    if (count == 0) {
        return 0;
    }
    return length <= GROBO_REGISTERS ? length : GROBO_ERR_FRAME;
}

int grobo_i_rs30x_announced(const uint8_t *header)
{
    if (header[0] == 0xFD) {
        return announced_by_return(header);
    }
    return header[GROBO_I_AT_ID] == 0 ? announced_by_long(header) : announced_by_short(header);
}

/* A false start is known as such by its second or third byte already, mostly. */
static int measure_start(const uint8_t *bytes, size_t n, unsigned accept)
{
    bool command = bytes[0] == 0xFA;
    if (!command && bytes[0] != 0xFD) {
        return GROBO_ERR_FRAME;
    }
    if ((accept & (command ? GROBO_ACCEPT_COMMANDS : GROBO_ACCEPT_RETURNS)) == 0) {
        return GROBO_ERR_FRAME;
    }
    if (n >= 2 && bytes[1] != (command ? 0xAF : 0xDF)) {
        return GROBO_ERR_FRAME;
    }
    if (n > GROBO_I_AT_ID) {
        uint8_t id = bytes[GROBO_I_AT_ID];
        bool known = is_servo(id) || (command && (id == 0 || id == GROBO_RS30X_ID_ALL));
        return known ? 0 : GROBO_ERR_FRAME;
    }
    return 0;
}

/* As measure, whatever the sum. */
static int measure_form(const uint8_t *bytes, size_t n, unsigned accept)
{
    if (bytes[0] == GROBO_RS30X_ACK || bytes[0] == GROBO_RS30X_NACK) {
        return (accept & GROBO_ACCEPT_ACKS) != 0 ? 1 : GROBO_ERR_FRAME;
    }
    int result = measure_start(bytes, n, accept);
    if (result < 0 || n < GROBO_I_AT_DATA) {
        return result;
    }
    int data = grobo_i_rs30x_announced(bytes);
    if (data < 0) {
        return data;
    }
    size_t size = (size_t)data + GROBO_RS30X_OVERHEAD_BYTES;
    if (n < size) {
        return 0;
    }
    /* The bare reset ends in id XOR flags, which is never FF: an FF here is its data byte. */
    if (grobo_i_rs30x_is_reset(bytes) && bytes[GROBO_I_AT_DATA] == RESET_DATA) {
        size++;
        if (n < size) {
            return 0;
        }
    }
    return (int)size;
}

/* Of a packet of the right form; a single byte has no sum. */
static bool has_good_sum(const uint8_t *bytes, int size)
{
    return size < GROBO_RS30X_OVERHEAD_BYTES ||
           grobo_i_xor(bytes + GROBO_I_AT_ID, (size_t)size - GROBO_I_AT_ID - 1) == bytes[size - 1];
}

int grobo_i_rs30x_measure(const uint8_t *bytes, size_t n, unsigned accept)
{
    int size = measure_form(bytes, n, accept);
    return size <= 0 || has_good_sum(bytes, size) ? size : GROBO_ERR_CHECKSUM;
}

static grobo_rs30x_kind kind_of(const uint8_t *bytes)
{
    switch (bytes[0]) {
    case GROBO_RS30X_ACK:
        return GROBO_RS30X_ACK_BYTE;
    case GROBO_RS30X_NACK:
        return GROBO_RS30X_NACK_BYTE;
    case 0xFD:
        return GROBO_RS30X_RETURN;
    default:
        return bytes[GROBO_I_AT_ID] == 0 ? GROBO_RS30X_LONG : GROBO_RS30X_SHORT;
    }
}

/* Takes the whole, good packet of n bytes apart. */
static void unpack(const uint8_t *bytes, size_t n, grobo_rs30x_packet *packet)
{
    memset(packet, 0, sizeof *packet);
    packet->kind = kind_of(bytes);
    if (n < GROBO_RS30X_OVERHEAD_BYTES) {
        return;
    }
    packet->id = bytes[GROBO_I_AT_ID];
    packet->flags = bytes[GROBO_I_AT_FLAGS];
    packet->address = bytes[GROBO_I_AT_ADDRESS];
    packet->length = bytes[GROBO_I_AT_LENGTH];
    packet->count = bytes[GROBO_I_AT_COUNT];
    packet->data = bytes + GROBO_I_AT_DATA;
    packet->data_bytes = n - GROBO_RS30X_OVERHEAD_BYTES;
}

int grobo_rs30x_peek(const uint8_t *bytes, size_t n, unsigned accept, grobo_rs30x_packet *packet,
                     bool *sum_ok)
{
    if ((bytes == NULL && n > 0) || packet == NULL || sum_ok == NULL) {
        return GROBO_ERR_ARG;
    }
    int size = n > 0 ? measure_form(bytes, n, accept) : 0;
    if (size > 0) {
        unpack(bytes, (size_t)size, packet);
        *sum_ok = has_good_sum(bytes, size);
    }
    return size;
}

void grobo_rs30x_parser_init(grobo_rs30x_parser *parser, unsigned accept)
{
    if (parser == NULL) {
        return;
    }
    grobo_i_framer_init(&parser->framer);
    parser->accept = accept;
}

size_t grobo_rs30x_parser_feed(grobo_rs30x_parser *parser, const uint8_t *bytes, size_t n)
{
    return parser == NULL || (bytes == NULL && n > 0)
               ? 0
               : grobo_i_framer_feed(&parser->framer, bytes, n);
}

int grobo_rs30x_parser_next(grobo_rs30x_parser *parser, grobo_rs30x_packet *packet)
{
    if (packet == NULL || parser == NULL) {
        return GROBO_ERR_ARG;
    }
    size_t size = grobo_i_framer_next(&parser->framer, grobo_i_rs30x_measure, parser->accept);
    if (size == 0) {
        return 0;
    }
    unpack(parser->framer.buf, size, packet);
    return 1;
}

void grobo_rs30x_parser_end(grobo_rs30x_parser *parser)
{
    if (parser != NULL) {
        grobo_i_framer_end(&parser->framer);
    }
}

void grobo_rs30x_parser_reset(grobo_rs30x_parser *parser)
{
    if (parser != NULL) {
        grobo_i_framer_reset(&parser->framer);
    }
}

size_t grobo_rs30x_parser_pending(const grobo_rs30x_parser *parser)
{
    return parser == NULL ? 0 : grobo_i_framer_pending(&parser->framer);
}

/* What the low nibble of the flags asks for, for one servo. */
static int reply_to_nibble(const uint8_t *packet, grobo_reply *reply)
{
    static const uint8_t blocks[][2] = {{0, 30}, {30, 30}, {20, 10}, {42, 18}, {30, 12}, {60, 68}};
    const uint8_t *block = &packet[GROBO_I_AT_ADDRESS];
    unsigned nibble = packet[GROBO_I_AT_FLAGS] & 0x0Fu;
    if (nibble == GROBO_RS30X_WANT_NOTHING) {
        return GROBO_OK;
    }
    if ((nibble & 1u) == 0) {
        return GROBO_ERR_ARG;
    }
    reply->count = 1;
    if (nibble == GROBO_RS30X_WANT_ACK) {
        reply->kind = GROBO_REPLY_ACK;
        reply->bytes = 1;
        return GROBO_OK;
    }
    if (nibble != GROBO_RS30X_WANT_GIVEN) {
        block = blocks[(nibble - GROBO_RS30X_WANT_0_29) / 2];
    }
    reply->kind = GROBO_REPLY_RETURN;
    reply->id = packet[GROBO_I_AT_ID];
    reply->tag = block[0];
    reply->address = block[0];
    reply->length = block[1];
    reply->bytes = (uint32_t)reply->length + GROBO_RS30X_OVERHEAD_BYTES;
    return reply->address + reply->length <= GROBO_REGISTERS ? GROBO_OK : GROBO_ERR_ARG;
}

int grobo_rs30x_reply_to(const uint8_t *packet, size_t n, grobo_reply *reply)
{
    if ((packet == NULL && n > 0) || reply == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_reply found = {.kind = GROBO_REPLY_NONE};
    int size = n > 0 ? grobo_i_rs30x_measure(packet, n, GROBO_ACCEPT_COMMANDS) : 0;
    if (size < 0) {
        return size;
    }
    if (size == 0 || (size_t)size != n) {
        return GROBO_ERR_FRAME;
    }
    uint8_t id = packet[GROBO_I_AT_ID];
    if (id != GROBO_RS30X_ID_ALL && id != 0) {
        int result = reply_to_nibble(packet, &found);
        if (result < 0) {
            return result;
        }
    }
    *reply = found;
    return (int)found.bytes;
}

/* ---- for the bus --------------------------------------------------------------------------- */

void grobo_i_rs30x_unpack(uint8_t *bytes, size_t n, grobo_packet *packet)
{
    memset(packet, 0, sizeof *packet);
    if (n < GROBO_RS30X_OVERHEAD_BYTES) {
        packet->kind = GROBO_PACKET_ACK;
        packet->refused = bytes[0] == GROBO_RS30X_NACK;
        return;
    }
    packet->id = bytes[GROBO_I_AT_ID];
    packet->flags = bytes[GROBO_I_AT_FLAGS];
    packet->address = bytes[GROBO_I_AT_ADDRESS];
    packet->data = bytes + GROBO_I_AT_DATA;
    packet->data_bytes = n - GROBO_RS30X_OVERHEAD_BYTES;
    if (bytes[0] == 0xFD) {
        packet->kind = GROBO_PACKET_RETURN;
        packet->refused = (packet->flags & GROBO_RS30X_STATUS_REFUSED) != 0;
    }
}

const grobo_protocol grobo_i_rs30x_protocol = GROBO_TABLE(
    grobo_protocol, .name = "RS30x", .measure = grobo_i_rs30x_measure,
    .unpack = grobo_i_rs30x_unpack, .reply_to = grobo_rs30x_reply_to,
    .return_delay_us = GROBO_RS30X_DELAY_US(0), .id_min = 1, .id_max = GROBO_RS30X_ID_MAX);

const grobo_protocol *grobo_rs30x_protocol(void)
{
    return &grobo_i_rs30x_protocol;
}
