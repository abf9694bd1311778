/* SPDX-License-Identifier: MIT */
/* Feetech's servos for the bus: the frames of DYNAMIXEL 1.0 with other errors. */
#include <grobo/core/bus.h>
#include <grobo/core/feetech.h>

#include "src/servo/dxl1/protocol.h"
#include "src/servo/tables.h"

/* All of its errors say how the servo is; the data are good, and the request was done. What a host
 * sends to read two bytes is a status with two, the address and a 2: it is no value of theirs, even
 * if a servo without its sensor may say so one time in 256. */
static void unpack(uint8_t *bytes, size_t n, grobo_packet *packet)
{
    grobo_i_dxl1_unpack(bytes, n, 0, packet);
    if (packet->flags == GROBO_DXL1_READ && packet->data_bytes == 2 && packet->data[1] == 2) {
        packet->kind = GROBO_PACKET_COMMAND;
    }
}

/* Register 7 in 2 us, as it leaves the factory: 0 of STS and SCS, 250 of SM (the models' files). */
#define DELAYED_US 500

#define FRAMES_OF(delay_us)                                                                        \
    GROBO_TABLE(grobo_protocol, .name = "Feetech", .measure = grobo_i_dxl1_measure,                \
                .unpack = unpack, .reply_to = grobo_i_dxl1_reply_to,                               \
                .reply_at = grobo_i_dxl1_reply_at, .several = grobo_bus_several,                   \
                .return_delay_us = (delay_us), .call_us = GROBO_DXL1_CALL_US, .id_min = 0,         \
                .id_max = GROBO_DXL1_ID_MAX)

const grobo_protocol grobo_i_feetech_protocol = FRAMES_OF(0);
/* Of robots with a servo that waits before it replies: of 20 replies to one frame that is 10 ms. */
const grobo_protocol grobo_i_feetech_delayed_protocol = FRAMES_OF(DELAYED_US);

const grobo_protocol *grobo_feetech_protocol(void)
{
    return &grobo_i_feetech_protocol;
}
