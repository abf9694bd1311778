/* SPDX-License-Identifier: MIT */
/* The X series of DYNAMIXEL: what packets of Protocol 2.0 do to its registers. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/dxl2.h>
#include <grobo/core/protocol.h>
#include <grobo/core/sim.h>

#include "src/base/bytes.h"
#include "src/model/joint.h"
#include "src/servo/families.h"
#include "src/servo/tables.h"
#include "src/sim/servo/family.h"
#include "src/sim/servo/indirect.h"
#include "src/sim/servo/note.h"
#include "src/sim/servo/power.h"
#include "src/sim/servo/registers.h"
#include "src/sim/servo/servo.h"
#include "src/sim/servo/shaft.h"

/* Counts: 0.229 rpm, 214.577 rev/min2, of the watchdog 20 ms, of a voltage 0.1 V. */
#define SPEED_MDEG_S 1374.0
#define ACCEL_MDEG_S2 21457.7
#define WATCHDOG_US 20000
#define COUNT_MV 100
/* A motor that works this hard for this long is overloaded. An assumption. */
#define OVERLOAD_EFFORT 0.8
#define OVERLOAD_US 1000000
/* The largest homing offset that counts where a position is within one turn. */
#define HOMING_ONE_TURN 1024
/* Where the registers in RAM begin. */
#define EEPROM_END 64

static int mode_of(const grobo_sim_servo *servo)
{
    return grobo_i_dxl_get(servo, GROBO_ROLE_MODE);
}

static bool places(int mode)
{
    return mode == GROBO_DXL2_MODE_POSITION || mode == GROBO_DXL2_MODE_EXTENDED ||
           mode == GROBO_DXL2_MODE_GRIP;
}

static bool drives_by_time(const grobo_sim_servo *servo)
{
    return (grobo_i_dxl_get(servo, GROBO_ROLE_DIRECTION) & (int)GROBO_DXL2_DRIVE_TIME) != 0;
}

static bool reverses(const grobo_sim_servo *servo)
{
    return (grobo_i_dxl_get(servo, GROBO_ROLE_DIRECTION) & (int)GROBO_DXL2_DRIVE_REVERSE) != 0;
}

/* ---- positions ----------------------------------------------------------------------------- */

static int32_t position_at(const grobo_sim_servo *servo, int32_t angle_mdeg)
{
    int32_t ticks = grobo_i_dxl_ticks(servo, reverses(servo), angle_mdeg);
    int32_t offset = grobo_i_dxl_get(servo, GROBO_ROLE_OFFSET);
    if (mode_of(servo) == GROBO_DXL2_MODE_POSITION) {
        bool counts = offset >= -HOMING_ONE_TURN && offset <= HOMING_ONE_TURN;
        return grobo_i_dxl_wrap(ticks, grobo_i_dxl_turn(servo)) + (counts ? offset : 0);
    }
    return ticks - servo->turns_ticks + offset;
}

/* The shaft's angle at the goal: as far from here as the goal is from the present position. */
static int32_t goal_mdeg(const grobo_sim *sim, const grobo_sim_servo *servo)
{
    int32_t here_mdeg = grobo_i_sim_angle_mdeg(servo, sim->now_us);
    int32_t way = grobo_i_dxl_get(servo, GROBO_ROLE_GOAL) - position_at(servo, here_mdeg);
    int32_t ticks = grobo_i_dxl_ticks(servo, false, here_mdeg) + (reverses(servo) ? -way : way);
    return (int32_t)lround((ticks - servo->model->middle) * grobo_i_dxl_tick_mdeg(servo));
}

/* ---- the shaft's side ---------------------------------------------------------------------- */

static void follow_wheel(grobo_sim_servo *servo, int mode)
{
    grobo_sim_wants *plant = &servo->plant;
    double speed = 0;
    if (mode == GROBO_DXL2_MODE_VELOCITY) {
        speed = grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_SPEED) * SPEED_MDEG_S;
    } else if (mode == GROBO_DXL2_MODE_PWM) {
        const grobo_servo_register *pwm =
            grobo_servo_register_of(servo->model, GROBO_ROLE_GOAL_PWM);
        speed =
            (double)plant->speed_mdeg_s * grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_PWM) / pwm->max;
    } else { /* a current without a load: as fast as it can */
        int32_t current = grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_CURRENT);
        speed = (current > 0) - (current < 0);
        speed *= plant->speed_mdeg_s;
    }
    speed = fmin(fmax(speed, -plant->speed_mdeg_s), plant->speed_mdeg_s);
    plant->wheel = true;
    plant->wheel_mdeg_s = (int32_t)lround(reverses(servo) ? -speed : speed);
}

static void follow(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_sim_wants *plant = &servo->plant;
    int mode = mode_of(servo);
    int32_t velocity = grobo_i_dxl_get(servo, GROBO_ROLE_SPEED);
    int32_t acceleration = grobo_i_dxl_get(servo, GROBO_ROLE_ACCELERATION);
    grobo_i_dxl_follow(sim, index);
    if (mode == GROBO_DXL2_MODE_GRIP) {
        const grobo_servo_register *current =
            grobo_servo_register_of(servo->model, GROBO_ROLE_GOAL_CURRENT);
        plant->most_ma =
            plant->stall_ma * abs(grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_CURRENT)) / current->max;
    }
    if (!places(mode)) {
        follow_wheel(servo, mode);
    } else if (drives_by_time(servo)) {
        plant->time_us = velocity * 1000;
        plant->ramp_us =
            acceleration * 1000 < plant->time_us / 2 ? acceleration * 1000 : plant->time_us / 2;
    } else {
        plant->cap_mdeg_s = (int32_t)lround(velocity * SPEED_MDEG_S);
        plant->accel_mdeg_s2 = (int32_t)lround(fmin(acceleration * ACCEL_MDEG_S2, INT32_MAX));
    }
}

static void cut(grobo_sim *sim, int index, bool hot)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_dxl_put(servo, GROBO_ROLE_TORQUE, 0);
    servo->status |= hot ? GROBO_DXL2_OVERHEATED : 0;
    follow(sim, index);
}

static void refresh(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const grobo_servo_register *current = grobo_servo_register_of(servo->model, GROBO_ROLE_CURRENT);
    int64_t now_us = sim->now_us;
    grobo_i_sim_settle(sim, index);
    double count_ma = current == NULL ? 0 : current->unit[0] == '1' ? 1 : 2.69;
    grobo_i_dxl_refresh(sim, index, reverses(servo) ? -SPEED_MDEG_S : SPEED_MDEG_S, count_ma);
    int32_t position = position_at(servo, grobo_i_sim_angle_mdeg(servo, now_us));
    grobo_i_dxl_put(servo, GROBO_ROLE_POSITION, position);
    grobo_i_dxl_put(servo, GROBO_ROLE_ERROR, servo->status);
    static const char *const same[] = {"position_trajectory", "velocity_trajectory", "present_pwm",
                                       "tick", "moving_status"};
    bool moves = grobo_i_sim_moving(servo, now_us);
    const int64_t values[] = {position, grobo_i_dxl_get(servo, GROBO_ROLE_PRESENT_SPEED),
                              lround(grobo_i_dxl_effort(sim, index) * 885), now_us / 1000 % 32768,
                              moves ? 0x32 : 0x01};
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
        const grobo_servo_register *reg = grobo_i_dxl_row(servo, same[i]);
        (void)grobo_servo_register_put(servo->model, reg, (int32_t)values[i],
                                       &servo->reg[reg->address]);
    }
}

/* ---- what a servo does by itself ----------------------------------------------------------- */

static int64_t overload_us(const grobo_sim_servo *servo)
{
    int64_t since_us = grobo_i_sim_strained_us(servo);
    bool works = since_us != GROBO_NEVER_US && grobo_i_sim_strain(servo) >= OVERLOAD_EFFORT &&
                 (servo->status & GROBO_DXL2_OVERLOAD) == 0;
    return works ? since_us + OVERLOAD_US : GROBO_NEVER_US;
}

static int64_t watchdog_us(const grobo_sim_servo *servo)
{
    int32_t count = grobo_i_dxl_get(servo, GROBO_ROLE_WATCHDOG);
    return count > 0 && servo->plant.torque == GROBO_TORQUE_ON
               ? servo->heard_us + (int64_t)count * WATCHDOG_US
               : GROBO_NEVER_US;
}

static int64_t next_us(const grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    if (!servo->powered) {
        return GROBO_NEVER_US;
    }
    if ((servo->status & GROBO_DXL2_VOLTAGE) == 0 && !grobo_i_dxl_fed(sim, servo, COUNT_MV)) {
        return sim->now_us;
    }
    int64_t load_us = overload_us(servo), dog_us = watchdog_us(servo);
    return load_us < dog_us ? load_us : dog_us;
}

/* An error that the register shutdown names takes the torque until a restart. */
static void fail(grobo_sim *sim, int index, unsigned error)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_torque before = (grobo_torque)servo->plant.torque;
    servo->status |= (uint8_t)error;
    if ((grobo_i_dxl_get(servo, GROBO_ROLE_SHUTDOWN) & (int)error) != 0) {
        cut(sim, index, false);
        grobo_i_sim_torque(sim, index, before);
    }
}

static void act(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    if ((servo->status & GROBO_DXL2_VOLTAGE) == 0 && !grobo_i_dxl_fed(sim, servo, COUNT_MV)) {
        fail(sim, index, GROBO_DXL2_VOLTAGE);
    } else if (overload_us(servo) <= sim->now_us) {
        fail(sim, index, GROBO_DXL2_OVERLOAD);
    } else if (watchdog_us(servo) <= sim->now_us) {
        grobo_i_dxl_put(servo, GROBO_ROLE_WATCHDOG, -1);
        grobo_i_dxl_put(servo, GROBO_ROLE_ACCELERATION, 0);
        grobo_i_dxl_put(servo, GROBO_ROLE_SPEED, 0);
        grobo_i_dxl_put(servo, GROBO_ROLE_GOAL_SPEED, 0);
        follow(sim, index);
        grobo_i_sim_halt(sim, index);
        servo->plant.goal_mdeg = servo->to_mdeg;
    }
}

/* ---- restart ------------------------------------------------------------------------------- */

static int32_t bps(const grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    return grobo_servo_baud_bps(servo->model, grobo_i_dxl_get(servo, GROBO_ROLE_BAUD));
}

static void restart(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_dxl_boot(sim, index);
    grobo_i_indirect_reset(servo);
    grobo_i_dxl_put(servo, GROBO_ROLE_GOAL_PWM, grobo_i_dxl_get(servo, GROBO_ROLE_MAX_TORQUE));
    grobo_i_dxl_put(servo, GROBO_ROLE_GOAL_CURRENT,
                    grobo_i_dxl_get(servo, GROBO_ROLE_CURRENT_LIMIT));
    grobo_i_dxl_one_turn(sim, servo, reverses(servo));
    int32_t here_mdeg = grobo_i_sim_angle_mdeg(servo, sim->now_us);
    grobo_i_dxl_put(servo, GROBO_ROLE_GOAL, position_at(servo, here_mdeg));
    servo->heard_us = sim->now_us;
    follow(sim, index);
}

static bool has_mode(const grobo_sim_servo *servo, int32_t mode)
{
    bool by_current = mode == GROBO_DXL2_MODE_CURRENT || mode == GROBO_DXL2_MODE_GRIP;
    return by_current
               ? grobo_servo_register_of(servo->model, GROBO_ROLE_GOAL_CURRENT) != NULL
               : places(mode) || mode == GROBO_DXL2_MODE_VELOCITY || mode == GROBO_DXL2_MODE_PWM;
}

static bool factory(grobo_sim *sim, int index, uint8_t id, uint32_t baud_bps)
{
    grobo_sim_servo *servo = &sim->servo[index];
    if (!grobo_i_dxl_sell(sim, index, id, GROBO_DXL2_ID_MAX, baud_bps)) {
        return false;
    }
    if (sim->config.mounted) {
        const grobo_joint *joint = grobo_i_joint(sim->config.model, index);
        bool grips = joint->torque_limit_pct > 0 && has_mode(servo, GROBO_DXL2_MODE_GRIP);
        grobo_i_dxl_put(servo, GROBO_ROLE_DIRECTION, GROBO_DXL2_DRIVE_TIME);
        grobo_i_dxl_put(servo, GROBO_ROLE_MODE,
                        grips          ? GROBO_DXL2_MODE_GRIP
                        : joint->turns ? GROBO_DXL2_MODE_EXTENDED
                                       : GROBO_DXL2_MODE_POSITION);
    }
    memcpy(servo->flash, servo->reg, sizeof servo->flash);
    return true;
}

/* ---- writing ------------------------------------------------------------------------------- */

static uint8_t outside_limits(const grobo_sim_servo *servo, const grobo_servo_register *reg,
                              int32_t value)
{
    int32_t most = INT32_MAX, least = INT32_MIN;
    if (reg->role == GROBO_ROLE_GOAL && mode_of(servo) == GROBO_DXL2_MODE_POSITION) {
        least = grobo_i_dxl_get(servo, GROBO_ROLE_MIN_POSITION);
        most = grobo_i_dxl_get(servo, GROBO_ROLE_MAX_POSITION);
    } else if (reg->role == GROBO_ROLE_GOAL_SPEED) {
        most = grobo_i_dxl_get(servo, GROBO_ROLE_SPEED_LIMIT);
        least = -most;
    } else if (reg->role == GROBO_ROLE_GOAL_CURRENT) {
        most = grobo_i_dxl_get(servo, GROBO_ROLE_CURRENT_LIMIT);
        least = -most;
    } else if (reg->role == GROBO_ROLE_GOAL_PWM) {
        most = grobo_i_dxl_get(servo, GROBO_ROLE_MAX_TORQUE);
        least = -most;
    }
    return value < least || value > most ? GROBO_DXL2_BAD_LIMIT : GROBO_DXL2_DONE;
}

static bool is_goal(const grobo_servo_register *reg)
{
    return reg->role == GROBO_ROLE_GOAL || reg->role == GROBO_ROLE_GOAL_SPEED ||
           reg->role == GROBO_ROLE_GOAL_CURRENT || reg->role == GROBO_ROLE_GOAL_PWM;
}

static bool is_shut_down(const grobo_sim_servo *servo)
{
    return (servo->status & grobo_i_dxl_get(servo, GROBO_ROLE_SHUTDOWN)) != 0;
}

/* Whether a register may get a value. */
static uint8_t judge_value(const grobo_sim_servo *servo, const grobo_servo_register *reg,
                           int32_t value)
{
    bool stopped = is_goal(reg) && grobo_i_dxl_get(servo, GROBO_ROLE_WATCHDOG) < 0;
    if (value < reg->min || value > reg->max || stopped) {
        return GROBO_DXL2_BAD_RANGE;
    }
    if ((reg->role == GROBO_ROLE_MODE && !has_mode(servo, value)) ||
        (reg->role == GROBO_ROLE_WATCHDOG && value < 0)) {
        return GROBO_DXL2_BAD_RANGE;
    }
    if (reg->role == GROBO_ROLE_TORQUE && value == 1 && is_shut_down(servo)) {
        return GROBO_DXL2_FAILED;
    }
    return outside_limits(servo, reg, value);
}

/* Whether registers may be written so: GROBO_DXL2_DONE, or why not. */
static uint8_t judge_registers(const grobo_sim_servo *servo, int address, const uint8_t *bytes,
                               size_t n)
{
    const grobo_servo_register *reg;
    bool hit = false;
    for (size_t i = 0; (reg = grobo_servo_register_row(servo->model, i)) != NULL; i++) {
        int end = address + (int)n;
        if (reg->address + reg->bytes <= address || reg->address >= end) {
            continue;
        }
        bool locked = (reg->flags & GROBO_REGISTER_KEPT) != 0 &&
                      grobo_i_dxl_get(servo, GROBO_ROLE_TORQUE) != 0;
        if ((reg->flags & GROBO_REGISTER_W) == 0 || locked) {
            return GROBO_DXL2_NO_ACCESS;
        }
        if (reg->address < address || reg->address + reg->bytes > end) {
            return GROBO_DXL2_BAD_LENGTH;
        }
        uint8_t error = judge_value(servo, reg, grobo_i_dxl_value_in(servo, reg, address, bytes));
        if (error != GROBO_DXL2_DONE) {
            return error;
        }
        hit = true;
    }
    return hit ? GROBO_DXL2_DONE : GROBO_DXL2_NO_ACCESS;
}

/* Whether all of a write can be done, its indirect part too. */
static uint8_t judge(const grobo_sim_servo *servo, int address, const uint8_t *bytes, size_t n)
{
    uint8_t error = n == 0 ? GROBO_DXL2_BAD_LENGTH : GROBO_DXL2_DONE;
    for (size_t at = 0; at < n && error == GROBO_DXL2_DONE;) {
        grobo_i_indirect_piece piece = grobo_i_indirect_piece_at(servo, address + (int)at, n - at);
        if (piece.kind == GROBO_I_INDIRECT_REGISTERS) {
            error = judge_registers(servo, piece.address, bytes + at, piece.n);
        } else if (piece.kind == GROBO_I_INDIRECT_ADDRESS &&
                   !grobo_i_indirect_fits(servo, &piece, bytes + at)) {
            error = GROBO_DXL2_BAD_RANGE;
        }
        at += piece.n;
    }
    return error;
}

/* By its drive mode, any goal switches torque on. */
static bool wakes(const grobo_sim_servo *servo)
{
    return (grobo_i_dxl_get(servo, GROBO_ROLE_DIRECTION) & (int)GROBO_DXL2_DRIVE_WAKES) != 0 &&
           !is_shut_down(servo);
}

/* Gains and profile of the new mode; the same rows as from the factory. */
static void mode_written(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    static const char *const gains[] = {"velocity_i", "velocity_p", "position_d", "position_i",
                                        "position_p"};
    for (size_t i = 0; i < sizeof gains / sizeof *gains; i++) {
        const grobo_servo_register *reg = grobo_i_dxl_row(servo, gains[i]);
        (void)grobo_servo_register_put(servo->model, reg, reg->factory, &servo->reg[reg->address]);
    }
    grobo_i_dxl_put(servo, GROBO_ROLE_SPEED, 0);
    grobo_i_dxl_put(servo, GROBO_ROLE_ACCELERATION, 0);
    grobo_i_dxl_put(servo, GROBO_ROLE_GOAL_PWM, grobo_i_dxl_get(servo, GROBO_ROLE_MAX_TORQUE));
    grobo_i_dxl_put(servo, GROBO_ROLE_GOAL_CURRENT,
                    grobo_i_dxl_get(servo, GROBO_ROLE_CURRENT_LIMIT));
    grobo_i_dxl_one_turn(sim, servo, reverses(servo));
    int32_t here_mdeg = grobo_i_sim_angle_mdeg(servo, sim->now_us);
    grobo_i_dxl_put(servo, GROBO_ROLE_GOAL, position_at(servo, here_mdeg));
}

static void took_effect(grobo_sim *sim, int index, const grobo_servo_register *reg)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_torque before = (grobo_torque)servo->plant.torque;
    int32_t value = grobo_servo_register_get(servo->model, reg, &servo->reg[reg->address]);
    if (reg->role == GROBO_ROLE_MODE) {
        mode_written(sim, index);
    } else if (is_goal(reg) && wakes(servo)) {
        grobo_i_dxl_put(servo, GROBO_ROLE_TORQUE, 1);
    }
    follow(sim, index);
    grobo_i_sim_torque(sim, index, before);
    if (servo->plant.torque == GROBO_TORQUE_ON && is_goal(reg) &&
        (reg->role == GROBO_ROLE_GOAL || servo->plant.wheel)) {
        grobo_i_sim_set_out(sim, index);
    }
    grobo_i_dxl_tell(sim, index, reg, value);
}

static int store(grobo_sim *sim, int index, int address, const uint8_t *bytes, size_t n)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const grobo_servo_register *reg;
    grobo_i_dxl_store(servo, address, bytes, n, true);
    for (size_t i = 0; (reg = grobo_servo_register_row(servo->model, i)) != NULL; i++) {
        if (reg->address >= address && reg->address < address + (int)n) {
            took_effect(sim, index, reg);
        }
    }
    return GROBO_OK;
}

static uint8_t write(grobo_sim *sim, int index, int address, const uint8_t *bytes, size_t n)
{
    grobo_sim_servo *servo = &sim->servo[index];
    uint8_t error = judge(servo, address, bytes, n);
    if (error != GROBO_DXL2_DONE) {
        grobo_i_sim_note(sim, GROBO_SIM_REFUSED, index, address);
    }
    for (size_t at = 0; at < n && error == GROBO_DXL2_DONE;) {
        grobo_i_indirect_piece piece = grobo_i_indirect_piece_at(servo, address + (int)at, n - at);
        if (piece.kind == GROBO_I_INDIRECT_REGISTERS) {
            (void)store(sim, index, piece.address, bytes + at, piece.n);
        } else {
            grobo_i_indirect_write(servo, &piece, bytes + at);
        }
        at += piece.n;
    }
    return error;
}

/* ---- answers ------------------------------------------------------------------------------- */

static uint8_t with_alert(const grobo_sim_servo *servo, uint8_t error)
{
    return (uint8_t)(error | (servo->status != 0 ? GROBO_DXL2_ALERT : 0));
}

static void answer(grobo_sim *sim, int index, grobo_i_dxl_round *round, uint8_t error,
                   const uint8_t *data, size_t n)
{
    uint8_t bytes[GROBO_SIM_TALK_BYTES];
    const grobo_dxl2_packet status = {.id = sim->servo[index].plant.id,
                                      .instruction = GROBO_DXL2_STATUS,
                                      .error = with_alert(&sim->servo[index], error),
                                      .data = data,
                                      .data_bytes = n};
    int size = grobo_dxl2_build(&status, bytes, sizeof bytes);
    if (size > 0) {
        grobo_i_dxl_answer(sim, index, round, bytes, (size_t)size);
    }
}

static uint8_t judge_read(const grobo_sim_servo *servo, int address, int length)
{
    if (length == 0) {
        return GROBO_DXL2_BAD_LENGTH;
    }
    return grobo_i_indirect_readable(servo, address, length) ? GROBO_DXL2_DONE
                                                             : GROBO_DXL2_NO_ACCESS;
}

static void answer_read(grobo_sim *sim, int index, grobo_i_dxl_round *round, int address,
                        int length)
{
    grobo_sim_servo *servo = &sim->servo[index];
    uint8_t bytes[GROBO_SIM_TALK_BYTES];
    uint8_t error = judge_read(servo, address, length);
    if (grobo_i_dxl_get(servo, GROBO_ROLE_REPLY_LEVEL) == 0 || length > (int)sizeof bytes) {
        return;
    }
    refresh(sim, index);
    if (error == GROBO_DXL2_DONE) {
        grobo_i_indirect_read(servo, address, length, bytes);
    }
    answer(sim, index, round, error, bytes, error == GROBO_DXL2_DONE ? (size_t)length : 0);
}

/* ---- packets for one ----------------------------------------------------------------------- */

static void ping(grobo_sim *sim, int index, grobo_i_dxl_round *round)
{
    const uint8_t *reg = sim->servo[index].reg;
    const grobo_servo_register *firmware =
        grobo_servo_register_of(sim->servo[index].model, GROBO_ROLE_FIRMWARE);
    const uint8_t data[] = {reg[0], reg[1], reg[firmware->address]};
    answer(sim, index, round, GROBO_DXL2_DONE, data, sizeof data);
}

static uint8_t keep(grobo_sim *sim, int index, const grobo_dxl2_packet *packet)
{
    grobo_sim_servo *servo = &sim->servo[index];
    uint8_t error = judge(servo, packet->address, packet->data, packet->data_bytes);
    if (error == GROBO_DXL2_DONE && packet->data_bytes > sizeof servo->kept) {
        error = GROBO_DXL2_BAD_LENGTH;
    }
    if (error == GROBO_DXL2_DONE) {
        memcpy(servo->kept, packet->data, packet->data_bytes);
        servo->kept_bytes = (uint8_t)packet->data_bytes;
        servo->kept_address = packet->address;
    }
    return error;
}

static uint8_t do_kept(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    size_t n = servo->kept_bytes;
    servo->kept_bytes = 0;
    return n == 0 ? GROBO_DXL2_BAD_INSTRUCTION
                  : write(sim, index, servo->kept_address, servo->kept, n);
}

static uint8_t forget_turns(grobo_sim *sim, int index, const grobo_dxl2_packet *packet)
{
    static const uint8_t key[] = {0x01, 0x44, 0x58, 0x4C, 0x22};
    if (packet->data_bytes != sizeof key || memcmp(packet->data, key, sizeof key) != 0) {
        return GROBO_DXL2_BAD_RANGE;
    }
    if (grobo_i_sim_moving(&sim->servo[index], sim->now_us)) {
        return GROBO_DXL2_FAILED;
    }
    grobo_i_dxl_one_turn(sim, &sim->servo[index], reverses(&sim->servo[index]));
    return GROBO_DXL2_DONE;
}

static uint8_t judge_reset(const grobo_dxl2_packet *packet)
{
    uint8_t what = packet->data_bytes == 1 ? packet->data[0] : 0;
    bool all = what == GROBO_DXL2_RESET_ALL && packet->id != GROBO_DXL2_ID_ALL;
    bool known = all || what == GROBO_DXL2_RESET_BUT_ID || what == GROBO_DXL2_RESET_BUT_ID_BAUD;
    return known ? GROBO_DXL2_DONE : GROBO_DXL2_BAD_RANGE;
}

static void reset(grobo_sim *sim, int index, uint8_t what)
{
    grobo_sim_servo *servo = &sim->servo[index];
    int32_t id = servo->plant.id, rate = grobo_i_dxl_get(servo, GROBO_ROLE_BAUD);
    grobo_i_dxl_factory(servo);
    if (what != GROBO_DXL2_RESET_ALL) {
        grobo_i_dxl_put(servo, GROBO_ROLE_ID, id);
    }
    if (what == GROBO_DXL2_RESET_BUT_ID_BAUD) {
        grobo_i_dxl_put(servo, GROBO_ROLE_BAUD, rate);
    }
    memcpy(servo->flash, servo->reg, sizeof servo->flash);
    grobo_i_sim_reboot(sim, index);
}

static uint8_t carry_out(grobo_sim *sim, int index, const grobo_dxl2_packet *packet)
{
    uint8_t code = packet->instruction;
    bool by_second = packet->id != sim->servo[index].plant.id && packet->id != GROBO_DXL2_ID_ALL;
    bool writes = code == GROBO_DXL2_WRITE || code == GROBO_DXL2_REG_WRITE;
    bool kept = code == GROBO_DXL2_FACTORY_RESET || (writes && packet->address < EEPROM_END);
    if (by_second && kept) { /* not by the secondary id */
        grobo_i_sim_note(sim, GROBO_SIM_REFUSED, index, packet->address);
        return GROBO_DXL2_NO_ACCESS;
    }
    if (code == GROBO_DXL2_WRITE) {
        return write(sim, index, packet->address, packet->data, packet->data_bytes);
    }
    if (code == GROBO_DXL2_REG_WRITE) {
        return keep(sim, index, packet);
    }
    if (code == GROBO_DXL2_ACTION) {
        return do_kept(sim, index);
    }
    if (code == GROBO_DXL2_CLEAR) {
        return forget_turns(sim, index, packet);
    }
    if (code == GROBO_DXL2_FACTORY_RESET) { /* when the answer is made, as a restart */
        return judge_reset(packet);
    }
    return code == GROBO_DXL2_REBOOT ? GROBO_DXL2_DONE : GROBO_DXL2_BAD_INSTRUCTION;
}

static void for_one(grobo_sim *sim, int index, const grobo_dxl2_packet *packet)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_dxl_round round = {0};
    bool named = packet->id == servo->plant.id;
    if (packet->instruction == GROBO_DXL2_READ) {
        if (named) {
            answer_read(sim, index, &round, packet->address, packet->length);
        }
        return;
    }
    uint8_t id = servo->plant.id;
    uint8_t error = carry_out(sim, index, packet);
    if (named && grobo_i_dxl_get(servo, GROBO_ROLE_REPLY_LEVEL) == 2) {
        uint8_t now = servo->plant.id;
        servo->plant.id = id; /* a new one is for what comes next */
        answer(sim, index, &round, error, NULL, 0);
        servo->plant.id = now;
    }
    if (packet->instruction == GROBO_DXL2_REBOOT) {
        grobo_i_sim_reboot(sim, index);
    } else if (packet->instruction == GROBO_DXL2_FACTORY_RESET && error == GROBO_DXL2_DONE) {
        reset(sim, index, packet->data[0]);
    }
}

/* ---- packets for several ------------------------------------------------------------------- */

/* What a packet asks of the k-th of its list. */
typedef struct item {
    uint8_t id;
    uint16_t address, length;
    const uint8_t *data;
} item;

static bool is_bulk(const grobo_dxl2_packet *packet)
{
    return packet->instruction == GROBO_DXL2_BULK_READ ||
           packet->instruction == GROBO_DXL2_FAST_BULK_READ ||
           packet->instruction == GROBO_DXL2_BULK_WRITE;
}

static bool is_write(const grobo_dxl2_packet *packet)
{
    return packet->instruction == GROBO_DXL2_SYNC_WRITE ||
           packet->instruction == GROBO_DXL2_BULK_WRITE;
}

/* The item that begins at *at; false where no whole one does. */
static bool next_item(const grobo_dxl2_packet *packet, size_t *at, item *found)
{
    grobo_i_span span = {packet->data, packet->data_bytes};
    const uint8_t *head = grobo_i_span_at(span, *at, is_bulk(packet) ? 5 : 1);
    if (head == NULL) {
        return false;
    }
    *found = (item){head[0], packet->address, packet->length, NULL};
    *at += 1;
    if (is_bulk(packet)) {
        found->address = grobo_i_get_u16(head + 1);
        found->length = grobo_i_get_u16(head + 3);
        *at += 4;
    }
    if (is_write(packet)) {
        found->data = grobo_i_span_at(span, *at, found->length);
        *at += found->length;
        return found->data != NULL;
    }
    return true;
}

static int hearer(grobo_sim *sim, uint8_t id, int before, const grobo_sim_event *raw)
{
    int index = grobo_i_dxl_hearer(sim, &grobo_i_sim_dxl2, id, before, raw);
    if (index >= 0) {
        sim->servo[index].heard_us = sim->now_us;
    }
    return index;
}

static void read_each(grobo_sim *sim, const grobo_dxl2_packet *packet, const grobo_sim_event *raw)
{
    grobo_i_dxl_round round = {0};
    item one;
    for (size_t at = 0; next_item(packet, &at, &one);) {
        const grobo_i_dxl_round begin = round;
        int index = hearer(sim, one.id, -1, raw);
        if (index < 0) {
            grobo_i_dxl_silence(sim, &round, GROBO_DXL2_STATUS_BYTES + (size_t)one.length);
        }
        for (; index >= 0; index = hearer(sim, one.id, index, raw)) {
            grobo_i_dxl_round own = begin;
            answer_read(sim, index, &own, one.address, one.length);
            grobo_i_dxl_beside(&round, &own);
        }
    }
}

/* What one servo adds to a fast status, without its CRC. */
static void fast_part(grobo_sim *sim, int index, const item *one, uint8_t *bytes)
{
    grobo_sim_servo *servo = &sim->servo[index];
    refresh(sim, index);
    bytes[0] = with_alert(servo, GROBO_DXL2_DONE);
    bytes[1] = one->id;
    grobo_i_indirect_read(servo, one->address, one->length, bytes + 2);
}

/* Firmware that has no such instruction is silent (issue pollen-robotics/rustypot#122). */
static bool answers_fast(const grobo_sim_servo *servo, const item *one)
{
    uint8_t from = servo->model->fast_firmware;
    return from > 0 && grobo_i_dxl_get(servo, GROBO_ROLE_FIRMWARE) >= from &&
           one->length <= GROBO_SIM_TALK_BYTES - 16 &&
           judge_read(servo, one->address, one->length) == GROBO_DXL2_DONE;
}

/* One status that all of the list make together; whoever is silent ends it. */
static void read_fast(grobo_sim *sim, const grobo_dxl2_packet *packet, const grobo_sim_event *raw)
{
    uint8_t bytes[GROBO_SIM_TALK_BYTES] = {
        0xFF, 0xFF, 0xFD, 0x00, GROBO_DXL2_ID_ALL, 0, 0, GROBO_DXL2_STATUS};
    size_t length = 1, n = 8;
    uint16_t crc = 0;
    int64_t at_ns = -1;
    item one;
    for (size_t at = 0; next_item(packet, &at, &one);) {
        length += 4u + one.length;
    }
    grobo_i_put_u16(bytes + 5, (uint16_t)length);
    for (size_t at = 0; next_item(packet, &at, &one); n = 0) {
        int index = hearer(sim, one.id, -1, raw);
        if (index < 0 || !answers_fast(&sim->servo[index], &one)) {
            return;
        }
        if (at_ns < 0) {
            at_ns = (int64_t)grobo_i_dxl_get(&sim->servo[index], GROBO_ROLE_RETURN_DELAY) * 2000;
        }
        const size_t end = n + 2u + one.length;
        const uint16_t before = crc;
        for (; index >= 0; index = hearer(sim, one.id, index, raw)) {
            fast_part(sim, index, &one, bytes + n);
            crc = grobo_dxl2_crc(before, bytes, end);
            grobo_i_put_u16(bytes + end, crc);
            crc = grobo_dxl2_crc(crc, bytes + end, 2);
            grobo_i_sim_speak(sim, index, bytes, end + 2, at_ns);
        }
        at_ns += (int64_t)(end + 2) * sim->bus_byte_ns;
    }
}

static void write_each(grobo_sim *sim, const grobo_dxl2_packet *packet, const grobo_sim_event *raw)
{
    item one;
    for (size_t at = 0; next_item(packet, &at, &one);) {
        for (int i = -1; (i = hearer(sim, one.id, i, raw)) >= 0;) {
            (void)write(sim, i, one.address, one.data, one.length);
        }
    }
}

/* Everyone answers, in the order of ids. */
static void ping_all(grobo_sim *sim, const grobo_sim_event *raw)
{
    grobo_i_dxl_round round = {0};
    for (int id = 0; id <= GROBO_DXL2_ID_MAX; id++) {
        const grobo_i_dxl_round begin = round;
        for (int i = -1; (i = hearer(sim, (uint8_t)id, i, raw)) >= 0;) {
            grobo_i_dxl_round own = begin;
            ping(sim, i, &own);
            grobo_i_dxl_beside(&round, &own);
        }
    }
}

/* ---- packets ------------------------------------------------------------------------------- */

static bool is_for(const grobo_sim_servo *servo, uint8_t id)
{
    int second = servo->reg[12]; /* secondary_id; above the highest id: none */
    return servo->plant.id == id || id == GROBO_DXL2_ID_ALL ||
           (second == id && second <= GROBO_DXL2_ID_MAX);
}

static void spread(grobo_sim *sim, const grobo_dxl2_packet *packet, int result,
                   const grobo_sim_event *raw)
{
    for (int i = 0; i < sim->n_servos; i++) {
        grobo_sim_servo *servo = &sim->servo[i];
        grobo_i_dxl_round round = {0};
        if (servo->family != &grobo_i_sim_dxl2 || !is_for(servo, packet->id) ||
            !grobo_i_sim_hears(sim, i, raw)) {
            continue;
        }
        servo->heard_us = sim->now_us;
        bool named = packet->id == servo->plant.id; /* to its second id it says nothing */
        if (result >= 0 && packet->instruction != GROBO_DXL2_PING) {
            for_one(sim, i, packet);
        } else if (named && result >= 0) {
            ping(sim, i, &round);
        } else if (named) {
            answer(sim, i, &round, GROBO_DXL2_BAD_LENGTH, NULL, 0);
        }
    }
}

static void packet(const grobo_sim_family *self, grobo_sim *sim, const grobo_sim_event *raw)
{
    (void)self;
    uint8_t data[GROBO_DXL2_FRAME_MAX_BYTES];
    grobo_dxl2_packet parts = {.id = raw->bytes[4], .instruction = raw->bytes[7]};
    int result = grobo_dxl2_parse(raw->bytes, raw->n_bytes, data, sizeof data, &parts);
    uint8_t code = parts.instruction;
    if (code == GROBO_DXL2_SYNC_READ || code == GROBO_DXL2_BULK_READ) {
        read_each(sim, &parts, raw);
    } else if (code == GROBO_DXL2_FAST_SYNC_READ || code == GROBO_DXL2_FAST_BULK_READ) {
        read_fast(sim, &parts, raw);
    } else if (is_write(&parts)) {
        write_each(sim, &parts, raw);
    } else if (parts.id == GROBO_DXL2_ID_ALL && code == GROBO_DXL2_PING) {
        ping_all(sim, raw);
    } else {
        spread(sim, &parts, result, raw);
    }
}

static int measure(const uint8_t *bytes, size_t n, bool good)
{
    int size = grobo_dxl2_measure(bytes, n, GROBO_ACCEPT_COMMANDS);
    return size == GROBO_ERR_CHECKSUM && !good ? 7 + grobo_i_get_u16(bytes + 5) : size;
}

const grobo_sim_family grobo_i_sim_dxl2 = {.tables = {&grobo_i_dxl2_table},
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
                                           .store = store};

const grobo_sim_family *grobo_sim_dxl2(void)
{
    return &grobo_i_sim_dxl2;
}
