/* SPDX-License-Identifier: MIT */
/* RS30x: registers, flash, and what packets do to them. */
#include <math.h>
#include <string.h>

#include <grobo/core/sim.h>

#include "src/base/bytes.h"
#include "src/model/joint.h"
#include "src/servo/families.h"
#include "src/servo/tables.h"
#include "src/sim/servo/family.h"
#include "src/sim/servo/note.h"
#include "src/sim/servo/power.h"
#include "src/sim/servo/registers.h"
#include "src/sim/servo/servo.h"
#include "src/sim/servo/shaft.h"

/* The alarm flag comes this much below the temperature limit. An assumption. */
#define ALARM_BELOW_LIMIT_C 10
/* Copper loss of RS301CR. An assumption (docs/simulator.md). */
#define HEAT_C_PER_MA2 8.5e-5

/* As far as register POSITION can tell. */
#define TURNS_MDEG 3276700

const grobo_servo_model *grobo_i_sim_rs30x_model(uint16_t number)
{
    const grobo_servo_model *model = grobo_servo_model_numbered(&grobo_i_rs30x_table, number);
    return model != NULL ? model : &grobo_i_rs30x_table.models[0];
}

/* Lacks what came with RS303MR: No.22, 23, 60-127, answers to all (manual of RS301CR/RS302CD). */
static bool is_early(const grobo_sim_servo *servo)
{
    return grobo_servo_register_at(servo->model, GROBO_RS30X_SILENCE_TORQUE) == NULL;
}

/* The register that an address begins or continues, if the servo has it. */
static const grobo_servo_register *row_at(const grobo_sim_servo *servo, int address)
{
    return grobo_servo_register_at(servo->model, (uint16_t)address);
}

/* Sets a register, to the end of its range where the value is beyond. */
static void hold(grobo_sim_servo *servo, int address, int64_t value)
{
    grobo_i_dxl_hold(servo, row_at(servo, address), value);
}

/* ---- the shaft's side ---------------------------------------------------------------------- */

/* A register of two bytes with a sign; the table knows of the others. These are read at each goal,
 * where looking them up takes most of the simulator's time. */
static int32_t wide(const grobo_sim_servo *servo, uint8_t address)
{
    return grobo_i_get_i16(&servo->reg[address]);
}

/* What is measured, in as many values as two bytes have, from `least` on. */
static void show(grobo_sim_servo *servo, uint8_t address, int64_t value, int64_t least)
{
    int64_t most = least + UINT16_MAX;
    int64_t shown = value < least ? least : value > most ? most : value;
    grobo_i_put_u16(&servo->reg[address], (uint16_t)(shown & UINT16_MAX));
}

static int32_t ddeg_of_mdeg(const grobo_sim_servo *servo, int32_t mdeg)
{
    int32_t ddeg = (mdeg < 0 ? mdeg - 50 : mdeg + 50) / 100;
    return servo->reg[GROBO_RS30X_REVERSE] ? -ddeg : ddeg;
}

/* The manuals give a speed as the time for 60 degrees, in hundredths of a second (0.11 s, 0.16 s);
 * the table has it rounded to degrees a second. */
static int32_t speed_mdeg_s(const grobo_servo_model *model)
{
    int32_t time_cs = (6000 + model->speed_dps / 2) / model->speed_dps;
    return (6000000 + time_cs / 2) / time_cs;
}

/* The plant after a change of registers. */
static void follow(grobo_sim_servo *servo)
{
    const grobo_servo_model *model = servo->model;
    int32_t goal_ddeg = wide(servo, GROBO_RS30X_GOAL);
    servo->plant = (grobo_sim_wants){
        .heat_c_per_ma2 = HEAT_C_PER_MA2,
        .goal_mdeg = (servo->reg[GROBO_RS30X_REVERSE] ? -goal_ddeg : goal_ddeg) * 100,
        .speed_mdeg_s = speed_mdeg_s(model),
        .stall_ma = model->current_ma,
        .most_ma = model->current_ma * servo->reg[GROBO_RS30X_MAX_TORQUE] / 100,
        .limit_c = wide(servo, GROBO_RS30X_TEMPERATURE_LIMIT),
        .nominal_mv = 7400,
        .torque = servo->reg[GROBO_RS30X_TORQUE],
        .id = servo->reg[GROBO_RS30X_ID]};
}

static void cut(grobo_sim *sim, int index, bool hot)
{
    grobo_sim_servo *servo = &sim->servo[index];
    servo->reg[GROBO_RS30X_TORQUE] = GROBO_TORQUE_OFF;
    servo->status |= hot ? GROBO_RS30X_STATUS_OVERHEATED : 0;
    follow(servo);
}

static bool starts(grobo_sim *sim, int index, int32_t here_mdeg)
{
    grobo_sim_servo *servo = &sim->servo[index];
    if (sim->config.jump_on_torque) {
        return true;
    }
    hold(servo, GROBO_RS30X_GOAL, ddeg_of_mdeg(servo, here_mdeg));
    follow(servo);
    return false;
}

static int32_t rate_of(const grobo_sim_servo *servo)
{
    return grobo_servo_baud_bps(servo->model, servo->reg[GROBO_RS30X_BAUD]);
}

static int32_t bps(const grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    return sim->config.baud_at_once ? rate_of(servo) : servo->baud_bps;
}

static void refresh(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_sim_settle(sim, index);
    int64_t now_us = sim->now_us;
    int32_t here_ddeg = ddeg_of_mdeg(servo, grobo_i_sim_angle_mdeg(servo, now_us));
    show(servo, GROBO_RS30X_POSITION, here_ddeg, INT16_MIN);
    show(servo, GROBO_RS30X_TIME, grobo_i_sim_move_age_us(servo, now_us) / 10000, 0);
    show(servo, GROBO_RS30X_SPEED, grobo_i_sim_speed_dps(servo, now_us), INT16_MIN);
    show(servo, GROBO_RS30X_CURRENT, grobo_i_sim_current_ma(servo, now_us), 0);
    show(servo, GROBO_RS30X_TEMPERATURE, lround(servo->temperature_c), INT16_MIN);
    show(servo, GROBO_RS30X_VOLTAGE, grobo_i_sim_supply_mv(sim) / 10, 0);
}

/* ---- flash --------------------------------------------------------------------------------- */

/* No.4-29 as they leave the factory. */
static void factory_block(grobo_sim_servo *servo)
{
    const grobo_servo_model *model = servo->model;
    const grobo_servo_register *reg;
    memset(&servo->reg[GROBO_RS30X_ID], 0, GROBO_SIM_FLASH_BYTES);
    for (size_t i = 0; (reg = grobo_servo_register_row(model, i)) != NULL; i++) {
        if (reg->address >= GROBO_RS30X_ID && (reg->flags & GROBO_REGISTER_KEPT) != 0) {
            grobo_i_dxl_hold(servo, reg, reg->factory);
        }
    }
}

static void to_flash(grobo_sim_servo *servo)
{
    memcpy(servo->flash, &servo->reg[GROBO_RS30X_ID], GROBO_SIM_FLASH_BYTES);
}

static bool factory(grobo_sim *sim, int index, uint8_t id, uint32_t baud_bps)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const grobo_servo_model *const *named = sim->config.servos;
    uint16_t number = named != NULL && named[index] != NULL
                          ? named[index]->number
                          : grobo_i_joint(sim->config.model, index)->servo_model;
    int code = grobo_servo_baud_code(servo->model, (int32_t)baud_bps);
    if (code < 0) {
        return false;
    }
    hold(servo, GROBO_RS30X_MODEL, number == 0 ? servo->model->number : number);
    hold(servo, GROBO_RS30X_FIRMWARE, servo->model->firmware);
    factory_block(servo);
    hold(servo, GROBO_RS30X_ID, id);
    hold(servo, GROBO_RS30X_BAUD, code);
    to_flash(servo);
    return true;
}

static void boot(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    memcpy(&servo->reg[GROBO_RS30X_ID], servo->flash, GROBO_SIM_FLASH_BYTES);
    servo->baud_bps = rate_of(servo);
    memset(&servo->reg[GROBO_RS30X_GOAL], 0, GROBO_REGISTERS - GROBO_RS30X_GOAL);
    hold(servo, GROBO_RS30X_MAX_TORQUE, row_at(servo, GROBO_RS30X_MAX_TORQUE)->factory);
    servo->status &= GROBO_RS30X_STATUS_FLASH_ERROR;
    follow(servo);
}

static void saved(grobo_sim *sim, int index, bool whole)
{
    grobo_sim_servo *servo = &sim->servo[index];
    if (whole) {
        to_flash(servo);
        servo->status &= (uint8_t)~GROBO_RS30X_STATUS_FLASH_ERROR;
    } else {
        servo->status |= GROBO_RS30X_STATUS_FLASH_ERROR;
    }
}

static bool flash_fits(const uint8_t *flash)
{
    /* The last model has all registers. */
    const grobo_servo_model *any = &grobo_i_rs30x_table.models[grobo_i_rs30x_table.model_count - 1];
    uint8_t registers[GROBO_REGISTERS] = {0};
    memcpy(&registers[GROBO_RS30X_ID], flash, GROBO_SIM_FLASH_BYTES);
    for (int a = GROBO_RS30X_ID; a < GROBO_RS30X_ID + GROBO_SIM_FLASH_BYTES; a++) {
        const grobo_servo_register *reg = grobo_servo_register_at(any, (uint16_t)a);
        int32_t value = reg == NULL ? registers[a]
                                    : grobo_servo_register_get(any, reg, &registers[reg->address]);
        if (value < (reg == NULL ? 0 : reg->min) || value > (reg == NULL ? 0 : reg->max)) {
            return false;
        }
    }
    return true;
}

/* ---- writing ------------------------------------------------------------------------------- */

static void tell(grobo_sim *sim, grobo_sim_event_kind kind, int index, int32_t value,
                 int32_t value2)
{
    if (sim->config.hook != NULL) { /* looked at first: this is done at each goal */
        grobo_i_sim_tell(sim, &(grobo_sim_event){.kind = kind,
                                                 .time_us = sim->now_us,
                                                 .servo = index,
                                                 .value = value,
                                                 .value2 = value2});
    }
}

static void goal_written(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    int32_t goal_ddeg = wide(servo, GROBO_RS30X_GOAL);
    int32_t time_cs = wide(servo, GROBO_RS30X_GOAL_TIME);
    if (servo->reg[GROBO_RS30X_TORQUE] == GROBO_TORQUE_ON) {
        servo->due_us = sim->now_us + (int64_t)time_cs * 10000;
        grobo_i_sim_drive(sim, index);
        servo->begun_us = sim->now_us;
    }
    tell(sim, GROBO_SIM_GOAL, index, goal_ddeg, time_cs);
}

/* Registers that take any value and make of it what they can (bend()), so that none is refused. */
static bool bends(const grobo_servo_register *reg)
{
    return reg->address == GROBO_RS30X_GOAL || reg->address == GROBO_RS30X_MAX_TORQUE ||
           reg->address == GROBO_RS30X_BAUD;
}

/* A goal outside of the limits is the limit. The manual on the others: over 100 % is 100 %, an
 * unknown rate is 115200 bps. */
static void bend(grobo_sim_servo *servo, const grobo_servo_register *reg)
{
    if (reg->address == GROBO_RS30X_GOAL) {
        int32_t goal_ddeg = wide(servo, GROBO_RS30X_GOAL);
        int32_t cw_ddeg = wide(servo, GROBO_RS30X_CW_LIMIT);
        int32_t ccw_ddeg = wide(servo, GROBO_RS30X_CCW_LIMIT);
        goal_ddeg = goal_ddeg > cw_ddeg ? cw_ddeg : goal_ddeg;
        goal_ddeg = goal_ddeg < ccw_ddeg ? ccw_ddeg : goal_ddeg;
        grobo_i_put_i16(&servo->reg[GROBO_RS30X_GOAL], (int16_t)goal_ddeg);
    } else if (reg->address == GROBO_RS30X_MAX_TORQUE) {
        hold(servo, GROBO_RS30X_MAX_TORQUE, servo->reg[GROBO_RS30X_MAX_TORQUE]);
    } else if (reg->address == GROBO_RS30X_BAUD && servo->reg[GROBO_RS30X_BAUD] > reg->max) {
        hold(servo, GROBO_RS30X_BAUD, GROBO_RS30X_BAUD_CODE_DEFAULT);
    }
}

/* Lets a register's new value take effect; `before`: its bytes till now. */
static void took_effect(grobo_sim *sim, int index, const grobo_servo_model *model,
                        const grobo_servo_register *reg, const uint8_t *before)
{
    grobo_sim_servo *servo = &sim->servo[index];
    if (reg->address == GROBO_RS30X_GOAL) {
        goal_written(sim, index);
        return;
    }
    if (reg->address == GROBO_RS30X_TORQUE) {
        servo->status &= (uint8_t)~GROBO_RS30X_STATUS_OVERHEATED;
        grobo_i_sim_torque(sim, index, (grobo_torque)*before);
        return;
    }
    if (reg->address == GROBO_RS30X_REVERSE && servo->reg[GROBO_RS30X_REVERSE] != *before) {
        hold(servo, GROBO_RS30X_GOAL, -wide(servo, GROBO_RS30X_GOAL));
        follow(servo);
    }
    if (sim->config.hook != NULL) {
        tell(sim, GROBO_SIM_REGISTER, index, reg->address,
             grobo_servo_register_get(model, reg, &servo->reg[reg->address]));
    }
}

enum { REGISTER_BYTES_MAX = 4 };

/* What writes of a packet hit: registers of a model, found once. Bytes of none are reserved, and
 * may be written. */
typedef struct hits {
    const grobo_servo_model *model; /* NULL: not looked for yet */
    const grobo_servo_register *reg[GROBO_REGISTERS];
    int n;
} hits;

static void find_hits(const grobo_sim_servo *servo, int address, size_t n, hits *hit)
{
    const grobo_servo_model *model = servo->model;
    if (hit->model == model) {
        return;
    }
    hit->model = model;
    hit->n = 0;
    for (int a = address; a < address + (int)n;) {
        const grobo_servo_register *reg = grobo_servo_register_at(hit->model, (uint16_t)a);
        a = reg == NULL ? a + 1 : reg->address + reg->bytes;
        if (reg != NULL) {
            hit->reg[hit->n++] = reg;
        }
    }
}

/* True if every register hit may be written and every value is in range. */
static bool may_write(const grobo_sim_servo *servo, const hits *hit, int address,
                      const uint8_t *bytes, size_t n)
{
    const int end = address + (int)n;
    for (int i = 0; i < hit->n; i++) {
        const grobo_servo_register *reg = hit->reg[i];
        if ((reg->flags & GROBO_REGISTER_W) == 0) {
            return false;
        }
        if (!bends(reg)) {
            uint8_t after[REGISTER_BYTES_MAX];
            for (int k = 0; k < reg->bytes; k++) { /* a write may hit a part of it */
                int at = reg->address + k;
                after[k] = at >= address && at < end ? bytes[at - address] : servo->reg[at];
            }
            int32_t value = grobo_servo_register_get(hit->model, reg, after);
            if (value < reg->min || value > reg->max) {
                return false;
            }
        }
    }
    return true;
}

static void store(grobo_sim *sim, int index, const hits *hit, int address, const uint8_t *bytes,
                  size_t n)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const int end = address + (int)n;
    uint8_t before[GROBO_REGISTERS];
    memcpy(before, servo->reg, sizeof before);
    for (int i = 0; i < hit->n; i++) {
        const grobo_servo_register *reg = hit->reg[i];
        int from = reg->address > address ? reg->address : address;
        int to = reg->address + reg->bytes < end ? reg->address + reg->bytes : end;
        for (int a = from; a < to; a++) {
            servo->reg[a] = bytes[a - address];
        }
    }
    for (int i = 0; i < hit->n; i++) {
        if (bends(hit->reg[i])) {
            bend(servo, hit->reg[i]);
        }
    }
    follow(servo);
    for (int i = 0; i < hit->n; i++) {
        const grobo_servo_register *reg = hit->reg[i];
        took_effect(sim, index, hit->model, reg, &before[reg->address]);
    }
}

/* All writes of a packet have one address and length. */
static bool write(grobo_sim *sim, int index, hits *hit, int address, const uint8_t *bytes, size_t n)
{
    grobo_sim_servo *servo = &sim->servo[index];
    if (address + (int)n <= GROBO_REGISTERS) {
        find_hits(servo, address, n, hit);
        if (may_write(servo, hit, address, bytes, n)) {
            store(sim, index, hit, address, bytes, n);
            return true;
        }
    }
    servo->status |= GROBO_RS30X_STATUS_REFUSED;
    grobo_i_sim_note(sim, GROBO_SIM_REFUSED, index, address);
    return false;
}

/* ---- packets ------------------------------------------------------------------------------- */

static uint8_t status_flags(const grobo_sim_servo *servo)
{
    int32_t limit_c = wide(servo, GROBO_RS30X_TEMPERATURE_LIMIT);
    bool hot = servo->temperature_c >= limit_c - ALARM_BELOW_LIMIT_C;
    return (uint8_t)(servo->status | (hot ? GROBO_RS30X_STATUS_HOT : 0));
}

static int64_t delay_ns(const grobo_sim_servo *servo)
{
    return (int64_t)GROBO_RS30X_DELAY_US(servo->reg[GROBO_RS30X_DELAY]) * 1000;
}

static void speak_registers(grobo_sim *sim, int index, const grobo_reply *want)
{
    grobo_sim_servo *servo = &sim->servo[index];
    uint8_t bytes[GROBO_REPLY_MAX_BYTES];
    refresh(sim, index);
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
        grobo_i_sim_speak(sim, index, bytes, (size_t)n, delay_ns(servo));
    }
}

/* Later models take a question to all as one to themselves; docs/simulator.md says who knows. */
static int wanted(const grobo_sim_servo *servo, const grobo_sim_event *raw, grobo_reply *want)
{
    uint8_t own[GROBO_RS30X_PACKET_MAX_BYTES];
    uint8_t id = servo->reg[GROBO_RS30X_ID];
    if (raw->bytes[2] != GROBO_RS30X_ID_ALL || is_early(servo)) {
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
    bool lacks = (raw->bytes[3] & 0xF) == GROBO_RS30X_WANT_60_127 && is_early(servo);
    if (result < 0 || lacks) {
        servo->status |= GROBO_RS30X_STATUS_REFUSED;
        grobo_i_sim_note(sim, GROBO_SIM_REFUSED, index, raw->bytes[4]);
    } else if (want.kind == GROBO_REPLY_RETURN) {
        speak_registers(sim, index, &want);
    } else if (want.kind == GROBO_REPLY_ACK && (done || sim->config.nack)) {
        uint8_t byte = done ? GROBO_RS30X_ACK : GROBO_RS30X_NACK;
        grobo_i_sim_speak(sim, index, &byte, 1, delay_ns(servo));
    }
}

static void command(grobo_sim *sim, int index, uint8_t flags)
{
    bool reboots = (flags & GROBO_RS30X_REBOOT) != 0;
    if (flags & GROBO_RS30X_FACTORY) {
        factory_block(&sim->servo[index]);
        follow(&sim->servo[index]);
        grobo_i_sim_save(sim, index, false);
    } else if (flags & GROBO_RS30X_FLASH) {
        grobo_i_sim_save(sim, index, reboots);
    } else if (reboots) {
        grobo_i_sim_reboot(sim, index);
    }
}

static void short_packet(grobo_sim *sim, int index, const grobo_rs30x_packet *packet,
                         const grobo_sim_event *raw, hits *hit)
{
    bool done = true;
    if (packet->count == 1 && packet->data_bytes > 0 && packet->address < GROBO_REGISTERS) {
        done = write(sim, index, hit, packet->address, packet->data, packet->data_bytes);
    }
    answer(sim, index, raw, done);
    command(sim, index, packet->flags);
}

/* The ids that a packet speaks to. */
typedef struct spoken_to {
    uint8_t
        first[UINT8_MAX + 1]; /* by id, the number of the first part that does, from 1; 0: none */
    bool twice;               /* more than one part speaks to one of them */
} spoken_to;

static void note_ids(const grobo_rs30x_packet *packet, spoken_to *ids)
{
    bool all = packet->kind == GROBO_RS30X_SHORT && packet->id == GROBO_RS30X_ID_ALL;
    memset(ids->first, all, sizeof ids->first);
    ids->twice = false;
    if (packet->kind == GROBO_RS30X_SHORT) {
        ids->first[packet->id] = 1;
        return;
    }
    for (size_t i = packet->count; i > 0; i--) {
        uint8_t *first = &ids->first[packet->data[(i - 1) * packet->length]];
        ids->twice = ids->twice || *first != 0;
        *first = (uint8_t)i;
    }
}

static void long_packet(grobo_sim *sim, int index, const grobo_rs30x_packet *packet,
                        const spoken_to *ids, hits *hit)
{
    uint8_t id = sim->servo[index].reg[GROBO_RS30X_ID];
    size_t end = ids->twice ? packet->count : ids->first[id];
    for (size_t i = ids->first[id] - 1u; i < end; i++) {
        const uint8_t *part = packet->data + i * packet->length;
        if (part[0] == id) {
            (void)write(sim, index, hit, packet->address, part + 1, packet->length - 1u);
        }
    }
}

static void packet(const grobo_sim_family *self, grobo_sim *sim, const grobo_sim_event *raw)
{
    grobo_rs30x_packet parts;
    bool sum_ok;
    spoken_to ids;
    hits hit = {.model = NULL, .n = 0};
    (void)grobo_rs30x_peek(raw->bytes, raw->n_bytes, GROBO_ACCEPT_COMMANDS, &parts, &sum_ok);
    note_ids(&parts, &ids);
    for (int i = 0; i < sim->n_servos; i++) {
        grobo_sim_servo *servo = &sim->servo[i];
        if (servo->family != self || ids.first[servo->reg[GROBO_RS30X_ID]] == 0 ||
            !grobo_i_sim_hears(sim, i, raw)) {
            continue;
        }
        if (parts.kind == GROBO_RS30X_SHORT) {
            short_packet(sim, i, &parts, raw, &hit);
        } else {
            long_packet(sim, i, &parts, &ids, &hit);
        }
    }
}

static int measure(const uint8_t *bytes, size_t n, bool good)
{
    grobo_rs30x_packet parts;
    bool sum_ok = true;
    int size = grobo_rs30x_peek(bytes, n, GROBO_ACCEPT_COMMANDS, &parts, &sum_ok);
    return size > 0 && good && !sum_ok ? GROBO_ERR_CHECKSUM : size;
}

/* ---- inspection ---------------------------------------------------------------------------- */

static const grobo_servo_register *register_from(const grobo_sim_servo *servo, int address)
{
    if (address < 0 || address >= GROBO_REGISTERS) {
        return NULL;
    }
    const grobo_servo_register *reg = row_at(servo, address);
    return reg != NULL && reg->address == address ? reg : NULL;
}

static int set(grobo_sim *sim, int index, int address, int32_t value)
{
    const grobo_servo_register *reg = register_from(&sim->servo[index], address);
    if (reg == NULL || reg->flags == 0) {
        return GROBO_ERR_ARG; /* what is measured */
    }
    uint8_t bytes[2];
    int n = grobo_servo_register_put(sim->servo[index].model, reg, value, bytes);
    if (n < 0) {
        return n;
    }
    hits hit = {.model = NULL, .n = 0};
    find_hits(&sim->servo[index], address, (size_t)n, &hit);
    store(sim, index, &hit, address, bytes, (size_t)n);
    return 0;
}

const grobo_sim_family grobo_i_sim_rs30x = {.usual_bps = 115200,
                                            .tables = {&grobo_i_rs30x_table},
                                            .turns_mdeg = TURNS_MDEG,
                                            .measure = measure,
                                            .packet = packet,
                                            .factory = factory,
                                            .boot = boot,
                                            .saved = saved,
                                            .cut = cut,
                                            .starts = starts,
                                            .refresh = refresh,
                                            .bps = bps,
                                            .set = set,
                                            .flash_fits = flash_fits};

const grobo_sim_family *grobo_sim_rs30x(void)
{
    return &grobo_i_sim_rs30x;
}
