/* SPDX-License-Identifier: MIT */
/* Frames of Kondo KRS servos: measured, taken apart, built. */
#include <string.h>

#include <grobo/core/ics.h>

enum {
    COMMAND_BITS = 0xE0,
    ID_BITS = 0x1F,
    TOP_BIT = 0x80,
    VALUE_MAX = 0x3FFF,
    BYTE_MAX = 0x7F,
    ID_WRITES = 1,
    GENERAL = 0x7F /* of devices that are no servos */
};

/* Bytes of a frame with this first byte and item. */
static int size_of(uint8_t command, bool reply, uint8_t item)
{
    switch (command) {
    case GROBO_ICS_POSITION:
        return 3;
    case GROBO_ICS_READ:
        if (!reply) {
            return 2;
        }
        return item == GROBO_ICS_EEPROM ? 66 : item == GROBO_ICS_POSITION_ITEM ? 4 : 3;
    case GROBO_ICS_WRITE:
        return item == GROBO_ICS_EEPROM ? (reply ? 2 : 66) : 3;
    default:
        return reply ? 1 : 4;
    }
}

/* An item that a command may name: a servo that lacks one is silent. What only other ICS devices
 * have is none. */
static bool has_item(uint8_t command, uint8_t item)
{
    switch (command) {
    case GROBO_ICS_POSITION:
        return true;
    case GROBO_ICS_READ:
        return item < GENERAL;
    case GROBO_ICS_WRITE:
        return item <= GROBO_ICS_TEMPERATURE;
    default:
        return item <= ID_WRITES;
    }
}

/* Size of a frame whose command is known; its further bytes have no top bit. */
static int measure(uint8_t command, bool reply, const uint8_t *bytes, size_t n)
{
    uint8_t item = n > 1 && command != GROBO_ICS_POSITION ? bytes[1] : 0;
    if (!has_item(command, item)) {
        return GROBO_ERR_FRAME;
    }
    bool known = n > 1 || command == GROBO_ICS_POSITION || (command == GROBO_ICS_ID && reply);
    size_t size = known ? (size_t)size_of(command, reply, item) : n + 1;
    for (size_t i = 1; i < n && i < size; i++) {
        bool repeats = command != GROBO_ICS_ID || bytes[i] == item;
        if ((bytes[i] & TOP_BIT) != 0 || !repeats) {
            return GROBO_ERR_FRAME;
        }
    }
    return n < size ? 0 : (int)size;
}

int grobo_ics_measure(const uint8_t *bytes, size_t n)
{
    if (bytes == NULL) {
        return GROBO_ERR_ARG;
    }
    if (n == 0) {
        return 0;
    }
    return (bytes[0] & TOP_BIT) != 0 ? measure(bytes[0] & COMMAND_BITS, false, bytes, n)
                                     : GROBO_ERR_FRAME;
}

/* The first byte of the reply to a command; an id that was read is news. */
static bool begins_answer(const uint8_t *sent, uint8_t byte)
{
    if ((sent[0] & COMMAND_BITS) == GROBO_ICS_ID) {
        return (byte & COMMAND_BITS) == GROBO_ICS_ID && (sent[1] != ID_WRITES || byte == sent[0]);
    }
    return byte == (sent[0] & ~TOP_BIT) || (sent[0] == GROBO_ICS_POSITION && byte == sent[0]);
}

int grobo_ics_answer(const uint8_t *sent, size_t sent_bytes, const uint8_t *bytes, size_t n)
{
    if (sent == NULL || bytes == NULL || sent_bytes == 0 ||
        grobo_ics_measure(sent, sent_bytes) != (int)sent_bytes) {
        return GROBO_ERR_ARG;
    }
    if (n == 0) {
        return 0;
    }
    if (!begins_answer(sent, bytes[0])) {
        return GROBO_ERR_FRAME;
    }
    uint8_t command = sent[0] & COMMAND_BITS;
    if (command == GROBO_ICS_ID) {
        return 1;
    }
    bool same_item = command == GROBO_ICS_POSITION || n < 2 || bytes[1] == sent[1];
    return same_item ? measure(command, true, bytes, n) : GROBO_ERR_FRAME;
}

int grobo_ics_parse(const uint8_t *sent, size_t sent_bytes, const uint8_t *frame, size_t n,
                    grobo_ics_packet *packet)
{
    if (frame == NULL || packet == NULL) {
        return GROBO_ERR_ARG;
    }
    bool reply = sent != NULL;
    int size = reply ? grobo_ics_answer(sent, sent_bytes, frame, n) : grobo_ics_measure(frame, n);
    if (size <= 0 || (size_t)size != n) {
        return size < 0 ? size : GROBO_ERR_FRAME;
    }
    uint8_t command = (reply ? sent[0] : frame[0]) & COMMAND_BITS;
    grobo_ics_packet found = {.reply = reply, .command = command, .id = frame[0] & ID_BITS};
    size_t at = 1;
    if (command != GROBO_ICS_POSITION) {
        found.item = reply && command == GROBO_ICS_ID ? sent[1] : frame[at++];
    }
    if (n == GROBO_ICS_FRAME_MAX_BYTES) {
        found.data = frame + at;
    } else if (command != GROBO_ICS_ID) {
        for (; at < n; at++) {
            found.value = (uint16_t)(found.value << 7 | frame[at]);
        }
    }
    *packet = found;
    return GROBO_OK;
}

static bool is_good(const grobo_ics_packet *packet, int size)
{
    bool two = packet->command == GROBO_ICS_POSITION || size == 4;
    bool eeprom = size == GROBO_ICS_FRAME_MAX_BYTES;
    if (eeprom && packet->data == NULL) {
        return false;
    }
    for (int i = 0; eeprom && i < GROBO_ICS_EEPROM_BYTES; i++) {
        if (packet->data[i] > BYTE_MAX) {
            return false;
        }
    }
    return (packet->command & ~COMMAND_BITS) == 0 && (packet->command & TOP_BIT) != 0 &&
           packet->id <= GROBO_ICS_ID_MAX && has_item(packet->command, packet->item) &&
           packet->value <= (two ? VALUE_MAX : BYTE_MAX);
}

int grobo_ics_build(const grobo_ics_packet *packet, uint8_t *buf, size_t cap)
{
    if (packet == NULL || buf == NULL) {
        return GROBO_ERR_ARG;
    }
    int size = size_of(packet->command, packet->reply, packet->item);
    if (!is_good(packet, size)) {
        return GROBO_ERR_ARG;
    }
    if ((size_t)size > cap) {
        return GROBO_ERR_SPACE;
    }
    if (size == GROBO_ICS_FRAME_MAX_BYTES) {
        memmove(buf + 2, packet->data, GROBO_ICS_EEPROM_BYTES);
    } else if (packet->command == GROBO_ICS_ID) {
        memset(buf, packet->item, (size_t)size);
    } else {
        buf[size - 1] = (uint8_t)(packet->value & BYTE_MAX);
        buf[size - 2] = (uint8_t)(packet->value >> 7);
    }
    if (size > 1 && packet->command != GROBO_ICS_POSITION) {
        buf[1] = packet->item;
    }
    bool marked = !packet->reply || packet->command == GROBO_ICS_ID;
    buf[0] = (uint8_t)((marked ? packet->command : packet->command & ~TOP_BIT) | packet->id);
    return size;
}
