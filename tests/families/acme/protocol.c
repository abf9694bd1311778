/* SPDX-License-Identifier: MIT */
/* For the bus: what a frame is answered by, and what a reply tells. */
#include <string.h>

#include "src/servo/acme/acme.h"

static void unpack(uint8_t *bytes, size_t n, grobo_packet *packet)
{
    grobo_dxl2_packet found;
    memset(packet, 0, sizeof *packet);
    packet->kind = GROBO_PACKET_COMMAND;
    if (grobo_i_acme_parse(bytes, n, NULL, 0, &found) >= 0 &&
        found.instruction == GROBO_DXL2_STATUS) {
        packet->kind = GROBO_PACKET_RETURN;
        packet->id = found.id;
        packet->flags = found.error;
        packet->refused = (found.error & ACME_REFUSED) != 0;
        packet->data = found.data;
        packet->data_bytes = found.data_bytes;
    }
}

static int reply_to(const uint8_t *frame, size_t n, grobo_reply *reply)
{
    grobo_dxl2_packet found;
    int result = grobo_i_acme_parse(frame, n, NULL, 0, &found);
    if (result < 0 || found.instruction == GROBO_DXL2_STATUS) {
        return result < 0 ? result : GROBO_ERR_FRAME;
    }
    *reply = (grobo_reply){.kind = GROBO_REPLY_NONE};
    if (found.id == GROBO_DXL2_ID_ALL) {
        reply->kind = found.instruction == GROBO_DXL2_PING ? GROBO_REPLY_ANY : GROBO_REPLY_NONE;
        return 0;
    }
    uint16_t length = found.instruction == GROBO_DXL2_READ ? found.length : 0;
    *reply = (grobo_reply){.kind = GROBO_REPLY_RETURN,
                           .id = found.id,
                           .count = 1,
                           .address = found.address,
                           .length = length,
                           .bytes = (uint32_t)length + ACME_OVERHEAD_BYTES};
    return (int)reply->bytes;
}

const grobo_protocol grobo_i_acme_protocol =
    GROBO_TABLE(grobo_protocol, .name = "Acme", .measure = grobo_i_acme_measure, .unpack = unpack,
                .reply_to = reply_to, .return_delay_us = 100, .call_us = 50000, .id_min = 0,
                .id_max = ACME_ID_MAX);
