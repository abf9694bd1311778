/* SPDX-License-Identifier: MIT */
/*
 * Simulated DYNAMIXEL X, MX(2.0), P, PRO and XL-320: what their registers mean for the shaft,
 * and which writes they take. Their units are those of their tables.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/dxl2.h>
#include <grobo/core/protocol.h>
#include <grobo/core/sim.h>

#include "src/model/joint.h"
#include "src/servo/dxl2/series.h"
#include "src/servo/dxl2/sim_packets.h"
#include "src/servo/families.h"
#include "src/servo/tables.h"
#include "src/servo/unit.h"
#include "src/sim/servo/family.h"
#include "src/sim/servo/indirect.h"
#include "src/sim/servo/note.h"
#include "src/sim/servo/power.h"
#include "src/sim/servo/registers.h"
#include "src/sim/servo/servo.h"
#include "src/sim/servo/shaft.h"

/* Counts of the watchdog and of a voltage. */
#define WATCHDOG_US 20000
#define COUNT_MV 100
/* A motor that works this hard for this long is overloaded. An assumption. */
#define OVERLOAD_EFFORT 0.8
#define OVERLOAD_US 1000000
/* The part of a turn that a homing offset may be where a position is within one turn. */
#define HOMING_PART 4
/* Of a speed of XL-320's output, whose sign is bit 10. */
#define OUTPUT_FULL 1023
#define OUTPUT_SIGN 1024

static bool is_xl320(const grobo_sim_servo *servo)
{
    return grobo_i_dxl2_series_of(servo->model) == GROBO_I_DXL2_XL320;
}

static bool is_pro(const grobo_sim_servo *servo)
{
    return grobo_i_dxl2_series_of(servo->model) == GROBO_I_DXL2_PRO;
}

/* XL-320 have two modes, with numbers of their own. */
static int mode_of(const grobo_sim_servo *servo)
{
    int32_t mode = grobo_i_dxl_get(servo, GROBO_ROLE_MODE);
    return !is_xl320(servo)                      ? mode
           : mode == GROBO_DXL2_MODE_XL320_JOINT ? GROBO_DXL2_MODE_POSITION
                                                 : GROBO_DXL2_MODE_PWM;
}

static uint8_t error_of(const grobo_sim_servo *servo, unsigned error)
{
    return (uint8_t)(!is_xl320(servo)                 ? error
                     : error == GROBO_DXL2_VOLTAGE    ? GROBO_DXL2_XL320_VOLTAGE
                     : error == GROBO_DXL2_OVERHEATED ? GROBO_DXL2_XL320_OVERHEATED
                                                      : GROBO_DXL2_XL320_OVERLOAD);
}

/* A count of the register of a role; 0: there is none. */
static double unit_of(const grobo_sim_servo *servo, grobo_register_role role)
{
    const grobo_servo_register *reg = grobo_servo_register_of(servo->model, role);
    return reg == NULL ? 0 : grobo_i_register_unit(reg);
}

static double speed_mdeg_s(const grobo_sim_servo *servo)
{
    return unit_of(servo, GROBO_ROLE_PRESENT_SPEED) * 1000;
}

/* The unit is rev/min2, of which a minute more is in the time. */
static double accel_mdeg_s2(const grobo_sim_servo *servo)
{
    return unit_of(servo, GROBO_ROLE_ACCELERATION) * 1000 / 60;
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

bool grobo_i_dxl2_sim_reverses(const grobo_sim_servo *servo)
{
    return (grobo_i_dxl_get(servo, GROBO_ROLE_DIRECTION) & (int)GROBO_DXL2_DRIVE_REVERSE) != 0;
}

/* ---- positions ----------------------------------------------------------------------------- */

static int32_t position_at(const grobo_sim_servo *servo, int32_t angle_mdeg)
{
    int32_t ticks = grobo_i_dxl_ticks(servo, grobo_i_dxl2_sim_reverses(servo), angle_mdeg);
    int32_t offset = grobo_i_dxl_get(servo, GROBO_ROLE_OFFSET);
    int32_t turn = grobo_i_dxl_turn(servo), first = grobo_i_first_tick(servo->model);
    if (mode_of(servo) == GROBO_DXL2_MODE_POSITION && turn > 0) {
        bool counts = abs(offset) <= turn / HOMING_PART;
        return first + grobo_i_dxl_wrap(ticks - first, turn) + (counts ? offset : 0);
    }
    return ticks - servo->turns_ticks + offset;
}

/* The shaft's angle at the goal: as far from here as the goal is from the present position. */
int32_t grobo_i_dxl2_sim_goal_mdeg(const grobo_sim *sim, const grobo_sim_servo *servo)
{
    int32_t here_mdeg = grobo_i_sim_angle_mdeg(servo, sim->now_us);
    int32_t way = grobo_i_dxl_get(servo, GROBO_ROLE_GOAL) - position_at(servo, here_mdeg);
    int32_t ticks = grobo_i_dxl_ticks(servo, false, here_mdeg) +
                    (grobo_i_dxl2_sim_reverses(servo) ? -way : way);
    return (int32_t)lround((ticks - servo->model->middle) * grobo_i_dxl_tick_mdeg(servo));
}

/* ---- the shaft's side ---------------------------------------------------------------------- */

/* Part of what it can, by a register of the output. */
static double output_of(const grobo_sim_servo *servo)
{
    int32_t counts = grobo_i_dxl_get(servo, GROBO_ROLE_SPEED);
    if (is_xl320(servo)) {
        double part = (double)(counts % OUTPUT_SIGN) / OUTPUT_FULL;
        return counts >= OUTPUT_SIGN ? -part : part;
    }
    const grobo_servo_register *pwm = grobo_servo_register_of(servo->model, GROBO_ROLE_GOAL_PWM);
    return (double)grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_PWM) / pwm->max;
}

/* The register of a wheel's speed: of PRO the one that a goal's speed is in. */
static grobo_register_role speed_role(const grobo_sim_servo *servo)
{
    return is_pro(servo) ? GROBO_ROLE_SPEED : GROBO_ROLE_GOAL_SPEED;
}

static void follow_wheel(grobo_sim_servo *servo, int mode)
{
    grobo_sim_wants *plant = &servo->plant;
    double speed = plant->speed_mdeg_s;
    if (mode == GROBO_DXL2_MODE_VELOCITY) {
        speed = grobo_i_dxl_get(servo, speed_role(servo)) * speed_mdeg_s(servo);
    } else if (mode == GROBO_DXL2_MODE_PWM) {
        speed *= output_of(servo);
    } else { /* a current without a load: as fast as it can */
        int32_t current = grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_CURRENT);
        speed *= (current > 0) - (current < 0);
    }
    speed = fmin(fmax(speed, -plant->speed_mdeg_s), plant->speed_mdeg_s);
    plant->wheel = true;
    plant->wheel_mdeg_s = (int32_t)lround(grobo_i_dxl2_sim_reverses(servo) ? -speed : speed);
}

/* The register that bounds the current in this mode; NULL: none does. */
static const grobo_servo_register *bound_of(const grobo_sim_servo *servo, int mode)
{
    grobo_i_dxl2_series series = grobo_i_dxl2_series_of(servo->model);
    grobo_register_role role = GROBO_ROLE_GOAL_CURRENT;
    if (series == GROBO_I_DXL2_XL320) {
        role = GROBO_ROLE_TORQUE_LIMIT;
    } else if (series == GROBO_I_DXL2_X && mode != GROBO_DXL2_MODE_GRIP) {
        return NULL;
    } else if (series == GROBO_I_DXL2_PRO && grobo_i_dxl_get(servo, role) == 0) {
        role = GROBO_ROLE_CURRENT_LIMIT; /* 0: no bound but this (emanual goal_torque) */
    }
    return grobo_servo_register_of(servo->model, role);
}

static void follow(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_sim_wants *plant = &servo->plant;
    int mode = mode_of(servo);
    int32_t velocity = grobo_i_dxl_get(servo, GROBO_ROLE_SPEED);
    int32_t acceleration = grobo_i_dxl_get(servo, GROBO_ROLE_ACCELERATION);
    grobo_i_dxl_follow(sim, index);
    const grobo_servo_register *bound = bound_of(servo, mode);
    if (bound != NULL) {
        int64_t counts = abs(grobo_i_dxl_get(servo, (grobo_register_role)bound->role));
        plant->most_ma = (int32_t)(plant->stall_ma * counts / bound->max);
    }
    if (!places(mode)) {
        follow_wheel(servo, mode);
    } else if (drives_by_time(servo)) {
        plant->time_us = velocity * 1000;
        plant->ramp_us =
            acceleration * 1000 < plant->time_us / 2 ? acceleration * 1000 : plant->time_us / 2;
    } else {
        plant->cap_mdeg_s = (int32_t)lround(fmin(fabs(velocity * speed_mdeg_s(servo)), INT32_MAX));
        plant->accel_mdeg_s2 =
            (int32_t)lround(fmin(acceleration * accel_mdeg_s2(servo), INT32_MAX));
    }
}

void grobo_i_dxl2_sim_cut(grobo_sim *sim, int index, bool hot)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_dxl_put(servo, GROBO_ROLE_TORQUE, 0);
    servo->status |= hot ? error_of(servo, GROBO_DXL2_OVERHEATED) : 0;
    follow(sim, index);
}

void grobo_i_dxl2_sim_refresh(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const grobo_servo_register *pwm = grobo_servo_register_of(servo->model, GROBO_ROLE_GOAL_PWM);
    int64_t now_us = sim->now_us;
    double speed = speed_mdeg_s(servo);
    grobo_i_sim_settle(sim, index);
    grobo_i_dxl_refresh(sim, index, grobo_i_dxl2_sim_reverses(servo) ? -speed : speed,
                        unit_of(servo, GROBO_ROLE_CURRENT));
    int32_t position = position_at(servo, grobo_i_sim_angle_mdeg(servo, now_us));
    grobo_i_dxl_put(servo, GROBO_ROLE_POSITION, position);
    grobo_i_dxl_put(servo, GROBO_ROLE_ERROR, servo->status);
    static const char *const same[] = {"position_trajectory", "velocity_trajectory", "present_pwm",
                                       "tick", "moving_status"};
    bool moves = grobo_i_sim_moving(servo, now_us);
    const int64_t values[] = {position, grobo_i_dxl_get(servo, GROBO_ROLE_PRESENT_SPEED),
                              lround(grobo_i_dxl_effort(sim, index) * (pwm != NULL ? pwm->max : 0)),
                              now_us / 1000 % 32768, moves ? 0x32 : 0x01};
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
        const grobo_servo_register *reg = grobo_servo_register_named(servo->model, same[i]);
        if (reg != NULL) {
            (void)grobo_servo_register_put(servo->model, reg, (int32_t)values[i],
                                           &servo->reg[reg->address]);
        }
    }
}

/* ---- what a servo does by itself ----------------------------------------------------------- */

static int64_t overload_us(const grobo_sim_servo *servo)
{
    int64_t since_us = grobo_i_sim_strained_us(servo);
    bool works = since_us != GROBO_NEVER_US && grobo_i_sim_strain(servo) >= OVERLOAD_EFFORT &&
                 (servo->status & error_of(servo, GROBO_DXL2_OVERLOAD)) == 0;
    return works ? since_us + OVERLOAD_US : GROBO_NEVER_US;
}

static int64_t watchdog_us(const grobo_sim_servo *servo)
{
    int32_t count = grobo_i_dxl_get(servo, GROBO_ROLE_WATCHDOG);
    return count > 0 && servo->plant.torque == GROBO_TORQUE_ON
               ? servo->heard_us + (int64_t)count * WATCHDOG_US
               : GROBO_NEVER_US;
}

int64_t grobo_i_dxl2_sim_next_us(const grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    if (!servo->powered) {
        return GROBO_NEVER_US;
    }
    if ((servo->status & error_of(servo, GROBO_DXL2_VOLTAGE)) == 0 &&
        !grobo_i_dxl_fed(sim, servo, COUNT_MV)) {
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
        grobo_i_dxl2_sim_cut(sim, index, false);
        grobo_i_sim_torque(sim, index, before);
    }
}

void grobo_i_dxl2_sim_act(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    if ((servo->status & error_of(servo, GROBO_DXL2_VOLTAGE)) == 0 &&
        !grobo_i_dxl_fed(sim, servo, COUNT_MV)) {
        fail(sim, index, error_of(servo, GROBO_DXL2_VOLTAGE));
    } else if (overload_us(servo) <= sim->now_us) {
        fail(sim, index, error_of(servo, GROBO_DXL2_OVERLOAD));
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

int32_t grobo_i_dxl2_sim_bps(const grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    return grobo_servo_baud_bps(servo->model, grobo_i_dxl_get(servo, GROBO_ROLE_BAUD));
}

/* Output and current as far as their limits (of PRO 0 says so), the goal where it is. */
static void goals_anew(const grobo_sim *sim, grobo_sim_servo *servo)
{
    int32_t here_mdeg = grobo_i_sim_angle_mdeg(servo, sim->now_us);
    grobo_i_dxl_put(servo, GROBO_ROLE_GOAL_PWM, grobo_i_dxl_get(servo, GROBO_ROLE_MAX_TORQUE));
    grobo_i_dxl_put(servo, GROBO_ROLE_GOAL_CURRENT,
                    is_pro(servo) ? 0 : grobo_i_dxl_get(servo, GROBO_ROLE_CURRENT_LIMIT));
    grobo_i_dxl_one_turn(sim, servo, grobo_i_dxl2_sim_reverses(servo));
    grobo_i_dxl_put(servo, GROBO_ROLE_GOAL, position_at(servo, here_mdeg));
}

void grobo_i_dxl2_sim_restart(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_dxl_boot(sim, index);
    grobo_i_indirect_restart(servo);
    goals_anew(sim, servo);
    grobo_i_dxl2_sim_start_up(servo);
    servo->heard_us = sim->now_us;
    follow(sim, index);
    grobo_i_sim_torque(sim, index, GROBO_TORQUE_OFF);
}

static bool has_mode(const grobo_sim_servo *servo, int32_t mode)
{
    grobo_i_dxl2_series series = grobo_i_dxl2_series_of(servo->model);
    bool by_current = mode == GROBO_DXL2_MODE_CURRENT || mode == GROBO_DXL2_MODE_GRIP;
    if (series != GROBO_I_DXL2_X && mode == GROBO_DXL2_MODE_GRIP) {
        return false;
    }
    return series == GROBO_I_DXL2_XL320 ? true
           : by_current
               ? grobo_servo_register_of(servo->model, GROBO_ROLE_GOAL_CURRENT) != NULL
               : places(mode) || mode == GROBO_DXL2_MODE_VELOCITY || mode == GROBO_DXL2_MODE_PWM;
}

bool grobo_i_dxl2_sim_factory(grobo_sim *sim, int index, uint8_t id, uint32_t baud_bps)
{
    grobo_sim_servo *servo = &sim->servo[index];
    if (!grobo_i_dxl_sell(sim, index, id, GROBO_DXL2_ID_MAX, baud_bps)) {
        return false;
    }
    grobo_i_indirect_factory(servo);
    bool wheel = sim->config.mounted && grobo_i_joint_is_wheel(sim->config.model, index);
    if (wheel) {
        grobo_i_dxl_put(servo, GROBO_ROLE_MODE, 1); /* of XL-320 too */
    } else if (sim->config.mounted && !is_xl320(servo)) {
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
    } else if (reg->role == speed_role(servo)) {
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

static bool is_goal(const grobo_sim_servo *servo, const grobo_servo_register *reg)
{
    bool output = is_xl320(servo) && reg->role == GROBO_ROLE_SPEED; /* of a wheel */
    return output || reg->role == GROBO_ROLE_GOAL || reg->role == speed_role(servo) ||
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
    bool stopped = is_goal(servo, reg) && grobo_i_dxl_get(servo, GROBO_ROLE_WATCHDOG) < 0;
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

uint8_t grobo_i_dxl2_sim_judge(const grobo_sim_servo *servo, int address, const uint8_t *bytes,
                               size_t n)
{
    uint8_t error = n == 0 ? GROBO_DXL2_BAD_LENGTH : GROBO_DXL2_DONE;
    for (size_t at = 0; at < n && error == GROBO_DXL2_DONE;) {
        grobo_i_indirect_piece piece = grobo_i_indirect_piece_at(servo, address + (int)at, n - at);
        if (piece.kind == GROBO_I_INDIRECT_REGISTERS) {
            error = judge_registers(servo, piece.address, bytes + at, piece.n);
        } else if (piece.kind == GROBO_I_INDIRECT_ADDRESS) {
            bool locked =
                grobo_i_indirect_kept(servo) && grobo_i_dxl_get(servo, GROBO_ROLE_TORQUE) != 0;
            error = locked                                             ? GROBO_DXL2_NO_ACCESS
                    : grobo_i_indirect_fits(servo, &piece, bytes + at) ? GROBO_DXL2_DONE
                                                                       : GROBO_DXL2_BAD_RANGE;
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
        const grobo_servo_register *reg = grobo_servo_register_named(servo->model, gains[i]);
        if (reg != NULL) {
            grobo_i_dxl_hold(servo, reg, reg->factory);
        }
    }
    grobo_i_dxl_put(servo, GROBO_ROLE_SPEED, 0);
    grobo_i_dxl_put(servo, GROBO_ROLE_ACCELERATION, 0);
    goals_anew(sim, servo);
}

static void took_effect(grobo_sim *sim, int index, const grobo_servo_register *reg)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_torque before = (grobo_torque)servo->plant.torque;
    int32_t value = grobo_servo_register_get(servo->model, reg, &servo->reg[reg->address]);
    if (reg->role == GROBO_ROLE_MODE) {
        mode_written(sim, index);
    } else if (is_goal(servo, reg) && wakes(servo)) {
        grobo_i_dxl_put(servo, GROBO_ROLE_TORQUE, 1);
    }
    follow(sim, index);
    grobo_i_sim_torque(sim, index, before);
    if (servo->plant.torque == GROBO_TORQUE_ON && is_goal(servo, reg) &&
        (reg->role == GROBO_ROLE_GOAL || servo->plant.wheel)) {
        grobo_i_sim_set_out(sim, index);
    }
    grobo_i_dxl_tell(sim, index, reg, value);
}

int grobo_i_dxl2_sim_store(grobo_sim *sim, int index, int address, const uint8_t *bytes, size_t n)
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

uint8_t grobo_i_dxl2_sim_write(grobo_sim *sim, int index, int address, const uint8_t *bytes,
                               size_t n)
{
    grobo_sim_servo *servo = &sim->servo[index];
    uint8_t error = grobo_i_dxl2_sim_judge(servo, address, bytes, n);
    if (error != GROBO_DXL2_DONE) {
        grobo_i_sim_note(sim, GROBO_SIM_REFUSED, index, address);
    }
    for (size_t at = 0; at < n && error == GROBO_DXL2_DONE;) {
        grobo_i_indirect_piece piece = grobo_i_indirect_piece_at(servo, address + (int)at, n - at);
        if (piece.kind == GROBO_I_INDIRECT_REGISTERS) {
            (void)grobo_i_dxl2_sim_store(sim, index, piece.address, bytes + at, piece.n);
        } else {
            grobo_i_indirect_write(servo, &piece, bytes + at);
        }
        at += piece.n;
    }
    return error;
}
