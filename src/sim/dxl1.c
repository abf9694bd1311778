/* SPDX-License-Identifier: MIT */
/*
 * AX and MX of DYNAMIXEL, STS and SCS of Feetech: what packets of Protocol 1.0 do to their
 * registers. The frame is one, so one ear hears for all; series differ by what `series` says.
 */
#include <math.h>
#include <string.h>

#include <grobo/feetech.h>
#include <grobo/protocol.h>

#include "src/base/bytes.h"
#include "src/sim/dxl.h"
#include "src/sim/family.h"
#include "src/sim/note.h"
#include "src/sim/power.h"
#include "src/sim/servo.h"
#include "src/sim/shaft.h"

/* How long AX and MX bear a stall. An assumption. */
#define AX_OVERLOAD_US 1000000
#define AX_OVERLOAD_EFFORT 0.8
#define STS_COUNT_MA 6.5
#define MX_COUNT_MA 4.5
#define COUNT_MV 100
#define LOCK_CLOSED 1

typedef enum dxl1_series { AX, MX, STS, SCS } dxl1_series;

static dxl1_series series_of(const grobo_sim_servo *servo)
{
    if (servo->model->table == &grobo_sts_table) {
        return STS;
    }
    if (servo->model->table == &grobo_scs_table) {
        return SCS;
    }
    return servo->model->span_deg == 360 ? MX : AX;
}

static bool is_feetech(const grobo_sim_servo *servo)
{
    return servo->model->table != &grobo_dxl1_table;
}

static int32_t named(const grobo_sim_servo *servo, const char *name)
{
    const grobo_servo_register *reg = grobo_i_dxl_row(servo, name);
    return grobo_servo_register_get(servo->model, reg, &servo->reg[reg->address]);
}

static bool both_limits_are(const grobo_sim_servo *servo, int32_t value)
{
    return grobo_i_dxl_get(servo, GROBO_ROLE_MIN_POSITION) == value &&
           grobo_i_dxl_get(servo, GROBO_ROLE_MAX_POSITION) == value;
}

/* ---- units --------------------------------------------------------------------------------- */

/* What a count of speed is worth. */
static double speed_mdeg_s(const grobo_sim_servo *servo)
{
    double tick_mdeg = grobo_i_dxl_tick_mdeg(servo);
    switch (series_of(servo)) {
    case AX:
        return 0.111 * 6000;
    case MX:
        return 0.114 * 6000;
    case STS:
        return (named(servo, "phase") & (int)GROBO_STS_PHASE_FINE_SPEED) != 0 ? tick_mdeg
                                                                              : 50 * tick_mdeg;
    case SCS:
        break;
    }
    return tick_mdeg;
}

static double accel_mdeg_s2(const grobo_sim_servo *servo)
{
    return series_of(servo) == STS ? 100 * grobo_i_dxl_tick_mdeg(servo) : 8583;
}

static double count_ma(const grobo_sim_servo *servo)
{
    return series_of(servo) == STS ? STS_COUNT_MA : 0;
}

static int32_t rate_of(const grobo_sim_servo *servo, int32_t code)
{
    int32_t listed_bps = grobo_servo_baud_bps(servo->model, code);
    bool formula = listed_bps < 0 && !is_feetech(servo) && code < 250;
    return formula ? 2000000 / (code + 1) : listed_bps;
}

/* ---- positions ----------------------------------------------------------------------------- */

static bool reverses(const grobo_sim_servo *servo)
{
    return (grobo_i_dxl_get(servo, GROBO_ROLE_DIRECTION) & 1) != 0;
}

static bool counts_turns(const grobo_sim_servo *servo)
{
    switch (series_of(servo)) {
    case STS:
        return (named(servo, "phase") & (int)GROBO_STS_PHASE_TURNS) != 0 ||
               both_limits_are(servo, 0);
    case MX:
        return both_limits_are(servo, 4095);
    case AX:
    case SCS:
        break;
    }
    return true; /* these do not turn around: positions end at the ends of their range */
}

static int32_t position_at(const grobo_sim_servo *servo, int32_t angle_mdeg)
{
    int32_t ticks = grobo_i_dxl_ticks(servo, reverses(servo), angle_mdeg);
    int32_t turn = grobo_i_dxl_turn(servo);
    int32_t offset = grobo_i_dxl_get(servo, GROBO_ROLE_OFFSET);
    if (is_feetech(servo)) {
        ticks -= offset;
    } else if (counts_turns(servo)) { /* of MX; else it means nothing */
        ticks += offset;
    }
    if (turn == 0 && reverses(servo)) {
        ticks += 2 * servo->model->middle;
    }
    if (turn > 0 && !counts_turns(servo)) {
        return grobo_i_dxl_wrap(ticks, turn);
    }
    return ticks - servo->turns_ticks;
}

static int32_t within_limits(const grobo_sim_servo *servo, int32_t goal)
{
    bool bounds = is_feetech(servo) && grobo_i_dxl_get(servo, GROBO_ROLE_MIN_POSITION) <
                                           grobo_i_dxl_get(servo, GROBO_ROLE_MAX_POSITION);
    return bounds ? grobo_i_dxl_within(servo, goal) : goal;
}

static int32_t goal_mdeg(const grobo_sim *sim, const grobo_sim_servo *servo)
{
    int32_t here_mdeg = grobo_i_sim_angle_mdeg(servo, sim->now_us);
    int32_t goal = within_limits(servo, grobo_i_dxl_get(servo, GROBO_ROLE_GOAL));
    int32_t way = goal - position_at(servo, here_mdeg);
    if (series_of(servo) == STS && grobo_i_dxl_get(servo, GROBO_ROLE_MODE) == GROBO_STS_MODE_STEP) {
        way = grobo_i_dxl_get(servo, GROBO_ROLE_GOAL);
    }
    int32_t ticks = grobo_i_dxl_ticks(servo, false, here_mdeg) + (reverses(servo) ? -way : way);
    return (int32_t)lround((ticks - servo->model->middle) * grobo_i_dxl_tick_mdeg(servo));
}

/* ---- the shaft's side ---------------------------------------------------------------------- */

/* Sign and magnitude with the sign in bit 10. */
static int32_t bit10(int32_t raw)
{
    return (raw & 0x400) != 0 ? -(raw & 0x3FF) : raw & 0x3FF;
}

/* Whether it turns on and on, and the part of its top speed at which it then does. */
static bool is_wheel(const grobo_sim_servo *servo, double *speed)
{
    double top = servo->plant.speed_mdeg_s;
    int32_t mode = grobo_i_dxl_get(servo, GROBO_ROLE_MODE);
    switch (series_of(servo)) {
    case AX:
        *speed = top * bit10(grobo_i_dxl_get(servo, GROBO_ROLE_SPEED)) / 1023;
        return both_limits_are(servo, 0);
    case MX:
        *speed = speed_mdeg_s(servo) * bit10(grobo_i_dxl_get(servo, GROBO_ROLE_SPEED));
        return both_limits_are(servo, 0);
    case STS:
        *speed = mode == GROBO_STS_MODE_PWM
                     ? top * grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_PWM) / 1000
                     : speed_mdeg_s(servo) * grobo_i_dxl_get(servo, GROBO_ROLE_SPEED);
        return mode == GROBO_STS_MODE_SPEED || mode == GROBO_STS_MODE_PWM;
    case SCS:
        *speed = top * bit10(grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_TIME)) / 1023;
        return both_limits_are(servo, 0);
    }
    return false;
}

/* A move: by time (SCS without a speed), or by speed and acceleration. */
static void follow_move(grobo_sim_servo *servo)
{
    grobo_sim_plant *plant = &servo->plant;
    int32_t speed = grobo_i_dxl_get(servo, GROBO_ROLE_SPEED);
    bool zero_stops =
        series_of(servo) == STS && (named(servo, "phase") & (int)GROBO_STS_PHASE_ZERO_FULL) == 0;
    speed = series_of(servo) == STS ? (speed < 0 ? -speed : speed) : speed & 0x3FFF;
    if (series_of(servo) == SCS && speed == 0) {
        plant->time_us = grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_TIME) * 1000;
    }
    plant->cap_mdeg_s = (int32_t)lround(fmin(speed * speed_mdeg_s(servo), INT32_MAX));
    if (speed == 0 && zero_stops) {
        plant->speed_mdeg_s = 0;
    }
    int32_t acceleration = grobo_i_dxl_get(servo, GROBO_ROLE_ACCELERATION);
    plant->accel_mdeg_s2 = (int32_t)lround(acceleration * accel_mdeg_s2(servo));
}

/* The force that is left by the torque limit, and after an overload. */
static int32_t most_ma(const grobo_sim_servo *servo)
{
    int32_t limit = grobo_i_dxl_get(servo, GROBO_ROLE_TORQUE_LIMIT);
    int32_t full = is_feetech(servo) ? 1000 : 1023;
    if (series_of(servo) == SCS) {
        limit = grobo_i_dxl_get(servo, GROBO_ROLE_MAX_TORQUE);
    }
    if (is_feetech(servo) && (servo->status & GROBO_FEETECH_OVERLOAD) != 0) {
        int32_t left = named(servo, "protective_torque") * 10;
        limit = left < limit ? left : limit;
    }
    return servo->plant.stall_ma * limit / full;
}

static void follow(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_sim_plant *plant = &servo->plant;
    double speed = 0;
    grobo_i_dxl_follow(sim, index);
    plant->most_ma = most_ma(servo);
    if (plant->most_ma == 0) {
        plant->torque = GROBO_TORQUE_OFF;
    }
    if (is_wheel(servo, &speed)) {
        speed = fmin(fmax(speed, -plant->speed_mdeg_s), plant->speed_mdeg_s);
        plant->wheel = true;
        plant->wheel_mdeg_s = (int32_t)lround(reverses(servo) ? -speed : speed);
    } else {
        follow_move(servo);
    }
}

/* The registers changed: torque, force and motion are what they say now. */
static void go(grobo_sim *sim, int index, bool new_goal)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_torque before = (grobo_torque)servo->plant.torque;
    follow(sim, index);
    if (servo->plant.torque != before) {
        grobo_i_sim_torque(sim, index, before);
    } else if (new_goal && servo->plant.torque == GROBO_TORQUE_ON) {
        grobo_i_sim_set_out(sim, index);
    }
}

/* A status bit came up; AX and MX lose their force for those that shutdown names. */
static void fail(grobo_sim *sim, int index, unsigned error)
{
    grobo_sim_servo *servo = &sim->servo[index];
    servo->status |= (uint8_t)error;
    if ((grobo_i_dxl_get(servo, GROBO_ROLE_SHUTDOWN) & (int)error) == 0) {
        return;
    }
    if (!is_feetech(servo)) {
        grobo_i_dxl_put(servo, GROBO_ROLE_TORQUE_LIMIT, 0);
    } else if ((error & (GROBO_FEETECH_OVERHEATED | GROBO_FEETECH_OVERCURRENT)) != 0) {
        grobo_i_dxl_put(servo, GROBO_ROLE_TORQUE, 0);
    }
}

static void cut(grobo_sim *sim, int index, bool hot)
{
    if (hot) {
        fail(sim, index, GROBO_DXL1_OVERHEATED);
    } else {
        grobo_i_dxl_put(&sim->servo[index], GROBO_ROLE_TORQUE, 0);
    }
    follow(sim, index);
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

static void refresh(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    double sign = reverses(servo) ? -1 : 1;
    see_states(sim, servo);
    grobo_i_dxl_refresh(sim, index, sign * speed_mdeg_s(servo), count_ma(servo));
    if (servo->model->table == &grobo_dxl1_table) { /* 2048 is none */
        double ma = grobo_i_dxl_effort(sim, index) * servo->plant.stall_ma;
        grobo_i_dxl_put(servo, GROBO_ROLE_CURRENT, 2048 + lround(ma / MX_COUNT_MA));
    }
    grobo_i_dxl_put(servo, GROBO_ROLE_POSITION,
                    position_at(servo, grobo_i_sim_angle_mdeg(servo, sim->now_us)));
    grobo_i_dxl_put(servo, GROBO_ROLE_ERROR, servo->status);
}

/* ---- what a servo does by itself ----------------------------------------------------------- */

/* What a stall leads to, and after how long. */
typedef struct stall_limit {
    unsigned error;
    int64_t after_us;
} stall_limit;

static stall_limit limit_of(const grobo_sim_servo *servo)
{
    double effort = (double)servo->plant.most_ma / servo->plant.stall_ma;
    if (!is_feetech(servo)) {
        return effort >= AX_OVERLOAD_EFFORT ? (stall_limit){GROBO_DXL1_OVERLOAD, AX_OVERLOAD_US}
                                            : (stall_limit){0, 0};
    }
    if (series_of(servo) == STS) {
        double most = grobo_i_dxl_get(servo, GROBO_ROLE_CURRENT_LIMIT) * STS_COUNT_MA;
        if (most > 0 && servo->plant.most_ma > most) {
            return (stall_limit){GROBO_FEETECH_OVERCURRENT,
                                 named(servo, "overcurrent_time") * 10000LL};
        }
    }
    int64_t unit_us = series_of(servo) == STS ? 10000 : 40000;
    return effort * 100 >= named(servo, "overload_torque")
               ? (stall_limit){GROBO_FEETECH_OVERLOAD, named(servo, "protection_time") * unit_us}
               : (stall_limit){0, 0};
}

static int64_t next_us(const grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    if (!servo->powered || !servo->stalled || servo->plant.torque != GROBO_TORQUE_ON) {
        return GROBO_NEVER_US;
    }
    stall_limit limit = limit_of(servo);
    bool named_it = (grobo_i_dxl_get(servo, GROBO_ROLE_SHUTDOWN) & (int)limit.error) != 0;
    return limit.error != 0 && named_it && (servo->status & limit.error) == 0
               ? servo->start_us + servo->move_us + limit.after_us
               : GROBO_NEVER_US;
}

static void act(grobo_sim *sim, int index)
{
    fail(sim, index, limit_of(&sim->servo[index]).error);
    go(sim, index, false);
}

/* ---- restart ------------------------------------------------------------------------------- */

static int32_t bps(const grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    return rate_of(servo, grobo_i_dxl_get(servo, GROBO_ROLE_BAUD));
}

static void restart(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_dxl_boot(sim, index);
    grobo_i_dxl_one_turn(sim, servo, reverses(servo));
    int32_t here_mdeg = grobo_i_sim_angle_mdeg(servo, sim->now_us);
    grobo_i_dxl_put(servo, GROBO_ROLE_GOAL, position_at(servo, here_mdeg));
    follow(sim, index);
}

static bool factory(grobo_sim *sim, int index, uint8_t id, uint32_t baud_bps)
{
    int code = grobo_servo_baud_code(sim->servo[index].model, (int32_t)baud_bps);
    if (code < 0 || id > GROBO_DXL1_ID_MAX) {
        return false;
    }
    grobo_i_dxl_sold(sim, index, id, code);
    return true;
}

/* ---- writing ------------------------------------------------------------------------------- */

/* AX and MX judge a value, Feetech's servos take any. */
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
        !(series_of(servo) == MX && counts_turns(servo)) &&
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
        if (is_feetech(servo)) {
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
    return hit || is_feetech(servo) ? 0 : GROBO_DXL1_BAD_RANGE;
}

/* Here becomes a position: by the offset, which may be as large as its range only. */
static void calibrate(grobo_sim *sim, int index, int32_t position)
{
    grobo_sim_servo *servo = &sim->servo[index];
    int32_t turn = grobo_i_dxl_turn(servo);
    int32_t ticks =
        grobo_i_dxl_ticks(servo, reverses(servo), grobo_i_sim_angle_mdeg(servo, sim->now_us));
    int32_t offset = turn > 0 ? grobo_i_dxl_wrap(ticks - position, turn) : 0;
    const grobo_servo_register *reg = grobo_servo_register_of(servo->model, GROBO_ROLE_OFFSET);
    if (turn > 0 && reg != NULL) {
        grobo_i_dxl_put(servo, GROBO_ROLE_OFFSET, offset > turn / 2 ? offset - turn : offset);
        memcpy(&servo->flash[reg->address], &servo->reg[reg->address], reg->bytes);
    }
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
    if (reg->role == GROBO_ROLE_TORQUE) {
        servo->status &= (uint8_t)~GROBO_FEETECH_OVERLOAD;
        servo->status &= (uint8_t) ~(is_feetech(servo) ? GROBO_FEETECH_OVERCURRENT : 0);
    }
    if (reg->role == GROBO_ROLE_TORQUE_LIMIT && !is_feetech(servo)) {
        servo->status &= (uint8_t)~GROBO_DXL1_OVERLOAD;
    }
    if (reg->role == GROBO_ROLE_TORQUE && value == GROBO_STS_TORQUE_CALIBRATE) {
        calibrate(sim, index, servo->model->middle);
        grobo_i_dxl_put(servo, GROBO_ROLE_TORQUE, servo->plant.torque == GROBO_TORQUE_ON);
    }
    if (goal) { /* brings the torque by itself: of STS measured (feetech-cli 0.1.8, simulator.py) */
        grobo_i_dxl_put(servo, GROBO_ROLE_TORQUE, 1);
    }
    go(sim, index, moves(servo, reg));
    grobo_i_dxl_tell(sim, index, reg, value);
}

static int store(grobo_sim *sim, int index, int address, const uint8_t *bytes, size_t n)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const grobo_servo_register *reg;
    bool open = !is_feetech(servo) || grobo_i_dxl_get(servo, GROBO_ROLE_LOCK) != LOCK_CLOSED;
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
        (void)store(sim, index, address, bytes, n);
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
    return is_feetech(servo) ? read || level > 0 : level > (read ? 0 : 1);
}

static void answer_read(grobo_sim *sim, int index, grobo_i_dxl_round *round, int address,
                        int length)
{
    grobo_sim_servo *servo = &sim->servo[index];
    bool beyond = address + length > GROBO_SIM_REGISTER_BYTES ||
                  (!is_feetech(servo) && address + length > grobo_i_dxl_end(servo));
    if (!answers(servo, true)) {
        return;
    }
    refresh(sim, index);
    if (beyond || length == 0) {
        answer(sim, index, round, is_feetech(servo) ? 0 : GROBO_DXL1_BAD_RANGE, NULL, 0);
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
    return is_feetech(servo) ? 0 : error;
}

static uint8_t do_kept(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    size_t n = servo->kept_bytes;
    servo->kept_bytes = 0;
    if (n == 0) {
        return is_feetech(servo) ? 0 : GROBO_DXL1_BAD_INSTRUCTION;
    }
    return write(sim, index, servo->kept_address, servo->kept, n);
}

/* All but the id with Feetech, all with AX and MX. */
static void reset(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    int32_t id = servo->plant.id;
    grobo_i_dxl_factory(servo);
    if (is_feetech(servo)) {
        grobo_i_dxl_put(servo, GROBO_ROLE_ID, id);
        memcpy(servo->flash, servo->reg, sizeof servo->flash);
    }
    grobo_i_sim_reboot(sim, index);
}

/* What Feetech has beside; false where the instruction is none of these. */
static bool extra(grobo_sim *sim, int index, const grobo_dxl1_packet *packet)
{
    grobo_sim_servo *servo = &sim->servo[index];
    if (packet->instruction == GROBO_DXL1_RESET_TURNS) {
        grobo_i_dxl_one_turn(sim, servo, reverses(servo));
    } else if (packet->instruction == GROBO_DXL1_CALIBRATE) {
        bool given = packet->data_bytes == 2;
        calibrate(sim, index, given ? grobo_i_get_u16(packet->data) : servo->model->middle);
        follow(sim, index);
    } else {
        return packet->instruction == GROBO_DXL1_REBOOT; /* when the answer is made */
    }
    return true;
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
    bool known = code == GROBO_DXL1_FACTORY_RESET || /* when the answer is made */
                 (is_feetech(&sim->servo[index]) && extra(sim, index, packet));
    return known ? 0 : GROBO_DXL1_BAD_INSTRUCTION;
}

static bool is_answered(const grobo_sim_servo *servo, const grobo_dxl1_packet *packet)
{
    bool known = packet->instruction <= GROBO_DXL1_CALIBRATE;
    return packet->id != GROBO_DXL1_ID_ALL && answers(servo, false) &&
           (known || !is_feetech(servo));
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
    error = is_feetech(servo) ? 0 : error;
    if (is_answered(servo, packet)) {
        uint8_t now = servo->plant.id;
        servo->plant.id = is_feetech(servo) ? now : id; /* Feetech answers with a new one at once */
        answer(sim, index, &round, error, NULL, 0);
        servo->plant.id = now;
    }
    if (packet->instruction == GROBO_DXL1_FACTORY_RESET) {
        reset(sim, index);
    } else if (packet->instruction == GROBO_DXL1_REBOOT && is_feetech(servo)) {
        grobo_i_sim_reboot(sim, index);
    }
}

/* ---- packets for several ------------------------------------------------------------------- */

/* One of a list answers, if its series has the instruction. */
static void read_one(grobo_sim *sim, const grobo_sim_event *raw, grobo_i_dxl_round *round,
                     dxl1_series series, const grobo_dxl1_packet *one)
{
    const grobo_i_dxl_round begin = *round;
    bool silent = true;
    for (int i = -1; (i = grobo_i_dxl_hearer(sim, &grobo_sim_dxl1, one->id, i, raw)) >= 0;) {
        grobo_i_dxl_round own = begin;
        if (series_of(&sim->servo[i]) == series) {
            answer_read(sim, i, &own, one->address, one->length);
            grobo_i_dxl_beside(round, &own);
            silent = false;
        }
    }
    if (silent) {
        grobo_i_dxl_silence(sim, round, GROBO_DXL1_OVERHEAD_BYTES + (size_t)one->length);
    }
}

static void sync_read(grobo_sim *sim, const grobo_dxl1_packet *packet, const grobo_sim_event *raw)
{
    grobo_i_dxl_round round = {0};
    for (size_t i = 0; i < packet->data_bytes; i++) {
        grobo_dxl1_packet one = *packet;
        one.id = packet->data[i];
        read_one(sim, raw, &round, STS, &one);
    }
}

/* An id that comes again counts once (emanual, bulk read). */
static void bulk_read(grobo_sim *sim, const grobo_dxl1_packet *packet, const grobo_sim_event *raw)
{
    grobo_i_dxl_round round = {0};
    bool seen[GROBO_DXL1_ID_ALL + 2] = {false};
    for (size_t i = 1; i + 3 <= packet->data_bytes; i += 3) {
        const uint8_t *item = packet->data + i;
        const grobo_dxl1_packet one = {.length = item[0], .id = item[1], .address = item[2]};
        if (!seen[one.id]) {
            read_one(sim, raw, &round, MX, &one);
        }
        seen[one.id] = true;
    }
}

static void sync_write(grobo_sim *sim, const grobo_dxl1_packet *packet, const grobo_sim_event *raw)
{
    size_t each = 1 + (size_t)packet->length;
    for (size_t at = 0; packet->length > 0 && at + each <= packet->data_bytes; at += each) {
        const uint8_t *data = packet->data + at;
        for (int i = -1; (i = grobo_i_dxl_hearer(sim, &grobo_sim_dxl1, *data, i, raw)) >= 0;) {
            (void)write(sim, i, packet->address, data + 1, packet->length);
        }
    }
}

/* STS take turns, in the order of ids; the others talk all at once. */
static void ping_all(grobo_sim *sim, const grobo_sim_event *raw)
{
    grobo_i_dxl_round turn = {0};
    for (int id = 0; id <= GROBO_DXL1_ID_MAX; id++) {
        const grobo_i_dxl_round begin = turn;
        const uint8_t its = (uint8_t)id;
        for (int i = -1; (i = grobo_i_dxl_hearer(sim, &grobo_sim_dxl1, its, i, raw)) >= 0;) {
            bool waits = series_of(&sim->servo[i]) == STS;
            grobo_i_dxl_round own = waits ? begin : (grobo_i_dxl_round){0};
            answer(sim, i, &own, 0, NULL, 0);
            if (waits) {
                grobo_i_dxl_beside(&turn, &own);
            }
        }
    }
}

/* ---- packets ------------------------------------------------------------------------------- */

static void spread(grobo_sim *sim, const grobo_dxl1_packet *packet, int result,
                   const grobo_sim_event *raw)
{
    for (int i = 0; i < sim->n_servos; i++) {
        grobo_sim_servo *servo = &sim->servo[i];
        grobo_i_dxl_round round = {0};
        if (servo->family != &grobo_sim_dxl1 ||
            (packet->id != GROBO_DXL1_ID_ALL && servo->plant.id != packet->id) ||
            !grobo_i_sim_hears(sim, i, raw)) {
            continue;
        }
        if (packet->instruction == GROBO_DXL1_PING) {
            answer(sim, i, &round, 0, NULL, 0);
        } else if (result >= 0) {
            for_one(sim, i, packet);
        } else if (!is_feetech(servo) && packet->id != GROBO_DXL1_ID_ALL) {
            answer(sim, i, &round, GROBO_DXL1_BAD_RANGE, NULL, 0);
        }
    }
}

static void packet(grobo_sim *sim, const grobo_sim_event *raw)
{
    grobo_dxl1_packet parts = {.id = raw->bytes[2], .instruction = raw->bytes[4]};
    int result = grobo_dxl1_parse(raw->bytes, raw->n_bytes, false, &parts);
    bool all = parts.id == GROBO_DXL1_ID_ALL;
    if (all && parts.instruction == GROBO_DXL1_PING) {
        ping_all(sim, raw);
    } else if (all && parts.instruction == GROBO_DXL1_SYNC_READ) {
        sync_read(sim, &parts, raw);
    } else if (all && parts.instruction == GROBO_DXL1_BULK_READ) {
        bulk_read(sim, &parts, raw);
    } else if (all && parts.instruction == GROBO_DXL1_SYNC_WRITE) {
        sync_write(sim, &parts, raw);
    } else {
        spread(sim, &parts, result, raw);
    }
}

/* AX and MX tell of a wrong sum; Feetech's servos are silent. */
static void broken(grobo_sim *sim, const uint8_t *bytes, size_t n)
{
    const grobo_sim_event raw = {.kind = GROBO_SIM_PACKET,
                                 .time_us = sim->now_us,
                                 .servo = -1,
                                 .bytes = bytes,
                                 .n_bytes = n};
    for (int i = -1; (i = grobo_i_dxl_hearer(sim, &grobo_sim_dxl1, bytes[2], i, &raw)) >= 0;) {
        grobo_i_dxl_round round = {0};
        if (!is_feetech(&sim->servo[i]) && answers(&sim->servo[i], false)) {
            answer(sim, i, &round, GROBO_DXL1_BAD_SUM, NULL, 0);
        }
    }
}

static int measure(const uint8_t *bytes, size_t n, bool good)
{
    int size = grobo_dxl1_measure(bytes, n, GROBO_ACCEPT_COMMANDS);
    return size == GROBO_ERR_CHECKSUM && !good ? 4 + bytes[3] : size;
}

const grobo_sim_family grobo_sim_dxl1 = {
    .tables = {&grobo_dxl1_table, &grobo_sts_table, &grobo_scs_table},
    .measure = measure,
    .packet = packet,
    .factory = factory,
    .boot = restart,
    .cut = cut,
    .goal_mdeg = goal_mdeg,
    .refresh = refresh,
    .bps = bps,
    .next_us = next_us,
    .act = act,
    .broken = broken,
    .set = grobo_i_dxl_set,
    .store = store};
