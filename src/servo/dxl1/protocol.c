/* SPDX-License-Identifier: MIT */
/* DYNAMIXEL Protocol 1.0 for the bus: what a frame is answered by, and what a status tells. Nothing
 * in a frame says whether it is a status: the bus compares with what it has sent, and what looks as
 * if a host had sent it answers nothing: an echo that nobody reckons with, or another host's. */
#include <string.h>

#include <grobo/core/bus.h>

#include "src/servo/dxl1/protocol.h"
#include "src/servo/tables.h"

enum {
    BULK_ITEM_BYTES = 3,  /* length, id, address */
    RETURN_DELAY_US = 500 /* register 5, as it leaves the factory */
};

void grobo_i_dxl1_unpack(uint8_t *bytes, size_t n, uint8_t refusals, grobo_packet *packet)
{
    grobo_dxl1_packet found;
    memset(packet, 0, sizeof *packet);
    packet->kind = GROBO_PACKET_COMMAND;
    if (grobo_dxl1_parse(bytes, n, true, &found) < 0) {
        return;
    }
    packet->kind = GROBO_PACKET_RETURN;
    packet->id = found.id;
    packet->flags = found.error;
    packet->data = found.data;
    packet->data_bytes = found.data_bytes;
    packet->refused = (found.error & refusals) != 0;
}

/* The other bits say how the servo is, and come with good data. Of a request that came broken: it
 * is asked again when the time of its answer is over. A read or a write of a host's would refuse,
 * with data, as no status does. */
static void unpack(uint8_t *bytes, size_t n, grobo_packet *packet)
{
    const uint8_t refusals =
        GROBO_DXL1_ANGLE_LIMIT | GROBO_DXL1_BAD_RANGE | GROBO_DXL1_BAD_INSTRUCTION;
    grobo_i_dxl1_unpack(bytes, n, refusals, packet);
    bool sent = packet->refused && packet->data_bytes > 0 && packet->flags <= GROBO_DXL1_WRITE;
    if (sent || (packet->flags & GROBO_DXL1_BAD_SUM) != 0) {
        packet->kind = GROBO_PACKET_COMMAND;
    }
}

static int open_frame(const uint8_t *frame, size_t n, grobo_dxl1_packet *packet)
{
    int result = grobo_dxl1_parse(frame, n, false, packet);
    return result == GROBO_ERR_SHORT ? GROBO_ERR_FRAME : result;
}

static unsigned items_of(const grobo_dxl1_packet *packet)
{
    bool bulk = packet->instruction == GROBO_DXL1_BULK_READ;
    return (unsigned)(bulk ? (packet->data_bytes - 1) / BULK_ITEM_BYTES : packet->data_bytes);
}

/* What the frame asks its servo k for, and which one that is. */
static void item_of(const grobo_dxl1_packet *packet, unsigned k, grobo_reply *reply)
{
    if (packet->instruction == GROBO_DXL1_BULK_READ) {
        const uint8_t *item = packet->data + 1 + (size_t)k * BULK_ITEM_BYTES;
        reply->length = item[0];
        reply->id = item[1];
        reply->address = item[2];
    } else {
        reply->length = packet->length;
        reply->id = packet->data[k];
        reply->address = packet->address;
    }
}

void grobo_i_dxl1_reply_at(const uint8_t *frame, size_t n, unsigned k, grobo_reply *reply)
{
    grobo_dxl1_packet packet;
    if (open_frame(frame, n, &packet) >= 0 && packet.data_bytes > 0 && k < items_of(&packet)) {
        item_of(&packet, k, reply);
    }
}

static int reply_of_several(const grobo_dxl1_packet *packet, grobo_reply *reply)
{
    unsigned n = packet->data_bytes > 0 ? items_of(packet) : 0;
    if (n == 0 || n > GROBO_REPLIES_MAX) {
        return n == 0 ? GROBO_ERR_ARG : GROBO_ERR_CAP;
    }
    for (unsigned k = n; k-- > 0;) {
        item_of(packet, k, reply);
        reply->bytes += (uint32_t)reply->length + GROBO_DXL1_OVERHEAD_BYTES;
    }
    reply->kind = GROBO_REPLY_RETURN;
    reply->id = n > 1 ? GROBO_DXL1_ID_ALL : reply->id;
    reply->count = (uint8_t)n;
    return GROBO_OK;
}

static int find_reply(const grobo_dxl1_packet *packet, grobo_reply *reply)
{
    uint8_t code = packet->instruction;
    if (code == GROBO_DXL1_SYNC_READ || code == GROBO_DXL1_BULK_READ) {
        return reply_of_several(packet, reply);
    }
    if (packet->id == GROBO_DXL1_ID_ALL) {
        reply->kind = code == GROBO_DXL1_PING ? GROBO_REPLY_ANY : GROBO_REPLY_NONE;
        return GROBO_OK;
    }
    *reply = (grobo_reply){.kind = GROBO_REPLY_RETURN,
                           .id = packet->id,
                           .count = 1,
                           .address = packet->address,
                           .length = code == GROBO_DXL1_READ ? packet->length : 0};
    reply->bytes = (uint32_t)reply->length + GROBO_DXL1_OVERHEAD_BYTES;
    return GROBO_OK;
}

int grobo_i_dxl1_reply_to(const uint8_t *frame, size_t n, grobo_reply *reply)
{
    grobo_dxl1_packet packet;
    grobo_reply found = {.kind = GROBO_REPLY_NONE};
    int result = open_frame(frame, n, &packet);
    if (result >= 0) {
        result = find_reply(&packet, &found);
    }
    if (result < 0) {
        return result;
    }
    *reply = found;
    return (int)found.bytes;
}

int grobo_i_dxl1_measure(const uint8_t *bytes, size_t n, unsigned accept)
{
    int size = grobo_dxl1_measure(bytes, n, accept);
    return size > GROBO_FRAME_MAX_BYTES ? GROBO_ERR_FRAME : size;
}

const grobo_protocol grobo_i_dxl1_protocol = GROBO_TABLE(
    grobo_protocol, .name = "DYNAMIXEL 1.0", .measure = grobo_i_dxl1_measure, .unpack = unpack,
    .reply_to = grobo_i_dxl1_reply_to, .reply_at = grobo_i_dxl1_reply_at,
    .several = grobo_bus_several, .return_delay_us = RETURN_DELAY_US, .call_us = GROBO_DXL1_CALL_US,
    .id_min = 0, .id_max = GROBO_DXL1_ID_MAX);

const grobo_protocol *grobo_dxl1_protocol(void)
{
    return &grobo_i_dxl1_protocol;
}
