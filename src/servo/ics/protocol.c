/* SPDX-License-Identifier: MIT */
/*
 * Kondo KRS servos for the bus. Nothing but bit 7 tells a command from a reply, and nothing but its
 * first two bytes how long a reply is. A reply to a position says nothing of what it answers: the
 * goal that was sent goes along as the address.
 */
#include <string.h>

#include "src/servo/ics/items.h"
#include "src/servo/tables.h"

enum {
    TOP_BIT = 0x80,
    KIND_BITS = 0x60, /* of a command, without the top bit */
    ID_BITS = 0x1F,
    NIBBLE_MAX = 0x0F,
    RETURN_DELAY_US = 500, /* an assumption: the maker prints none */
    CALL_US = 20000
};

/* Size of the reply that begins so; 0: more is needed; negative: none. */
static int reply_size(const uint8_t *bytes, size_t n)
{
    const uint8_t kind = bytes[0] & KIND_BITS;
    const bool write = kind == (GROBO_ICS_WRITE & KIND_BITS);
    if (kind == 0) { /* a position */
        return 3;
    }
    if (!write && kind != (GROBO_ICS_READ & KIND_BITS)) {
        return GROBO_ERR_FRAME;
    }
    if (n < 2) {
        return 0;
    }
    if (bytes[1] == GROBO_ICS_EEPROM) {
        return write ? 2 : GROBO_ICS_FRAME_MAX_BYTES;
    }
    const uint16_t code = GROBO_I_ICS_CODE(write ? GROBO_ICS_WRITE : GROBO_ICS_READ, bytes[1]);
    const grobo_i_item *item = grobo_i_item_of(grobo_i_ics_items, code);
    return item == NULL ? GROBO_ERR_FRAME : 2 + item->bytes;
}

static int measure_reply(const uint8_t *bytes, size_t n)
{
    /* The servo with id 0 answers a position with the command's byte, as ICS 2.0 did. */
    int size = bytes[0] == GROBO_ICS_POSITION ? 3 : reply_size(bytes, n);
    if (size < 0 || ((bytes[0] & TOP_BIT) != 0 && bytes[0] != GROBO_ICS_POSITION)) {
        return GROBO_ERR_FRAME;
    }
    for (size_t i = 1; i < n && (size == 0 || i < (size_t)size); i++) {
        if (bytes[i] > (size == GROBO_ICS_FRAME_MAX_BYTES ? NIBBLE_MAX : TOP_BIT - 1)) {
            return GROBO_ERR_FRAME;
        }
    }
    return (size_t)size <= n ? size : 0;
}

static int measure(const uint8_t *bytes, size_t n, unsigned accept)
{
    int size =
        (accept & GROBO_ACCEPT_COMMANDS) != 0 ? grobo_ics_measure(bytes, n) : GROBO_ERR_FRAME;
    return size == GROBO_ERR_FRAME && (accept & GROBO_ACCEPT_RETURNS) != 0 ? measure_reply(bytes, n)
                                                                           : size;
}

static void unpack(uint8_t *bytes, size_t n, grobo_packet *packet)
{
    memset(packet, 0, sizeof *packet);
    packet->kind = GROBO_PACKET_COMMAND;
    if (measure_reply(bytes, n) != (int)n) {
        return;
    }
    bool position = (bytes[0] & KIND_BITS) == 0;
    packet->kind = GROBO_PACKET_RETURN;
    packet->id = bytes[0] & ID_BITS;
    packet->address = position ? 0 : (uint16_t)((bytes[0] & KIND_BITS) | bytes[1]);
    packet->data = bytes + (position ? 1 : 2);
    packet->data_bytes = n - (position ? 1 : 2);
    if (n == GROBO_ICS_FRAME_MAX_BYTES) { /* nibbles are put together */
        for (size_t i = 0; i < GROBO_I_ICS_EEPROM_BYTES; i++) {
            bytes[2 + i] = (uint8_t)(bytes[2 + 2 * i] << 4 | bytes[3 + 2 * i]);
        }
        packet->data_bytes = GROBO_I_ICS_EEPROM_BYTES;
    } else if (packet->data_bytes == 2) { /* so are the halves of a position */
        uint8_t *data = bytes + (position ? 1 : 2);
        uint16_t value = grobo_i_ics_value(data);
        data[0] = (uint8_t)(value >> 8);
        data[1] = (uint8_t)value;
    }
}

/* Reading or writing the id is for a line with one servo, which the caller must know: no frame of
 * the bus does it. */
static int reply_to(const uint8_t *frame, size_t n, grobo_reply *reply)
{
    grobo_ics_packet packet;
    int result = grobo_ics_parse(NULL, 0, frame, n, &packet);
    if (result < 0 || packet.command == GROBO_ICS_ID) {
        return result < 0 ? result : GROBO_ERR_ARG;
    }
    grobo_reply found = {.kind = GROBO_REPLY_RETURN, .id = packet.id, .count = 1};
    if (packet.command == GROBO_ICS_POSITION) {
        found.address = (uint16_t)(GROBO_I_ICS_AT_GOAL | packet.value);
        found.length = 2;
        found.bytes = 3;
    } else {
        bool write = packet.command == GROBO_ICS_WRITE;
        bool eeprom = packet.item == GROBO_ICS_EEPROM;
        const uint16_t code = GROBO_I_ICS_CODE(packet.command, packet.item);
        const grobo_i_item *item = grobo_i_item_of(grobo_i_ics_items, code);
        if (item == NULL) {
            return GROBO_ERR_ARG;
        }
        found.tag = (uint8_t)((packet.command & KIND_BITS) | packet.item);
        found.address = item->address;
        found.length = eeprom && write ? 0 : item->bytes;
        found.bytes = eeprom && !write ? GROBO_ICS_FRAME_MAX_BYTES : 2u + found.length;
    }
    *reply = found;
    return (int)found.bytes;
}

const grobo_protocol grobo_i_ics_protocol =
    GROBO_TABLE(grobo_protocol, .name = "Kondo ICS", .measure = measure, .unpack = unpack,
                .reply_to = reply_to, .return_delay_us = RETURN_DELAY_US, .call_us = CALL_US,
                .parity = GROBO_PARITY_EVEN, .id_min = 0, .id_max = GROBO_ICS_ID_MAX);

const grobo_protocol *grobo_ics_protocol(void)
{
    return &grobo_i_ics_protocol;
}
