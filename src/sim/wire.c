/* SPDX-License-Identifier: MIT */
#include "src/base/assert.h"
#include "src/sim/servo/fault.h"
#include "src/sim/wire.h"

/* A byte that is over at at_ns; false when there is no room for it. */
static bool put(grobo_sim_wire *wire, uint8_t byte, int64_t at_ns)
{
    wire->free_ns = at_ns;
    if (wire->used == GROBO_SIM_WIRE_BYTES) {
        return false;
    }
    size_t at = (size_t)(wire->head + wire->used++) % GROBO_SIM_WIRE_BYTES;
    GROBO_ASSERT(wire->used <= GROBO_SIM_WIRE_BYTES);
    wire->byte[at] = byte;
    wire->at_ns[at] = at_ns;
    return true;
}

void grobo_i_sim_wire_write(grobo_sim_wire *wire, const uint8_t *bytes, size_t n, int64_t at_ns,
                            int64_t byte_ns)
{
    GROBO_ASSERT(wire->used + n <= GROBO_SIM_WIRE_BYTES);
    wire->head = wire->used > 0 ? wire->head : 0; /* in one piece: grobo_i_sim_sound() */
    size_t at = (size_t)(wire->head + wire->used) % GROBO_SIM_WIRE_BYTES;
    for (size_t i = 0; i < n; i++) {
        at_ns += byte_ns;
        wire->byte[at] = bytes[i];
        wire->at_ns[at] = at_ns;
        at = at + 1 < GROBO_SIM_WIRE_BYTES ? at + 1 : 0;
    }
    wire->used = (uint16_t)(wire->used + n);
    wire->free_ns = n > 0 ? at_ns : wire->free_ns;
}

static uint8_t take(grobo_sim_wire *wire)
{
    GROBO_ASSERT(wire->used > 0 && wire->head < GROBO_SIM_WIRE_BYTES);
    uint8_t byte = wire->byte[wire->head];
    wire->head = (uint16_t)((wire->head + 1) % GROBO_SIM_WIRE_BYTES);
    wire->used--;
    return byte;
}

size_t grobo_i_sim_wire_read(grobo_sim_wire *wire, uint8_t *buf, size_t cap, int64_t now_ns)
{
    size_t n = 0;
    for (size_t at = wire->head; n < cap && n < wire->used && wire->at_ns[at] <= now_ns; n++) {
        buf[n] = wire->byte[at];
        at = at + 1 < GROBO_SIM_WIRE_BYTES ? at + 1 : 0;
    }
    grobo_i_sim_wire_drop(wire, n);
    return n;
}

int64_t grobo_i_sim_wire_next(const grobo_sim_wire *wire)
{
    return wire->used > 0 ? wire->at_ns[wire->head] : GROBO_NEVER_US;
}

static bool at_rate(const grobo_sim *sim)
{
    return sim->config.wiring == GROBO_WIRING_BUS || sim->line_bps == sim->config.baud_bps;
}

/* A byte as it arrives at another rate than it was sent. */
static void misread(grobo_sim *sim, uint8_t *byte)
{
    if (!at_rate(sim)) {
        *byte = (uint8_t)grobo_i_sim_random(sim, GROBO_I_SIM_CHANCE, 256);
    }
}

/* When the host's adapter hands over a byte that has arrived there at at_ns. */
static int64_t handed_over_ns(grobo_sim *sim, int64_t at_ns)
{
    if (at_ns > sim->hand_over_ns) {
        sim->hand_over_ns = at_ns + (int64_t)sim->config.latency_us * 1000;
    }
    return sim->hand_over_ns;
}

/* True where no byte between the host and the robot suffers. */
static bool is_sound(const grobo_sim *sim)
{
    return at_rate(sim) && sim->fault_below[GROBO_SIM_FAULT_DROP] == 0 &&
           sim->fault_below[GROBO_SIM_FAULT_FLIP] == 0;
}

void grobo_i_sim_to_host(grobo_sim *sim, const uint8_t *bytes, size_t n, int64_t at_ns)
{
    const bool sound = is_sound(sim);
    for (size_t i = 0; i < n && !sim->gone; i++, at_ns += sim->line_byte_ns) {
        uint8_t byte = bytes[i];
        if (!sound) {
            misread(sim, &byte);
        }
        if ((sound || grobo_i_sim_crosses(sim, &byte)) &&
            !put(&sim->out, byte, handed_over_ns(sim, at_ns))) {
            sim->stats.overflows++;
        }
        sim->out.free_ns = at_ns; /* the adapter waits, the line does not */
    }
}

const uint8_t *grobo_i_sim_sound(const grobo_sim *sim)
{
    const grobo_sim_wire *in = &sim->in;
    return is_sound(sim) && in->head + in->used <= GROBO_SIM_WIRE_BYTES ? &in->byte[in->head]
                                                                        : NULL;
}

void grobo_i_sim_wire_drop(grobo_sim_wire *wire, size_t n)
{
    GROBO_ASSERT(n <= wire->used);
    wire->head = (uint16_t)((wire->head + n) % GROBO_SIM_WIRE_BYTES);
    wire->used = (uint16_t)(wire->used - n);
}

bool grobo_i_sim_from_host(grobo_sim *sim, uint8_t *byte)
{
    *byte = take(&sim->in);
    sim->stats.rx_bytes++;
    misread(sim, byte);
    return grobo_i_sim_crosses(sim, byte);
}

void grobo_i_sim_cut(grobo_sim *sim)
{
    sim->gone = true;
    sim->in.used = sim->out.used = 0;
    sim->in.free_ns = sim->out.free_ns = sim->hand_over_ns = sim->now_ns;
    sim->fifo_used = 0;
    grobo_board_parser_reset(&sim->board);
}
