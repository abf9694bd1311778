/* SPDX-License-Identifier: MIT */
/*
 * A world in steps of 1 ms: each servo's loop and motor make a drive of its joint, a plant moves
 * the joints, what came of it is what the servo measures. Every tenth step servos are warmed, and
 * do what they do by themselves.
 *
 * A step begins with all values of the step before, so the order of joints does not matter.
 */
#include <math.h>
#include <string.h>

#include <grobo/core/imu.h>

#include "src/base/assert.h"
#include "src/base/memory.h"
#include "src/base/sized.h"
#include "src/model/joint.h"
#include "src/sim/physics/loops.h"
#include "src/sim/physics/physics.h"
#include "src/sim/servo/family.h"
#include "src/sim/servo/power.h"
#include "src/sim/servo/registers.h"
#include "src/sim/servo/shaft.h"

#define PI 3.14159265358979323846
#define STEP_S (GROBO_SIM_STEP_US / 1e6)
/* Steps from one look at heat, supply and what servos do by themselves to the next. */
#define CHORE_STEPS 10
#define CHORE_US (CHORE_STEPS * GROBO_SIM_STEP_US)
/* Further behind the clock than this, steps are skipped; one that rests may be so far behind. */
#define LATE_US 200000
/* Slower than this no joint of a world that rests may be. */
#define REST_RAD_S 1e-4
/* The supply's capacitors: this part of the way to its new voltage in a step. An assumption. */
#define BUS_PART 0.2
/* So long below GROBO_SIM_BROWN_OUT_MV resets the servos. An assumption. */
#define LOW_US 5000
#define IDLE_A 0.006
/* A shaft that stands beyond a stop is brought back no faster than this. */
#define BACK_RAD_S 1.0
/* Duty for an error of speed of 1 rad/s where a servo turns on and on. An assumption. */
#define WHEEL_DUTY 0.5
/* How fast a load falls through the backlash, rad/s, and the least that does. Assumptions. */
#define PLAY_RAD_S 0.5
#define PLAY_LEAST_NM 0.002
#define GRAVITY_M_S2 9.80665
#define SUPPLY_MOHM 100

static double rad_of_mdeg(double mdeg)
{
    return mdeg / 1000 * PI / 180;
}

static double mdeg_of_rad(double rad)
{
    return rad * 180 / PI * 1000;
}

/* ---- a servo's drive ------------------------------------------------------------------------ */

static double volts_in(const grobo_i_world *w, const grobo_sim *sim, const grobo_sim_servo *servo)
{
    return w->base.bus_mv * servo->model->voltage_mv / sim->config.supply_mv / 1000;
}

static double shaft_rad(const grobo_i_joint_world *j, const grobo_sim_state *state)
{
    return j->zero_rad + j->ratio * state->angle_rad;
}

/* Duty of a servo that holds or moves: by its position loop, or by speed. */
static double duty_of(grobo_i_joint_world *j, const grobo_sim *sim, const grobo_sim_servo *servo,
                      const grobo_sim_state *state, double volts)
{
    double speed = j->ratio * state->speed_rad_s;
    if (servo->plant.wheel) {
        double wanted = rad_of_mdeg(servo->plant.wheel_mdeg_s);
        double duty = wanted * j->motor.kt_nm_a / fmax(volts, 1) + WHEEL_DUTY * (wanted - speed);
        duty = wanted == 0 && servo->plant.speed_mdeg_s == 0 ? 0 : duty;
        return fmin(fmax(duty, -j->loop.duty_max), j->loop.duty_max);
    }
    double seen = rad_of_mdeg(j->body.angle_mdeg);
    if (j->tick_rad > 0) {
        seen = round(seen / j->tick_rad) * j->tick_rad;
    }
    j->set_rad = rad_of_mdeg(grobo_i_sim_planned_mdeg(servo, sim->now_us));
    double set_rad_s = rad_of_mdeg(grobo_i_sim_planned_mdeg_s(servo, sim->now_us));
    j->integral += (j->set_rad - seen) * STEP_S;
    return grobo_i_loop_duty(&j->loop, j->set_rad - seen, set_rad_s - speed, &j->integral);
}

/* The winding's current at a speed, as the servo's limits let it be. */
static double current_of(const grobo_i_joint_world *j, double volts, double speed, bool *limited)
{
    const grobo_sim_motor *motor = &j->motor;
    double amps = (volts - motor->kt_nm_a * speed) / motor->resistance_ohm;
    double most = j->loop.current_max_a > 0 ? j->loop.current_max_a : INFINITY;
    if (motor->torque_max_nm > 0) {
        most = fmin(most, motor->torque_max_nm / motor->kt_nm_a);
    }
    *limited = fabs(amps) > most;
    return *limited ? copysign(most, amps) : amps;
}

/* Speeds that stops, walls and hands leave to a joint. */
static void bound(const grobo_i_joint_world *j, const grobo_sim *sim, const grobo_sim_servo *servo,
                  const grobo_sim_state *state, grobo_sim_drive *drive)
{
    double here = mdeg_of_rad(shaft_rad(j, state)), low = -INFINITY, high = INFINITY;
    if (servo->by_hand) {
        double next = grobo_i_sim_planned_mdeg(servo, sim->now_us + GROBO_SIM_STEP_US);
        low = high = rad_of_mdeg(next - here) / STEP_S;
    } else if (servo->blocked) {
        low = high = 0;
    } else {
        double min = fmax(servo->stop_min_mdeg, j->wall_mdeg[0]);
        double max = fmin(servo->stop_max_mdeg, j->wall_mdeg[1]);
        low = fmin(rad_of_mdeg(min - here) / STEP_S, BACK_RAD_S);
        high = fmax(rad_of_mdeg(max - here) / STEP_S, -BACK_RAD_S);
    }
    bool opposed = j->ratio < 0;
    drive->low_rad_s = (opposed ? high : low) / j->ratio;
    drive->high_rad_s = (opposed ? low : high) / j->ratio;
}

static void drive(grobo_i_world *w, const grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_joint_world *j = &w->joint[index];
    const grobo_sim_state *state = &w->state[index];
    const grobo_sim_motor *motor = &j->motor;
    double torque_nm = 0, damping = 0, speed = j->ratio * state->speed_rad_s;
    bool on = servo->powered && servo->plant.torque == GROBO_TORQUE_ON;
    bool brake = servo->powered && servo->plant.torque == GROBO_TORQUE_BRAKE;
    if (j->body.stale) {
        grobo_i_loop_read(servo, motor, &j->loop);
        j->body.stale = false;
    }
    j->body.duty = 0;
    if (on) {
        double volts = volts_in(w, sim, servo);
        j->body.duty = duty_of(j, sim, servo, state, volts);
    } else {
        j->integral = 0;
        j->set_rad = rad_of_mdeg(j->body.angle_mdeg);
    }
    j->motor_nm = 0;
    if (on || brake) {
        bool limited;
        double volts = j->body.duty * volts_in(w, sim, servo);
        double amps = current_of(j, volts, speed, &limited);
        j->motor_nm = motor->kt_nm_a * amps;
        torque_nm = limited ? j->motor_nm : motor->kt_nm_a * volts / motor->resistance_ohm;
        damping = limited ? 0 : motor->kt_nm_a * motor->kt_nm_a / motor->resistance_ohm;
    }
    double friction =
        grobo_i_motor_friction(&motor->friction, j->motor_nm, state->load_nm / j->ratio, speed);
    double turns = fabs(j->ratio);
    w->drive[index] = (grobo_sim_drive){
        .torque_nm = j->ratio * torque_nm + j->push_nm,
        .damping_nms = turns * turns * damping,
        .friction_nm = turns * friction,
        .armature_kgm2 = turns * turns * motor->armature_kgm2,
    };
    bound(j, sim, servo, state, &w->drive[index]);
}

/* ---- what a servo measures ------------------------------------------------------------------ */

static void measure_strain(grobo_i_joint_world *j, const grobo_sim *sim, double volts)
{
    grobo_i_body *body = &j->body;
    double stall_a = volts * j->motor.duty_max / j->motor.resistance_ohm;
    if (j->motor.torque_max_nm > 0) {
        stall_a = fmin(stall_a, j->motor.torque_max_nm / j->motor.kt_nm_a);
    }
    body->strain = j->loop.strained_by_duty ? fabs(body->duty)
                   : stall_a > 0            ? fmin(fabs(body->winding_ma) / 1000 / stall_a, 1)
                                            : 0;
    if (body->strain < body->strained_at) {
        body->strained_us = GROBO_NEVER_US;
    } else if (body->strained_us == GROBO_NEVER_US) {
        body->strained_us = sim->now_us;
    }
    body->stalled = fabs(body->duty) > 0 && fabs(body->duty) >= j->loop.duty_max * 0.99 &&
                    fabs(body->speed_mdeg_s) < 1000;
}

/* The shaft's side of the gear, which hangs in its backlash on the side of the load. */
static double play_rad(const grobo_i_joint_world *j, const grobo_sim_state *state, double before)
{
    double half = j->motor.backlash_rad / 2, load = state->load_nm / j->ratio + j->push_nm;
    if (half <= 0 || fabs(load) < PLAY_LEAST_NM) {
        return before;
    }
    double way = copysign(half, load) - before;
    return before + copysign(fmin(fabs(way), PLAY_RAD_S * STEP_S), way);
}

static void measure(grobo_i_world *w, grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_joint_world *j = &w->joint[index];
    const grobo_sim_state *state = &w->state[index];
    double volts = volts_in(w, sim, servo), speed = j->ratio * state->speed_rad_s;
    bool limited, powered = servo->powered && servo->plant.torque != GROBO_TORQUE_OFF;
    double amps = powered ? current_of(j, j->body.duty * volts, speed, &limited) : 0;
    j->play_rad = play_rad(j, state, j->play_rad);
    j->body.angle_mdeg = mdeg_of_rad(shaft_rad(j, state) + j->play_rad);
    j->body.speed_mdeg_s = mdeg_of_rad(speed);
    j->body.winding_ma = amps * 1000;
    j->heat_ma2 += j->body.winding_ma * j->body.winding_ma;
    measure_strain(j, sim, volts);
}

/* ---- steps ---------------------------------------------------------------------------------- */

static void feed(grobo_i_world *w, const grobo_sim *sim)
{
    double amps = 0;
    for (int i = 0; i < w->n; i++) {
        const grobo_i_body *body = &w->joint[i].body;
        double own =
            body->winding_ma / 1000 * body->duty; /* what the bridge takes; none comes back */
        amps += (sim->servo[i].powered ? IDLE_A : 0) + fmax(own, 0);
    }
    double left_mv = fmax(sim->supply_mv - w->supply_ohm * amps * 1000, 0);
    w->base.bus_mv += BUS_PART * (left_mv - w->base.bus_mv);
    bool low = sim->supply_mv >= GROBO_SIM_BROWN_OUT_MV && w->base.bus_mv < GROBO_SIM_BROWN_OUT_MV;
    if (!low) {
        w->low_us = GROBO_NEVER_US;
    } else if (w->low_us == GROBO_NEVER_US) {
        w->low_us = sim->now_us;
    }
}

/* Heat, supply, and what servos do by themselves. */
static void chores(grobo_i_world *w, grobo_sim *sim)
{
    if (w->low_us != GROBO_NEVER_US && sim->now_us - w->low_us >= LOW_US) {
        w->low_us = GROBO_NEVER_US;
        w->base.bus_mv = sim->supply_mv;
        grobo_i_sim_brown_out(sim);
    }
    for (int i = 0; i < w->n; i++) {
        grobo_i_joint_world *j = &w->joint[i];
        grobo_i_sim_warm_by(sim, i, sqrt(j->heat_ma2 / CHORE_STEPS));
        j->heat_ma2 = 0;
        grobo_i_sim_settle(sim, i);
        j->body.stale = true;
    }
}

/* Nothing turns, and nothing is about to; what another program's plant does is not known here. */
static bool rests(const grobo_i_world *w, const grobo_sim *sim)
{
    bool still = w->plant.step == grobo_i_tree_step;
    for (int i = 0; i < w->n && still; i++) {
        const grobo_sim_servo *servo = &sim->servo[i];
        still = fabs(w->state[i].speed_rad_s) < REST_RAD_S && !servo->by_hand &&
                sim->now_us >= servo->start_us + servo->move_us;
    }
    return still;
}

static void step(grobo_i_world *w, grobo_sim *sim)
{
    for (int i = 0; i < w->n; i++) {
        const grobo_sim_servo *servo = &sim->servo[i];
        if (servo->by_hand && sim->now_us >= servo->start_us + servo->move_us) {
            grobo_i_sim_settle(sim, i);
        }
        drive(w, sim, i);
    }
    grobo_sim_state before[GROBO_JOINTS_MAX];
    memcpy(before, w->state, sizeof before);
    int result = w->plant.step(w->plant.ctx, w->drive, STEP_S, w->state);
    for (int i = 0; i < w->n; i++) {
        const grobo_sim_state *state = &w->state[i];
        if (result < 0 || !isfinite(state->angle_rad) || !isfinite(state->speed_rad_s) ||
            !isfinite(state->load_nm)) {
            w->state[i] = before[i];
            w->state[i].speed_rad_s = 0;
        }
    }
    sim->now_us += GROBO_SIM_STEP_US;
    for (int i = 0; i < w->n; i++) {
        measure(w, sim, i);
    }
    feed(w, sim);
    if (++w->steps % CHORE_STEPS == 0) {
        chores(w, sim);
        w->base.rests = rests(w, sim);
    }
}

static void advance(grobo_sim_physics *physics, grobo_sim *sim, int64_t t_us)
{
    grobo_i_world *w = (grobo_i_world *)physics;
    int64_t late_us = LATE_US + (physics->rests ? GROBO_I_WORLD_REST_US : 0);
    if (physics->real_time && t_us - physics->at_us > late_us) {
        int64_t late = (t_us - physics->at_us - CHORE_US) / GROBO_SIM_STEP_US;
        w->skipped += (uint64_t)late;
        physics->at_us += late * GROBO_SIM_STEP_US;
    }
    while (physics->at_us + GROBO_SIM_STEP_US <= t_us) {
        int64_t now_us = sim->now_us;
        sim->now_us = physics->at_us;
        step(w, sim);
        physics->at_us += GROBO_SIM_STEP_US;
        sim->now_us = now_us;
    }
}

/* ---- begin ---------------------------------------------------------------------------------- */

static int begin(grobo_sim_physics *physics, grobo_sim *sim)
{
    grobo_i_world *w = (grobo_i_world *)physics;
    if (sim->n_servos != w->n) {
        return GROBO_ERR_ARG;
    }
    w->base.bus_mv = sim->supply_mv;
    for (int i = 0; i < w->n; i++) {
        grobo_sim_servo *servo = &sim->servo[i];
        grobo_i_joint_world *j = &w->joint[i];
        if (!w->given[i]) {
            int result = grobo_sim_motor_of(servo->model, &j->motor);
            if (result < 0) {
                return result;
            }
        }
        double at_rad = rad_of_mdeg(servo->to_mdeg);
        w->state[i] = (grobo_sim_state){.angle_rad = (at_rad - j->zero_rad) / j->ratio};
        j->tick_rad = w->steps_seen ? rad_of_mdeg(grobo_i_dxl_tick_mdeg(servo)) : 0;
        j->body =
            (grobo_i_body){.angle_mdeg = servo->to_mdeg,
                           .strained_us = GROBO_NEVER_US,
                           .profile_mdeg_s = (int32_t)lround(mdeg_of_rad(j->motor.profile_rad_s)),
                           .stale = true};
        servo->body = &j->body;
    }
    return GROBO_OK;
}

static int imu(const grobo_sim_physics *physics, grobo_imu *reading)
{
    const grobo_i_world *w = (const grobo_i_world *)physics;
    return w->plant.imu == NULL ? GROBO_ERR_UNSUPPORTED : w->plant.imu(w->plant.ctx, reading);
}

static const grobo_i_world_ops ops = {.begin = begin, .advance = advance, .imu = imu};

static bool motor_ok(const grobo_sim_motor *motor)
{
    const double numbers[] = {motor->duty_per_rad,        motor->armature_kgm2,
                              motor->torque_max_nm,       motor->profile_rad_s,
                              motor->backlash_rad,        motor->friction.base_nm,
                              motor->friction.viscous_nms};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        if (!isfinite(numbers[i]) || numbers[i] < 0) {
            return false;
        }
    }
    return motor->kt_nm_a > 0 && motor->resistance_ohm > 0 && motor->duty_max > 0 &&
           motor->duty_max <= 1 && isfinite(motor->kt_nm_a) && isfinite(motor->resistance_ohm);
}

static int fill(grobo_i_world *w, const grobo_sim_physics_config *config)
{
    static const double down[3] = {0, 0, -GRAVITY_M_S2};
    const double *g = config->gravity_m_s2;
    bool none = g[0] == 0 && g[1] == 0 && g[2] == 0;
    w->base.ops = &ops;
    w->base.real_time = config->real_time;
    w->n = config->model->n_joints;
    w->steps_seen = !config->no_encoder_steps;
    w->payload = -1;
    w->low_us = GROBO_NEVER_US;
    w->supply_ohm = (config->supply_mohm == 0 ? SUPPLY_MOHM : config->supply_mohm) / 1000.0;
    int result = grobo_i_tree_make(&w->tree, config->links, config->n_links, w->n);
    if (result < 0) {
        return result;
    }
    memcpy(w->tree.gravity_m_s2, none ? down : g, sizeof down);
    w->plant = config->plant != NULL
                   ? *config->plant
                   : (grobo_sim_plant){.step = grobo_i_tree_step, .ctx = &w->tree};
    for (int i = 0; i < config->n_links; i++) {
        const char *name = config->links[i].name != NULL ? config->links[i].name : "";
        size_t length = strlen(name);
        length = length < GROBO_NAME_MAX_BYTES ? length : GROBO_NAME_MAX_BYTES - 1;
        memcpy(w->link_name[i], name, length);
    }
    for (int i = 0; i < w->n; i++) {
        const grobo_joint *joint = grobo_i_joint(config->model, i);
        grobo_i_joint_world *j = &w->joint[i];
        j->zero_rad = grobo_joint_to_servo(joint, 0);
        j->ratio = grobo_joint_to_servo(joint, 1) - j->zero_rad;
        j->wall_mdeg[0] = INT32_MIN;
        j->wall_mdeg[1] = INT32_MAX;
        if (config->motors != NULL && config->motors[i] != NULL) {
            w->given[i] = true;
            j->motor = *config->motors[i];
            if (!motor_ok(&j->motor)) {
                return GROBO_ERR_ARG;
            }
        }
    }
    return GROBO_OK;
}

int grobo_sim_physics_new(const grobo_sim_physics_config *config, const grobo_mem *mem,
                          grobo_sim_physics **physics)
{
    grobo_sim_physics_config with;
    if (physics == NULL || grobo_i_sized_take(&with, sizeof with, config) < 0 ||
        grobo_model_check(with.model) < 0 || (with.plant != NULL && with.plant->step == NULL)) {
        return GROBO_ERR_ARG;
    }
    grobo_i_world *w = grobo_i_new(mem, sizeof *w);
    if (w == NULL) {
        return GROBO_ERR_NOMEM;
    }
    w->mem = mem;
    int result = fill(w, &with);
    if (result < 0) {
        grobo_i_free(mem, w, sizeof *w);
        return result;
    }
    *physics = &w->base;
    return GROBO_OK;
}

void grobo_sim_physics_free(grobo_sim_physics *physics)
{
    grobo_i_world *w = (grobo_i_world *)physics;
    if (w != NULL) {
        grobo_i_free(w->mem, w, sizeof *w);
    }
}
