/* SPDX-License-Identifier: MIT */
#include <stdint.h>
#include <string.h>

#include <grobo/core/sim_static.h>

#include "tests/support/test.h"
#include "tests/support/witness.h"

/* A reply later than this is nobody's any more. */
#define LATE_US 1000000
/* A line that says a reply twice does so within this: the second may be taken for the answer to the
 * same question asked again, and then the answer to that for the answer to the next. Each is the
 * same joint's, and as old as a reading may be. */
#define DOUBLED_US 20000
/* A board that waits for the rest of a broken frame keeps what comes behind it, and forwards that
 * when it has given up (GROBO_BOARD_STALL_US): later than anybody waits who has never seen a reply
 * as late. What is forwarded in time takes less than this. */
#define KEPT_US 40000
/* Longest return packet that the engine asks for. */
enum { REPLY_MAX = 40 };

void witness_init(witness *w, const grobo_model *model, const grobo_sim *sim, const grobo_bus *bus)
{
    memset(w, 0, sizeof *w);
    w->model = model;
    w->sim = sim;
    w->bus = bus;
}

static witness_packet *keep(witness_packet *ring, unsigned capacity, unsigned *count,
                            const uint8_t *bytes, size_t n)
{
    witness_packet *packet = &ring[(*count)++ % capacity];
    assert_true(n <= sizeof packet->bytes);
    memset(packet, 0, sizeof *packet);
    packet->n = (uint8_t)n;
    memcpy(packet->bytes, bytes, n);
    return packet;
}

static bool same(const witness_packet *packet, const uint8_t *bytes, size_t n)
{
    return packet->n == n && memcmp(packet->bytes, bytes, n) == 0;
}

/* ---- commands -------------------------------------------------------------------------------- */

/* Calls with every servo that a command packet writes to, or reads. */
static void each_servo(witness *w, const uint8_t *p, void (*take)(witness *w, int joint))
{
    int n = p[2] == 0 ? p[6] : 1;
    for (int i = 0; i < n; i++) {
        int id = p[2] == 0 ? p[7 + i * p[5]] : p[2];
        int joint = grobo_model_joint_of_motor(w->model, id);
        if (joint >= 0) {
            take(w, joint);
        }
    }
}

static void mislead(witness *w, int joint)
{
    w->misled |= GROBO_JOINT_BIT(joint);
}

static bool reads(const uint8_t *packet)
{
    return packet[2] != 0 && packet[6] == 0;
}

/* So long an exchange takes at most: frame and reply twice over the line, 35 bytes. */
#define EXCHANGE_US 6500

/* For how long the last packet that asks the same has been over. */
static int64_t silence(const witness *w, const uint8_t *packet, size_t n, int64_t now_us)
{
    int64_t sent_us = INT64_MIN / 2;
    for (unsigned i = 0; i < WITNESS_SENT; i++) {
        if (same(&w->sent[i], packet, n) && w->sent[i].at_us < now_us &&
            w->sent[i].at_us > sent_us) {
            sent_us = w->sent[i].at_us;
        }
    }
    return now_us - sent_us - EXCHANGE_US;
}

/* A transaction on the wire for the first time is a new question, wherever it is kept. */
static void ask(witness *w, const uint8_t *packet, size_t n, const grobo_txn *txn, int64_t now_us)
{
    int i = 0;
    while (i < WITNESS_QUESTIONS && w->questions[i].txn != NULL && w->questions[i].txn != txn) {
        i++;
    }
    assert_true(i < WITNESS_QUESTIONS);
    if (txn->attempts_ == 1) {
        w->questions[i] = (witness_question){.txn = txn,
                                             .since_us = now_us,
                                             .silence_us = silence(w, packet, n, now_us),
                                             .span_us = 2 * w->bus->worst_us,
                                             .motor = packet[2],
                                             .address = packet[4],
                                             .length = packet[5]};
    }
    assert_true(w->questions[i].txn == txn);
}

/* The question that a return packet answers: of those that ask for the same the latest. Between its
 * attempts other questions to the same motor may leave. */
static witness_question question_of(const witness *w, const uint8_t *packet)
{
    witness_question found = {0};
    for (int i = 0; i < WITNESS_QUESTIONS && w->questions[i].txn != NULL; i++) {
        const witness_question *q = &w->questions[i];
        if (q->motor == packet[2] && q->address == packet[4] && q->length == packet[5] &&
            q->since_us >= found.since_us) {
            found = *q;
        }
    }
    return found;
}

void witness_sent(witness *w, const uint8_t *packet, size_t n, const grobo_txn *txn, int64_t now_us)
{
    keep(w->sent, WITNESS_SENT, &w->n_sent, packet, n)->at_us = now_us;
    if (reads(packet)) {
        ask(w, packet, n, txn, now_us);
    }
}

/* True if another packet left behind this one before servos heard this: a board that waits for the
 * rest of a broken frame takes it from the next, which is lost. */
static bool is_completed(const witness *w, int64_t sent_us, int64_t heard_us)
{
    bool found = false;
    for (unsigned i = 0; i < WITNESS_SENT; i++) {
        found = found ||
                (w->sent[i].n > 0 && w->sent[i].at_us > sent_us && w->sent[i].at_us < heard_us);
    }
    return w->sim->config.wiring == GROBO_WIRING_BOARD && found;
}

static void hear_packet(witness *w, const grobo_sim_event *event)
{
    int64_t sent_us = -1;
    for (unsigned i = 0; i < WITNESS_SENT; i++) {
        if (same(&w->sent[i], event->bytes, event->n_bytes) && w->sent[i].at_us <= event->time_us) {
            sent_us = w->sent[i].at_us > sent_us ? w->sent[i].at_us : sent_us;
        }
    }
    w->heard_us = event->time_us;
    w->heard_late = event->time_us - sent_us > KEPT_US || is_completed(w, sent_us, event->time_us);
    if (sent_us >= 0) {
        return;
    }
    w->made_up_commands++;
    each_servo(w, event->bytes, mislead);
    bool writes = event->bytes[2] == 0 || event->bytes[6] != 0;
    bool acts = event->bytes[3] >= GROBO_RS30X_FACTORY; /* or flash, or reboot */
    if (acts || (writes && event->bytes[4] < GROBO_RS30X_GOAL)) {
        w->settings_hit = true;
    }
}

/* ---- replies --------------------------------------------------------------------------------- */

/* Two that talk at once make up a reply that neither gave: a servo's own is in its registers, but
 * for one that was told to restart in the same breath. */
static bool is_given(const witness *w, const uint8_t *p, size_t n)
{
    int joint = n >= 8 ? grobo_model_joint_of_motor(w->model, p[2]) : -1;
    return joint >= 0 && p[5] == n - 8 && p[4] + p[5] <= GROBO_REGISTERS &&
           (w->reboot_us[joint] >= w->heard_us ||
            memcmp(p + 7, &w->sim->servo[joint].reg[p[4]], p[5]) == 0);
}

static void hear_reply(witness *w, const grobo_sim_event *event)
{
    witness_packet *said = keep(w->said, WITNESS_SAID, &w->n_said, event->bytes, event->n_bytes);
    said->kept = w->heard_late;
    said->at_us = w->heard_us; /* what it says was true then */
    said->sound = is_given(w, event->bytes, event->n_bytes);
    said->said_number = w->n_said - 1;
}

void witness_heard(witness *w, const grobo_sim_event *event)
{
    if (event->kind == GROBO_SIM_PACKET) {
        hear_packet(w, event);
    } else if (event->kind == GROBO_SIM_REPLY) {
        hear_reply(w, event);
    } else if (event->kind == GROBO_SIM_REBOOT && event->servo >= 0) {
        w->reboot_us[event->servo] = event->time_us;
    } else if (event->kind == GROBO_SIM_INJECTED && event->value == GROBO_SIM_FAULT_DUPLICATE) {
        int joint =
            grobo_model_joint_of_motor(w->model, w->said[(w->n_said - 1) % WITNESS_SAID].bytes[2]);
        if (joint >= 0) {
            w->twice_us[joint] = event->time_us;
        }
    }
}

static uint8_t tail_at(const witness *w, unsigned i)
{
    return w->tail[i % WITNESS_BYTES];
}

/* True if the last n bytes are a whole return packet. */
static bool ends_packet(const witness *w, unsigned n)
{
    unsigned from = w->n_tail - n;
    uint8_t sum = 0;
    if (tail_at(w, from) != 0xFD || tail_at(w, from + 1) != 0xDF || tail_at(w, from + 5) != n - 8) {
        return false;
    }
    for (unsigned i = 2; i < n; i++) {
        sum ^= tail_at(w, from + i);
    }
    return sum == 0;
}

/* The reply that these bytes are. A servo at rest says the same again and again: of several alike
 * the latest that was not believed yet, as those before it were lost. */
static const witness_packet *find_said(const witness *w, const uint8_t *bytes, size_t n,
                                       int64_t now_us)
{
    const witness_packet *found = NULL;
    for (unsigned i = 0; i < WITNESS_SAID && i < w->n_said; i++) {
        const witness_packet *said = &w->said[i];
        if (said->sound && same(said, bytes, n) && now_us - said->at_us <= LATE_US &&
            (found == NULL || (found->believed && !said->believed) ||
             (found->believed == said->believed && said->at_us > found->at_us))) {
            found = said;
        }
    }
    return found;
}

static void see_packet(witness *w, unsigned n, int64_t now_us)
{
    uint8_t bytes[REPLY_MAX];
    for (unsigned i = 0; i < n; i++) {
        bytes[i] = tail_at(w, w->n_tail - n + i);
    }
    const witness_packet *said = find_said(w, bytes, n, now_us);
    witness_packet *seen = keep(w->seen, WITNESS_SEEN, &w->n_seen, bytes, n);
    seen->at_us = now_us;
    seen->sound = said != NULL;
    seen->said_number = said != NULL ? said->said_number : 0;
    w->made_up_replies += said == NULL;
}

void witness_arrived(witness *w, const uint8_t *bytes, size_t n, int64_t now_us)
{
    for (size_t i = 0; i < n; i++) {
        w->tail[w->n_tail++ % WITNESS_BYTES] = bytes[i];
        for (unsigned size = 8; size <= REPLY_MAX && size <= w->n_tail; size++) {
            if (ends_packet(w, size)) {
                see_packet(w, size, now_us);
            }
        }
    }
}

/* ---- belief ---------------------------------------------------------------------------------- */

/* The register at an address as a return packet has it, and whether it does. */
static bool has(const witness_packet *p, int address, int bytes, int *value)
{
    int at = address - p->bytes[4];
    if (at < 0 || at + bytes > p->bytes[5]) {
        return false;
    }
    const uint8_t *data = &p->bytes[7 + at];
    *value = bytes == 1 ? data[0] : (int16_t)(data[0] | data[1] << 8);
    return true;
}

static bool agrees(const witness_packet *p, const grobo_joint_state *state)
{
    int value;
    return (!has(p, GROBO_RS30X_POSITION, 2, &value) ||
            value == grobo_ddeg_from_rad(state->angle_rad)) &&
           (!has(p, GROBO_RS30X_GOAL, 2, &value) ||
            value == grobo_ddeg_from_rad(state->goal_rad)) &&
           (!has(p, GROBO_RS30X_TORQUE, 1, &value) || value == (int)state->torque) &&
           (!has(p, GROBO_RS30X_SPEED, 2, &value) || value == state->speed_dps) &&
           (!has(p, GROBO_RS30X_CURRENT, 2, &value) || value == state->current_ma) &&
           (!has(p, GROBO_RS30X_TEMPERATURE, 2, &value) || value == state->temperature_c) &&
           (!has(p, GROBO_RS30X_VOLTAGE, 2, &value) || value * 10 == state->voltage_mv);
}

/* The packet that says this of the joint, the last since it was asked; one that was said rather. It
 * need not have arrived just now: behind a broken length it is found when more bytes have come. */
static const witness_packet *find_seen(const witness *w, int joint, const grobo_joint_state *state)
{
    const witness_packet *found = NULL;
    for (unsigned i = 0; i < WITNESS_SEEN; i++) {
        const witness_packet *seen = &w->seen[i];
        if (seen->at_us >= question_of(w, seen->bytes).since_us &&
            seen->bytes[2] == w->model->joints[joint].motor && agrees(seen, state) &&
            (found == NULL || seen->at_us > found->at_us ||
             (seen->at_us == found->at_us && seen->sound))) {
            found = seen;
        }
    }
    return found;
}

/* True if this may as well be the second one of a reply that the line said twice, or came to the
 * question behind its own because of one. */
static bool may_be_doubled(const witness *w, int joint, const witness_packet *seen, int64_t now_us)
{
    const witness_packet *its = &w->said[seen->said_number % WITNESS_SAID];
    if (!its->believed && now_us - its->at_us <= DOUBLED_US &&
        (now_us - w->doubled_us[joint] <= DOUBLED_US || /* or was let go by, late itself */
         now_us - w->twice_us[joint] <= 2 * DOUBLED_US)) {
        return true;
    }
    for (unsigned i = 0; i < WITNESS_SAID && i < w->n_said; i++) {
        const witness_packet *said = &w->said[i];
        if (said->believed && same(said, seen->bytes, seen->n) &&
            now_us - said->at_us <= DOUBLED_US) {
            return true;
        }
    }
    return false;
}

static void believe_said(witness *w, int joint, const witness_packet *seen, int64_t now_us)
{
    const char *name = w->model->joints[joint].name;
    witness_packet *said = &w->said[seen->said_number % WITNESS_SAID];
    int64_t asked_us = w->answered.since_us;
    bool fresh = !said->believed && said->at_us >= asked_us;
    if (!fresh && may_be_doubled(w, joint, seen, now_us)) {
        w->doubled++;
        w->doubled_us[joint] = now_us;
        said->believed = true;
        return;
    }
    if (said->believed) {
        fail_msg("a reply of %s was believed twice", name);
    }
    /* bus.h: a late reply is told apart for twice the worst lateness that was learnt. */
    bool late = w->answered.silence_us >= w->answered.span_us && asked_us - said->at_us < LATE_US;
    w->late += said->at_us < asked_us && !said->kept && late;
    if (said->at_us < asked_us && !said->kept && !late) {
        fail_msg("a reply of %s was believed that is older than the question: given at %.6f s, "
                 "asked for at %.6f s",
                 name, (double)said->at_us / 1e6, (double)asked_us / 1e6);
    }
    said->believed = true;
    w->said_us[joint] = said->at_us;
    w->believed++;
    if (said->bytes[4] == GROBO_RS30X_GOAL) {
        w->goal_us[joint] = said->at_us;
        w->misled &= ~GROBO_JOINT_BIT(joint);
    }
}

void witness_believed(witness *w, int joint, const grobo_joint_state *state, int64_t now_us)
{
    const witness_packet *seen = find_seen(w, joint, state);
    if (seen == NULL) {
        fail_msg("nobody said what was believed of %s", w->model->joints[joint].name);
        return;
    }
    w->answered = question_of(w, seen->bytes);
    if (seen->sound) {
        believe_said(w, joint, seen, now_us);
    } else {
        w->made_up_believed++;
        mislead(w, joint);
    }
}

bool witness_told(const witness *w, int address)
{
    const witness_question *q = &w->answered;
    return q->address <= address && address < q->address + q->length;
}

bool witness_restarted(const witness *w, int joint)
{
    return w->reboot_us[joint] > 0 && w->reboot_us[joint] >= w->goal_us[joint];
}
