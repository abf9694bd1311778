/* SPDX-License-Identifier: MIT */
/* What servos with a register table have in common: registers, positions, answers in turn. */
#include <math.h>
#include <string.h>

#include <grobo/posture.h>

#include "src/base/assert.h"
#include "src/model/joint.h"
#include "src/servo/unit.h"
#include "src/sim/servo/family.h"
#include "src/sim/servo/note.h"
#include "src/sim/servo/registers.h"
#include "src/sim/servo/servo.h"
#include "src/sim/servo/shaft.h"
#include "src/sim/servo/world.h"

/* A stalled motor of any size warms as much as that of RS301CR. An assumption. */
#define STALL_HEAT_C 122.0
/* A count of the register RETURN_DELAY. */
#define DELAY_NS 2000

/* ---- registers ----------------------------------------------------------------------------- */

static const grobo_servo_register *row_of(const grobo_sim_servo *servo, grobo_register_role role)
{
    return grobo_servo_register_of(servo->model, role);
}

int32_t grobo_i_dxl_get(const grobo_sim_servo *servo, grobo_register_role role)
{
    const grobo_servo_register *reg = row_of(servo, role);
    return reg == NULL ? 0 : grobo_servo_register_get(servo->model, reg, &servo->reg[reg->address]);
}

void grobo_i_dxl_hold(grobo_sim_servo *servo, const grobo_servo_register *reg, int64_t value)
{
    int64_t held = value < reg->min ? reg->min : value > reg->max ? reg->max : value;
    (void)grobo_servo_register_put(servo->model, reg, (int32_t)held, &servo->reg[reg->address]);
}

void grobo_i_dxl_put(grobo_sim_servo *servo, grobo_register_role role, int64_t value)
{
    const grobo_servo_register *reg = row_of(servo, role);
    if (reg != NULL) {
        grobo_i_dxl_hold(servo, reg, value);
    }
}

const grobo_servo_register *grobo_i_dxl_row(const grobo_sim_servo *servo, const char *name)
{
    const grobo_servo_register *reg = grobo_servo_register_named(servo->model, name);
    GROBO_ASSERT(reg != NULL);
    return reg;
}

static void to_factory(grobo_sim_servo *servo, bool kept)
{
    const grobo_servo_register *reg;
    for (size_t i = 0; (reg = grobo_servo_register_row(servo->model, i)) != NULL; i++) {
        GROBO_ASSERT(reg->address + reg->bytes <= GROBO_SIM_REGISTER_BYTES);
        if (((reg->flags & GROBO_REGISTER_KEPT) != 0) == kept) {
            grobo_i_dxl_hold(servo, reg, reg->factory);
        }
    }
}

void grobo_i_dxl_factory(grobo_sim_servo *servo)
{
    to_factory(servo, true);
    grobo_i_dxl_put(servo, GROBO_ROLE_MODEL, servo->model->number);
    grobo_i_dxl_put(servo, GROBO_ROLE_FIRMWARE, servo->model->firmware);
    memcpy(servo->flash, servo->reg, sizeof servo->flash);
}

/* Not the factory's range: it would not be a calibrated one. */
static void calibrate(grobo_sim_servo *servo, const grobo_joint *joint)
{
    double ends[] = {grobo_joint_to_servo(joint, joint->min_rad),
                     grobo_joint_to_servo(joint, joint->max_rad)};
    double tick_deg = (double)servo->model->span_deg / servo->model->span_ticks;
    long low = lround(grobo_deg_from_rad(fmin(ends[0], ends[1])) / tick_deg);
    long high = lround(grobo_deg_from_rad(fmax(ends[0], ends[1])) / tick_deg);
    const grobo_servo_register *max = row_of(servo, GROBO_ROLE_MAX_POSITION);
    high += servo->model->middle;
    grobo_i_dxl_put(servo, GROBO_ROLE_MIN_POSITION, low + servo->model->middle);
    grobo_i_dxl_put(servo, GROBO_ROLE_MAX_POSITION, high >= max->factory ? max->factory - 1 : high);
}

void grobo_i_dxl_sold(grobo_sim *sim, int index, uint8_t id, int baud_code)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_dxl_factory(servo);
    grobo_i_dxl_put(servo, GROBO_ROLE_ID, id);
    grobo_i_dxl_put(servo, GROBO_ROLE_BAUD, baud_code);
    const grobo_joint *joint = grobo_i_joint(sim->config.model, index);
    if (sim->config.mounted && joint->calibrated) {
        calibrate(servo, joint);
    }
    const grobo_servo_register *most = row_of(servo, GROBO_ROLE_MAX_TORQUE);
    bool kept = most != NULL && row_of(servo, GROBO_ROLE_TORQUE_LIMIT) == NULL &&
                row_of(servo, GROBO_ROLE_GOAL_PWM) == NULL; /* the one limit that it has */
    if (sim->config.mounted && joint->torque_limit_pct > 0 && kept) {
        grobo_i_dxl_put(servo, GROBO_ROLE_MAX_TORQUE, most->max * joint->torque_limit_pct / 100);
    }
    memcpy(servo->flash, servo->reg, sizeof servo->flash);
}

bool grobo_i_dxl_sell(grobo_sim *sim, int index, uint8_t id, uint8_t id_max, uint32_t baud_bps)
{
    int code = grobo_servo_baud_code(sim->servo[index].model, (int32_t)baud_bps);
    bool fits = grobo_i_dxl_end(&sim->servo[index]) <= GROBO_SIM_REGISTER_BYTES;
    bool has = code >= 0 && id <= id_max && fits;
    if (has) {
        grobo_i_dxl_sold(sim, index, id, code);
    }
    return has;
}

void grobo_i_dxl_boot(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const grobo_servo_register *reg;
    for (size_t i = 0; (reg = grobo_servo_register_row(servo->model, i)) != NULL; i++) {
        if ((reg->flags & GROBO_REGISTER_KEPT) != 0) {
            memcpy(&servo->reg[reg->address], &servo->flash[reg->address], reg->bytes);
        }
    }
    to_factory(servo, false);
    grobo_i_dxl_put(servo, GROBO_ROLE_TORQUE_LIMIT, grobo_i_dxl_get(servo, GROBO_ROLE_MAX_TORQUE));
    servo->kept_bytes = 0;
    servo->status = 0;
}

int grobo_i_dxl_end(const grobo_sim_servo *servo)
{
    int end = 0;
    const grobo_servo_register *reg;
    for (size_t i = 0; (reg = grobo_servo_register_row(servo->model, i)) != NULL; i++) {
        end = reg->address + reg->bytes;
    }
    return end;
}

void grobo_i_dxl_store(grobo_sim_servo *servo, int address, const uint8_t *bytes, size_t n,
                       bool open)
{
    for (size_t i = 0; i < n; i++) {
        size_t a = (size_t)address + i;
        const grobo_servo_register *reg = grobo_servo_register_at(servo->model, (uint16_t)a);
        if (reg == NULL || (reg->flags & GROBO_REGISTER_W) == 0) {
            continue;
        }
        servo->reg[a] = bytes[i];
        if (open && (reg->flags & GROBO_REGISTER_KEPT) != 0) {
            servo->flash[a] = bytes[i];
        }
    }
}

int32_t grobo_i_dxl_value_in(const grobo_sim_servo *servo, const grobo_servo_register *reg,
                             int address, const uint8_t *bytes)
{
    return grobo_servo_register_get(servo->model, reg, bytes + (reg->address - address));
}

/* ---- positions ----------------------------------------------------------------------------- */

double grobo_i_dxl_tick_mdeg(const grobo_sim_servo *servo)
{
    return servo->model->span_deg * 1000.0 / servo->model->span_ticks;
}

int32_t grobo_i_dxl_turn(const grobo_sim_servo *servo)
{
    return servo->model->span_deg == 360 ? (int32_t)servo->model->span_ticks : 0;
}

int32_t grobo_i_dxl_wrap(int32_t x, int32_t turn)
{
    int32_t rest = x % turn;
    return rest < 0 ? rest + turn : rest;
}

int32_t grobo_i_dxl_ticks(const grobo_sim_servo *servo, bool reverse, int32_t angle_mdeg)
{
    int32_t ticks =
        servo->model->middle + (int32_t)lround(angle_mdeg / grobo_i_dxl_tick_mdeg(servo));
    return reverse ? -ticks : ticks;
}

/* ---- the shaft's side ---------------------------------------------------------------------- */

void grobo_i_dxl_follow(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const grobo_servo_model *model = servo->model;
    grobo_sim_wants *plant = &servo->plant;
    double stall_ma = model->current_ma;
    plant->heat_c_per_ma2 = STALL_HEAT_C / (stall_ma * stall_ma);
    plant->speed_mdeg_s = model->speed_dps * 1000;
    plant->stall_ma = plant->most_ma = model->current_ma;
    plant->limit_c = grobo_i_dxl_get(servo, GROBO_ROLE_TEMPERATURE_LIMIT);
    plant->nominal_mv = (int32_t)sim->config.supply_mv; /* each has a supply of its own kind */
    plant->torque =
        grobo_i_dxl_get(servo, GROBO_ROLE_TORQUE) == 1 ? GROBO_TORQUE_ON : GROBO_TORQUE_OFF;
    plant->id = (uint8_t)grobo_i_dxl_get(servo, GROBO_ROLE_ID);
    plant->cap_mdeg_s = plant->accel_mdeg_s2 = plant->time_us = plant->ramp_us = 0;
    plant->wheel_mdeg_s = 0;
    plant->wheel = false;
}

double grobo_i_dxl_effort(const grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    const grobo_sim_wants *plant = &servo->plant;
    if (plant->torque != GROBO_TORQUE_ON || !servo->powered) {
        return 0;
    }
    const grobo_i_body *body = servo->body;
    if (body != NULL) {
        return body->duty;
    }
    double speed = grobo_i_sim_speed_mdeg_s(servo, sim->now_us);
    double ma = grobo_i_sim_current_ma(servo, sim->now_us);
    double towards = plant->wheel ? plant->wheel_mdeg_s : plant->goal_mdeg - servo->to_mdeg;
    return ma / plant->stall_ma * (speed < 0 || (speed == 0 && towards < 0) ? -1 : 1);
}

double grobo_i_dxl_current_ma(const grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    const grobo_i_body *body = servo->body;
    return body != NULL ? body->winding_ma : grobo_i_dxl_effort(sim, index) * servo->plant.stall_ma;
}

void grobo_i_dxl_refresh(grobo_sim *sim, int index, double speed_mdeg_s, double count_ma)
{
    grobo_sim_servo *servo = &sim->servo[index];
    int64_t battery_mv = grobo_i_sim_supply_mv(sim);
    int64_t own_mv = grobo_i_dxl_own_mv(sim, servo, battery_mv);
    double effort = grobo_i_dxl_effort(sim, index);
    grobo_i_dxl_put(servo, GROBO_ROLE_PRESENT_SPEED,
                    lround(grobo_i_sim_speed_mdeg_s(servo, sim->now_us) / speed_mdeg_s));
    grobo_i_dxl_put(servo, GROBO_ROLE_LOAD, lround(effort * 1000));
    if (count_ma > 0) {
        grobo_i_dxl_put(servo, GROBO_ROLE_CURRENT,
                        lround(grobo_i_dxl_current_ma(sim, index) / count_ma));
    }
    grobo_i_dxl_put(servo, GROBO_ROLE_VOLTAGE, (own_mv + 50) / 100);
    grobo_i_dxl_put(servo, GROBO_ROLE_TEMPERATURE, lround(servo->temperature_c));
    grobo_i_dxl_put(servo, GROBO_ROLE_MOVING, grobo_i_sim_moving(servo, sim->now_us));
    grobo_i_dxl_put(servo, GROBO_ROLE_REGISTERED, servo->kept_bytes > 0);
}

/* ---- answers ------------------------------------------------------------------------------- */

void grobo_i_dxl_answer(grobo_sim *sim, int index, grobo_i_dxl_round *round, uint8_t *bytes,
                        size_t n)
{
    int64_t delay_ns =
        (int64_t)grobo_i_dxl_get(&sim->servo[index], GROBO_ROLE_RETURN_DELAY) * DELAY_NS;
    round->at_ns += delay_ns;
    grobo_i_sim_speak(sim, index, bytes, n, round->at_ns);
    round->at_ns += (int64_t)n * sim->bus_byte_ns;
}

void grobo_i_dxl_silence(const grobo_sim *sim, grobo_i_dxl_round *round, size_t n)
{
    round->at_ns += (int64_t)n * sim->bus_byte_ns;
}

void grobo_i_dxl_beside(grobo_i_dxl_round *round, const grobo_i_dxl_round *own)
{
    round->at_ns = own->at_ns > round->at_ns ? own->at_ns : round->at_ns;
}

/* ---- inspection ---------------------------------------------------------------------------- */

static const grobo_servo_register *begins(const grobo_sim_servo *servo, int address)
{
    const grobo_servo_register *reg =
        address < 0 ? NULL : grobo_servo_register_at(servo->model, (uint16_t)address);
    return reg != NULL && reg->address == address ? reg : NULL;
}

int grobo_i_dxl_look(const grobo_sim_servo *servo, int address, int32_t *value)
{
    const grobo_servo_register *reg = begins(servo, address);
    if (reg == NULL) {
        return GROBO_ERR_ARG;
    }
    *value = grobo_servo_register_get(servo->model, reg, &servo->reg[address]);
    return GROBO_OK;
}

int grobo_i_dxl_set(grobo_sim *sim, int index, int address, int32_t value)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    const grobo_servo_register *reg = begins(servo, address);
    uint8_t bytes[4];
    if (reg == NULL || (reg->flags & GROBO_REGISTER_W) == 0) {
        return GROBO_ERR_ARG;
    }
    int n = grobo_servo_register_put(servo->model, reg, value, bytes);
    return n < 0 ? n : servo->family->store(sim, index, address, bytes, (size_t)n);
}

/* ---- what families do alike ---------------------------------------------------------------- */

void grobo_i_dxl_tell(grobo_sim *sim, int index, const grobo_servo_register *reg, int32_t value)
{
    bool goal = reg->role == GROBO_ROLE_GOAL;
    grobo_i_sim_tell(sim, &(grobo_sim_event){.kind = goal ? GROBO_SIM_GOAL : GROBO_SIM_REGISTER,
                                             .time_us = sim->now_us,
                                             .servo = index,
                                             .value = goal ? value : reg->address,
                                             .value2 = goal ? 0 : value});
}

int grobo_i_dxl_hearer(grobo_sim *sim, const grobo_sim_family *family, int id, int before,
                       const grobo_sim_event *raw)
{
    for (int i = before + 1; i < sim->n_servos; i++) {
        bool meant = id == GROBO_I_DXL_ALL || sim->servo[i].plant.id == id;
        if (sim->servo[i].family == family && meant && grobo_i_sim_hears(sim, i, raw)) {
            return i;
        }
    }
    return -1;
}

int64_t grobo_i_dxl_own_mv(const grobo_sim *sim, const grobo_sim_servo *servo, int64_t battery_mv)
{
    return battery_mv * servo->model->voltage_mv / (int64_t)sim->config.supply_mv;
}

bool grobo_i_dxl_fed(const grobo_sim *sim, const grobo_sim_servo *servo, int count_mv)
{
    int64_t counts = grobo_i_dxl_own_mv(sim, servo, sim->supply_mv) / count_mv;
    return counts >= grobo_i_dxl_get(servo, GROBO_ROLE_MIN_VOLTAGE) &&
           counts <= grobo_i_dxl_get(servo, GROBO_ROLE_MAX_VOLTAGE);
}

void grobo_i_dxl_one_turn(const grobo_sim *sim, grobo_sim_servo *servo, bool reverse)
{
    int32_t turn = grobo_i_dxl_turn(servo);
    int32_t ticks = grobo_i_dxl_ticks(servo, reverse, grobo_i_sim_angle_mdeg(servo, sim->now_us));
    int32_t way = ticks - grobo_i_first_tick(servo->model);
    servo->turns_ticks = turn > 0 ? way - grobo_i_dxl_wrap(way, turn) : 0;
}

int32_t grobo_i_dxl_within(const grobo_sim_servo *servo, int32_t goal)
{
    int32_t min = grobo_i_dxl_get(servo, GROBO_ROLE_MIN_POSITION);
    int32_t max = grobo_i_dxl_get(servo, GROBO_ROLE_MAX_POSITION);
    return goal < min ? min : goal > max ? max : goal;
}
