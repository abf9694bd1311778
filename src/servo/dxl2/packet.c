/* SPDX-License-Identifier: MIT */
/* Frames of DYNAMIXEL Protocol 2.0: measured, taken apart, built. */
#include <string.h>

#include <grobo/core/dxl2.h>
#include <grobo/core/protocol.h>

#include "src/base/bytes.h"

enum {
    AT_ID = 4,
    AT_LENGTH = 5,
    AT_INSTRUCTION = 7,
    AT_PARAMETERS = 8,
    CRC_BYTES = 2,
    BLOCK_HEAD_BYTES = 2 /* error, id */
};

static const uint8_t header[] = {0xFF, 0xFF, 0xFD, 0x00};

uint16_t grobo_dxl2_crc(uint16_t crc, const uint8_t *bytes, size_t n)
{
    /* Polynomial 8005, four bits at a time. */
    static const uint16_t table[] = {0x0000, 0x8005, 0x800F, 0x000A, 0x801B, 0x001E,
                                     0x0014, 0x8011, 0x8033, 0x0036, 0x003C, 0x8039,
                                     0x0028, 0x802D, 0x8027, 0x0022};
    for (size_t i = 0; bytes != NULL && i < n; i++) {
        crc = (uint16_t)((uint16_t)(crc << 4) ^ table[crc >> 12 ^ bytes[i] >> 4]);
        crc = (uint16_t)((uint16_t)(crc << 4) ^ table[crc >> 12 ^ (bytes[i] & 0x0F)]);
    }
    return crc;
}

static bool has_good_crc(const uint8_t *bytes, size_t n)
{
    return grobo_dxl2_crc(0, bytes, n - CRC_BYTES) == grobo_i_get_u16(bytes + n - CRC_BYTES);
}

/* Whether FF FF FD ends at frame[i], within the parameters. */
static bool ends_header(const uint8_t *frame, size_t i)
{
    return i >= AT_PARAMETERS + 2 && frame[i] == 0xFD && frame[i - 1] == 0xFF &&
           frame[i - 2] == 0xFF;
}

/* Of parameters: FF FF FD that no FD follows. A CRC in a fast status may look like one. */
static bool is_stuffed(const uint8_t *bytes, size_t n)
{
    for (size_t i = AT_PARAMETERS; i < n - CRC_BYTES; i++) {
        if (ends_header(bytes, i)) {
            if (++i == n - CRC_BYTES || bytes[i] != 0xFD) {
                return false;
            }
        }
    }
    return true;
}

static bool is_id(uint8_t id)
{
    return id <= GROBO_DXL2_ID_MAX || id == GROBO_DXL2_ID_ALL;
}

/* The size that the bytes announce, whatever stands at its end; 0 for more bytes. */
static int announced(const uint8_t *bytes, size_t n, unsigned accept)
{
    size_t known = n < sizeof header ? n : sizeof header;
    if (memcmp(bytes, header, known) != 0 || (n > AT_ID && !is_id(bytes[AT_ID]))) {
        return GROBO_ERR_FRAME;
    }
    if (n < AT_INSTRUCTION) {
        return 0;
    }
    int size = AT_INSTRUCTION + grobo_i_get_u16(bytes + AT_LENGTH);
    if (size < GROBO_DXL2_OVERHEAD_BYTES || size > GROBO_DXL2_FRAME_MAX_BYTES) {
        return GROBO_ERR_FRAME;
    }
    if (n == AT_INSTRUCTION) {
        return 0;
    }
    bool status = bytes[AT_INSTRUCTION] == GROBO_DXL2_STATUS;
    bool accepted = (accept & (status ? GROBO_ACCEPT_RETURNS : GROBO_ACCEPT_COMMANDS)) != 0;
    return accepted && (!status || size >= GROBO_DXL2_STATUS_BYTES) ? size : GROBO_ERR_FRAME;
}

int grobo_dxl2_measure(const uint8_t *bytes, size_t n, unsigned accept)
{
    if (bytes == NULL) {
        return GROBO_ERR_ARG;
    }
    int size = announced(bytes, n, accept);
    if (size <= 0 || n < (size_t)size) {
        return size < 0 ? size : 0;
    }
    if (!has_good_crc(bytes, (size_t)size)) {
        return GROBO_ERR_CHECKSUM;
    }
    bool strict = bytes[AT_INSTRUCTION] == GROBO_DXL2_STATUS && bytes[AT_ID] != GROBO_DXL2_ID_ALL;
    return strict && !is_stuffed(bytes, (size_t)size) ? GROBO_ERR_FRAME : size;
}

/* Parameters from..end of a frame without the stuffing; never more than there were, so that they
 * may stay where they are. */
static size_t unstuff(const uint8_t *frame, size_t end, uint8_t *to)
{
    uint8_t last[2] = {0, 0};
    size_t n = 0;
    for (size_t i = AT_PARAMETERS; i < end; i++) {
        uint8_t byte = frame[i];
        bool pattern = byte == 0xFD && last[0] == 0xFF && last[1] == 0xFF;
        to[n++] = byte;
        last[1] = last[0];
        last[0] = byte;
        if (pattern && i + 1 < end && frame[i + 1] == 0xFD) {
            i++;
        }
    }
    return n;
}

/* What stands before the data. */
static bool has_error(const grobo_dxl2_packet *packet)
{
    return packet->instruction == GROBO_DXL2_STATUS && packet->id != GROBO_DXL2_ID_ALL;
}

static bool has_length(const grobo_dxl2_packet *packet)
{
    uint8_t code = packet->instruction;
    return code == GROBO_DXL2_READ || code == GROBO_DXL2_SYNC_READ ||
           code == GROBO_DXL2_FAST_SYNC_READ || code == GROBO_DXL2_SYNC_WRITE;
}

static bool has_address(const grobo_dxl2_packet *packet)
{
    return has_length(packet) || packet->instruction == GROBO_DXL2_WRITE ||
           packet->instruction == GROBO_DXL2_REG_WRITE;
}

static size_t head_bytes(const grobo_dxl2_packet *packet)
{
    return (has_error(packet) ? 1u : 0u) + (has_address(packet) ? 2u : 0u) +
           (has_length(packet) ? 2u : 0u);
}

int grobo_dxl2_parse(const uint8_t *frame, size_t n, uint8_t *data, size_t cap,
                     grobo_dxl2_packet *packet)
{
    if (frame == NULL || data == NULL || packet == NULL) {
        return GROBO_ERR_ARG;
    }
    const unsigned both = GROBO_ACCEPT_COMMANDS | GROBO_ACCEPT_RETURNS;
    int size = n > 0 ? grobo_dxl2_measure(frame, n, both) : 0;
    if (size <= 0 || (size_t)size != n) {
        return size < 0 ? size : GROBO_ERR_FRAME;
    }
    if (cap < n - GROBO_DXL2_OVERHEAD_BYTES) {
        return GROBO_ERR_SPACE;
    }
    grobo_dxl2_packet found = {.id = frame[AT_ID], .instruction = frame[AT_INSTRUCTION]};
    bool fast = found.instruction == GROBO_DXL2_STATUS && found.id == GROBO_DXL2_ID_ALL;
    size_t got = n - GROBO_DXL2_OVERHEAD_BYTES;
    if (fast) {
        memmove(data, frame + AT_PARAMETERS, got);
    } else {
        got = unstuff(frame, n - CRC_BYTES, data);
    }
    size_t head = head_bytes(&found);
    if (got < head) {
        return GROBO_ERR_SHORT;
    }
    found.error = has_error(&found) ? data[0] : 0;
    found.address = has_address(&found) ? grobo_i_get_u16(data) : 0;
    found.length = has_length(&found) ? grobo_i_get_u16(data + 2) : 0;
    found.data = data + head;
    found.data_bytes = got - head;
    *packet = found;
    return GROBO_OK;
}

/* Stuffs the parameters before end in their place. Returns their new end, 0 when it is beyond
 * cap. */
static size_t stuff(uint8_t *buf, size_t end, size_t cap)
{
    size_t extra = 0;
    for (size_t i = AT_PARAMETERS; i < end; i++) {
        extra += ends_header(buf, i) ? 1 : 0;
    }
    if (end + extra > cap) {
        return 0;
    }
    for (size_t from = end, to = end + extra; to > from; from--) {
        if (ends_header(buf, from - 1)) {
            buf[--to] = 0xFD;
        }
        buf[--to] = buf[from - 1];
    }
    return end + extra;
}

static void put_head(const grobo_dxl2_packet *packet, uint8_t *buf)
{
    memcpy(buf, header, sizeof header);
    buf[AT_ID] = packet->id;
    buf[AT_INSTRUCTION] = packet->instruction;
    uint8_t *at = buf + AT_PARAMETERS;
    if (has_error(packet)) {
        at[0] = packet->error;
    }
    if (has_address(packet)) {
        grobo_i_put_u16(at, packet->address);
    }
    if (has_length(packet)) {
        grobo_i_put_u16(at + 2, packet->length);
    }
}

int grobo_dxl2_build(const grobo_dxl2_packet *packet, uint8_t *buf, size_t cap)
{
    if (packet == NULL || buf == NULL || (packet->data == NULL && packet->data_bytes > 0) ||
        !is_id(packet->id)) {
        return GROBO_ERR_ARG;
    }
    size_t at = AT_PARAMETERS + head_bytes(packet);
    if (packet->data_bytes > GROBO_DXL2_FRAME_MAX_BYTES - CRC_BYTES - at) {
        return GROBO_ERR_CAP;
    }
    size_t end = at + packet->data_bytes;
    if (end + CRC_BYTES > cap) {
        return GROBO_ERR_SPACE;
    }
    if (packet->data_bytes > 0) {
        memmove(buf + at, packet->data, packet->data_bytes);
    }
    put_head(packet, buf);
    if (packet->instruction != GROBO_DXL2_STATUS || packet->id != GROBO_DXL2_ID_ALL) {
        end = stuff(buf, end, cap - CRC_BYTES);
    }
    if (end == 0) {
        return GROBO_ERR_SPACE;
    }
    if (end + CRC_BYTES > GROBO_DXL2_FRAME_MAX_BYTES) {
        return GROBO_ERR_CAP;
    }
    grobo_i_put_u16(buf + AT_LENGTH, (uint16_t)(end + CRC_BYTES - AT_INSTRUCTION));
    grobo_i_put_u16(buf + end, grobo_dxl2_crc(0, buf, end));
    return (int)(end + CRC_BYTES);
}

int grobo_dxl2_block(const uint8_t *frame, size_t n, size_t at, uint16_t length,
                     grobo_dxl2_packet *block)
{
    if (frame == NULL || block == NULL) {
        return GROBO_ERR_ARG;
    }
    size_t end = at + BLOCK_HEAD_BYTES + length;
    if (at < AT_PARAMETERS || at > n || end + CRC_BYTES > n) {
        return GROBO_ERR_SHORT;
    }
    if (!has_good_crc(frame, end + CRC_BYTES)) {
        return GROBO_ERR_CHECKSUM;
    }
    *block = (grobo_dxl2_packet){.id = frame[at + 1],
                                 .instruction = GROBO_DXL2_STATUS,
                                 .error = frame[at],
                                 .data = frame + at + BLOCK_HEAD_BYTES,
                                 .data_bytes = length};
    return (int)(end + CRC_BYTES);
}
