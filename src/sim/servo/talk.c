/* SPDX-License-Identifier: MIT */
/*
 * The servos' half-duplex line. One master (the board, or the host on bus wiring) and any number
 * of servos; where two talk at once both bytes become their AND, as on a line that idles high.
 */
#include <string.h>

#include "src/base/assert.h"
#include "src/sim/servo/note.h"
#include "src/sim/servo/talk.h"

/* ---- two at once --------------------------------------------------------------------------- */

/* Bytes of a talk that lie in [from_ns, to_ns): ANDs them with byte and byte with them. */
static bool clash(grobo_sim *sim, grobo_sim_talk *talk, int64_t from_ns, uint8_t *byte)
{
    const int64_t byte_ns = sim->bus_byte_ns;
    int64_t to_ns = from_ns + byte_ns;
    int64_t first = (from_ns - talk->start_ns) / byte_ns;
    uint8_t *said = sim->talk_byte + talk->at;
    bool clashed = false;
    for (int64_t k = first < 0 ? 0 : first; k < talk->used; k++) {
        int64_t start_ns = talk->start_ns + k * byte_ns;
        if (start_ns >= to_ns) {
            break;
        }
        if (start_ns + byte_ns > from_ns) {
            *byte &= said[k];
            said[k] = *byte;
            clashed = true;
        }
    }
    return clashed;
}

/* The byte that the master began before to_ns and that is not over yet. */
static bool clash_with_master(const grobo_sim *sim, int64_t to_ns, uint8_t *byte)
{
    if (sim->config.wiring == GROBO_WIRING_BUS) {
        const grobo_sim_wire *in = &sim->in;
        if (in->used == 0 || in->at_ns[in->head] - sim->bus_byte_ns >= to_ns) {
            return false;
        }
        *byte &= in->byte[in->head];
        return true;
    }
    if (sim->board_state != GROBO_SIM_BOARD_SENDING ||
        sim->board_at_ns - sim->bus_byte_ns >= to_ns) {
        return false;
    }
    *byte &= sim->send[sim->sent];
    return true;
}

static void collided(grobo_sim *sim, bool with_master)
{
    sim->stats.collisions++;
    grobo_i_sim_note(sim, GROBO_SIM_COLLISION, -1, with_master);
}

bool grobo_i_sim_talk_into(grobo_sim *sim, uint8_t *byte, int64_t t_ns)
{
    bool clashed = false;
    for (size_t i = 0; i < sim->n_talks; i++) {
        clashed |= clash(sim, &sim->talk[i], t_ns - sim->bus_byte_ns, byte);
    }
    if (clashed) {
        collided(sim, true);
    }
    return !clashed || !sim->parity;
}

/* ---- what servos say ------------------------------------------------------------------------- */

/* Makes a talk longer by so many bytes, which are not filled in; by -talk->used: it has none. */
static void widen(grobo_sim *sim, int index, int by)
{
    grobo_sim_talk *talk = &sim->talk[index];
    size_t behind = (size_t)talk->at + talk->used, left = sim->talk_bytes - behind;
    memmove(sim->talk_byte + behind + by, sim->talk_byte + behind, left);
    talk->used = (uint16_t)(talk->used + by);
    sim->talk_bytes = (uint16_t)(sim->talk_bytes + by);
    for (int i = index + 1; i < sim->n_talks; i++) {
        sim->talk[i].at = (uint16_t)(sim->talk[i].at + by);
    }
}

/* How many of n bytes there is room for; the others are lost. */
static size_t fit(grobo_sim *sim, size_t n)
{
    size_t room = sizeof sim->talk_byte - sim->talk_bytes;
    sim->stats.overflows += n > room ? (uint32_t)(n - room) : 0;
    return n < room ? n : room;
}

/* Two with one id begin together: what both say at the same time is the AND. */
static void join(grobo_sim *sim, int index, const uint8_t *bytes, size_t n)
{
    grobo_sim_talk *talk = &sim->talk[index];
    uint8_t *said = sim->talk_byte + talk->at;
    size_t used = talk->used;
    for (size_t i = 0; i < n && i < used; i++) {
        said[i] &= bytes[i];
    }
    if (n > used) {
        size_t more = fit(sim, n - used);
        widen(sim, index, (int)more);
        memcpy(said + used, bytes + used, more);
    }
    collided(sim, false);
}

void grobo_i_sim_talk(grobo_sim *sim, const uint8_t *bytes, size_t n, int64_t start_ns)
{
    GROBO_ASSERT(n > 0 && n <= GROBO_SIM_TALK_BYTES);
    for (int i = 0; i < sim->n_talks; i++) {
        if (sim->talk[i].start_ns == start_ns) {
            join(sim, i, bytes, n);
            return;
        }
    }
    if (sim->n_talks == GROBO_SIM_TALKS_MAX || sim->talk_bytes == sizeof sim->talk_byte) {
        sim->stats.overflows += (uint32_t)n;
        return;
    }
    n = fit(sim, n);
    sim->talk[sim->n_talks] = (grobo_sim_talk){.start_ns = start_ns, .at = sim->talk_bytes};
    memcpy(sim->talk_byte + sim->talk_bytes, bytes, n);
    widen(sim, sim->n_talks++, (int)n);
}

static int64_t byte_end_ns(const grobo_sim *sim, const grobo_sim_talk *talk)
{
    return talk->start_ns + (talk->said + 1) * sim->bus_byte_ns;
}

static int next_talk(const grobo_sim *sim)
{
    int first = sim->n_talks > 0 ? 0 : -1;
    for (int i = 1; i < sim->n_talks; i++) {
        if (byte_end_ns(sim, &sim->talk[i]) < byte_end_ns(sim, &sim->talk[first])) {
            first = i;
        }
    }
    return first;
}

int64_t grobo_i_sim_talk_next(const grobo_sim *sim)
{
    int i = next_talk(sim);
    return i < 0 ? GROBO_NEVER_US : byte_end_ns(sim, &sim->talk[i]);
}

int64_t grobo_i_sim_talks_end(const grobo_sim *sim)
{
    int64_t end_ns = GROBO_NEVER_US;
    for (int i = 0; i < sim->n_talks; i++) {
        const grobo_sim_talk *talk = &sim->talk[i];
        int64_t its_ns = talk->start_ns + talk->used * sim->bus_byte_ns;
        end_ns = its_ns < end_ns ? its_ns : end_ns;
    }
    return end_ns;
}

static void end_where_over(grobo_sim *sim, int index)
{
    grobo_sim_talk *talk = &sim->talk[index];
    if (talk->said == talk->used) {
        widen(sim, index, -talk->used);
        sim->n_talks--;
        memmove(talk, talk + 1, (size_t)(sim->n_talks - index) * sizeof *talk);
    }
}

bool grobo_i_sim_talk_take(grobo_sim *sim, int64_t t_ns, uint8_t *taken)
{
    int first = next_talk(sim);
    GROBO_ASSERT(first >= 0 && sim->talk[first].said < sim->talk[first].used);
    grobo_sim_talk *talk = &sim->talk[first];
    uint8_t byte = sim->talk_byte[talk->at + talk->said++];
    bool with_master = clash_with_master(sim, t_ns, &byte), clashed = with_master;
    for (int i = 0; i < sim->n_talks; i++) {
        if (i != first) {
            clashed |= clash(sim, &sim->talk[i], t_ns - sim->bus_byte_ns, &byte);
        }
    }
    if (clashed) {
        collided(sim, with_master);
    }
    end_where_over(sim, first);
    *taken = byte;
    return !clashed || !sim->parity;
}

void grobo_i_sim_talk_take_run(grobo_sim *sim, size_t n, uint8_t *taken)
{
    grobo_sim_talk *talk = &sim->talk[0];
    GROBO_ASSERT(sim->n_talks == 1 && talk->said + n <= talk->used);
    memcpy(taken, &sim->talk_byte[talk->at + talk->said], n);
    talk->said = (uint16_t)(talk->said + n);
    end_where_over(sim, 0);
}
