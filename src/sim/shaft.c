/* SPDX-License-Identifier: MIT */
/*
 * Where a shaft is, what it draws, how warm it is: functions of the time since the last goal.
 * Nothing is integrated in steps, so virtual time may jump by hours.
 */
#include <math.h>

#include "src/base/assert.h"
#include "src/sim/family.h"
#include "src/sim/note.h"
#include "src/sim/shaft.h"

/* Assumptions (docs/simulator.md): mA of the circuit, of holding, of moving at full speed. */
#define IDLE_MA 6
#define HOLD_MA 40
#define MOVE_MA 260
/* How fast the heat of a current comes. */
#define HEAT_TAU_US 300e6

#define MDEG_PER_RAD (180000.0 / 3.14159265358979323846)

/* ---- position ------------------------------------------------------------------------------ */

static int32_t round_div(int64_t n, int64_t d)
{
    return (int32_t)((n < 0 ? n - d / 2 : n + d / 2) / d);
}

int32_t grobo_i_sim_mdeg_of_rad(double angle_rad)
{
    return (int32_t)lround(angle_rad * MDEG_PER_RAD);
}

bool grobo_i_sim_moving(const grobo_sim_servo *servo, int64_t t_us)
{
    return t_us < servo->start_us + servo->move_us;
}

int32_t grobo_i_sim_angle_mdeg(const grobo_sim_servo *servo, int64_t t_us)
{
    if (!grobo_i_sim_moving(servo, t_us)) {
        return servo->to_mdeg;
    }
    GROBO_ASSERT(servo->move_us > 0);
    int64_t way = servo->to_mdeg - servo->from_mdeg;
    int64_t done_us = t_us > servo->start_us ? t_us - servo->start_us : 0;
    return servo->from_mdeg + round_div(way * done_us, servo->move_us);
}

int32_t grobo_i_sim_speed_dps(const grobo_sim_servo *servo, int64_t t_us)
{
    if (!grobo_i_sim_moving(servo, t_us)) {
        return 0;
    }
    int64_t way = servo->to_mdeg - servo->from_mdeg;
    return round_div((way < 0 ? -way : way) * 1000, servo->move_us);
}

/* When the last move by the servo's own power ends or has ended, be the shaft on the way or not. */
static int64_t own_end_us(const grobo_sim_servo *servo)
{
    return servo->start_us + servo->plan_us;
}

int64_t grobo_i_sim_move_age_us(const grobo_sim_servo *servo, int64_t t_us)
{
    int64_t end_us = own_end_us(servo);
    int64_t age_us = (t_us < end_us ? t_us : end_us) - servo->begun_us;
    return age_us > 0 ? age_us : 0;
}

static int32_t clamp(int32_t x, int32_t min, int32_t max)
{
    return x < min ? min : x > max ? max : x;
}

static int64_t distance(int32_t a, int32_t b)
{
    return a < b ? (int64_t)b - a : (int64_t)a - b;
}

void grobo_i_sim_halt(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    int64_t rested_us = sim->now_us - own_end_us(servo);
    servo->to_mdeg = servo->from_mdeg = grobo_i_sim_angle_mdeg(servo, sim->now_us);
    servo->begun_us += rested_us > 0 ? rested_us : 0; /* to rest is not to move */
    servo->start_us = sim->now_us;
    servo->move_us = servo->plan_us = 0;
    servo->stalled = servo->by_hand = false;
}

/*
 * The servo plans the way to its goal and knows nothing of stops: speed and time are those of the
 * whole way. The shaft goes along until it meets a stop, and the motor stalls there.
 */
void grobo_i_sim_drive(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_sim_halt(sim, index);
    int32_t goal_mdeg = servo->plant.goal_mdeg;
    if (!servo->blocked) {
        servo->to_mdeg = clamp(goal_mdeg, servo->stop_min_mdeg, servo->stop_max_mdeg);
    }
    GROBO_ASSERT(servo->stop_min_mdeg <= servo->stop_max_mdeg);
    servo->stalled = servo->to_mdeg != goal_mdeg;
    int64_t wanted = distance(servo->from_mdeg, goal_mdeg);
    int64_t way = distance(servo->from_mdeg, servo->to_mdeg);
    if (wanted == 0) {
        return;
    }
    int64_t speed = (int64_t)servo->plant.speed_mdeg_s * sim->supply_mv / servo->plant.nominal_mv;
    int64_t least_us = speed > 0 ? wanted * 1000000 / speed : 0;
    int64_t left_us = servo->due_us - sim->now_us;
    servo->plan_us = left_us > least_us ? left_us : least_us;
    servo->move_us = servo->plan_us * way / wanted;
    GROBO_ASSERT(servo->move_us >= 0 && servo->move_us <= servo->plan_us);
}

void grobo_i_sim_go_on(grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    if (servo->powered && !servo->by_hand && servo->plant.torque == GROBO_TORQUE_ON) {
        grobo_i_sim_drive(sim, index);
    }
}

/* ---- torque -------------------------------------------------------------------------------- */

void grobo_i_sim_torque(grobo_sim *sim, int index, grobo_torque before)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_torque torque = (grobo_torque)servo->plant.torque;
    if (torque == before) {
        return;
    }
    bool on = torque == GROBO_TORQUE_ON;
    if (!servo->by_hand) {
        grobo_i_sim_halt(sim, index);
    }
    int32_t here_mdeg = grobo_i_sim_angle_mdeg(servo, sim->now_us);
    bool starts = on && servo->family->starts(sim, index, here_mdeg);
    if (starts && !servo->by_hand) { /* from under a hand at the end of its way */
        servo->due_us = sim->now_us;
        grobo_i_sim_drive(sim, index);
        servo->begun_us = sim->now_us;
    }
    grobo_i_sim_note(sim, GROBO_SIM_TORQUE, index, (int32_t)torque);
}

/* ---- current and temperature --------------------------------------------------------------- */

int32_t grobo_i_sim_current_ma(const grobo_sim_servo *servo, int64_t t_us)
{
    if (!servo->powered) {
        return 0;
    }
    if (servo->plant.torque != GROBO_TORQUE_ON) {
        return IDLE_MA;
    }
    int32_t most_ma = servo->plant.most_ma;
    int32_t ma = HOLD_MA + servo->load_ma;
    if (grobo_i_sim_moving(servo, t_us)) {
        ma += (int32_t)((int64_t)MOVE_MA * grobo_i_sim_speed_dps(servo, t_us) * 1000 /
                        servo->plant.speed_mdeg_s);
    } else if (servo->stalled) {
        ma = most_ma;
    }
    return clamp(ma, IDLE_MA, most_ma < IDLE_MA ? IDLE_MA : most_ma);
}

static void overheat(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    servo->family->cut(sim, index, true);
    grobo_i_sim_note(sim, GROBO_SIM_OVERHEAT, index, (int32_t)lround(servo->temperature_c));
    grobo_i_sim_torque(sim, index, GROBO_TORQUE_ON);
}

/* Warms or cools for at most until_us; stops early where the current changes or the torque goes. */
static void warm_once(grobo_sim *sim, int index, int64_t until_us)
{
    grobo_sim_servo *servo = &sim->servo[index];
    int64_t from_us = servo->settled_us, end_us = servo->start_us + servo->move_us;
    int64_t to_us = from_us < end_us && end_us < until_us ? end_us : until_us;
    double ma = grobo_i_sim_current_ma(servo, from_us);
    double last_c = sim->config.ambient_c + servo->plant.heat_c_per_ma2 * ma * ma;
    double limit_c = servo->plant.limit_c;
    bool on = servo->powered && servo->plant.torque != GROBO_TORQUE_OFF;
    bool cut = on && servo->temperature_c >= limit_c;
    if (on && !cut && last_c > limit_c) {
        double left_us = HEAT_TAU_US * log((last_c - servo->temperature_c) / (last_c - limit_c));
        cut = left_us < (double)(to_us - from_us);
        to_us = cut ? from_us + (int64_t)ceil(left_us) : to_us;
    } else if (cut) {
        to_us = from_us;
    }
    servo->temperature_c =
        last_c + (servo->temperature_c - last_c) * exp((double)(from_us - to_us) / HEAT_TAU_US);
    servo->settled_us = sim->now_us = to_us;
    if (cut) {
        overheat(sim, index);
    }
}

void grobo_i_sim_warm(grobo_sim *sim, int index, int64_t until_us)
{
    while (sim->servo[index].settled_us < until_us) {
        warm_once(sim, index, until_us);
    }
}
