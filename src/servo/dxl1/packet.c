/* SPDX-License-Identifier: MIT */
/* Frames of DYNAMIXEL Protocol 1.0 and of Feetech: measured, taken apart, built. */
#include <string.h>

#include <grobo/core/dxl1.h>
#include <grobo/core/protocol.h>

enum {
    HEADER = 0xFF,
    AT_ID = 2,
    AT_LENGTH = 3,
    AT_INSTRUCTION = 4,
    AT_PARAMETERS = 5,
    LENGTH_MIN = 2, /* instruction, sum */
    LENGTH_MAX = 255,
    BULK_ITEM_BYTES = 3 /* length, id, address */
};

static uint8_t sum_of(const uint8_t *frame, size_t n)
{
    unsigned sum = 0;
    for (size_t i = AT_ID; i < n - 1; i++) {
        sum += frame[i];
    }
    return (uint8_t)~sum;
}

static bool is_id(uint8_t id, unsigned accept)
{
    return id <= GROBO_DXL1_ID_MAX ||
           (id == GROBO_DXL1_ID_ALL && (accept & GROBO_ACCEPT_COMMANDS) != 0);
}

int grobo_dxl1_measure(const uint8_t *bytes, size_t n, unsigned accept)
{
    if (bytes == NULL) {
        return GROBO_ERR_ARG;
    }
    for (size_t i = 0; i < n && i < AT_ID; i++) {
        if (bytes[i] != HEADER) {
            return GROBO_ERR_FRAME;
        }
    }
    if ((n > AT_ID && !is_id(bytes[AT_ID], accept)) ||
        (n > AT_LENGTH && bytes[AT_LENGTH] < LENGTH_MIN)) {
        return GROBO_ERR_FRAME;
    }
    if (n <= AT_LENGTH || n < (size_t)bytes[AT_LENGTH] + AT_INSTRUCTION) {
        return 0;
    }
    size_t size = (size_t)bytes[AT_LENGTH] + AT_INSTRUCTION;
    return sum_of(bytes, size) == bytes[size - 1] ? (int)size : GROBO_ERR_CHECKSUM;
}

/* Bytes that a servo was asked for; -1 when it was not asked. */
static int asked(const grobo_dxl1_packet *sent, uint8_t id)
{
    if (sent->instruction == GROBO_DXL1_SYNC_READ) {
        return sent->data_bytes > 0 && memchr(sent->data, id, sent->data_bytes) != NULL
                   ? sent->length
                   : -1;
    }
    if (sent->instruction == GROBO_DXL1_BULK_READ) {
        for (size_t i = 1; i + BULK_ITEM_BYTES <= sent->data_bytes; i += BULK_ITEM_BYTES) {
            if (sent->data[i + 1] == id) {
                return sent->data[i];
            }
        }
        return -1;
    }
    if (sent->id != id && (sent->id != GROBO_DXL1_ID_ALL || sent->instruction != GROBO_DXL1_PING)) {
        return -1;
    }
    return sent->instruction == GROBO_DXL1_READ ? sent->length : 0;
}

/* Whether the first bytes of a status fit an instruction. */
static bool fits(const grobo_dxl1_packet *sent, const uint8_t *bytes, size_t n)
{
    int data = n > AT_ID ? asked(sent, bytes[AT_ID]) : 0;
    if (data < 0) {
        return false;
    }
    if (n <= AT_LENGTH || bytes[AT_LENGTH] == data + LENGTH_MIN) {
        return true;
    }
    return bytes[AT_LENGTH] == LENGTH_MIN && (n <= AT_INSTRUCTION || bytes[AT_INSTRUCTION] != 0);
}

int grobo_dxl1_answer(const uint8_t *sent, size_t sent_bytes, const uint8_t *bytes, size_t n)
{
    grobo_dxl1_packet packet;
    if (sent == NULL || bytes == NULL) {
        return GROBO_ERR_ARG;
    }
    int result = grobo_dxl1_parse(sent, sent_bytes, false, &packet);
    if (result < 0) {
        return result;
    }
    int size = grobo_dxl1_measure(bytes, n, GROBO_ACCEPT_RETURNS);
    if (size == GROBO_ERR_FRAME || !fits(&packet, bytes, n)) {
        return GROBO_ERR_FRAME;
    }
    bool echo = size == (int)sent_bytes && memcmp(bytes, sent, sent_bytes) == 0;
    return echo ? GROBO_ERR_FRAME : size;
}

/* What stands before the data. */
static bool has_length(const grobo_dxl1_packet *packet)
{
    uint8_t code = packet->instruction;
    return !packet->status && (code == GROBO_DXL1_READ || code == GROBO_DXL1_SYNC_READ ||
                               code == GROBO_DXL1_SYNC_WRITE);
}

static bool has_address(const grobo_dxl1_packet *packet)
{
    uint8_t code = packet->instruction;
    return has_length(packet) ||
           (!packet->status && (code == GROBO_DXL1_WRITE || code == GROBO_DXL1_REG_WRITE));
}

static size_t head_bytes(const grobo_dxl1_packet *packet)
{
    return (has_address(packet) ? 1u : 0u) + (has_length(packet) ? 1u : 0u);
}

int grobo_dxl1_parse(const uint8_t *frame, size_t n, bool status, grobo_dxl1_packet *packet)
{
    if (frame == NULL || packet == NULL) {
        return GROBO_ERR_ARG;
    }
    unsigned accept = status ? GROBO_ACCEPT_RETURNS : GROBO_ACCEPT_COMMANDS;
    int size = n > 0 ? grobo_dxl1_measure(frame, n, accept) : 0;
    if (size < 0 || (size_t)size != n || size == 0) {
        return size < 0 ? size : GROBO_ERR_FRAME;
    }
    uint8_t byte = frame[AT_INSTRUCTION];
    grobo_dxl1_packet found = {.status = status,
                               .id = frame[AT_ID],
                               .instruction = status ? 0 : byte,
                               .error = status ? byte : 0};
    size_t head = head_bytes(&found);
    size_t got = n - GROBO_DXL1_OVERHEAD_BYTES;
    if (got < head) {
        return GROBO_ERR_SHORT;
    }
    found.address = has_address(&found) ? frame[AT_PARAMETERS] : 0;
    found.length = has_length(&found) ? frame[AT_PARAMETERS + 1] : 0;
    found.data = frame + AT_PARAMETERS + head;
    found.data_bytes = got - head;
    *packet = found;
    return GROBO_OK;
}

int grobo_dxl1_build(const grobo_dxl1_packet *packet, uint8_t *buf, size_t cap)
{
    if (packet == NULL || buf == NULL || (packet->data == NULL && packet->data_bytes > 0) ||
        !is_id(packet->id, packet->status ? 0 : GROBO_ACCEPT_COMMANDS)) {
        return GROBO_ERR_ARG;
    }
    size_t head = head_bytes(packet);
    if (packet->data_bytes > LENGTH_MAX - LENGTH_MIN - head) {
        return GROBO_ERR_CAP;
    }
    size_t size = head + packet->data_bytes + GROBO_DXL1_OVERHEAD_BYTES;
    if (size > cap) {
        return GROBO_ERR_SPACE;
    }
    if (packet->data_bytes > 0) {
        memmove(buf + AT_PARAMETERS + head, packet->data, packet->data_bytes);
    }
    buf[0] = HEADER;
    buf[1] = HEADER;
    buf[AT_ID] = packet->id;
    buf[AT_LENGTH] = (uint8_t)(size - AT_INSTRUCTION);
    buf[AT_INSTRUCTION] = packet->status ? packet->error : packet->instruction;
    if (has_address(packet)) {
        buf[AT_PARAMETERS] = packet->address;
    }
    if (has_length(packet)) {
        buf[AT_PARAMETERS + 1] = packet->length;
    }
    buf[size - 1] = sum_of(buf, size);
    return (int)size;
}
