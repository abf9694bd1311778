/* SPDX-License-Identifier: MIT */
/*
 * What packets of Protocol 1.0 do to the registers of servos: of AX and MX (sim.c), and of those of
 * Feetech (src/servo/feetech/sim.c), which differ by the table of their series.
 */
#include <math.h>
#include <string.h>

#include <grobo/core/protocol.h>

#include "src/base/bytes.h"
#include "src/model/joint.h"
#include "src/servo/dxl1/sim_packets.h"
#include "src/servo/unit.h"
#include "src/sim/servo/family.h"
#include "src/sim/servo/note.h"
#include "src/sim/servo/power.h"
#include "src/sim/servo/registers.h"
#include "src/sim/servo/servo.h"
#include "src/sim/servo/shaft.h"

#define COUNT_MV 100
#define LOCK_CLOSED 1

static const grobo_i_dxl1_series *series_of(const grobo_sim_servo *servo)
{
    return servo->family->series(servo);
}

static bool judges(const grobo_sim_servo *servo)
{
    return series_of(servo)->judges;
}

int32_t grobo_i_dxl1_sim_named(const grobo_sim_servo *servo, const char *name)
{
    const grobo_servo_register *reg = grobo_i_dxl_row(servo, name);
    return grobo_servo_register_get(servo->model, reg, &servo->reg[reg->address]);
}

bool grobo_i_dxl1_sim_limits_are(const grobo_sim_servo *servo, int32_t value)
{
    return grobo_i_dxl_get(servo, GROBO_ROLE_MIN_POSITION) == value &&
           grobo_i_dxl_get(servo, GROBO_ROLE_MAX_POSITION) == value;
}

double grobo_i_dxl1_sim_speed_mdeg_s(const grobo_sim_servo *servo)
{
    const grobo_servo_register *reg =
        grobo_servo_register_of(servo->model, GROBO_ROLE_PRESENT_SPEED);
    return grobo_i_register_unit(reg) * 1000;
}

/* ---- positions ----------------------------------------------------------------------------- */

bool grobo_i_dxl1_sim_reverses(const grobo_sim_servo *servo)
{
    return (grobo_i_dxl_get(servo, GROBO_ROLE_DIRECTION) & 1) != 0;
}

static bool counts_turns(const grobo_sim_servo *servo)
{
    return series_of(servo)->counts_turns(servo);
}

static int32_t position_at(const grobo_sim_servo *servo, int32_t angle_mdeg)
{
    int32_t ticks = grobo_i_dxl_ticks(servo, grobo_i_dxl1_sim_reverses(servo), angle_mdeg);
    int32_t turn = grobo_i_dxl_turn(servo);
    ticks += series_of(servo)->offset(servo);
    if (turn == 0 && grobo_i_dxl1_sim_reverses(servo)) {
        ticks += 2 * servo->model->middle;
    }
    if (turn > 0 && !counts_turns(servo)) {
        return grobo_i_dxl_wrap(ticks, turn);
    }
    return ticks - servo->turns_ticks;
}

static int32_t within_limits(const grobo_sim_servo *servo, int32_t goal)
{
    bool bounds = !series_of(servo)->judges && grobo_i_dxl_get(servo, GROBO_ROLE_MIN_POSITION) <
                                                   grobo_i_dxl_get(servo, GROBO_ROLE_MAX_POSITION);
    return bounds ? grobo_i_dxl_within(servo, goal) : goal;
}

int32_t grobo_i_dxl1_sim_goal_mdeg(const grobo_sim *sim, const grobo_sim_servo *servo)
{
    int32_t here_mdeg = grobo_i_sim_angle_mdeg(servo, sim->now_us);
    int32_t goal = within_limits(servo, grobo_i_dxl_get(servo, GROBO_ROLE_GOAL));
    int32_t way = goal - position_at(servo, here_mdeg);
    if (series_of(servo)->steps != NULL && series_of(servo)->steps(servo)) {
        way = grobo_i_dxl_get(servo, GROBO_ROLE_GOAL);
    }
    int32_t ticks = grobo_i_dxl_ticks(servo, false, here_mdeg) +
                    (grobo_i_dxl1_sim_reverses(servo) ? -way : way);
    return (int32_t)lround((ticks - servo->model->middle) * grobo_i_dxl_tick_mdeg(servo));
}

/* ---- the shaft's side ---------------------------------------------------------------------- */

/* Sign and magnitude with the sign in bit 10. */
int32_t grobo_i_dxl1_sim_bit10(int32_t raw)
{
    return (raw & 0x400) != 0 ? -(raw & 0x3FF) : raw & 0x3FF;
}

static bool is_wheel(const grobo_sim_servo *servo, double *speed)
{
    return series_of(servo)->is_wheel(servo, speed);
}

/* A move, by speed and acceleration. */
static void follow_move(grobo_sim_servo *servo)
{
    const grobo_i_dxl1_series *series = series_of(servo);
    grobo_sim_wants *plant = &servo->plant;
    int32_t speed = series->move_speed(servo);
    plant->cap_mdeg_s = (int32_t)lround(fmin(speed * series->speed_mdeg_s(servo), INT32_MAX));
    int32_t acceleration = grobo_i_dxl_get(servo, GROBO_ROLE_ACCELERATION);
    plant->accel_mdeg_s2 = (int32_t)lround(acceleration * series->accel_mdeg_s2(servo));
}

void grobo_i_dxl1_sim_follow(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_sim_wants *plant = &servo->plant;
    double speed = 0;
    grobo_i_dxl_follow(sim, index);
    plant->most_ma =
        plant->stall_ma * series_of(servo)->torque_limit(servo) / series_of(servo)->torque_full;
    if (plant->most_ma == 0) {
        plant->torque = GROBO_TORQUE_OFF;
    }
    if (is_wheel(servo, &speed)) {
        speed = fmin(fmax(speed, -plant->speed_mdeg_s), plant->speed_mdeg_s);
        plant->wheel = true;
        plant->wheel_mdeg_s = (int32_t)lround(grobo_i_dxl1_sim_reverses(servo) ? -speed : speed);
    } else {
        follow_move(servo);
    }
}

/* The registers changed: torque, force and motion are what they say now. */
static void go(grobo_sim *sim, int index, bool new_goal)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_torque before = (grobo_torque)servo->plant.torque;
    grobo_i_dxl1_sim_follow(sim, index);
    if (servo->plant.torque != before) {
        grobo_i_sim_torque(sim, index, before);
    } else if (new_goal && servo->plant.torque == GROBO_TORQUE_ON) {
        grobo_i_sim_set_out(sim, index);
    }
}

/* A status bit came up. */
static void fail(grobo_sim *sim, int index, unsigned error)
{
    grobo_sim_servo *servo = &sim->servo[index];
    servo->status |= (uint8_t)error;
    if ((grobo_i_dxl_get(servo, GROBO_ROLE_SHUTDOWN) & (int)error) != 0) {
        series_of(servo)->shut_down(servo, error);
    }
}

void grobo_i_dxl1_sim_cut(grobo_sim *sim, int index, bool hot)
{
    if (hot) {
        fail(sim, index, GROBO_DXL1_OVERHEATED);
    } else {
        grobo_i_dxl_put(&sim->servo[index], GROBO_ROLE_TORQUE, 0);
    }
    grobo_i_dxl1_sim_follow(sim, index);
    sim->servo[index].plant.torque = GROBO_TORQUE_OFF;
}

/* ---- present values ------------------------------------------------------------------------ */

/* States that come and go by themselves. */
static void see_states(const grobo_sim *sim, grobo_sim_servo *servo)
{
    bool fed = grobo_i_dxl_fed(sim, servo, COUNT_MV);
    bool hot = servo->temperature_c >= grobo_i_dxl_get(servo, GROBO_ROLE_TEMPERATURE_LIMIT);
    unsigned states = (fed ? 0 : GROBO_DXL1_VOLTAGE) | (hot ? GROBO_DXL1_OVERHEATED : 0);
    servo->status =
        (uint8_t)((servo->status & ~(GROBO_DXL1_VOLTAGE | GROBO_DXL1_OVERHEATED)) | states);
}

void grobo_i_dxl1_sim_refresh(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const grobo_i_dxl1_series *series = series_of(servo);
    double sign = grobo_i_dxl1_sim_reverses(servo) ? -1 : 1;
    see_states(sim, servo);
    grobo_i_dxl_refresh(sim, index, sign * series->speed_mdeg_s(servo), series->count_ma);
    if (series->refresh != NULL) {
        series->refresh(sim, index);
    }
    grobo_i_dxl_put(servo, GROBO_ROLE_POSITION,
                    position_at(servo, grobo_i_sim_angle_mdeg(servo, sim->now_us)));
    grobo_i_dxl_put(servo, GROBO_ROLE_ERROR, servo->status);
}

/* ---- what a servo does by itself ----------------------------------------------------------- */

int64_t grobo_i_dxl1_sim_next_us(const grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    int64_t since_us = grobo_i_sim_strained_us(servo);
    if (!servo->powered || since_us == GROBO_NEVER_US) {
        return GROBO_NEVER_US;
    }
    grobo_i_dxl1_stall limit = series_of(servo)->stall(servo);
    bool named_it = (grobo_i_dxl_get(servo, GROBO_ROLE_SHUTDOWN) & (int)limit.error) != 0;
    return limit.error != 0 && named_it && (servo->status & limit.error) == 0
               ? since_us + limit.after_us
               : GROBO_NEVER_US;
}

void grobo_i_dxl1_sim_act(grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    fail(sim, index, series_of(servo)->stall(servo).error);
    go(sim, index, false);
}

/* ---- restart ------------------------------------------------------------------------------- */

int32_t grobo_i_dxl1_sim_bps(const grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    int32_t code = grobo_i_dxl_get(servo, GROBO_ROLE_BAUD);
    int32_t listed_bps = grobo_servo_baud_bps(servo->model, code);
    const grobo_i_dxl1_series *series = series_of(servo);
    return listed_bps < 0 && series->bps != NULL ? series->bps(code) : listed_bps;
}

void grobo_i_dxl1_sim_restart(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_dxl_boot(sim, index);
    grobo_i_dxl_one_turn(sim, servo, grobo_i_dxl1_sim_reverses(servo));
    int32_t here_mdeg = grobo_i_sim_angle_mdeg(servo, sim->now_us);
    grobo_i_dxl_put(servo, GROBO_ROLE_GOAL, position_at(servo, here_mdeg));
    grobo_i_dxl1_sim_follow(sim, index);
}

bool grobo_i_dxl1_sim_factory(grobo_sim *sim, int index, uint8_t id, uint32_t baud_bps)
{
    grobo_sim_servo *servo = &sim->servo[index];
    bool sold = grobo_i_dxl_sell(sim, index, id, GROBO_DXL1_ID_MAX, baud_bps);
    bool wheel = sim->config.mounted && grobo_i_joint_is_wheel(sim->config.model, index);
    if (sold && wheel && series_of(servo)->wheel_mode) {
        grobo_i_dxl_put(servo, GROBO_ROLE_MODE, 1);
    } else if (sold && wheel) {
        grobo_i_dxl_put(servo, GROBO_ROLE_MIN_POSITION, 0);
        grobo_i_dxl_put(servo, GROBO_ROLE_MAX_POSITION, 0);
    }
    memcpy(servo->flash, servo->reg, sizeof servo->flash);
    return sold;
}

/* ---- writing ------------------------------------------------------------------------------- */

/* What a series that judges has against a value. */
static uint8_t judge_value(const grobo_sim_servo *servo, const grobo_servo_register *reg,
                           int32_t value)
{
    bool opens = reg->role == GROBO_ROLE_LOCK && value != LOCK_CLOSED; /* only power-off does */
    bool locked = ((reg->flags & GROBO_REGISTER_KEPT) != 0 || opens) &&
                  grobo_i_dxl_get(servo, GROBO_ROLE_LOCK) == LOCK_CLOSED;
    if (value < reg->min || value > reg->max || locked) {
        return GROBO_DXL1_BAD_RANGE;
    }
    double speed;
    if (reg->role == GROBO_ROLE_GOAL && !is_wheel(servo, &speed) &&
        !(grobo_i_dxl_turn(servo) > 0 && counts_turns(servo)) &&
        (value < grobo_i_dxl_get(servo, GROBO_ROLE_MIN_POSITION) ||
         value > grobo_i_dxl_get(servo, GROBO_ROLE_MAX_POSITION))) {
        return GROBO_DXL1_ANGLE_LIMIT;
    }
    return 0;
}

static bool is_hit(const grobo_servo_register *reg, int address, size_t n)
{
    return reg->address + reg->bytes > address && reg->address < address + (int)n;
}

/* Bits of what is wrong with a write; 0: it can be done. */
static uint8_t judge(const grobo_sim_servo *servo, int address, const uint8_t *bytes, size_t n)
{
    const grobo_servo_register *reg;
    bool hit = false;
    for (size_t i = 0; (reg = grobo_servo_register_row(servo->model, i)) != NULL; i++) {
        if (!is_hit(reg, address, n)) {
            continue;
        }
        bool whole = reg->address >= address && reg->address + reg->bytes <= address + (int)n;
        bool writable = (reg->flags & GROBO_REGISTER_W) != 0;
        hit = hit || writable;
        if (!judges(servo)) {
            continue;
        }
        uint8_t error = GROBO_DXL1_BAD_RANGE;
        if (whole && writable) {
            error = judge_value(servo, reg, grobo_i_dxl_value_in(servo, reg, address, bytes));
        }
        if (error != 0) {
            return error;
        }
    }
    return hit || !judges(servo) ? 0 : GROBO_DXL1_BAD_RANGE;
}

static bool moves(const grobo_sim_servo *servo, const grobo_servo_register *reg)
{
    double speed;
    bool by_speed = reg->role == GROBO_ROLE_SPEED || reg->role == GROBO_ROLE_GOAL_PWM ||
                    reg->role == GROBO_ROLE_GOAL_TIME;
    return reg->role == GROBO_ROLE_GOAL || (by_speed && is_wheel(servo, &speed));
}

static void took_effect(grobo_sim *sim, int index, const grobo_servo_register *reg)
{
    grobo_sim_servo *servo = &sim->servo[index];
    int32_t value = grobo_servo_register_get(servo->model, reg, &servo->reg[reg->address]);
    bool goal = reg->role == GROBO_ROLE_GOAL;
    const grobo_i_dxl1_series *series = series_of(servo);
    servo->status &= (uint8_t)~series->clears(servo, reg);
    if (series->wrote != NULL) {
        series->wrote(sim, index, reg, value);
    }
    if (goal) { /* brings the torque by itself: of STS measured (feetech-cli 0.1.8, simulator.py) */
        grobo_i_dxl_put(servo, GROBO_ROLE_TORQUE, 1);
    }
    go(sim, index, moves(servo, reg));
    grobo_i_dxl_tell(sim, index, reg, value);
}

int grobo_i_dxl1_sim_store(grobo_sim *sim, int index, int address, const uint8_t *bytes, size_t n)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const grobo_servo_register *reg;
    bool open = !series_of(servo)->locks || grobo_i_dxl_get(servo, GROBO_ROLE_LOCK) != LOCK_CLOSED;
    grobo_i_dxl_store(servo, address, bytes, n, open);
    for (size_t i = 0; (reg = grobo_servo_register_row(servo->model, i)) != NULL; i++) {
        if (is_hit(reg, address, n) && (reg->flags & GROBO_REGISTER_W) != 0) {
            took_effect(sim, index, reg);
        }
    }
    return GROBO_OK;
}

static uint8_t write(grobo_sim *sim, int index, int address, const uint8_t *bytes, size_t n)
{
    uint8_t error = judge(&sim->servo[index], address, bytes, n);
    if (error == 0 && address + (int)n <= GROBO_SIM_REGISTER_BYTES) {
        (void)grobo_i_dxl1_sim_store(sim, index, address, bytes, n);
    } else {
        grobo_i_sim_note(sim, GROBO_SIM_REFUSED, index, address);
    }
    return error;
}

/* ---- answers ------------------------------------------------------------------------------- */

static void answer(grobo_sim *sim, int index, grobo_i_dxl_round *round, uint8_t error,
                   const uint8_t *data, size_t n)
{
    uint8_t bytes[GROBO_SIM_TALK_BYTES];
    grobo_sim_servo *servo = &sim->servo[index];
    see_states(sim, servo);
    const grobo_dxl1_packet status = {.status = true,
                                      .id = servo->plant.id,
                                      .error = (uint8_t)(error | servo->status),
                                      .data = data,
                                      .data_bytes = n};
    int size = grobo_dxl1_build(&status, bytes, sizeof bytes);
    if (size > 0) {
        grobo_i_dxl_answer(sim, index, round, bytes, (size_t)size);
    }
}

/* The level from which on a read, and a write, is answered. */
static bool answers(const grobo_sim_servo *servo, bool read)
{
    int32_t level = grobo_i_dxl_get(servo, GROBO_ROLE_REPLY_LEVEL);
    return !judges(servo) ? read || level > 0 : level > (read ? 0 : 1);
}

static void answer_read(grobo_sim *sim, int index, grobo_i_dxl_round *round, int address,
                        int length)
{
    grobo_sim_servo *servo = &sim->servo[index];
    bool beyond = address + length > GROBO_SIM_REGISTER_BYTES ||
                  (judges(servo) && address + length > grobo_i_dxl_end(servo));
    if (!answers(servo, true)) {
        return;
    }
    grobo_i_dxl1_sim_refresh(sim, index);
    if (beyond || length == 0) {
        answer(sim, index, round, !judges(servo) ? 0 : GROBO_DXL1_BAD_RANGE, NULL, 0);
    } else {
        answer(sim, index, round, 0, &servo->reg[address], (size_t)length);
    }
}

/* ---- packets for one ----------------------------------------------------------------------- */

static uint8_t keep(grobo_sim *sim, int index, const grobo_dxl1_packet *packet)
{
    grobo_sim_servo *servo = &sim->servo[index];
    uint8_t error = judge(servo, packet->address, packet->data, packet->data_bytes);
    if (packet->data_bytes == 0 || packet->data_bytes > sizeof servo->kept) {
        error |= GROBO_DXL1_BAD_RANGE;
    }
    if (error == 0) {
        memcpy(servo->kept, packet->data, packet->data_bytes);
        servo->kept_bytes = (uint8_t)packet->data_bytes;
        servo->kept_address = packet->address;
    }
    return !judges(servo) ? 0 : error;
}

static uint8_t do_kept(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    size_t n = servo->kept_bytes;
    servo->kept_bytes = 0;
    if (n == 0) {
        return !judges(servo) ? 0 : GROBO_DXL1_BAD_INSTRUCTION;
    }
    return write(sim, index, servo->kept_address, servo->kept, n);
}

/* A series that judges loses its id too. */
static void reset(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    int32_t id = servo->plant.id;
    grobo_i_dxl_factory(servo);
    if (!judges(servo)) {
        grobo_i_dxl_put(servo, GROBO_ROLE_ID, id);
        memcpy(servo->flash, servo->reg, sizeof servo->flash);
    }
    grobo_i_sim_reboot(sim, index);
}

static uint8_t carry_out(grobo_sim *sim, int index, const grobo_dxl1_packet *packet)
{
    uint8_t code = packet->instruction;
    if (code == GROBO_DXL1_WRITE) {
        return write(sim, index, packet->address, packet->data, packet->data_bytes);
    }
    if (code == GROBO_DXL1_REG_WRITE) {
        return keep(sim, index, packet);
    }
    if (code == GROBO_DXL1_ACTION) {
        return do_kept(sim, index);
    }
    const grobo_i_dxl1_series *series = series_of(&sim->servo[index]);
    bool known = code == GROBO_DXL1_FACTORY_RESET || /* when the answer is made */
                 (series->extra != NULL && series->extra(sim, index, packet));
    return known ? 0 : GROBO_DXL1_BAD_INSTRUCTION;
}

static bool is_answered(const grobo_sim_servo *servo, const grobo_dxl1_packet *packet)
{
    bool known = packet->instruction <= GROBO_DXL1_CALIBRATE;
    return packet->id != GROBO_DXL1_ID_ALL && answers(servo, false) && (known || judges(servo));
}

static void for_one(grobo_sim *sim, int index, const grobo_dxl1_packet *packet)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_dxl_round round = {0};
    if (packet->instruction == GROBO_DXL1_READ) {
        if (packet->id != GROBO_DXL1_ID_ALL) {
            answer_read(sim, index, &round, packet->address, packet->length);
        }
        return;
    }
    uint8_t id = servo->plant.id;
    uint8_t error = carry_out(sim, index, packet);
    error = !judges(servo) ? 0 : error;
    if (is_answered(servo, packet)) {
        uint8_t now = servo->plant.id;
        servo->plant.id = judges(servo) ? id : now; /* a new one counts at once, or after this */
        answer(sim, index, &round, error, NULL, 0);
        servo->plant.id = now;
    }
    if (packet->instruction == GROBO_DXL1_FACTORY_RESET) {
        reset(sim, index);
    } else if (packet->instruction == GROBO_DXL1_REBOOT && series_of(servo)->extra != NULL) {
        grobo_i_sim_reboot(sim, index);
    }
}

/* ---- packets for several ------------------------------------------------------------------- */

/* One of a list answers, if its series has the instruction. */
static void read_one(const grobo_sim_family *family, grobo_sim *sim, const grobo_sim_event *raw,
                     grobo_i_dxl_round *round, bool sync, const grobo_dxl1_packet *one)
{
    const grobo_i_dxl_round begin = *round;
    bool silent = true;
    for (int i = -1; (i = grobo_i_dxl_hearer(sim, family, one->id, i, raw)) >= 0;) {
        grobo_i_dxl_round own = begin;
        const grobo_i_dxl1_series *series = series_of(&sim->servo[i]);
        if (sync ? series->sync_read : series->bulk_read) {
            answer_read(sim, i, &own, one->address, one->length);
            grobo_i_dxl_beside(round, &own);
            silent = false;
        }
    }
    if (silent) {
        grobo_i_dxl_silence(sim, round, GROBO_DXL1_OVERHEAD_BYTES + (size_t)one->length);
    }
}

static void sync_read(const grobo_sim_family *family, grobo_sim *sim,
                      const grobo_dxl1_packet *packet, const grobo_sim_event *raw)
{
    grobo_i_dxl_round round = {0};
    for (size_t i = 0; i < packet->data_bytes; i++) {
        grobo_dxl1_packet one = *packet;
        one.id = packet->data[i];
        read_one(family, sim, raw, &round, true, &one);
    }
}

/* An id that comes again counts once (emanual, bulk read). */
static void bulk_read(const grobo_sim_family *family, grobo_sim *sim,
                      const grobo_dxl1_packet *packet, const grobo_sim_event *raw)
{
    grobo_i_dxl_round round = {0};
    bool seen[GROBO_DXL1_ID_ALL + 2] = {false};
    for (size_t i = 1; i + 3 <= packet->data_bytes; i += 3) {
        const uint8_t *item = packet->data + i;
        const grobo_dxl1_packet one = {.length = item[0], .id = item[1], .address = item[2]};
        if (!seen[one.id]) {
            read_one(family, sim, raw, &round, false, &one);
        }
        seen[one.id] = true;
    }
}

static void sync_write(const grobo_sim_family *family, grobo_sim *sim,
                       const grobo_dxl1_packet *packet, const grobo_sim_event *raw)
{
    size_t each = 1 + (size_t)packet->length;
    for (size_t at = 0; packet->length > 0 && at + each <= packet->data_bytes; at += each) {
        const uint8_t *data = packet->data + at;
        for (int i = -1; (i = grobo_i_dxl_hearer(sim, family, *data, i, raw)) >= 0;) {
            (void)write(sim, i, packet->address, data + 1, packet->length);
        }
    }
}

/* Some take turns, in the order of ids; the others talk all at once. */
static void ping_all(const grobo_sim_family *family, grobo_sim *sim, const grobo_sim_event *raw)
{
    grobo_i_dxl_round turn = {0};
    for (int id = 0; id <= GROBO_DXL1_ID_MAX; id++) {
        const grobo_i_dxl_round begin = turn;
        const uint8_t its = (uint8_t)id;
        for (int i = -1; (i = grobo_i_dxl_hearer(sim, family, its, i, raw)) >= 0;) {
            bool waits = series_of(&sim->servo[i])->ping_turns;
            grobo_i_dxl_round own = waits ? begin : (grobo_i_dxl_round){0};
            answer(sim, i, &own, 0, NULL, 0);
            if (waits) {
                grobo_i_dxl_beside(&turn, &own);
            }
        }
    }
}

/* ---- packets ------------------------------------------------------------------------------- */

static void spread(const grobo_sim_family *family, grobo_sim *sim, const grobo_dxl1_packet *packet,
                   int result, const grobo_sim_event *raw)
{
    int id = packet->id != GROBO_DXL1_ID_ALL ? packet->id : GROBO_I_DXL_ALL;
    for (int i = -1; (i = grobo_i_dxl_hearer(sim, family, id, i, raw)) >= 0;) {
        grobo_i_dxl_round round = {0};
        if (packet->instruction == GROBO_DXL1_PING) {
            answer(sim, i, &round, 0, NULL, 0);
        } else if (result >= 0) {
            for_one(sim, i, packet);
        } else if (judges(&sim->servo[i]) && packet->id != GROBO_DXL1_ID_ALL) {
            answer(sim, i, &round, GROBO_DXL1_BAD_RANGE, NULL, 0);
        }
    }
}

void grobo_i_dxl1_sim_packet(const grobo_sim_family *family, grobo_sim *sim,
                             const grobo_sim_event *raw)
{
    grobo_dxl1_packet parts = {.id = raw->bytes[2], .instruction = raw->bytes[4]};
    int result = grobo_dxl1_parse(raw->bytes, raw->n_bytes, false, &parts);
    bool all = parts.id == GROBO_DXL1_ID_ALL;
    if (all && parts.instruction == GROBO_DXL1_PING) {
        ping_all(family, sim, raw);
    } else if (all && parts.instruction == GROBO_DXL1_SYNC_READ) {
        sync_read(family, sim, &parts, raw);
    } else if (all && parts.instruction == GROBO_DXL1_BULK_READ) {
        bulk_read(family, sim, &parts, raw);
    } else if (all && parts.instruction == GROBO_DXL1_SYNC_WRITE) {
        sync_write(family, sim, &parts, raw);
    } else {
        spread(family, sim, &parts, result, raw);
    }
}

/* A series that judges tells of a wrong sum. */
void grobo_i_dxl1_sim_broken(const grobo_sim_family *family, grobo_sim *sim, const uint8_t *bytes,
                             size_t n)
{
    const grobo_sim_event raw = {.kind = GROBO_SIM_PACKET,
                                 .time_us = sim->now_us,
                                 .servo = -1,
                                 .bytes = bytes,
                                 .n_bytes = n};
    for (int i = -1; (i = grobo_i_dxl_hearer(sim, family, bytes[2], i, &raw)) >= 0;) {
        grobo_i_dxl_round round = {0};
        if (judges(&sim->servo[i]) && answers(&sim->servo[i], false)) {
            answer(sim, i, &round, GROBO_DXL1_BAD_SUM, NULL, 0);
        }
    }
}

int grobo_i_dxl1_sim_measure(const uint8_t *bytes, size_t n, bool good)
{
    int size = grobo_dxl1_measure(bytes, n, GROBO_ACCEPT_COMMANDS);
    return size == GROBO_ERR_CHECKSUM && !good ? 4 + bytes[3] : size;
}
