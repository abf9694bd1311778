/* SPDX-License-Identifier: MIT */
/* DYNAMIXEL Protocol 2.0 for the bus: what a frame is answered by, and what a status tells. */
#include <string.h>

#include <grobo/core/bus.h>
#include <grobo/core/dxl2.h>

#include "src/base/bytes.h"
#include "src/servo/tables.h"

enum {
    PING_BYTES = 3,       /* model, firmware */
    AT_PARAMETERS = 8,    /* data of a status too, behind its error */
    BLOCK_BYTES = 4,      /* of a fast status, without its data: error, id, CRC */
    BULK_ITEM_BYTES = 5,  /* id, address, length */
    RETURN_DELAY_US = 500 /* register 9, as it leaves the factory */
};

/* Servos answer a ping to all in the order of their ids, some time apart; DynamixelSDK waits 3 ms
 * for each of 252 that there may be, and 16 ms. */
#define CALL_US 772000

typedef uint8_t room[GROBO_FRAME_MAX_BYTES];

static int open_frame(const uint8_t *frame, size_t n, uint8_t *data, grobo_dxl2_packet *packet)
{
    int result = grobo_dxl2_parse(frame, n, data, sizeof(room), packet);
    if (result < 0) {
        return result == GROBO_ERR_CHECKSUM ? result : GROBO_ERR_FRAME;
    }
    return packet->instruction == GROBO_DXL2_STATUS ? GROBO_ERR_ARG : GROBO_OK;
}

static void unpack(uint8_t *bytes, size_t n, grobo_packet *packet)
{
    grobo_dxl2_packet found;
    memset(packet, 0, sizeof *packet);
    packet->kind = GROBO_PACKET_COMMAND;
    if (grobo_dxl2_parse(bytes, n, bytes + AT_PARAMETERS, n - AT_PARAMETERS, &found) < 0 ||
        found.instruction != GROBO_DXL2_STATUS) {
        return;
    }
    uint8_t error = found.error & (uint8_t)~GROBO_DXL2_ALERT;
    packet->id = found.id;
    packet->flags = found.error;
    packet->data = found.data;
    packet->data_bytes = found.data_bytes;
    packet->refused = error != GROBO_DXL2_DONE;
    /* Of a request that came broken: it is asked again when the time of its answer is over. */
    packet->kind = error == GROBO_DXL2_BAD_CRC ? GROBO_PACKET_COMMAND : GROBO_PACKET_RETURN;
}

static unsigned items_of(const grobo_dxl2_packet *packet)
{
    bool bulk = packet->instruction == GROBO_DXL2_BULK_READ ||
                packet->instruction == GROBO_DXL2_FAST_BULK_READ;
    return (unsigned)(packet->data_bytes / (bulk ? BULK_ITEM_BYTES : 1));
}

/* What the frame asks its servo k for, and which one that is. */
static void item_of(const grobo_dxl2_packet *packet, unsigned k, grobo_reply *reply)
{
    const uint8_t *item = packet->data + k;
    reply->address = packet->address;
    reply->length = packet->length;
    if (packet->instruction == GROBO_DXL2_BULK_READ ||
        packet->instruction == GROBO_DXL2_FAST_BULK_READ) {
        item = packet->data + (size_t)k * BULK_ITEM_BYTES;
        reply->address = grobo_i_get_u16(item + 1);
        reply->length = grobo_i_get_u16(item + 3);
    }
    reply->id = item[0];
}

static void reply_at(const uint8_t *frame, size_t n, unsigned k, grobo_reply *reply)
{
    room data;
    grobo_dxl2_packet packet;
    if (open_frame(frame, n, data, &packet) >= 0 && k < items_of(&packet)) {
        item_of(&packet, k, reply);
    }
}

/* Of a frame for several: a packet of each, or a fast one for all. */
static int reply_of_several(const grobo_dxl2_packet *packet, bool fast, grobo_reply *reply)
{
    unsigned n = items_of(packet);
    uint32_t bytes = 0;
    if (n == 0 || n > GROBO_REPLIES_MAX) {
        return n == 0 ? GROBO_ERR_ARG : GROBO_ERR_CAP;
    }
    for (unsigned k = n; k-- > 0;) {
        item_of(packet, k, reply);
        bytes += (fast ? BLOCK_BYTES : GROBO_DXL2_STATUS_BYTES) + (uint32_t)reply->length;
    }
    reply->kind = GROBO_REPLY_RETURN;
    reply->id = n > 1 || fast ? GROBO_DXL2_ID_ALL : reply->id;
    reply->count = fast ? 1 : (uint8_t)n;
    reply->bytes = bytes + (fast ? AT_PARAMETERS : 0);
    reply->length = fast ? (uint16_t)(bytes - 2) : reply->length; /* the last CRC is the frame's */
    return GROBO_OK;
}

static int reply_of_one(const grobo_dxl2_packet *packet, uint16_t length, grobo_reply *reply)
{
    if (packet->id == GROBO_DXL2_ID_ALL) {
        reply->kind = packet->instruction == GROBO_DXL2_PING ? GROBO_REPLY_ANY : GROBO_REPLY_NONE;
        return GROBO_OK;
    }
    *reply = (grobo_reply){.kind = GROBO_REPLY_RETURN,
                           .id = packet->id,
                           .count = 1,
                           .address = packet->address,
                           .length = length,
                           .bytes = (uint32_t)length + GROBO_DXL2_STATUS_BYTES};
    return GROBO_OK;
}

static int find_reply(const grobo_dxl2_packet *packet, grobo_reply *reply)
{
    uint8_t code = packet->instruction;
    if (code == GROBO_DXL2_SYNC_READ || code == GROBO_DXL2_BULK_READ) {
        return reply_of_several(packet, false, reply);
    }
    if (code == GROBO_DXL2_FAST_SYNC_READ || code == GROBO_DXL2_FAST_BULK_READ) {
        return reply_of_several(packet, true, reply);
    }
    if (code == GROBO_DXL2_SYNC_WRITE || code == GROBO_DXL2_BULK_WRITE) {
        return GROBO_OK;
    }
    uint16_t length = code == GROBO_DXL2_PING ? PING_BYTES : packet->length; /* of a read */
    return reply_of_one(packet, length, reply);
}

static int reply_to(const uint8_t *frame, size_t n, grobo_reply *reply)
{
    room data;
    grobo_dxl2_packet packet;
    grobo_reply found = {.kind = GROBO_REPLY_NONE};
    int result = n > sizeof data ? GROBO_ERR_FRAME : open_frame(frame, n, data, &packet);
    if (result >= 0) {
        result = find_reply(&packet, &found);
    }
    if (result < 0) {
        return result;
    }
    *reply = found;
    return (int)found.bytes;
}

static int measure(const uint8_t *bytes, size_t n, unsigned accept)
{
    int size = grobo_dxl2_measure(bytes, n, accept);
    return size > GROBO_FRAME_MAX_BYTES ? GROBO_ERR_FRAME : size;
}

const grobo_protocol grobo_i_dxl2_protocol =
    GROBO_TABLE(grobo_protocol, .name = "DYNAMIXEL 2.0", .measure = measure, .unpack = unpack,
                .reply_to = reply_to, .reply_at = reply_at, .several = grobo_bus_several,
                .return_delay_us = RETURN_DELAY_US, .call_us = CALL_US, .id_min = 0,
                .id_max = GROBO_DXL2_ID_MAX);

const grobo_protocol *grobo_dxl2_protocol(void)
{
    return &grobo_i_dxl2_protocol;
}
