/* SPDX-License-Identifier: MIT */
/*
 * Where a shaft is, what it draws, how warm it is: functions of the time since the last goal.
 * Nothing is integrated in steps, so virtual time may jump by hours. In a world with weight
 * (world.h) that is only the plan, which the position loop follows.
 */
#include <math.h>
#include <stdlib.h>

#include "src/base/assert.h"
#include "src/sim/servo/family.h"
#include "src/sim/servo/note.h"
#include "src/sim/servo/shaft.h"
#include "src/sim/servo/world.h"

/* Assumptions (docs/simulator.md): mA of the circuit, of holding, of moving at full speed. */
#define IDLE_MA 6
#define HOLD_MA 40
#define MOVE_MA 260
/* How fast the heat of a current comes. */
#define HEAT_TAU_US 300e6

/* Further than anything turns. */
#define SPIN_MDEG 500000000
#define TURN_MDEG 360000

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

/* Slower than this a shaft stands. */
#define STANDS_MDEG_S 1000

/* A world's steps may be a little behind the last goal. */
static bool under_way(const grobo_sim_servo *servo, int64_t t_us)
{
    return servo->move_us > 0 && t_us < servo->start_us + servo->move_us;
}

bool grobo_i_sim_moving(const grobo_sim_servo *servo, int64_t t_us)
{
    const grobo_i_body *body = servo->body;
    return under_way(servo, t_us) || (body != NULL && fabs(body->speed_mdeg_s) > STANDS_MDEG_S);
}

/* Signed way since the begin of a move with ramps, and the speed then. */
static double ramped_way(const grobo_sim_ramps *r, double t_s, double *speed)
{
    double ramp_s = t_s < r->ramp_s ? t_s : r->ramp_s;
    double accel = r->ramp_s > 0 ? (r->peak - r->start) / r->ramp_s : 0;
    double way = r->start * ramp_s + accel * ramp_s * ramp_s / 2;
    *speed = r->start + accel * ramp_s;
    if (t_s > r->ramp_s) {
        double even_s = t_s - r->ramp_s < r->even_s ? t_s - r->ramp_s : r->even_s;
        double brake_s = t_s - r->ramp_s - even_s;
        brake_s = brake_s < r->brake_s ? brake_s : r->brake_s;
        way += r->peak * (even_s + brake_s) + r->end_accel * brake_s * brake_s / 2;
        *speed = r->peak + r->end_accel * brake_s;
    }
    return way;
}

static int64_t done_us_at(const grobo_sim_servo *servo, int64_t t_us)
{
    return t_us > servo->start_us ? t_us - servo->start_us : 0;
}

double grobo_i_sim_planned_mdeg(const grobo_sim_servo *servo, int64_t t_us)
{
    if (!under_way(servo, t_us)) {
        return servo->to_mdeg;
    }
    GROBO_ASSERT(servo->move_us > 0);
    int64_t done_us = done_us_at(servo, t_us);
    if (servo->ramped) {
        double speed;
        double way = ramped_way(&servo->ramps, (double)done_us / 1e6, &speed);
        double at = servo->from_mdeg + way;
        if (servo->body != NULL) {
            return at;
        }
        at = at < servo->stop_min_mdeg ? servo->stop_min_mdeg : at;
        return at > servo->stop_max_mdeg ? servo->stop_max_mdeg : at;
    }
    double way = (double)servo->to_mdeg - servo->from_mdeg; /* a wheel's is beyond the integers */
    return servo->from_mdeg + way * (double)done_us / (double)servo->move_us;
}

int32_t grobo_i_sim_angle_mdeg(const grobo_sim_servo *servo, int64_t t_us)
{
    const grobo_i_body *body = servo->body;
    double at = body != NULL ? body->angle_mdeg : grobo_i_sim_planned_mdeg(servo, t_us);
    return (int32_t)lround(at);
}

double grobo_i_sim_planned_mdeg_s(const grobo_sim_servo *servo, int64_t t_us)
{
    if (!under_way(servo, t_us)) {
        return 0;
    }
    if (servo->ramped) {
        double speed;
        (void)ramped_way(&servo->ramps, (double)done_us_at(servo, t_us) / 1e6, &speed);
        return speed;
    }
    return ((double)servo->to_mdeg - servo->from_mdeg) * 1e6 / (double)servo->move_us;
}

double grobo_i_sim_speed_mdeg_s(const grobo_sim_servo *servo, int64_t t_us)
{
    const grobo_i_body *body = servo->body;
    return body != NULL ? body->speed_mdeg_s : grobo_i_sim_planned_mdeg_s(servo, t_us);
}

int32_t grobo_i_sim_speed_dps(const grobo_sim_servo *servo, int64_t t_us)
{
    if (!grobo_i_sim_moving(servo, t_us)) {
        return 0;
    }
    if (servo->ramped || servo->body != NULL) {
        return (int32_t)lround(fabs(grobo_i_sim_speed_mdeg_s(servo, t_us)) / 1000);
    }
    int64_t way = (int64_t)servo->to_mdeg - servo->from_mdeg;
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
    servo->to_mdeg = servo->from_mdeg =
        (int32_t)lround(grobo_i_sim_planned_mdeg(servo, sim->now_us));
    servo->begun_us += rested_us > 0 ? rested_us : 0; /* to rest is not to move */
    servo->start_us = sim->now_us;
    servo->move_us = servo->plan_us = 0;
    servo->stalled = servo->by_hand = servo->ramped = false;
}

void grobo_i_sim_rest(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_sim_halt(sim, index);
    servo->to_mdeg = servo->from_mdeg = grobo_i_sim_angle_mdeg(servo, sim->now_us);
}

double grobo_i_sim_strain(const grobo_sim_servo *servo)
{
    const grobo_i_body *body = servo->body;
    if (servo->plant.torque != GROBO_TORQUE_ON) {
        return 0;
    }
    return body != NULL     ? body->strain
           : servo->stalled ? (double)servo->plant.most_ma / servo->plant.stall_ma
                            : 0;
}

int64_t grobo_i_sim_strained_us(const grobo_sim_servo *servo)
{
    const grobo_i_body *body = servo->body;
    if (servo->plant.torque != GROBO_TORQUE_ON) {
        return GROBO_NEVER_US;
    }
    return body != NULL     ? body->strained_us
           : servo->stalled ? servo->start_us + servo->move_us
                            : GROBO_NEVER_US;
}

/* Turns on and on, until it is told otherwise: its end is too far away to come. */
static void spin(grobo_sim_servo *servo)
{
    int64_t speed = servo->plant.wheel_mdeg_s;
    if (abs(servo->from_mdeg) > SPIN_MDEG / 2 && servo->body == NULL) { /* the shaft has no end */
        servo->from_mdeg = servo->to_mdeg = servo->from_mdeg % TURN_MDEG;
    }
    if (servo->body != NULL) {
        return; /* its loop is one of speed: there is nothing to plan */
    }
    if (servo->blocked || speed == 0) {
        servo->stalled = speed != 0;
        return;
    }
    servo->to_mdeg = speed > 0 ? servo->from_mdeg + SPIN_MDEG : servo->from_mdeg - SPIN_MDEG;
    servo->to_mdeg = clamp(servo->to_mdeg, servo->stop_min_mdeg, servo->stop_max_mdeg);
    servo->plan_us = servo->move_us =
        distance(servo->from_mdeg, servo->to_mdeg) * 1000000 / (speed < 0 ? -speed : speed);
    servo->stalled = servo->to_mdeg == servo->from_mdeg;
}

/* A move of this way that begins at a speed, with the acceleration, and ends at rest. */
static void ramp(grobo_sim_servo *servo, double way, double begin, double top, double accel)
{
    double dir = way - begin * fabs(begin) / (2 * accel) < 0 ? -1 : 1;
    double start = begin * dir;
    double peak = sqrt(fmax(accel * way * dir + start * start / 2, 0));
    peak = peak < top ? peak : top;
    grobo_sim_ramps *r = &servo->ramps;
    r->ramp_s = fabs(peak - start) / accel;
    r->brake_s = peak / accel;
    double even = way * dir - (start + peak) / 2 * r->ramp_s - peak / 2 * r->brake_s;
    r->even_s = peak > 0 && even > 0 ? even / peak : 0;
    r->start = begin;
    r->peak = peak * dir;
    r->end_accel = -accel * dir;
    servo->ramped = true;
    servo->plan_us = (int64_t)ceil((r->ramp_s + r->even_s + r->brake_s) * 1e6);
    servo->move_us = servo->plan_us;
}

/* A move with ramps that a stop ends: when it gets there. */
static void ramp_to_stop(grobo_sim_servo *servo)
{
    int64_t before_us = 0, behind_us = servo->plan_us;
    double wanted = servo->to_mdeg - servo->from_mdeg, speed;
    while (behind_us - before_us > 1) {
        int64_t us = before_us + (behind_us - before_us) / 2;
        double way = ramped_way(&servo->ramps, (double)us / 1e6, &speed);
        if (wanted < 0 ? way <= wanted : way >= wanted) {
            behind_us = us;
        } else {
            before_us = us;
        }
    }
    servo->move_us = behind_us;
}

/* The servo's own choice of ramps for a way; false where it has none. */
static bool plan_ramps(grobo_sim_servo *servo, double way, double begin, double top)
{
    const grobo_sim_wants *plant = &servo->plant;
    double accel = plant->accel_mdeg_s2;
    if (plant->ramp_us > 0) {
        double cap = fabs(way) * 1e6 / (plant->time_us - plant->ramp_us);
        accel = cap * 1e6 / plant->ramp_us;
        top = cap < top ? cap : top;
    }
    if (accel <= 0 || top <= 0 || (way == 0 && begin == 0)) {
        return false;
    }
    ramp(servo, way, begin, top, accel);
    return true;
}

/* Of a move; 0: at once, or not at all where the motor has none. */
static int64_t speed_of(const grobo_sim *sim, const grobo_sim_servo *servo)
{
    const grobo_sim_wants *plant = &servo->plant;
    const grobo_i_body *body = servo->body;
    int64_t speed = (int64_t)plant->speed_mdeg_s * sim->supply_mv / plant->nominal_mv;
    if (body != NULL) {
        speed = plant->speed_mdeg_s == 0 ? 0 : body->profile_mdeg_s;
    }
    int64_t cap = plant->cap_mdeg_s;
    return cap > 0 && (cap < speed || body != NULL) ? cap : speed;
}

/* Of a profile with ramps; where the loop has none, what the maker says of the servo. */
static double top_of(const grobo_sim_servo *servo, int64_t speed)
{
    return speed > 0 || servo->body == NULL ? (double)speed : servo->plant.speed_mdeg_s;
}

/*
 * The servo plans the way to its goal and knows nothing of stops: speed and time are those of the
 * whole way. The shaft goes along until it meets a stop, and the motor stalls there.
 */
void grobo_i_sim_drive(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const grobo_i_body *body = servo->body;
    double begin = servo->by_hand ? 0 : grobo_i_sim_planned_mdeg_s(servo, sim->now_us);
    grobo_i_sim_halt(sim, index);
    if (servo->plant.wheel) {
        spin(servo);
        return;
    }
    int32_t goal_mdeg = servo->plant.goal_mdeg;
    if (body != NULL) {
        servo->to_mdeg = goal_mdeg; /* what stops the shaft does not stop the plan */
    } else if (!servo->blocked) {
        servo->to_mdeg = clamp(goal_mdeg, servo->stop_min_mdeg, servo->stop_max_mdeg);
    }
    GROBO_ASSERT(servo->stop_min_mdeg <= servo->stop_max_mdeg);
    servo->stalled = servo->to_mdeg != goal_mdeg;
    int64_t wanted = distance(servo->from_mdeg, goal_mdeg);
    int64_t way = distance(servo->from_mdeg, servo->to_mdeg);
    int64_t speed = speed_of(sim, servo);
    if (!(servo->blocked && body == NULL) &&
        plan_ramps(servo, (double)goal_mdeg - servo->from_mdeg, begin, top_of(servo, speed))) {
        if (servo->stalled) {
            ramp_to_stop(servo);
        }
        return;
    }
    if (wanted == 0) {
        return;
    }
    int64_t least_us = speed > 0 ? wanted * 1000000 / speed : 0;
    int64_t left_us = servo->due_us - sim->now_us;
    servo->plan_us = left_us > least_us ? left_us : least_us;
    servo->move_us = servo->plan_us * way / wanted;
    GROBO_ASSERT(servo->move_us >= 0 && servo->move_us <= servo->plan_us);
}

void grobo_i_sim_set_out(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    servo->due_us = sim->now_us + servo->plant.time_us;
    servo->plant.goal_mdeg = servo->family->goal_mdeg(sim, servo);
    if (!servo->by_hand) {
        grobo_i_sim_drive(sim, index);
    }
    servo->begun_us = sim->now_us;
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
        grobo_i_sim_rest(sim, index);
    }
    int32_t here_mdeg = grobo_i_sim_angle_mdeg(servo, sim->now_us);
    const grobo_sim_family *family = servo->family;
    if (on && family->goal_mdeg != NULL) {
        servo->plant.goal_mdeg = family->goal_mdeg(sim, servo);
    }
    bool starts = on && (family->starts == NULL || family->starts(sim, index, here_mdeg));
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
    const grobo_i_body *body = servo->body;
    if (body != NULL) {
        bool on = servo->plant.torque == GROBO_TORQUE_ON;
        return IDLE_MA + (int32_t)lround(fabs(body->winding_ma)) + (on ? servo->load_ma : 0);
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

void grobo_i_sim_warm_by(grobo_sim *sim, int index, double ma)
{
    grobo_sim_servo *servo = &sim->servo[index];
    double last_c = sim->config.ambient_c + servo->plant.heat_c_per_ma2 * ma * ma;
    double passed_us = (double)(sim->now_us - servo->settled_us);
    servo->temperature_c += (last_c - servo->temperature_c) * passed_us / (HEAT_TAU_US + passed_us);
    servo->settled_us = sim->now_us;
    if (servo->powered && servo->plant.torque != GROBO_TORQUE_OFF &&
        servo->temperature_c >= servo->plant.limit_c) {
        overheat(sim, index);
    }
}

void grobo_i_sim_warm(grobo_sim *sim, int index, int64_t until_us)
{
    if (sim->servo[index].body != NULL) {
        return; /* its world warms it */
    }
    while (sim->servo[index].settled_us < until_us) {
        warm_once(sim, index, until_us);
    }
}
