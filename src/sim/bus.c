/* SPDX-License-Identifier: MIT */
/* What servos hear: bytes of the board or host, and the packets that they make. */
#include "src/sim/bus.h"
#include "src/sim/fault.h"
#include "src/sim/note.h"
#include "src/sim/power.h"
#include "src/sim/servo.h"
#include "src/sim/talk.h"
#include "src/sim/wire.h"

/* A servo forgets a packet that stands still for this long. */
#define SERVO_STALL_NS 10000000

void grobo_i_sim_frame_faults(grobo_sim *sim)
{
    if (grobo_i_sim_strikes(sim, GROBO_SIM_FAULT_BROWN_OUT, -1)) {
        grobo_i_sim_brown_out(sim);
    }
    if (grobo_i_sim_strikes(sim, GROBO_SIM_FAULT_HANG_UP, -1)) {
        grobo_i_sim_cut(sim);
    }
}

static void hear_packet(grobo_sim *sim, const grobo_rs30x_packet *packet)
{
    uint8_t bytes[GROBO_RS30X_PACKET_MAX_BYTES];
    int n = grobo_rs30x_build(packet, bytes, sizeof bytes);
    if (n < 0) {
        return;
    }
    sim->stats.packets++;
    const grobo_sim_event raw = {.kind = GROBO_SIM_PACKET,
                                 .time_us = sim->now_us,
                                 .servo = -1,
                                 .bytes = bytes,
                                 .n_bytes = (size_t)n};
    grobo_i_sim_tell(sim, &raw);
    if (sim->config.wiring == GROBO_WIRING_BUS) {
        grobo_i_sim_frame_faults(sim);
    }
    grobo_i_sim_packet(sim, packet, &raw);
}

/* What has come of a packet is forgotten. */
static void stalled(grobo_sim *sim)
{
    const grobo_framer *framer = &sim->bus.framer;
    sim->stats.stalls++;
    grobo_i_sim_tell(sim, &(grobo_sim_event){.kind = GROBO_SIM_STALLED,
                                             .time_us = sim->now_us,
                                             .servo = -1,
                                             .bytes = framer->buf + framer->taken,
                                             .n_bytes = grobo_rs30x_parser_pending(&sim->bus)});
    grobo_rs30x_parser_reset(&sim->bus);
}

void grobo_i_sim_bus_hear(grobo_sim *sim, uint8_t byte, int64_t t_ns)
{
    grobo_i_sim_talk_into(sim, &byte, t_ns);
    if (sim->config.echo) {
        grobo_i_sim_to_host(sim, byte, t_ns);
    }
    if (t_ns - sim->bus_heard_ns > SERVO_STALL_NS && grobo_rs30x_parser_pending(&sim->bus) > 0) {
        stalled(sim);
    }
    sim->bus_heard_ns = t_ns;
    (void)grobo_rs30x_parser_feed(&sim->bus, &byte, 1);
    grobo_rs30x_packet packet;
    while (grobo_rs30x_parser_next(&sim->bus, &packet) > 0) {
        hear_packet(sim, &packet);
    }
}
