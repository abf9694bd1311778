/* SPDX-License-Identifier: MIT */
/* A servo's registers and what packets do to them. */
#include <math.h>
#include <string.h>

#include "src/sim/fault.h"
#include "src/sim/note.h"
#include "src/sim/power.h"
#include "src/sim/registers.h"
#include "src/sim/servo.h"
#include "src/sim/shaft.h"
#include "src/sim/talk.h"

/* The alarm flag comes this much below the temperature limit. An assumption. */
#define ALARM_BELOW_LIMIT_C 10
/* Resistance of battery and wires: the supply sags by it. An assumption. */
#define SUPPLY_MOHM 100

bool grobo_i_sim_deaf(const grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    return !servo->powered || servo->cable != GROBO_SIM_CABLE_IN ||
           sim->now_us < servo->deaf_until_us;
}

int32_t grobo_i_sim_bps(const grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    return sim->config.baud_at_once ? grobo_rs30x_baud_bps(servo->reg[GROBO_RS30X_BAUD])
                                    : servo->baud_bps;
}

static bool hears(const grobo_sim *sim, int index)
{
    int32_t bps = grobo_i_sim_bps(sim, index);
    return !grobo_i_sim_deaf(sim, index) && bps > 0 && (uint32_t)bps == sim->bus_bps;
}

/* ---- reading ------------------------------------------------------------------------------- */

static int32_t supply_mv(const grobo_sim *sim)
{
    int64_t total_ma = 0;
    for (int i = 0; i < sim->n_servos; i++) {
        total_ma += grobo_i_sim_current_ma(&sim->servo[i], sim->now_us);
    }
    int64_t mv = (int64_t)sim->supply_mv - total_ma * SUPPLY_MOHM / 1000;
    return mv > 0 ? (int32_t)mv : 0;
}

void grobo_i_sim_refresh(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_sim_settle(sim, index);
    int64_t now_us = sim->now_us;
    int32_t here_ddeg = grobo_i_sim_ddeg(servo, grobo_i_sim_angle_mdeg(servo, now_us));
    grobo_i_sim_hold(servo, GROBO_RS30X_POSITION, here_ddeg);
    grobo_i_sim_hold(servo, GROBO_RS30X_TIME, grobo_i_sim_move_age_us(servo, now_us) / 10000);
    grobo_i_sim_hold(servo, GROBO_RS30X_SPEED, grobo_i_sim_speed_dps(servo, now_us));
    grobo_i_sim_hold(servo, GROBO_RS30X_CURRENT, grobo_i_sim_current_ma(servo, now_us));
    grobo_i_sim_hold(servo, GROBO_RS30X_TEMPERATURE, lround(servo->temperature_c));
    grobo_i_sim_hold(servo, GROBO_RS30X_VOLTAGE, supply_mv(sim) / 10);
}

/* ---- writing ------------------------------------------------------------------------------- */

static void goal_written(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    int32_t goal_ddeg = grobo_i_sim_value(servo, GROBO_RS30X_GOAL);
    int32_t cw_ddeg = grobo_i_sim_value(servo, GROBO_RS30X_CW_LIMIT);
    int32_t ccw_ddeg = grobo_i_sim_value(servo, GROBO_RS30X_CCW_LIMIT);
    goal_ddeg = goal_ddeg > cw_ddeg ? cw_ddeg : goal_ddeg;
    goal_ddeg = goal_ddeg < ccw_ddeg ? ccw_ddeg : goal_ddeg;
    grobo_i_sim_hold(servo, GROBO_RS30X_GOAL, goal_ddeg);
    int32_t time_cs = grobo_i_sim_value(servo, GROBO_RS30X_GOAL_TIME);
    if (servo->reg[GROBO_RS30X_TORQUE] == GROBO_TORQUE_ON) {
        servo->due_us = sim->now_us + (int64_t)time_cs * 10000;
        grobo_i_sim_drive(sim, index);
        servo->begun_us = sim->now_us;
    }
    grobo_i_sim_tell(sim, &(grobo_sim_event){.kind = GROBO_SIM_GOAL,
                                             .time_us = sim->now_us,
                                             .servo = index,
                                             .value = goal_ddeg,
                                             .value2 = time_cs});
}

/* Registers that take any value and make of it what they can, so that none is refused. */
static bool bends(const grobo_rs30x_register *reg)
{
    return reg->address == GROBO_RS30X_GOAL || reg->address == GROBO_RS30X_MAX_TORQUE ||
           reg->address == GROBO_RS30X_BAUD;
}

/* The manual on those beside the goal: over 100 % is 100 %, an unknown rate is 115200 bps. */
static void bend(grobo_sim_servo *servo, const grobo_rs30x_register *reg)
{
    int32_t value = grobo_i_sim_value(servo, reg->address);
    if (reg->address == GROBO_RS30X_MAX_TORQUE) {
        grobo_i_sim_hold(servo, GROBO_RS30X_MAX_TORQUE, value);
    } else if (reg->address == GROBO_RS30X_BAUD && value > reg->max) {
        grobo_i_sim_hold(servo, GROBO_RS30X_BAUD, GROBO_RS30X_BAUD_CODE_DEFAULT);
    }
}

/* Lets a register's new value take effect. */
static void took_effect(grobo_sim *sim, int index, const grobo_rs30x_register *reg, int32_t before)
{
    grobo_sim_servo *servo = &sim->servo[index];
    bend(servo, reg);
    int32_t value = grobo_i_sim_value(servo, reg->address);
    if (reg->address == GROBO_RS30X_GOAL) {
        goal_written(sim, index);
        return;
    }
    if (reg->address == GROBO_RS30X_TORQUE) {
        servo->status &= (uint8_t)~GROBO_RS30X_STATUS_OVERHEATED;
        grobo_i_sim_torque(sim, index, (grobo_torque)before);
        return;
    }
    if (reg->address == GROBO_RS30X_REVERSE && value != before) {
        grobo_i_sim_hold(servo, GROBO_RS30X_GOAL, -grobo_i_sim_value(servo, GROBO_RS30X_GOAL));
    }
    grobo_i_sim_tell(sim, &(grobo_sim_event){.kind = GROBO_SIM_REGISTER,
                                             .time_us = sim->now_us,
                                             .servo = index,
                                             .value = reg->address,
                                             .value2 = value});
}

/* The row of the table that an address begins or continues, if the servo has it. */
static const grobo_rs30x_register *row_at(const grobo_sim_servo *servo, int address)
{
    const grobo_rs30x_register *reg = grobo_rs30x_register_at((uint8_t)address);
    bool lacks = address == GROBO_RS30X_SILENCE_TORQUE || address == GROBO_RS30X_WARM_UP_TIME;
    return lacks && grobo_i_sim_type_of(servo)->early ? NULL : reg;
}

/* True if every register hit may be written and every value is in range. Reserved ones may. */
static bool may_write(const grobo_sim_servo *servo, int address, const uint8_t *bytes, size_t n)
{
    uint8_t after[GROBO_REGISTERS];
    if (address + (int)n > GROBO_REGISTERS) {
        return false;
    }
    memcpy(after, servo->reg, sizeof after);
    memcpy(&after[address], bytes, n);
    for (int a = address; a < address + (int)n; a++) {
        const grobo_rs30x_register *reg = row_at(servo, a);
        if (reg == NULL) {
            continue;
        }
        int32_t value = grobo_rs30x_register_get(reg, &after[reg->address]);
        if (reg->access != GROBO_RS30X_ACCESS_RW ||
            (!bends(reg) && (value < reg->min || value > reg->max))) {
            return false;
        }
    }
    return true;
}

void grobo_i_sim_store(grobo_sim *sim, int index, int address, const uint8_t *bytes, size_t n)
{
    grobo_sim_servo *servo = &sim->servo[index];
    uint8_t before[GROBO_REGISTERS];
    memcpy(before, servo->reg, sizeof before);
    for (size_t i = 0; i < n; i++) {
        if (row_at(servo, address + (int)i) != NULL) {
            servo->reg[address + (int)i] = bytes[i];
        }
    }
    for (int a = address; a < address + (int)n; a++) {
        const grobo_rs30x_register *reg = row_at(servo, a);
        bool told = reg != NULL && reg->address != a && a > address;
        if (reg != NULL && !told) {
            took_effect(sim, index, reg, grobo_rs30x_register_get(reg, &before[reg->address]));
        }
    }
}

static bool write(grobo_sim *sim, int index, int address, const uint8_t *bytes, size_t n)
{
    grobo_sim_servo *servo = &sim->servo[index];
    if (may_write(servo, address, bytes, n)) {
        grobo_i_sim_store(sim, index, address, bytes, n);
        return true;
    }
    servo->status |= GROBO_RS30X_STATUS_REFUSED;
    grobo_i_sim_note(sim, GROBO_SIM_REFUSED, index, address);
    return false;
}

/* ---- packets ------------------------------------------------------------------------------- */

/* The servos' own replies go straight to the bus; on its way to the host a reply may suffer. */
static void speak(grobo_sim *sim, int index, uint8_t *bytes, size_t n)
{
    uint8_t delay = sim->servo[index].reg[GROBO_RS30X_DELAY];
    int64_t start_ns = sim->now_ns + (int64_t)GROBO_RS30X_DELAY_US(delay) * 1000;
    if (grobo_i_sim_strikes(sim, GROBO_SIM_FAULT_DUPLICATE_ID, index)) {
        for (size_t i = n > 1 ? 2 : 0; i < n; i++) {
            bytes[i] &= (uint8_t)grobo_i_sim_random(sim, GROBO_SIM_FAULT_DUPLICATE_ID, 256);
        }
    }
    if (sim->config.wiring == GROBO_WIRING_BOARD) {
        grobo_i_sim_talk(sim, bytes, n, start_ns);
        return;
    }
    const grobo_sim_event reply = {.kind = GROBO_SIM_REPLY,
                                   .time_us = grobo_i_sim_us(start_ns),
                                   .servo = index,
                                   .bytes = bytes,
                                   .n_bytes = n};
    grobo_i_sim_reply(sim, &reply, start_ns, grobo_i_sim_talk);
}

static uint8_t status_flags(const grobo_sim_servo *servo)
{
    int32_t limit_c = grobo_i_sim_value(servo, GROBO_RS30X_TEMPERATURE_LIMIT);
    bool hot = servo->temperature_c >= limit_c - ALARM_BELOW_LIMIT_C;
    return (uint8_t)(servo->status | (hot ? GROBO_RS30X_STATUS_HOT : 0));
}

static void speak_registers(grobo_sim *sim, int index, const grobo_reply *want)
{
    grobo_sim_servo *servo = &sim->servo[index];
    uint8_t bytes[GROBO_REPLY_MAX_BYTES];
    grobo_i_sim_refresh(sim, index);
    const grobo_rs30x_packet packet = {.kind = GROBO_RS30X_RETURN,
                                       .id = servo->reg[GROBO_RS30X_ID],
                                       .flags = status_flags(servo),
                                       .address = (uint8_t)want->address,
                                       .length = (uint8_t)want->length,
                                       .count = 1,
                                       .data = &servo->reg[want->address],
                                       .data_bytes = want->length};
    int n = grobo_rs30x_build(&packet, bytes, sizeof bytes);
    servo->status &= (uint8_t)~GROBO_RS30X_STATUS_REFUSED;
    if (n > 0) {
        speak(sim, index, bytes, (size_t)n);
    }
}

/* Later models take a question to all as one to themselves; docs/simulator.md says who knows. */
static int wanted(const grobo_sim_servo *servo, const grobo_sim_event *raw, grobo_reply *want)
{
    uint8_t own[GROBO_RS30X_PACKET_MAX_BYTES];
    uint8_t id = servo->reg[GROBO_RS30X_ID];
    if (grobo_i_sim_type_of(servo)->early || raw->bytes[2] != GROBO_RS30X_ID_ALL) {
        return grobo_rs30x_reply_to(raw->bytes, raw->n_bytes, want);
    }
    memcpy(own, raw->bytes, raw->n_bytes);
    own[2] = id;
    own[raw->n_bytes - 1] ^= GROBO_RS30X_ID_ALL ^ id;
    return grobo_rs30x_reply_to(own, raw->n_bytes, want);
}

static void answer(grobo_sim *sim, int index, const grobo_sim_event *raw, bool done)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_reply want;
    int result = wanted(servo, raw, &want);
    bool lacks =
        (raw->bytes[3] & 0xF) == GROBO_RS30X_WANT_60_127 && grobo_i_sim_type_of(servo)->early;
    if (result < 0 || lacks) {
        servo->status |= GROBO_RS30X_STATUS_REFUSED;
        grobo_i_sim_note(sim, GROBO_SIM_REFUSED, index, raw->bytes[4]);
    } else if (want.kind == GROBO_REPLY_RETURN) {
        speak_registers(sim, index, &want);
    } else if (want.kind == GROBO_REPLY_ACK && (done || sim->config.nack)) {
        uint8_t byte = done ? GROBO_RS30X_ACK : GROBO_RS30X_NACK;
        speak(sim, index, &byte, 1);
    }
}

static void command(grobo_sim *sim, int index, uint8_t flags)
{
    bool reboots = (flags & GROBO_RS30X_REBOOT) != 0;
    if (flags & GROBO_RS30X_FACTORY) {
        grobo_i_sim_reset(sim, index);
    } else if (flags & GROBO_RS30X_FLASH) {
        grobo_i_sim_save(sim, index, reboots);
    } else if (reboots) {
        grobo_i_sim_reboot(sim, index);
    }
}

static void short_packet(grobo_sim *sim, int index, const grobo_rs30x_packet *packet,
                         const grobo_sim_event *raw)
{
    bool done = true;
    if (packet->count == 1 && packet->data_bytes > 0 && packet->address < GROBO_REGISTERS) {
        done = write(sim, index, packet->address, packet->data, packet->data_bytes);
    }
    answer(sim, index, raw, done);
    command(sim, index, packet->flags);
}

static void long_packet(grobo_sim *sim, int index, const grobo_rs30x_packet *packet)
{
    uint8_t id = sim->servo[index].reg[GROBO_RS30X_ID];
    for (size_t i = 0; i < packet->count; i++) {
        const uint8_t *part = packet->data + i * packet->length;
        if (part[0] == id) {
            (void)write(sim, index, packet->address, part + 1, packet->length - 1u);
        }
    }
}

static bool speaks_to(const grobo_rs30x_packet *packet, uint8_t id)
{
    if (packet->kind == GROBO_RS30X_SHORT) {
        return packet->id == id || packet->id == GROBO_RS30X_ID_ALL;
    }
    for (size_t i = 0; i < packet->count; i++) {
        if (packet->data[i * packet->length] == id) {
            return true;
        }
    }
    return false;
}

/* A servo that does something else for a while misses what it is told. */
static void note_missed(grobo_sim *sim, int index, const grobo_sim_event *raw)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    if (sim->now_us < servo->deaf_until_us && servo->powered &&
        servo->cable == GROBO_SIM_CABLE_IN) {
        grobo_sim_event missed = *raw;
        missed.kind = GROBO_SIM_MISSED;
        missed.servo = index;
        missed.value =
            servo->saved_us != GROBO_NEVER_US ? GROBO_SIM_BUSY_FLASH : GROBO_SIM_BUSY_REBOOT;
        grobo_i_sim_tell(sim, &missed);
    }
}

void grobo_i_sim_packet(grobo_sim *sim, const grobo_rs30x_packet *packet,
                        const grobo_sim_event *raw)
{
    for (int i = 0; i < sim->n_servos; i++) {
        if (!speaks_to(packet, sim->servo[i].reg[GROBO_RS30X_ID])) {
            continue;
        }
        grobo_i_sim_settle(sim, i);
        note_missed(sim, i, raw);
        if (!hears(sim, i) || grobo_i_sim_strikes(sim, GROBO_SIM_FAULT_SILENT, i)) {
            continue;
        }
        if (packet->kind == GROBO_RS30X_SHORT) {
            short_packet(sim, i, packet, raw);
        } else {
            long_packet(sim, i, packet);
        }
    }
}
