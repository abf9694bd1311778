/* SPDX-License-Identifier: MIT */
/* Simulated AX and MX of DYNAMIXEL: what they have beside packets of Protocol 1.0 and registers. */
#include <math.h>

#include <grobo/core/sim.h>

#include "src/servo/dxl1/sim_packets.h"
#include "src/servo/families.h"
#include "src/servo/tables.h"
#include "src/sim/servo/registers.h"
#include "src/sim/servo/shaft.h"

/* How long AX and MX bear a stall. An assumption. */
#define AX_OVERLOAD_US 1000000
#define AX_OVERLOAD_EFFORT 0.8
#define MX_COUNT_MA 4.5
#define TORQUE_FULL 1023

/* ---- units --------------------------------------------------------------------------------- */

static double accel_mdeg_s2(const grobo_sim_servo *servo)
{
    (void)servo;
    return 8583;
}

static int32_t rate_bps(int32_t code)
{
    return code < 250 ? 2000000 / (code + 1) : -1;
}

/* ---- positions ----------------------------------------------------------------------------- */

/* AX do not turn around: positions end at the ends of their range. */
static bool ax_counts_turns(const grobo_sim_servo *servo)
{
    (void)servo;
    return true;
}

static bool mx_counts_turns(const grobo_sim_servo *servo)
{
    return grobo_i_dxl1_sim_limits_are(servo, 4095);
}

/* Of MX that count turns; else it means nothing. */
static int32_t mx_offset(const grobo_sim_servo *servo)
{
    return mx_counts_turns(servo) ? grobo_i_dxl_get(servo, GROBO_ROLE_OFFSET) : 0;
}

static int32_t ax_offset(const grobo_sim_servo *servo)
{
    return grobo_i_dxl_get(servo, GROBO_ROLE_OFFSET);
}

/* ---- moves --------------------------------------------------------------------------------- */

static bool ax_is_wheel(const grobo_sim_servo *servo, double *speed_mdeg_s)
{
    int32_t counts = grobo_i_dxl1_sim_bit10(grobo_i_dxl_get(servo, GROBO_ROLE_SPEED));
    *speed_mdeg_s = (double)servo->plant.speed_mdeg_s * counts / TORQUE_FULL;
    return grobo_i_dxl1_sim_limits_are(servo, 0);
}

static bool mx_is_wheel(const grobo_sim_servo *servo, double *speed_mdeg_s)
{
    int32_t counts = grobo_i_dxl1_sim_bit10(grobo_i_dxl_get(servo, GROBO_ROLE_SPEED));
    *speed_mdeg_s = grobo_i_dxl1_sim_speed_mdeg_s(servo) * counts;
    return grobo_i_dxl1_sim_limits_are(servo, 0);
}

static int32_t move_speed(grobo_sim_servo *servo)
{
    return grobo_i_dxl_get(servo, GROBO_ROLE_SPEED) & 0x3FFF;
}

/* ---- force --------------------------------------------------------------------------------- */

static int32_t torque_limit(const grobo_sim_servo *servo)
{
    return grobo_i_dxl_get(servo, GROBO_ROLE_TORQUE_LIMIT);
}

static grobo_i_dxl1_stall stall(const grobo_sim_servo *servo)
{
    double effort = grobo_i_sim_strain(servo);
    return effort >= AX_OVERLOAD_EFFORT ? (grobo_i_dxl1_stall){GROBO_DXL1_OVERLOAD, AX_OVERLOAD_US}
                                        : (grobo_i_dxl1_stall){0, 0};
}

/* They lose their force. */
static void shut_down(grobo_sim_servo *servo, unsigned error)
{
    (void)error;
    grobo_i_dxl_put(servo, GROBO_ROLE_TORQUE_LIMIT, 0);
}

static uint8_t clears(const grobo_sim_servo *servo, const grobo_servo_register *reg)
{
    (void)servo;
    bool ends = reg->role == GROBO_ROLE_TORQUE || reg->role == GROBO_ROLE_TORQUE_LIMIT;
    return ends ? GROBO_DXL1_OVERLOAD : 0;
}

/* A current of 2048 is none. */
static void see_current(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    double ma = grobo_i_dxl_current_ma(sim, index);
    grobo_i_dxl_put(servo, GROBO_ROLE_CURRENT, 2048 + lround(ma / MX_COUNT_MA));
}

/* ---- the family ---------------------------------------------------------------------------- */

static const grobo_i_dxl1_series ax = {.judges = true,
                                       .speed_mdeg_s = grobo_i_dxl1_sim_speed_mdeg_s,
                                       .accel_mdeg_s2 = accel_mdeg_s2,
                                       .counts_turns = ax_counts_turns,
                                       .offset = ax_offset,
                                       .is_wheel = ax_is_wheel,
                                       .move_speed = move_speed,
                                       .torque_limit = torque_limit,
                                       .torque_full = TORQUE_FULL,
                                       .bps = rate_bps,
                                       .refresh = see_current,
                                       .shut_down = shut_down,
                                       .stall = stall,
                                       .clears = clears};

static const grobo_i_dxl1_series mx = {.judges = true,
                                       .bulk_read = true,
                                       .speed_mdeg_s = grobo_i_dxl1_sim_speed_mdeg_s,
                                       .accel_mdeg_s2 = accel_mdeg_s2,
                                       .counts_turns = mx_counts_turns,
                                       .offset = mx_offset,
                                       .is_wheel = mx_is_wheel,
                                       .move_speed = move_speed,
                                       .torque_limit = torque_limit,
                                       .torque_full = TORQUE_FULL,
                                       .bps = rate_bps,
                                       .refresh = see_current,
                                       .shut_down = shut_down,
                                       .stall = stall,
                                       .clears = clears};

static const grobo_i_dxl1_series *series_of(const grobo_sim_servo *servo)
{
    return servo->model->span_deg == 360 ? &mx : &ax;
}

const grobo_sim_family grobo_i_sim_dxl1 = {
    .tables = {&grobo_i_dxl1_table}, .series = series_of, GROBO_I_DXL1_SIM};

const grobo_sim_family *grobo_sim_dxl1(void)
{
    return &grobo_i_sim_dxl1;
}
