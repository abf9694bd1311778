/* SPDX-License-Identifier: MIT */
/* Chance: one generator a fault, so that turning one on does not change when another strikes. */
#include <string.h>

#include <grobo/core/sim.h>

#include "src/sim/servo/fault.h"
#include "src/sim/servo/note.h"

static const char *const names[GROBO_SIM_FAULTS] = {
#define NAME(name, text, hits, does) text,
    GROBO_SIM_FAULT_LIST(NAME)
#undef NAME
};

const char *grobo_sim_fault_name(int fault)
{
    return fault >= 0 && fault < (int)GROBO_SIM_FAULTS ? names[fault] : NULL;
}

int grobo_sim_fault_find(const char *name, size_t length)
{
    if (name == NULL && length > 0) {
        return GROBO_ERR_ARG;
    }
    for (int i = 0; i < (int)GROBO_SIM_FAULTS; i++) {
        if (strlen(names[i]) == length && memcmp(names[i], name, length) == 0) {
            return i;
        }
    }
    return GROBO_ERR_NOTFOUND;
}

/* A hash that leaves no two neighbouring seeds alike (finalizer of MurmurHash3, public domain). */
static uint32_t mix(uint32_t x)
{
    x ^= x >> 16;
    x *= 0x85EBCA6Bu;
    x ^= x >> 13;
    x *= 0xC2B2AE35u;
    return x ^ x >> 16;
}

void grobo_i_sim_seed(grobo_sim *sim)
{
    for (uint32_t i = 0; i <= GROBO_SIM_FAULTS; i++) {
        uint32_t x = mix(sim->config.seed + mix(i + 1));
        sim->random[i] = x == 0 ? 1 : x;
    }
}

/* Marsaglia's xorshift32: every value but 0. */
static uint32_t next(uint32_t *state)
{
    uint32_t x = *state;
    x ^= x << 13;
    x ^= x >> 17;
    x ^= x << 5;
    return *state = x;
}

uint32_t grobo_i_sim_random(grobo_sim *sim, int generator, uint32_t below)
{
    return (uint32_t)(((uint64_t)next(&sim->random[generator]) * below) >> 32);
}

bool grobo_i_sim_strikes(grobo_sim *sim, grobo_sim_fault fault, int servo)
{
    if (sim->fault_below[fault] == 0 || next(&sim->random[fault]) > sim->fault_below[fault]) {
        return false;
    }
    sim->stats.injected[fault]++;
    grobo_i_sim_note(sim, GROBO_SIM_INJECTED, servo, (int32_t)fault);
    return true;
}

bool grobo_i_sim_crosses(grobo_sim *sim, uint8_t *byte)
{
    if (grobo_i_sim_strikes(sim, GROBO_SIM_FAULT_DROP, -1)) {
        return false;
    }
    if (grobo_i_sim_strikes(sim, GROBO_SIM_FAULT_FLIP, -1)) {
        if (sim->parity) {
            return false; /* whoever receives it drops it */
        }
        *byte = (uint8_t)(*byte ^ 1u << grobo_i_sim_random(sim, GROBO_SIM_FAULT_FLIP, 8));
    }
    return true;
}

/* ---- replies ------------------------------------------------------------------------------- */

static int64_t pause_ns(grobo_sim *sim, grobo_sim_fault fault, uint32_t max_us)
{
    return (int64_t)(1 + grobo_i_sim_random(sim, (int)fault, max_us)) * 1000;
}

static int64_t rubbish(grobo_sim *sim, int64_t start_ns, grobo_i_sim_emit emit)
{
    uint8_t bytes[8];
    size_t n = 1 + grobo_i_sim_random(sim, GROBO_SIM_FAULT_RUBBISH, sizeof bytes);
    for (size_t i = 0; i < n; i++) {
        bytes[i] = (uint8_t)grobo_i_sim_random(sim, GROBO_SIM_FAULT_RUBBISH, 256);
    }
    emit(sim, bytes, n, start_ns);
    return start_ns + (int64_t)n * sim->bus_byte_ns;
}

static int64_t whole(grobo_sim *sim, const grobo_sim_event *reply, int64_t start_ns,
                     grobo_i_sim_emit emit)
{
    size_t first = reply->n_bytes;
    if (first > 1 && grobo_i_sim_strikes(sim, GROBO_SIM_FAULT_SPLIT, reply->servo)) {
        first = 1 + grobo_i_sim_random(sim, GROBO_SIM_FAULT_SPLIT, (uint32_t)first - 1);
    }
    emit(sim, reply->bytes, first, start_ns);
    start_ns += (int64_t)first * sim->bus_byte_ns;
    if (first < reply->n_bytes) {
        start_ns += pause_ns(sim, GROBO_SIM_FAULT_SPLIT, GROBO_SIM_SPLIT_MAX_US);
        emit(sim, reply->bytes + first, reply->n_bytes - first, start_ns);
        start_ns += (int64_t)(reply->n_bytes - first) * sim->bus_byte_ns;
    }
    return start_ns;
}

void grobo_i_sim_reply(grobo_sim *sim, const grobo_sim_event *reply, int64_t start_ns,
                       grobo_i_sim_emit emit)
{
    sim->stats.replies++;
    grobo_i_sim_tell(sim, reply);
    if (grobo_i_sim_strikes(sim, GROBO_SIM_FAULT_DELAY, reply->servo)) {
        start_ns += pause_ns(sim, GROBO_SIM_FAULT_DELAY, GROBO_SIM_DELAY_MAX_US);
    }
    if (grobo_i_sim_strikes(sim, GROBO_SIM_FAULT_RUBBISH, reply->servo)) {
        start_ns = rubbish(sim, start_ns, emit);
    }
    start_ns = whole(sim, reply, start_ns, emit);
    if (grobo_i_sim_strikes(sim, GROBO_SIM_FAULT_DUPLICATE, reply->servo)) {
        whole(sim, reply, start_ns, emit);
    }
}

/* ---- rates --------------------------------------------------------------------------------- */

int grobo_sim_set_fault(grobo_sim *sim, int fault, double rate)
{
    if (sim == NULL || fault < 0 || fault >= (int)GROBO_SIM_FAULTS || !(rate >= 0 && rate <= 1)) {
        return GROBO_ERR_ARG;
    }
    sim->fault_below[fault] = (uint32_t)(rate * UINT32_MAX);
    return 0;
}

/* A decimal like "0.01" or "1%"; negative if the text is none. */
static double parse_rate(const char *text, size_t n)
{
    double value = 0, place = 1;
    size_t digits = 0;
    bool fraction = false, percent = n > 0 && text[n - 1] == '%';
    for (size_t i = 0; i < n - (percent ? 1 : 0); i++) {
        if (text[i] == '.' && !fraction) {
            fraction = true;
        } else if (text[i] >= '0' && text[i] <= '9') {
            value = value * 10 + (text[i] - '0');
            place *= fraction ? 10 : 1;
            digits++;
        } else {
            return -1;
        }
    }
    return digits == 0 ? -1 : value / place / (percent ? 100 : 1);
}

/* Takes "name=rate" into rates (negative: not given). */
static int parse_one(const char *text, size_t n, double *rates)
{
    const char *equals = memchr(text, '=', n);
    size_t name_n = equals == NULL ? n : (size_t)(equals - text);
    bool all = name_n == 3 && memcmp(text, "all", 3) == 0;
    int fault = all ? 0 : grobo_sim_fault_find(text, name_n);
    if (fault < 0) {
        return fault;
    }
    double rate = equals == NULL ? -1 : parse_rate(equals + 1, n - name_n - 1);
    if (!(rate >= 0 && rate <= 1)) {
        return GROBO_ERR_ARG;
    }
    for (int i = 0; i < (int)GROBO_SIM_FAULTS; i++) {
        if (all ? i != GROBO_SIM_FAULT_HANG_UP : i == fault) {
            rates[i] = rate;
        }
    }
    return 0;
}

int grobo_sim_set_faults(grobo_sim *sim, const char *list, size_t length)
{
    if (sim == NULL || (list == NULL && length > 0)) {
        return GROBO_ERR_ARG;
    }
    double rates[GROBO_SIM_FAULTS];
    for (int i = 0; i < (int)GROBO_SIM_FAULTS; i++) {
        rates[i] = -1;
    }
    while (length > 0) {
        const char *comma = memchr(list, ',', length);
        size_t n = comma == NULL ? length : (size_t)(comma - list);
        int result = parse_one(list, n, rates);
        if (result < 0) {
            return result;
        }
        n += comma == NULL ? 0 : 1;
        list += n;
        length -= n;
    }
    int set = 0;
    for (int i = 0; i < (int)GROBO_SIM_FAULTS; i++) {
        set += rates[i] >= 0 && grobo_sim_set_fault(sim, i, rates[i]) == 0;
    }
    return set;
}
