/* SPDX-License-Identifier: MIT */
/* What servos hear: bytes of the board or host, and the packets that they make. */
#include <string.h>

#include "src/base/assert.h"
#include "src/sim/bus.h"
#include "src/sim/servo/family.h"
#include "src/sim/servo/fault.h"
#include "src/sim/servo/note.h"
#include "src/sim/servo/power.h"
#include "src/sim/servo/talk.h"
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

static void hear_packet(grobo_sim *sim, const grobo_sim_ear *ear, size_t n)
{
    sim->stats.packets++;
    const grobo_sim_event raw = {.kind = GROBO_SIM_PACKET,
                                 .time_us = sim->now_us,
                                 .servo = -1,
                                 .bytes = ear->byte,
                                 .n_bytes = n};
    grobo_i_sim_tell(sim, &raw);
    if (sim->config.wiring == GROBO_WIRING_BUS) {
        grobo_i_sim_frame_faults(sim);
    }
    ear->family->packet(ear->family, sim, &raw);
}

/* What has come of a packet is forgotten. */
static void stalled(grobo_sim *sim, grobo_sim_ear *ear)
{
    sim->stats.stalls++;
    grobo_i_sim_tell(sim, &(grobo_sim_event){.kind = GROBO_SIM_STALLED,
                                             .time_us = sim->now_us,
                                             .servo = -1,
                                             .bytes = ear->byte,
                                             .n_bytes = ear->used});
    ear->used = 0;
}

/* After a false start goes on with the byte behind it, which may start a true packet. */
static void listen(grobo_sim *sim, grobo_sim_ear *ear)
{
    while (ear->used > 0) {
        int size = ear->family->measure(ear->byte, ear->used, true);
        if (size == 0 && ear->used < sizeof ear->byte) {
            return;
        }
        if (size > 0) {
            hear_packet(sim, ear, (size_t)size);
        } else if (size == GROBO_ERR_CHECKSUM && ear->family->broken != NULL) {
            ear->family->broken(ear->family, sim, ear->byte, ear->used);
        }
        ear->used = (uint16_t)(ear->used - (size > 0 ? size : 1));
        memmove(ear->byte, ear->byte + (size > 0 ? size : 1), ear->used);
    }
}

void grobo_i_sim_bus_hear(grobo_sim *sim, uint8_t byte, int64_t t_ns)
{
    if (!grobo_i_sim_talk_into(sim, &byte, t_ns)) {
        return;
    }
    if (sim->config.echo) {
        grobo_i_sim_to_host(sim, &byte, 1, t_ns);
    }
    bool still = t_ns - sim->bus_heard_ns > SERVO_STALL_NS;
    sim->bus_heard_ns = t_ns;
    for (int i = 0; i < sim->n_ears; i++) {
        if (still && sim->ear[i].used > 0) {
            stalled(sim, &sim->ear[i]);
        }
        GROBO_ASSERT(sim->ear[i].used < sizeof sim->ear[i].byte);
        sim->ear[i].byte[sim->ear[i].used++] = byte;
        listen(sim, &sim->ear[i]);
    }
}

size_t grobo_i_sim_bus_packet(const grobo_sim *sim, const uint8_t *bytes, size_t n)
{
    const grobo_sim_ear *ear = &sim->ear[0];
    if (sim->n_ears != 1 || sim->n_talks > 0 || ear->used > 0 || sim->config.echo) {
        return 0;
    }
    int size = ear->family->measure(bytes, n, true);
    return size > 0 && size <= (int)sizeof ear->byte ? (size_t)size : 0;
}

void grobo_i_sim_bus_hear_packet(grobo_sim *sim, const uint8_t *bytes, size_t n, int64_t t_ns)
{
    grobo_sim_ear *ear = &sim->ear[0];
    GROBO_ASSERT(sim->n_ears == 1 && ear->used == 0 && n <= sizeof ear->byte);
    sim->bus_heard_ns = t_ns;
    memcpy(ear->byte, bytes, n);
    ear->used = (uint16_t)n;
    listen(sim, ear);
}
