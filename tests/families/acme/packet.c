/* SPDX-License-Identifier: MIT */
/* Frames: measured, taken apart, built. */
#include <string.h>

#include "src/servo/acme/acme.h"

enum { HOST = 0xC5, SERVO = 0x5C, AT_ID = 1, AT_LENGTH = 2, AT_OP = 3, AT_DATA = 4 };

uint8_t grobo_i_acme_sum(const uint8_t *frame, size_t n)
{
    uint8_t sum = 0x5A;
    for (size_t i = AT_ID; i < n - 1; i++) {
        sum ^= frame[i];
    }
    return sum;
}

int grobo_i_acme_measure(const uint8_t *bytes, size_t n, unsigned accept)
{
    bool host = bytes[0] == HOST && (accept & GROBO_ACCEPT_COMMANDS) != 0;
    bool servo = bytes[0] == SERVO && (accept & GROBO_ACCEPT_RETURNS) != 0;
    if (!host && !servo) {
        return GROBO_ERR_FRAME;
    }
    if (n > AT_ID && bytes[AT_ID] > ACME_ID_MAX && (servo || bytes[AT_ID] != ACME_ID_ALL)) {
        return GROBO_ERR_FRAME;
    }
    if (n <= AT_LENGTH) {
        return 0;
    }
    size_t size = (size_t)bytes[AT_LENGTH] + AT_DATA;
    if (bytes[AT_LENGTH] == 0 || size > ACME_FRAME_MAX_BYTES) {
        return GROBO_ERR_FRAME;
    }
    if (n < size) {
        return 0;
    }
    return grobo_i_acme_sum(bytes, size) == bytes[size - 1] ? (int)size : GROBO_ERR_CHECKSUM;
}

static int finish(uint8_t header, uint8_t id, uint8_t op, size_t data_bytes, uint8_t *buf)
{
    size_t size = data_bytes + ACME_OVERHEAD_BYTES;
    buf[0] = header;
    buf[AT_ID] = id;
    buf[AT_LENGTH] = (uint8_t)(data_bytes + 1);
    buf[AT_OP] = op;
    buf[size - 1] = grobo_i_acme_sum(buf, size);
    return (int)size;
}

/* How many bytes of address and length stand in front of the data. */
static size_t head_of(uint8_t op)
{
    switch (op) {
    case GROBO_DXL2_READ:
    case GROBO_DXL2_SYNC_WRITE:
        return 2;
    case GROBO_DXL2_WRITE:
        return 1;
    default:
        return 0;
    }
}

int grobo_i_acme_build(const grobo_dxl2_packet *packet, uint8_t *buf, size_t cap)
{
    size_t head = head_of(packet->instruction);
    size_t n = head + packet->data_bytes;
    if (packet->address > UINT8_MAX || packet->length > UINT8_MAX) {
        return GROBO_ERR_ARG;
    }
    if (n + ACME_OVERHEAD_BYTES > cap || n + ACME_OVERHEAD_BYTES > ACME_FRAME_MAX_BYTES) {
        return GROBO_ERR_SPACE;
    }
    if (packet->data_bytes > 0) {
        memmove(buf + AT_DATA + head, packet->data, packet->data_bytes);
    }
    if (head > 0) {
        buf[AT_DATA] = (uint8_t)packet->address;
    }
    if (head > 1) {
        buf[AT_DATA + 1] = (uint8_t)packet->length;
    }
    return finish(HOST, packet->id == GROBO_DXL2_ID_ALL ? ACME_ID_ALL : packet->id,
                  packet->instruction, n, buf);
}

int grobo_i_acme_answer(uint8_t id, uint8_t error, const uint8_t *data, size_t n, uint8_t *buf,
                        size_t cap)
{
    if (n + ACME_OVERHEAD_BYTES > cap || n + ACME_OVERHEAD_BYTES > ACME_FRAME_MAX_BYTES) {
        return GROBO_ERR_SPACE;
    }
    if (n > 0) {
        memmove(buf + AT_DATA, data, n);
    }
    return finish(SERVO, id, error, n, buf);
}

int grobo_i_acme_parse(const uint8_t *frame, size_t n, uint8_t *data, size_t cap,
                       grobo_dxl2_packet *packet)
{
    (void)data; /* nothing is stuffed */
    (void)cap;
    int size =
        n > 0 ? grobo_i_acme_measure(frame, n, GROBO_ACCEPT_COMMANDS | GROBO_ACCEPT_RETURNS) : 0;
    if (size <= 0 || (size_t)size != n) {
        return size < 0 ? size : GROBO_ERR_FRAME;
    }
    bool reply = frame[0] == SERVO;
    uint8_t op = reply ? (uint8_t)GROBO_DXL2_STATUS : frame[AT_OP];
    size_t head = reply ? 0 : head_of(op);
    if (n < head + ACME_OVERHEAD_BYTES) {
        return GROBO_ERR_FRAME;
    }
    *packet = (grobo_dxl2_packet){.id = frame[AT_ID] == ACME_ID_ALL ? (uint8_t)GROBO_DXL2_ID_ALL
                                                                    : frame[AT_ID],
                                  .instruction = op,
                                  .error = reply ? frame[AT_OP] : 0,
                                  .address = head > 0 ? frame[AT_DATA] : 0,
                                  .length = head > 1 ? frame[AT_DATA + 1] : 0,
                                  .data = frame + AT_DATA + head,
                                  .data_bytes = n - head - ACME_OVERHEAD_BYTES};
    return GROBO_OK;
}
