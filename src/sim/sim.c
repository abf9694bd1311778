/* SPDX-License-Identifier: MIT */
/*
 * The simulator's pump: what is due next on any wire happens next. A byte's way, by files:
 *
 *   host - wire - board (fifo, send) - bus - servo - talk - board (got) - wire - host
 *   host - wire ---------------------- bus - servo - talk --------------- wire - host
 */
#include <string.h>

#include <grobo/core/sim.h>

#include "src/base/instant.h"
#include "src/base/sized.h"
#include "src/model/joint.h"
#include "src/robots/robots.h"
#include "src/sim/board.h"
#include "src/sim/bus.h"
#include "src/sim/servo/family.h"
#include "src/sim/servo/fault.h"
#include "src/sim/servo/note.h"
#include "src/sim/servo/power.h"
#include "src/sim/servo/servo.h"
#include "src/sim/servo/shaft.h"
#include "src/sim/servo/talk.h"
#include "src/sim/servo/world.h"
#include "src/sim/wire.h"

#define LOWEST_BPS 300
/* Assumptions; docs/simulator.md lists them. */
#define SUPPLY_MV 7400
#define AMBIENT_C 25
#define SILENCE_US 2000
/* The board's rate towards the servos (protocol 2). */
#define BUS_BPS 115200
/* What nearly every robot of other servos uses. */
#define OTHERS_BPS 1000000
/* As far as a wheel turns. */
#define WHEEL_MDEG 1500000000

static int64_t byte_ns(const grobo_sim *sim, uint32_t bps)
{
    int64_t bits = sim->parity ? 11 : 10;
    return sim->config.unpaced ? 1 : bits * 1000000000 / bps;
}

/*
 * How many bytes of the host make a frame whose end is all that matters: it is all on the line,
 * undamaged, and nothing else goes on. The board or the servos get it whole then, which costs a
 * third of what its bytes do one by one. 1: byte by byte.
 */
static size_t frame_run(const grobo_sim *sim)
{
    const grobo_sim_wire *in = &sim->in;
    bool board = sim->config.wiring == GROBO_WIRING_BOARD;
    const uint8_t *bytes = grobo_i_sim_sound(sim);
    if (bytes == NULL || in->used < 2 || (board && !grobo_i_sim_board_listens(sim))) {
        return 1;
    }
    grobo_board_frame frame;
    int size = board ? grobo_board_peek(bytes, in->used, &frame)
                     : (int)grobo_i_sim_bus_packet(sim, bytes, in->used);
    return size > 1 ? (size_t)size : 1;
}

static void arrive(grobo_sim *sim, size_t run, int64_t t_ns)
{
    uint8_t byte;
    if (run > 1) {
        const uint8_t *bytes = grobo_i_sim_sound(sim);
        sim->stats.rx_bytes += (uint32_t)run;
        grobo_i_sim_wire_drop(&sim->in, run);
        if (sim->config.wiring == GROBO_WIRING_BUS) {
            grobo_i_sim_bus_hear_packet(sim, bytes, run, t_ns);
        } else {
            grobo_i_sim_board_hear_frame(sim, bytes, run, t_ns);
        }
        return;
    }
    if (!grobo_i_sim_from_host(sim, &byte)) {
        return;
    }
    if (sim->config.wiring == GROBO_WIRING_BUS) {
        grobo_i_sim_bus_hear(sim, byte, t_ns);
    } else {
        grobo_i_sim_board_hear(sim, byte, t_ns);
    }
}

/* How many bytes of a servo the board gets before anything else goes on. */
static int reply_run(const grobo_sim *sim)
{
    int left = sim->n_talks == 1 ? sim->talk[0].used - sim->talk[0].said : 1;
    if (sim->board_state != GROBO_SIM_BOARD_WAITING || left < 2 ||
        grobo_i_sim_talk_next(sim) > sim->board_at_ns ||
        sim->bus_byte_ns > (int64_t)sim->config.board_silence_us * 1000) {
        return 1;
    }
    return left < sim->want - sim->got_used ? left : sim->want - sim->got_used;
}

/* A byte of a servo is over. */
static void said(grobo_sim *sim, int64_t t_ns)
{
    uint8_t byte;
    if (!grobo_i_sim_talk_take(sim, t_ns, &byte)) {
        return;
    }
    if (sim->config.wiring == GROBO_WIRING_BUS) {
        grobo_i_sim_to_host(sim, &byte, 1, t_ns);
    } else {
        grobo_i_sim_board_got(sim, &byte, 1, t_ns);
    }
}

/* Some that nobody disturbs are over: reply_run(). */
static void said_all(grobo_sim *sim, int run, int64_t t_ns)
{
    uint8_t bytes[GROBO_SIM_TALK_BYTES];
    grobo_i_sim_talk_take_run(sim, (size_t)run, bytes);
    grobo_i_sim_board_got(sim, bytes, (size_t)run, t_ns);
}

/* ---- time ---------------------------------------------------------------------------------- */

/* Does what is due first, if it is due by limit_ns. */
static bool step_once(grobo_sim *sim, int64_t limit_ns)
{
    int64_t talk_ns = grobo_i_sim_talk_next(sim), in_ns = grobo_i_sim_wire_next(&sim->in);
    int64_t board_ns = grobo_i_sim_board_next(sim);
    int said_run = sim->n_talks > 0 ? reply_run(sim) : 0;
    size_t come_run = in_ns <= limit_ns ? frame_run(sim) : 0;
    if (said_run > 1) {
        talk_ns += (said_run - 1) * sim->bus_byte_ns;
        board_ns = GROBO_NEVER_US; /* each byte puts its patience off */
    }
    if (come_run > 1) {
        in_ns = sim->in.at_ns[sim->in.head + come_run - 1];
    }
    int64_t t_ns = grobo_i_sooner(talk_ns, grobo_i_sooner(in_ns, board_ns));
    if (t_ns > limit_ns) {
        return false;
    }
    grobo_i_world_advance(sim, grobo_i_sim_us(t_ns));
    sim->now_ns = t_ns;
    sim->now_us = grobo_i_sim_us(t_ns);
    if (talk_ns == t_ns) {
        if (said_run > 1) {
            said_all(sim, said_run, t_ns);
        } else {
            said(sim, t_ns);
        }
    } else if (in_ns == t_ns) {
        arrive(sim, come_run, t_ns);
    } else {
        grobo_i_sim_board_act(sim, t_ns);
    }
    return true;
}

void grobo_sim_step(grobo_sim *sim, int64_t now_us)
{
    if (sim == NULL) {
        return;
    }
    now_us = now_us > sim->now_us ? now_us : sim->now_us;
    while (step_once(sim, now_us * 1000)) {
    }
    grobo_i_world_advance(sim, now_us);
    sim->now_us = now_us;
    sim->now_ns = now_us * 1000;
}

/* ---- what comes ---------------------------------------------------------------------------- */

/* Size of the frame at the start of bytes; 0: not whole yet; negative: none. */
static int frame_at(const grobo_sim_ear *ear, const uint8_t *bytes, size_t n)
{
    grobo_board_frame frame;
    return ear != NULL ? ear->family->measure(bytes, n, false) : grobo_board_peek(bytes, n, &frame);
}

/*
 * When the next frame of the host is whole for the board (ear NULL) or for an ear: nobody acts on a
 * part of one. What has arrived of it is kept there, the rest is on the line. Where more is
 * missing, or nothing starts, the last byte looked at.
 */
static int64_t whole_ns(const grobo_sim *sim, const grobo_sim_ear *ear)
{
    const grobo_sim_wire *in = &sim->in;
    const grobo_framer *heard = &sim->board.framer;
    uint8_t bytes[GROBO_SIM_EAR_BYTES + GROBO_RS30X_PACKET_MAX_BYTES];
    size_t arrived = ear != NULL ? ear->used : (size_t)(heard->used - heard->taken);
    size_t n = arrived, at = 0;
    int size = -1;
    memcpy(bytes, ear != NULL ? ear->byte : heard->buf + heard->taken, arrived);
    for (size_t i = 0; i < in->used && n < sizeof bytes; i++) {
        bytes[n++] = in->byte[(in->head + i) % GROBO_SIM_WIRE_BYTES];
    }
    while (at < n && (size = frame_at(ear, bytes + at, n - at)) < 0) {
        at++;
    }
    size_t end = size > 0 ? at + (size_t)size : n;
    size_t ahead = end > arrived ? end - arrived : 1;
    return in->at_ns[(in->head + ahead - 1) % GROBO_SIM_WIRE_BYTES];
}

static int64_t next_whole_ns(const grobo_sim *sim)
{
    int64_t at_ns = GROBO_NEVER_US;
    if (sim->in.used == 0) {
        return GROBO_NEVER_US;
    }
    size_t run = frame_run(sim);
    if (run > 1) {
        return sim->in.at_ns[sim->in.head + run - 1];
    }
    if (sim->config.wiring == GROBO_WIRING_BOARD) {
        return whole_ns(sim, NULL);
    }
    for (int i = 0; i < sim->n_ears; i++) {
        at_ns = grobo_i_sooner(at_ns, whole_ns(sim, &sim->ear[i]));
    }
    return at_ns;
}

/* When the board does something that depends on nothing that is still to come. */
static int64_t board_step_ns(const grobo_sim *sim)
{
    switch (sim->board_state) {
    case GROBO_SIM_BOARD_SENDING: /* a payload acts when it is over */
        return sim->board_at_ns + (sim->send_used - sim->sent - sim->sending) * sim->bus_byte_ns;
    case GROBO_SIM_BOARD_WAITING: /* bytes that come put its patience off */
        if (grobo_i_sim_talk_next(sim) <= sim->board_at_ns) {
            return GROBO_NEVER_US;
        }
        break;
    case GROBO_SIM_BOARD_IDLE:
    case GROBO_SIM_BOARD_REPLYING:
        break;
    }
    return grobo_i_sim_board_next(sim);
}

/* When something has to be done within, whatever the host sees of it. */
static int64_t inner_deadline_ns(const grobo_sim *sim)
{
    int64_t at_ns = grobo_i_sim_talks_end(sim);
    if (sim->config.wiring == GROBO_WIRING_BUS) {
        return grobo_i_sooner(at_ns, next_whole_ns(sim));
    }
    if (sim->board_state == GROBO_SIM_BOARD_IDLE) {
        at_ns = grobo_i_sooner(at_ns, next_whole_ns(sim));
    }
    return grobo_i_sooner(at_ns, board_step_ns(sim));
}

/* When the last of the bytes is ready that follow each other to the host without a pause. */
static int64_t burst_end_ns(const grobo_sim *sim)
{
    const grobo_sim_wire *out = &sim->out;
    int64_t end_ns = grobo_i_sim_wire_next(out);
    for (size_t i = 1; i < out->used; i++) {
        int64_t at_ns = out->at_ns[(out->head + i) % GROBO_SIM_WIRE_BYTES];
        if (at_ns - end_ns > sim->line_byte_ns) {
            break;
        }
        end_ns = at_ns;
    }
    return end_ns;
}

static int64_t deadline_us(const grobo_sim *sim, int64_t at_ns)
{
    int64_t tend_us = grobo_i_world_deadline(sim->config.physics);
    return at_ns == GROBO_NEVER_US ? tend_us : grobo_i_sooner(tend_us, grobo_i_sim_us(at_ns));
}

int64_t grobo_sim_deadline(const grobo_sim *sim)
{
    if (sim == NULL) {
        return GROBO_NEVER_US;
    }
    int64_t at_ns = grobo_i_sooner(grobo_i_sim_wire_next(&sim->out), inner_deadline_ns(sim));
    if (sim->config.wiring == GROBO_WIRING_BUS) { /* these reach the host as they are over */
        at_ns = grobo_i_sooner(at_ns, grobo_i_sim_talk_next(sim));
        at_ns = sim->config.echo ? grobo_i_sooner(at_ns, grobo_i_sim_wire_next(&sim->in)) : at_ns;
    }
    return deadline_us(sim, at_ns);
}

int64_t grobo_sim_packet_deadline(const grobo_sim *sim)
{
    return sim == NULL
               ? GROBO_NEVER_US
               : deadline_us(sim, grobo_i_sooner(burst_end_ns(sim), inner_deadline_ns(sim)));
}

/* ---- the host's end ------------------------------------------------------------------------ */

size_t grobo_sim_rx_room(const grobo_sim *sim)
{
    return sim == NULL ? 0 : GROBO_SIM_WIRE_BYTES - (size_t)sim->in.used;
}

size_t grobo_sim_rx(grobo_sim *sim, const uint8_t *bytes, size_t n, int64_t now_us)
{
    if (sim == NULL || (bytes == NULL && n > 0)) {
        return 0;
    }
    grobo_sim_step(sim, now_us);
    if (sim->gone) {
        return n;
    }
    grobo_i_world_wake(sim);
    size_t room = grobo_sim_rx_room(sim);
    n = n < room ? n : room;
    int64_t at_ns = sim->in.free_ns > sim->now_ns ? sim->in.free_ns : sim->now_ns;
    grobo_i_sim_wire_write(&sim->in, bytes, n, at_ns, sim->line_byte_ns);
    return n;
}

size_t grobo_sim_tx(grobo_sim *sim, uint8_t *buf, size_t cap, int64_t now_us)
{
    if (sim == NULL || buf == NULL) {
        return 0;
    }
    grobo_sim_step(sim, now_us);
    size_t n = grobo_i_sim_wire_read(&sim->out, buf, cap, sim->now_ns);
    sim->stats.tx_bytes += (uint32_t)n;
    return n;
}

/* ---- the host's cable ---------------------------------------------------------------------- */

void grobo_sim_plug(grobo_sim *sim, bool in, int64_t now_us)
{
    if (sim == NULL) {
        return;
    }
    grobo_sim_step(sim, now_us);
    grobo_i_sim_cut(sim);
    sim->gone = !in;
}

bool grobo_sim_hung_up(const grobo_sim *sim)
{
    return sim != NULL && sim->gone;
}

int grobo_sim_set_line_bps(grobo_sim *sim, uint32_t line_bps)
{
    if (sim == NULL || line_bps < LOWEST_BPS) {
        return GROBO_ERR_ARG;
    }
    sim->line_bps = line_bps;
    sim->line_byte_ns = byte_ns(sim, line_bps);
    if (sim->config.wiring == GROBO_WIRING_BUS) {
        sim->bus_bps = line_bps;
        sim->bus_byte_ns = sim->line_byte_ns;
    }
    return 0;
}

/* ---- power-up ------------------------------------------------------------------------------ */

/* Of the shaft of a servo, which may be mounted the other way round, turned or geared down. */
static int32_t shaft_mdeg(const grobo_joint *joint, double angle_rad)
{
    return grobo_i_sim_mdeg_of_rad(grobo_joint_to_servo(joint, angle_rad));
}

static int32_t start_mdeg(grobo_sim *sim, const grobo_sim_servo *servo, const grobo_joint *joint)
{
    int32_t span_mdeg = servo->stop_max_mdeg - servo->stop_min_mdeg;
    switch (sim->config.start) {
    case GROBO_SIM_START_INIT:
        return shaft_mdeg(joint, joint->init_rad);
    case GROBO_SIM_START_ZERO:
        return servo->stop_min_mdeg > 0   ? servo->stop_min_mdeg
               : servo->stop_max_mdeg < 0 ? servo->stop_max_mdeg
                                          : 0;
    case GROBO_SIM_START_LIMP:
        break;
    }
    return servo->stop_min_mdeg +
           (int32_t)grobo_i_sim_random(sim, GROBO_I_SIM_CHANCE, (uint32_t)span_mdeg + 1);
}

static bool knows(const grobo_sim_family *family, const grobo_servo_model *model)
{
    const grobo_servo_table *const *table = family->tables;
    while (*table != NULL && *table != grobo_servo_series(model)) {
        table++;
    }
    return *table != NULL;
}

/* NULL: no family that was given has the servo. */
static const grobo_sim_family *family_of(const grobo_sim_config *config, int index)
{
    const grobo_servo_model *model = config->servos != NULL ? config->servos[index] : NULL;
    if (model == NULL) {
        return &grobo_i_sim_rs30x;
    }
    const grobo_sim_family *const *family = config->families;
    while (family != NULL && *family != NULL && !knows(*family, model)) {
        family++;
    }
    return family != NULL ? *family : NULL;
}

/* The ear of the family of a servo; none where no family that was given has it. */
static grobo_sim_ear *ear_of(grobo_sim *sim, const grobo_sim_family *family)
{
    for (int i = 0; i < sim->n_ears; i++) {
        if (sim->ear[i].family == family) {
            return &sim->ear[i];
        }
    }
    if (sim->n_ears == GROBO_SIM_FAMILIES_MAX) {
        return NULL;
    }
    sim->ear[sim->n_ears].family = family;
    return &sim->ear[sim->n_ears++];
}

static int init_servo(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const grobo_joint *joint = grobo_i_joint(sim->config.model, index);
    servo->family = family_of(&sim->config, index);
    servo->model = sim->config.servos != NULL ? sim->config.servos[index] : NULL;
    if (servo->model == NULL) {
        servo->model = grobo_i_sim_rs30x_model(joint->servo_model);
    }
    if (sim->config.wiring == GROBO_WIRING_BOARD && servo->family != &grobo_i_sim_rs30x) {
        return GROBO_ERR_ARG;
    }
    if (servo->family == NULL || ear_of(sim, servo->family) == NULL) {
        return GROBO_ERR_UNSUPPORTED;
    }
    bool reversed = joint->sign < 0;
    servo->stop_min_mdeg = shaft_mdeg(joint, reversed ? joint->max_rad : joint->min_rad);
    servo->stop_max_mdeg = shaft_mdeg(joint, reversed ? joint->min_rad : joint->max_rad);
    servo->from_mdeg = servo->to_mdeg = start_mdeg(sim, servo, joint);
    if (sim->config.no_stops || grobo_i_joint_is_wheel(sim->config.model, index)) {
        servo->stop_max_mdeg =
            servo->family->turns_mdeg != 0 ? servo->family->turns_mdeg : WHEEL_MDEG;
        servo->stop_min_mdeg = -servo->stop_max_mdeg;
    }
    servo->start_us = servo->due_us = servo->settled_us = sim->now_us;
    servo->saved_us = GROBO_NEVER_US;
    servo->temperature_c = sim->config.ambient_c;
    if (!servo->family->factory(sim, index, joint->motor, sim->bus_bps)) {
        return GROBO_ERR_ARG;
    }
    grobo_i_sim_boot(sim, index, 0);
    grobo_i_sim_feed(sim, index);
    return GROBO_OK;
}

static void use_defaults(grobo_sim_config *config)
{
    config->model = config->model == NULL ? &grobo_i_gr001_model : config->model;
    if (config->baud_bps == 0) {
        const grobo_sim_family *first = family_of(config, 0);
        config->baud_bps = first == NULL || first->usual_bps == 0 ? OTHERS_BPS : first->usual_bps;
    }
    config->supply_mv = config->supply_mv == 0 ? SUPPLY_MV : config->supply_mv;
    config->ambient_c = config->ambient_c == 0 ? AMBIENT_C : config->ambient_c;
    if (config->board_silence_us == 0) {
        config->board_silence_us = SILENCE_US;
    }
}

size_t grobo_i_sim_bytes(const grobo_model *model)
{
    size_t n = model != NULL ? model->n_joints : grobo_i_gr001_model.n_joints;
    return offsetof(grobo_sim, servo) + n * sizeof(grobo_sim_servo);
}

int grobo_sim_init_sized(grobo_sim *sim, size_t sim_bytes, const grobo_sim_config *config,
                         int64_t now_us)
{
    grobo_sim_config with;
    if (sim == NULL || grobo_i_sized_take(&with, sizeof with, config) < 0) {
        return GROBO_ERR_ARG;
    }
    use_defaults(&with);
    if ((sim_bytes != sizeof *sim && sim_bytes != grobo_i_sim_bytes(with.model)) ||
        grobo_model_check(with.model) < 0 || with.baud_bps < LOWEST_BPS || with.ambient_c < -40 ||
        with.ambient_c > 60 || (with.wiring == GROBO_WIRING_BOARD && with.echo)) {
        return GROBO_ERR_ARG;
    }
    if (with.model->n_joints > GROBO_SIM_SERVOS_MAX) {
        return GROBO_ERR_CAP;
    }
    memset(sim, 0, sim_bytes);
    sim->config = with;
    sim->config.hook = NULL;
    sim->now_us = now_us;
    sim->now_ns = now_us * 1000;
    sim->in.free_ns = sim->out.free_ns = sim->bus_heard_ns = sim->hand_over_ns = sim->now_ns;
    sim->supply_mv = with.supply_mv;
    sim->n_servos = with.model->n_joints;
    const grobo_sim_family *first = family_of(&with, 0);
    sim->parity = first != NULL && first->parity;
    sim->bus_bps = BUS_BPS;
    sim->bus_byte_ns = byte_ns(sim, sim->bus_bps);
    (void)grobo_sim_set_line_bps(sim, with.baud_bps);
    grobo_board_parser_init(&sim->board, with.board_stall_us);
    grobo_i_sim_seed(sim);
    for (int i = 0; i < sim->n_servos; i++) {
        int result = init_servo(sim, i);
        if (result < 0) {
            return result;
        }
    }
    sim->config.hook = with.hook;
    return grobo_i_world_begin(sim);
}
