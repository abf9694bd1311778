/* SPDX-License-Identifier: MIT */
/* LewanSoul and Hiwonder servos for the bus: what a frame is answered by. */
#include <string.h>

#include "src/servo/lx16a/items.h"
#include "src/servo/tables.h"

enum {
    RETURN_DELAY_US = 500, /* an assumption: the maker prints none */
    CALL_US = 30000        /* as long as lx16a-servo waits for a reply */
};

static void unpack(uint8_t *bytes, size_t n, grobo_packet *packet)
{
    grobo_lx16a_packet found;
    memset(packet, 0, sizeof *packet);
    packet->kind = GROBO_PACKET_COMMAND;
    if (grobo_lx16a_parse(bytes, n, &found) >= 0 && found.data_bytes > 0 &&
        found.data_bytes == grobo_lx16a_reply_bytes(found.command)) {
        packet->kind = GROBO_PACKET_RETURN;
        packet->id = found.id;
        packet->address = found.command;
        packet->data = found.data;
        packet->data_bytes = found.data_bytes;
    }
}

/* Writes are never answered; the id is all that a servo tells when all are asked. */
static int reply_to(const uint8_t *frame, size_t n, grobo_reply *reply)
{
    grobo_lx16a_packet packet;
    int result = grobo_lx16a_parse(frame, n, &packet);
    if (result < 0) {
        return result;
    }
    size_t length = grobo_lx16a_reply_bytes(packet.command);
    *reply = (grobo_reply){.kind = GROBO_REPLY_NONE};
    if (packet.id == GROBO_LX16A_ID_ALL) {
        reply->kind = packet.command == GROBO_LX16A_ID_READ ? GROBO_REPLY_ANY : GROBO_REPLY_NONE;
    } else if (length > 0) {
        *reply =
            (grobo_reply){.kind = GROBO_REPLY_RETURN,
                          .id = packet.id,
                          .tag = packet.command,
                          .count = 1,
                          .address = grobo_i_item_of(grobo_i_lx16a_items, packet.command)->address,
                          .length = (uint16_t)length,
                          .bytes = (uint32_t)length + GROBO_LX16A_OVERHEAD_BYTES};
    }
    return (int)reply->bytes;
}

const grobo_protocol grobo_i_lx16a_protocol =
    GROBO_TABLE(grobo_protocol, .name = "Hiwonder LX", .measure = grobo_lx16a_measure,
                .unpack = unpack, .reply_to = reply_to, .return_delay_us = RETURN_DELAY_US,
                .call_us = CALL_US, .id_min = 0, .id_max = GROBO_LX16A_ID_MAX);

const grobo_protocol *grobo_lx16a_protocol(void)
{
    return &grobo_i_lx16a_protocol;
}
