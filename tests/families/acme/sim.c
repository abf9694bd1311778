/* SPDX-License-Identifier: MIT */
/* The simulated servo: what packets do to its registers, and what these say of the shaft. */
#include <math.h>

#include "src/servo/acme/acme.h"
#include "src/servo/families.h"
#include "src/sim/servo/family.h"
#include "src/sim/servo/note.h"
#include "src/sim/servo/power.h"
#include "src/sim/servo/registers.h"
#include "src/sim/servo/servo.h"
#include "src/sim/servo/shaft.h"

/* ---- positions and the shaft's side ---------------------------------------------------------- */

static int32_t position(const grobo_sim *sim, const grobo_sim_servo *servo)
{
    return grobo_i_dxl_ticks(servo, false, grobo_i_sim_angle_mdeg(servo, sim->now_us));
}

static int32_t goal_mdeg(const grobo_sim *sim, const grobo_sim_servo *servo)
{
    (void)sim;
    int32_t ticks = grobo_i_dxl_within(servo, grobo_i_dxl_get(servo, GROBO_ROLE_GOAL));
    return (int32_t)lround((ticks - servo->model->middle) * grobo_i_dxl_tick_mdeg(servo));
}

static void follow(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_dxl_follow(sim, index);
    servo->plant.time_us = grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_TIME) * 1000;
}

static void cut(grobo_sim *sim, int index, bool hot)
{
    grobo_sim_servo *servo = &sim->servo[index];
    servo->status |= hot ? ACME_OVERHEATED : 0;
    grobo_i_dxl_put(servo, GROBO_ROLE_TORQUE, 0);
    follow(sim, index);
}

static void refresh(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_dxl_refresh(sim, index, grobo_i_dxl_tick_mdeg(servo), 0);
    grobo_i_dxl_put(servo, GROBO_ROLE_POSITION, position(sim, servo));
    grobo_i_dxl_put(servo, GROBO_ROLE_ERROR, servo->status);
}

/* ---- restart --------------------------------------------------------------------------------- */

static int32_t bps(const grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    return grobo_servo_baud_bps(servo->model, grobo_i_dxl_get(servo, GROBO_ROLE_BAUD));
}

static void restart(grobo_sim *sim, int index)
{
    grobo_i_dxl_boot(sim, index);
    grobo_i_dxl_put(&sim->servo[index], GROBO_ROLE_GOAL, position(sim, &sim->servo[index]));
    follow(sim, index);
}

static bool factory(grobo_sim *sim, int index, uint8_t id, uint32_t baud_bps)
{
    int code = grobo_servo_baud_code(sim->servo[index].model, (int32_t)baud_bps);
    if (code < 0 || id > ACME_ID_MAX) {
        return false;
    }
    grobo_i_dxl_sold(sim, index, id, code);
    return true;
}

/* ---- writing --------------------------------------------------------------------------------- */

static bool touches(const grobo_servo_register *reg, int address, size_t n)
{
    return reg->address + reg->bytes > address && reg->address < address + (int)n;
}

static int store(grobo_sim *sim, int index, int address, const uint8_t *bytes, size_t n)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const grobo_servo_register *reg;
    grobo_torque before = (grobo_torque)servo->plant.torque;
    bool moves = false;
    grobo_i_dxl_store(servo, address, bytes, n, true);
    for (size_t i = 0; (reg = grobo_servo_register_row(servo->model, i)) != NULL; i++) {
        if (touches(reg, address, n)) {
            moves = moves || reg->role == GROBO_ROLE_GOAL;
            grobo_i_dxl_tell(
                sim, index, reg,
                grobo_servo_register_get(servo->model, reg, &servo->reg[reg->address]));
        }
    }
    follow(sim, index);
    if (servo->plant.torque != before) {
        grobo_i_sim_torque(sim, index, before);
    } else if (moves && servo->plant.torque == GROBO_TORQUE_ON) {
        grobo_i_sim_set_out(sim, index);
    }
    return GROBO_OK;
}

/* A write is done whole, or refused. */
static uint8_t write(grobo_sim *sim, int index, int address, const uint8_t *bytes, size_t n)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    const grobo_servo_register *reg;
    bool good = n > 0 && address + (int)n <= grobo_i_dxl_end(servo);
    for (size_t i = 0; good && (reg = grobo_servo_register_row(servo->model, i)) != NULL; i++) {
        if (touches(reg, address, n)) {
            bool whole = reg->address >= address && reg->address + reg->bytes <= address + (int)n;
            int32_t value = whole ? grobo_i_dxl_value_in(servo, reg, address, bytes) : 0;
            good = whole && (reg->flags & GROBO_REGISTER_W) != 0 && value >= reg->min &&
                   value <= reg->max;
        }
    }
    if (!good) {
        grobo_i_sim_note(sim, GROBO_SIM_REFUSED, index, address);
        return ACME_REFUSED;
    }
    (void)store(sim, index, address, bytes, n);
    return 0;
}

/* ---- packets --------------------------------------------------------------------------------- */

static void answer(grobo_sim *sim, int index, grobo_i_dxl_round *round, uint8_t error,
                   const uint8_t *data, size_t n)
{
    uint8_t bytes[ACME_FRAME_MAX_BYTES];
    const grobo_sim_servo *servo = &sim->servo[index];
    int size = grobo_i_acme_answer(servo->plant.id, (uint8_t)(error | servo->status), data, n,
                                   bytes, sizeof bytes);
    if (size > 0) {
        grobo_i_dxl_answer(sim, index, round, bytes, (size_t)size);
    }
}

static void for_one(grobo_sim *sim, int index, const grobo_dxl2_packet *p)
{
    grobo_i_dxl_round round = {0};
    const grobo_sim_servo *servo = &sim->servo[index];
    if (p->instruction == GROBO_DXL2_READ) {
        bool there = p->length > 0 && p->address + p->length <= grobo_i_dxl_end(servo);
        refresh(sim, index);
        answer(sim, index, &round, there ? 0 : ACME_REFUSED, &servo->reg[p->address],
               there ? p->length : 0);
    } else if (p->instruction == GROBO_DXL2_WRITE) {
        answer(sim, index, &round, write(sim, index, p->address, p->data, p->data_bytes), NULL, 0);
    } else {
        answer(sim, index, &round, p->instruction == GROBO_DXL2_PING ? 0 : ACME_REFUSED, NULL, 0);
    }
}

/* All answer one after the other, by their ids. */
static void ping_all(grobo_sim *sim, const grobo_sim_event *raw)
{
    grobo_i_dxl_round round = {0};
    for (int id = 0; id <= ACME_ID_MAX; id++) {
        int i = grobo_i_dxl_hearer(sim, &grobo_i_sim_acme, (uint8_t)id, -1, raw);
        if (i >= 0) {
            answer(sim, i, &round, 0, NULL, 0);
        }
    }
}

static void sync_write(grobo_sim *sim, const grobo_dxl2_packet *p, const grobo_sim_event *raw)
{
    size_t each = 1 + (size_t)p->length;
    for (size_t at = 0; at + each <= p->data_bytes; at += each) {
        int i = grobo_i_dxl_hearer(sim, &grobo_i_sim_acme, p->data[at], -1, raw);
        if (i >= 0) {
            (void)write(sim, i, p->address, p->data + at + 1, p->length);
        }
    }
}

static void packet(const grobo_sim_family *self, grobo_sim *sim, const grobo_sim_event *raw)
{
    grobo_dxl2_packet p;
    if (grobo_i_acme_parse(raw->bytes, raw->n_bytes, NULL, 0, &p) < 0) {
        return;
    }
    if (p.id == GROBO_DXL2_ID_ALL && p.instruction == GROBO_DXL2_PING) {
        ping_all(sim, raw);
    } else if (p.id == GROBO_DXL2_ID_ALL && p.instruction == GROBO_DXL2_SYNC_WRITE) {
        sync_write(sim, &p, raw);
    } else if (p.id != GROBO_DXL2_ID_ALL) {
        int i = grobo_i_dxl_hearer(sim, self, p.id, -1, raw);
        if (i >= 0) {
            for_one(sim, i, &p);
        }
    }
}

static int measure(const uint8_t *bytes, size_t n, bool good)
{
    int size = grobo_i_acme_measure(bytes, n, GROBO_ACCEPT_COMMANDS);
    return size == GROBO_ERR_CHECKSUM && !good ? bytes[2] + 4 : size;
}

const grobo_sim_family grobo_i_sim_acme = {.usual_bps = 250000,
                                           .tables = {&grobo_i_acme_table},
                                           .measure = measure,
                                           .packet = packet,
                                           .factory = factory,
                                           .boot = restart,
                                           .cut = cut,
                                           .goal_mdeg = goal_mdeg,
                                           .refresh = refresh,
                                           .bps = bps,
                                           .store = store};
