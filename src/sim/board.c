/* SPDX-License-Identifier: MIT */
/* The controller board: takes a frame, relays its payload, waits, returns what came. */
#include <string.h>

#include "src/base/assert.h"
#include "src/sim/board.h"
#include "src/sim/bus.h"
#include "src/sim/servo/fault.h"
#include "src/sim/servo/note.h"
#include "src/sim/wire.h"

/* ---- replying ------------------------------------------------------------------------------ */

static void emit(grobo_sim *sim, const uint8_t *bytes, size_t n, int64_t start_ns)
{
    int64_t at_ns = start_ns > sim->out.free_ns ? start_ns : sim->out.free_ns;
    grobo_i_sim_to_host(sim, bytes, n, at_ns + sim->line_byte_ns);
}

static void reply(grobo_sim *sim, const uint8_t *bytes, size_t n, int64_t t_ns)
{
    const grobo_sim_event event = {
        .kind = GROBO_SIM_REPLY, .time_us = sim->now_us, .servo = -1, .bytes = bytes, .n_bytes = n};
    if (n > 0) {
        grobo_i_sim_reply(sim, &event, t_ns, emit);
    }
    sim->board_state = GROBO_SIM_BOARD_REPLYING;
    sim->board_at_ns = sim->out.free_ns > t_ns ? sim->out.free_ns : t_ns;
}

/* ---- frames -------------------------------------------------------------------------------- */

/* The next byte, or all of them where they are a packet that nobody disturbs. */
static void send_on(grobo_sim *sim, int64_t t_ns)
{
    bool whole =
        sim->sent == 0 && grobo_i_sim_bus_packet(sim, sim->send, sim->send_used) == sim->send_used;
    sim->sending = whole ? sim->send_used : 1;
    sim->board_at_ns = t_ns + sim->sending * sim->bus_byte_ns;
}

/* What was being sent is over. */
static void sent(grobo_sim *sim, int64_t t_ns)
{
    GROBO_ASSERT(sim->sent + sim->sending <= sim->send_used);
    if (sim->sending > 1) {
        grobo_i_sim_bus_hear_packet(sim, sim->send, sim->sending, t_ns);
    } else {
        grobo_i_sim_bus_hear(sim, sim->send[sim->sent], t_ns);
    }
    sim->sent = (uint8_t)(sim->sent + sim->sending);
    if (sim->sent < sim->send_used) {
        send_on(sim, t_ns);
    } else if (sim->want > 0) {
        sim->board_state = GROBO_SIM_BOARD_WAITING;
        sim->board_at_ns = t_ns + (int64_t)sim->config.board_silence_us * 1000;
    } else {
        sim->board_state = GROBO_SIM_BOARD_IDLE;
    }
}

static void relay(grobo_sim *sim, const grobo_board_frame *frame, int64_t t_ns)
{
    GROBO_ASSERT(frame->packet_bytes > 0 && frame->packet_bytes <= sizeof sim->send);
    memcpy(sim->send, frame->packet, frame->packet_bytes);
    sim->send_used = (uint8_t)frame->packet_bytes;
    sim->sent = 0;
    sim->want = frame->kind == GROBO_BOARD_ASK ? frame->reply_bytes : 0;
    sim->got_used = 0;
    sim->board_state = GROBO_SIM_BOARD_SENDING;
    send_on(sim, t_ns);
}

static void take_frame(grobo_sim *sim, const grobo_board_frame *frame, int64_t t_ns)
{
    static const uint8_t here = GROBO_RS30X_ACK;
    sim->stats.frames++;
    grobo_i_sim_tell(sim, &(grobo_sim_event){.kind = GROBO_SIM_FRAME,
                                             .time_us = sim->now_us,
                                             .servo = -1,
                                             .value = (int32_t)frame->kind,
                                             .bytes = frame->packet,
                                             .n_bytes = frame->packet_bytes});
    switch (frame->kind) {
    case GROBO_BOARD_CHECK:
        reply(sim, &here, 1, t_ns);
        break;
    case GROBO_BOARD_SEND:
    case GROBO_BOARD_ASK:
        relay(sim, frame, t_ns);
        break;
    case GROBO_BOARD_SLOT:
        sim->stats.slots++;
        sim->stats.last_slot = frame->number;
        grobo_i_sim_note(sim, GROBO_SIM_SLOT, -1, frame->number);
        break;
    case GROBO_BOARD_SCENARIO:
        sim->stats.scenarios++;
        sim->stats.last_scenario = frame->number;
        grobo_i_sim_note(sim, GROBO_SIM_SCENARIO, -1, frame->number);
        break;
    }
    grobo_i_sim_frame_faults(sim);
}

/* Takes frames, and bytes that have waited, until it has something to do. */
static void listen(grobo_sim *sim, int64_t t_ns)
{
    grobo_board_frame frame;
    while (sim->board_state == GROBO_SIM_BOARD_IDLE) {
        if (grobo_board_parser_next(&sim->board, sim->now_us, &frame) > 0) {
            take_frame(sim, &frame, t_ns);
        } else if (sim->fifo_used > 0) {
            (void)grobo_board_parser_feed(&sim->board, &sim->fifo[sim->fifo_head], 1, sim->now_us);
            sim->fifo_head = (uint16_t)((sim->fifo_head + 1) % GROBO_SIM_FIFO_BYTES);
            GROBO_ASSERT(sim->fifo_used <= GROBO_SIM_FIFO_BYTES);
            sim->fifo_used--;
        } else {
            return;
        }
    }
}

/* ---- bytes --------------------------------------------------------------------------------- */

void grobo_i_sim_board_hear(grobo_sim *sim, uint8_t byte, int64_t t_ns)
{
    if (sim->fifo_used == GROBO_SIM_FIFO_BYTES) {
        sim->stats.overflows++;
        return;
    }
    sim->fifo[(sim->fifo_head + sim->fifo_used++) % GROBO_SIM_FIFO_BYTES] = byte;
    listen(sim, t_ns);
}

bool grobo_i_sim_board_listens(const grobo_sim *sim)
{
    const grobo_framer *heard = &sim->board.framer;
    return sim->board_state == GROBO_SIM_BOARD_IDLE && heard->used == heard->taken;
}

void grobo_i_sim_board_hear_frame(grobo_sim *sim, const uint8_t *bytes, size_t n, int64_t t_ns)
{
    GROBO_ASSERT(grobo_i_sim_board_listens(sim));
    (void)grobo_board_parser_feed(&sim->board, bytes, n, sim->now_us);
    listen(sim, t_ns);
}

void grobo_i_sim_board_got(grobo_sim *sim, const uint8_t *bytes, size_t n, int64_t t_ns)
{
    if (sim->board_state != GROBO_SIM_BOARD_WAITING) {
        sim->stats.stray_bytes += (uint32_t)n;
        return;
    }
    GROBO_ASSERT(sim->got_used + n <= sim->want);
    memcpy(&sim->got[sim->got_used], bytes, n);
    sim->got_used = (uint8_t)(sim->got_used + n);
    sim->board_at_ns = t_ns + (int64_t)sim->config.board_silence_us * 1000;
    if (sim->got_used == sim->want) {
        reply(sim, sim->got, sim->got_used, t_ns);
    }
}

/* ---- time ---------------------------------------------------------------------------------- */

int64_t grobo_i_sim_board_next(const grobo_sim *sim)
{
    if (sim->board_state != GROBO_SIM_BOARD_IDLE) {
        return sim->board_at_ns;
    }
    int64_t stall_us = grobo_board_parser_deadline(&sim->board);
    return stall_us == GROBO_NEVER_US ? GROBO_NEVER_US : stall_us * 1000;
}

void grobo_i_sim_board_act(grobo_sim *sim, int64_t t_ns)
{
    switch (sim->board_state) {
    case GROBO_SIM_BOARD_IDLE:
        break;
    case GROBO_SIM_BOARD_SENDING:
        sent(sim, t_ns);
        break;
    case GROBO_SIM_BOARD_WAITING:
        sim->stats.short_replies++;
        reply(sim, sim->got, sim->got_used, t_ns);
        break;
    case GROBO_SIM_BOARD_REPLYING:
        sim->board_state = GROBO_SIM_BOARD_IDLE;
        break;
    }
    listen(sim, t_ns);
}
