/* SPDX-License-Identifier: MIT */
/* Simulated STS, SMS, HLS and SCS of Feetech: what they have beside registers and packets of the
 * Protocol 1.0. */
#include <stdlib.h>
#include <string.h>

#include <grobo/core/feetech.h>
#include <grobo/core/sim.h>

#include "src/base/bytes.h"
#include "src/servo/dxl1/sim_packets.h"
#include "src/servo/families.h"
#include "src/servo/tables.h"
#include "src/sim/servo/registers.h"
#include "src/sim/servo/shaft.h"

#define STS_COUNT_MA 6.5
#define TORQUE_FULL 1000

/* ---- units --------------------------------------------------------------------------------- */

static bool phase(const grobo_sim_servo *servo, unsigned bit)
{
    return ((unsigned)grobo_i_dxl1_sim_named(servo, "phase") & bit) != 0;
}

static double sts_speed_mdeg_s(const grobo_sim_servo *servo)
{
    return (phase(servo, GROBO_STS_PHASE_FINE_SPEED) ? 1 : 50) * grobo_i_dxl_tick_mdeg(servo);
}

static double sts_accel_mdeg_s2(const grobo_sim_servo *servo)
{
    return 100 * grobo_i_dxl_tick_mdeg(servo);
}

/* ---- positions ----------------------------------------------------------------------------- */

static bool sts_counts_turns(const grobo_sim_servo *servo)
{
    return phase(servo, GROBO_STS_PHASE_TURNS) || grobo_i_dxl1_sim_limits_are(servo, 0);
}

/* SCS do not turn around: positions end at the ends of their range. */
static bool scs_counts_turns(const grobo_sim_servo *servo)
{
    (void)servo;
    return true;
}

static int32_t offset(const grobo_sim_servo *servo)
{
    return -grobo_i_dxl_get(servo, GROBO_ROLE_OFFSET);
}

static bool sts_steps(const grobo_sim_servo *servo)
{
    return grobo_i_dxl_get(servo, GROBO_ROLE_MODE) == GROBO_STS_MODE_STEP;
}

/* Here becomes a position: by the offset, which may be as large as its range only. */
static void calibrate(grobo_sim *sim, int index, int32_t position)
{
    grobo_sim_servo *servo = &sim->servo[index];
    int32_t turn = grobo_i_dxl_turn(servo);
    int32_t here_mdeg = grobo_i_sim_angle_mdeg(servo, sim->now_us);
    int32_t ticks = grobo_i_dxl_ticks(servo, grobo_i_dxl1_sim_reverses(servo), here_mdeg);
    int32_t moved = turn > 0 ? grobo_i_dxl_wrap(ticks - position, turn) : 0;
    const grobo_servo_register *reg = grobo_servo_register_of(servo->model, GROBO_ROLE_OFFSET);
    if (turn > 0 && reg != NULL) {
        grobo_i_dxl_put(servo, GROBO_ROLE_OFFSET, moved > turn / 2 ? moved - turn : moved);
        memcpy(&servo->flash[reg->address], &servo->reg[reg->address], reg->bytes);
    }
}

/* ---- moves --------------------------------------------------------------------------------- */

static bool sts_is_wheel(const grobo_sim_servo *servo, double *speed_mdeg_s)
{
    double top = servo->plant.speed_mdeg_s;
    int32_t mode = grobo_i_dxl_get(servo, GROBO_ROLE_MODE);
    *speed_mdeg_s = mode == GROBO_STS_MODE_PWM
                        ? top * grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_PWM) / 1000
                        : sts_speed_mdeg_s(servo) * grobo_i_dxl_get(servo, GROBO_ROLE_SPEED);
    return mode == GROBO_STS_MODE_SPEED || mode == GROBO_STS_MODE_PWM;
}

/* HLS: a current in mode 2, the PWM of mode 3 in the same register. */
static bool hls_is_wheel(const grobo_sim_servo *servo, double *speed_mdeg_s)
{
    enum { MODE_CURRENT = 2, MODE_PWM = 3, PWM_FULL = 1000 };
    double top = servo->plant.speed_mdeg_s;
    int32_t mode = grobo_i_dxl_get(servo, GROBO_ROLE_MODE);
    int32_t counts = grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_CURRENT);
    double part = mode == MODE_CURRENT ? (counts > 0) - (counts < 0)
                                       : (double)grobo_i_dxl1_sim_bit10(counts) / PWM_FULL;
    *speed_mdeg_s = mode == GROBO_STS_MODE_SPEED ? grobo_i_dxl1_sim_speed_mdeg_s(servo) *
                                                       grobo_i_dxl_get(servo, GROBO_ROLE_SPEED)
                                                 : top * part;
    return mode != GROBO_STS_MODE_POSITION;
}

static bool scs_is_wheel(const grobo_sim_servo *servo, double *speed_mdeg_s)
{
    int32_t counts = grobo_i_dxl1_sim_bit10(grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_TIME));
    *speed_mdeg_s = (double)servo->plant.speed_mdeg_s * counts / 1023;
    return grobo_i_dxl1_sim_limits_are(servo, 0);
}

static int32_t sts_move_speed(grobo_sim_servo *servo)
{
    int32_t speed = grobo_i_dxl_get(servo, GROBO_ROLE_SPEED);
    if (speed == 0 && !phase(servo, GROBO_STS_PHASE_ZERO_FULL)) {
        servo->plant.speed_mdeg_s = 0;
    }
    return speed < 0 ? -speed : speed;
}

/* Without a speed the move has a time. */
static int32_t scs_move_speed(grobo_sim_servo *servo)
{
    int32_t speed = grobo_i_dxl_get(servo, GROBO_ROLE_SPEED) & 0x3FFF;
    if (speed == 0) {
        servo->plant.time_us = grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_TIME) * 1000;
    }
    return speed;
}

/* ---- force --------------------------------------------------------------------------------- */

static int32_t left_of(const grobo_sim_servo *servo, int32_t limit)
{
    int32_t left = grobo_i_dxl1_sim_named(servo, "protective_torque") * 10;
    return (servo->status & GROBO_FEETECH_OVERLOAD) != 0 && left < limit ? left : limit;
}

/* SCS and SM60CL have none but that which they keep. */
static int32_t torque_limit(const grobo_sim_servo *servo)
{
    bool own = grobo_servo_register_of(servo->model, GROBO_ROLE_TORQUE_LIMIT) != NULL;
    return left_of(servo,
                   grobo_i_dxl_get(servo, own ? GROBO_ROLE_TORQUE_LIMIT : GROBO_ROLE_MAX_TORQUE));
}

/* By the lower of the limit and the current of the goal. */
static int32_t hls_torque_limit(const grobo_sim_servo *servo)
{
    int32_t limit = grobo_i_dxl_get(servo, GROBO_ROLE_TORQUE_LIMIT);
    double most_ma = abs(grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_CURRENT)) * STS_COUNT_MA;
    double part = most_ma / servo->plant.stall_ma;
    return part < 1 ? (int32_t)(limit * part) : limit;
}

static grobo_i_dxl1_stall overload(const grobo_sim_servo *servo, int64_t unit_us)
{
    double effort = grobo_i_sim_strain(servo);
    int64_t after_us = grobo_i_dxl1_sim_named(servo, "protection_time") * unit_us;
    return effort * 100 >= grobo_i_dxl1_sim_named(servo, "overload_torque")
               ? (grobo_i_dxl1_stall){GROBO_FEETECH_OVERLOAD, after_us}
               : (grobo_i_dxl1_stall){0, 0};
}

static grobo_i_dxl1_stall overcurrent(const grobo_sim_servo *servo)
{
    double most_ma = grobo_i_dxl_get(servo, GROBO_ROLE_CURRENT_LIMIT) * STS_COUNT_MA;
    if (most_ma > 0 && grobo_i_sim_strain(servo) * servo->plant.stall_ma > most_ma) {
        return (grobo_i_dxl1_stall){GROBO_FEETECH_OVERCURRENT,
                                    grobo_i_dxl1_sim_named(servo, "overcurrent_time") * 10000LL};
    }
    return (grobo_i_dxl1_stall){0, 0};
}

static grobo_i_dxl1_stall sts_stall(const grobo_sim_servo *servo)
{
    grobo_i_dxl1_stall found = overcurrent(servo);
    return found.error != 0 ? found : overload(servo, 10000);
}

static grobo_i_dxl1_stall scs_stall(const grobo_sim_servo *servo)
{
    return overload(servo, 40000);
}

/* An overload only leaves less force: left_of(). */
static void shut_down(grobo_sim_servo *servo, unsigned error)
{
    if ((error & (GROBO_FEETECH_OVERHEATED | GROBO_FEETECH_OVERCURRENT)) != 0) {
        grobo_i_dxl_put(servo, GROBO_ROLE_TORQUE, 0);
    }
}

static uint8_t clears(const grobo_sim_servo *servo, const grobo_servo_register *reg)
{
    (void)servo;
    return reg->role == GROBO_ROLE_TORQUE ? GROBO_FEETECH_OVERLOAD | GROBO_FEETECH_OVERCURRENT : 0;
}

/* ---- instructions and values of their own -------------------------------------------------- */

static void wrote(grobo_sim *sim, int index, const grobo_servo_register *reg, int32_t value)
{
    grobo_sim_servo *servo = &sim->servo[index];
    if (reg->role == GROBO_ROLE_TORQUE && value == GROBO_STS_TORQUE_CALIBRATE) {
        calibrate(sim, index, servo->model->middle);
        grobo_i_dxl_put(servo, GROBO_ROLE_TORQUE, servo->plant.torque == GROBO_TORQUE_ON);
    }
}

static bool extra(grobo_sim *sim, int index, const grobo_dxl1_packet *packet)
{
    grobo_sim_servo *servo = &sim->servo[index];
    if (packet->instruction == GROBO_DXL1_RESET_TURNS) {
        grobo_i_dxl_one_turn(sim, servo, grobo_i_dxl1_sim_reverses(servo));
    } else if (packet->instruction == GROBO_DXL1_CALIBRATE) {
        bool given = packet->data_bytes == 2;
        calibrate(sim, index, given ? grobo_i_get_u16(packet->data) : servo->model->middle);
        grobo_i_dxl1_sim_follow(sim, index);
    } else {
        return packet->instruction == GROBO_DXL1_REBOOT; /* when the answer is made */
    }
    return true;
}

/* ---- the family ---------------------------------------------------------------------------- */

static const grobo_i_dxl1_series sts = {.locks = true,
                                        .sync_read = true,
                                        .ping_turns = true,
                                        .wheel_mode = true,
                                        .count_ma = STS_COUNT_MA,
                                        .speed_mdeg_s = sts_speed_mdeg_s,
                                        .accel_mdeg_s2 = sts_accel_mdeg_s2,
                                        .counts_turns = sts_counts_turns,
                                        .offset = offset,
                                        .steps = sts_steps,
                                        .is_wheel = sts_is_wheel,
                                        .move_speed = sts_move_speed,
                                        .torque_limit = torque_limit,
                                        .torque_full = TORQUE_FULL,
                                        .shut_down = shut_down,
                                        .stall = sts_stall,
                                        .clears = clears,
                                        .wrote = wrote,
                                        .extra = extra};

/* What they have of STS; no overload. */
static const grobo_i_dxl1_series hls = {.locks = true,
                                        .sync_read = true,
                                        .ping_turns = true,
                                        .wheel_mode = true,
                                        .count_ma = STS_COUNT_MA,
                                        .speed_mdeg_s = grobo_i_dxl1_sim_speed_mdeg_s,
                                        .accel_mdeg_s2 = sts_accel_mdeg_s2,
                                        .counts_turns = sts_counts_turns,
                                        .offset = offset,
                                        .is_wheel = hls_is_wheel,
                                        .move_speed = sts_move_speed,
                                        .torque_limit = hls_torque_limit,
                                        .torque_full = TORQUE_FULL,
                                        .shut_down = shut_down,
                                        .stall = overcurrent,
                                        .clears = clears,
                                        .wrote = wrote,
                                        .extra = extra};

/* A count of speed is a step/s. They have no register for the acceleration. */
static const grobo_i_dxl1_series scs = {.locks = true,
                                        .speed_mdeg_s = grobo_i_dxl_tick_mdeg,
                                        .accel_mdeg_s2 = grobo_i_dxl_tick_mdeg,
                                        .counts_turns = scs_counts_turns,
                                        .offset = offset,
                                        .is_wheel = scs_is_wheel,
                                        .move_speed = scs_move_speed,
                                        .torque_limit = torque_limit,
                                        .torque_full = TORQUE_FULL,
                                        .shut_down = shut_down,
                                        .stall = scs_stall,
                                        .clears = clears,
                                        .wrote = wrote,
                                        .extra = extra};

static const grobo_i_dxl1_series *series_of(const grobo_sim_servo *servo)
{
    bool has_current = grobo_servo_register_of(servo->model, GROBO_ROLE_GOAL_CURRENT) != NULL;
    return grobo_servo_series(servo->model) != &grobo_i_sts_table ? &scs
           : has_current                                          ? &hls
                                                                  : &sts;
}

const grobo_sim_family grobo_i_sim_feetech = {
    .tables = {&grobo_i_sts_table, &grobo_i_scs_table}, .series = series_of, GROBO_I_DXL1_SIM};

const grobo_sim_family *grobo_sim_feetech(void)
{
    return &grobo_i_sim_feetech;
}
