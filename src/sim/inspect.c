/* SPDX-License-Identifier: MIT */
/* What a test, or a person at the simulator, sees and changes behind the robot's back. */
#include <string.h>

#include <grobo/core/sim.h>

#include "src/sim/imu.h"
#include "src/sim/servo/family.h"
#include "src/sim/servo/power.h"
#include "src/sim/servo/registers.h"
#include "src/sim/servo/servo.h"
#include "src/sim/servo/shaft.h"
#include "src/sim/servo/world.h"

/* The servo, settled; NULL when there is none of this index. */
static grobo_sim_servo *servo_at(grobo_sim *sim, int index)
{
    if (sim == NULL || index < 0 || index >= sim->n_servos) {
        return NULL;
    }
    grobo_i_sim_settle(sim, index);
    grobo_i_world_touch(&sim->servo[index]);
    grobo_i_world_wake(sim);
    return &sim->servo[index];
}

static int has_flash(grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = servo_at(sim, index);
    return servo == NULL                       ? GROBO_ERR_ARG
           : servo->family->flash_fits == NULL ? GROBO_ERR_UNSUPPORTED
                                               : GROBO_OK;
}

/* ---- looking --------------------------------------------------------------------------------- */

int grobo_sim_servos(const grobo_sim *sim)
{
    return sim == NULL ? GROBO_ERR_ARG : sim->n_servos;
}

int grobo_sim_find(const grobo_sim *sim, int id)
{
    if (sim == NULL) {
        return GROBO_ERR_ARG;
    }
    for (int i = 0; i < sim->n_servos; i++) {
        if (sim->servo[i].plant.id == id) {
            return i;
        }
    }
    return GROBO_ERR_NOTFOUND;
}

static bool is_stalled(const grobo_sim *sim, const grobo_sim_servo *servo)
{
    const grobo_i_body *body = servo->body;
    return body != NULL ? body->stalled : servo->stalled && !grobo_i_sim_moving(servo, sim->now_us);
}

int grobo_sim_look(grobo_sim *sim, int index, grobo_sim_view *view)
{
    if (view == NULL) {
        return GROBO_ERR_ARG;
    }
    const grobo_sim_servo *servo = servo_at(sim, index);
    if (servo == NULL) {
        return GROBO_ERR_ARG;
    }
    int32_t bps = grobo_i_sim_bps(sim, index);
    *view = (grobo_sim_view){
        .angle_mdeg = grobo_i_sim_angle_mdeg(servo, sim->now_us),
        .target_mdeg = servo->to_mdeg,
        .speed_dps = grobo_i_sim_speed_dps(servo, sim->now_us),
        .current_ma = grobo_i_sim_current_ma(servo, sim->now_us),
        .temperature_c = servo->temperature_c,
        .torque = (grobo_torque)servo->plant.torque,
        .cable = (grobo_sim_cable)servo->cable,
        .moving = grobo_i_sim_moving(servo, sim->now_us),
        .stalled = is_stalled(sim, servo),
        .deaf = grobo_i_sim_deaf(sim, index),
        .id = servo->plant.id,
        .baud_bps = bps < 0 ? 0 : (uint32_t)bps,
    };
    return 0;
}

int grobo_sim_get_register(grobo_sim *sim, int index, int address, int32_t *value)
{
    if (value == NULL) {
        return GROBO_ERR_ARG;
    }
    const grobo_sim_servo *servo = servo_at(sim, index);
    if (servo == NULL) {
        return GROBO_ERR_ARG;
    }
    servo->family->refresh(sim, index);
    return grobo_i_dxl_look(servo, address, value);
}

int grobo_sim_set_id(grobo_sim *sim, int index, int id)
{
    const grobo_sim_servo *servo = servo_at(sim, index);
    if (servo == NULL) {
        return GROBO_ERR_ARG;
    }
    return grobo_sim_set_register(
        sim, index, grobo_servo_register_of(servo->model, GROBO_ROLE_ID)->address, id);
}

int grobo_sim_get_flash(grobo_sim *sim, int index, uint8_t flash[GROBO_SIM_FLASH_BYTES])
{
    int result = flash == NULL ? GROBO_ERR_ARG : has_flash(sim, index);
    if (result == GROBO_OK) {
        memcpy(flash, sim->servo[index].flash, GROBO_SIM_FLASH_BYTES);
    }
    return result;
}

/* ---- changing -------------------------------------------------------------------------------- */

int grobo_sim_set_register(grobo_sim *sim, int index, int address, int32_t value)
{
    const grobo_sim_servo *servo = servo_at(sim, index);
    if (servo == NULL) {
        return GROBO_ERR_ARG;
    }
    return servo->family->set != NULL ? servo->family->set(sim, index, address, value)
                                      : grobo_i_dxl_set(sim, index, address, value);
}

int grobo_sim_set_flash(grobo_sim *sim, int index, const uint8_t flash[GROBO_SIM_FLASH_BYTES])
{
    int result = flash == NULL ? GROBO_ERR_ARG : has_flash(sim, index);
    if (result == GROBO_OK && !sim->servo[index].family->flash_fits(flash)) {
        result = GROBO_ERR_LIMIT;
    }
    if (result == GROBO_OK) {
        grobo_i_sim_exchange_flash(sim, index, flash);
    }
    return result;
}

int grobo_sim_set_angle(grobo_sim *sim, int index, int32_t angle_mdeg, int64_t time_us)
{
    grobo_sim_servo *servo = servo_at(sim, index);
    if (servo == NULL || time_us < 0 || time_us > INT32_MAX) {
        return GROBO_ERR_ARG;
    }
    grobo_i_sim_rest(sim, index);
    servo->to_mdeg = angle_mdeg < servo->stop_min_mdeg   ? servo->stop_min_mdeg
                     : angle_mdeg > servo->stop_max_mdeg ? servo->stop_max_mdeg
                                                         : angle_mdeg;
    servo->move_us = time_us;
    servo->by_hand = true;
    grobo_i_sim_settle(sim, index);
    return 0;
}

int grobo_sim_set_blocked(grobo_sim *sim, int index, bool blocked)
{
    grobo_sim_servo *servo = servo_at(sim, index);
    if (servo == NULL) {
        return GROBO_ERR_ARG;
    }
    servo->blocked = blocked;
    grobo_i_sim_go_on(sim, index);
    return 0;
}

int grobo_sim_set_load(grobo_sim *sim, int index, int32_t load_ma)
{
    grobo_sim_servo *servo = servo_at(sim, index);
    if (servo == NULL || load_ma < 0 || load_ma > 5000) {
        return GROBO_ERR_ARG;
    }
    servo->load_ma = load_ma;
    return 0;
}

int grobo_sim_set_temperature(grobo_sim *sim, int index, double temperature_c)
{
    grobo_sim_servo *servo = servo_at(sim, index);
    if (servo == NULL || !(temperature_c >= -40 && temperature_c <= 150)) {
        return GROBO_ERR_ARG;
    }
    servo->temperature_c = temperature_c;
    return 0;
}

int grobo_sim_set_cable(grobo_sim *sim, int index, grobo_sim_cable cable)
{
    grobo_sim_servo *servo = servo_at(sim, index);
    if (servo == NULL || (unsigned)cable > GROBO_SIM_CABLE_OUT) {
        return GROBO_ERR_ARG;
    }
    servo->cable = (uint8_t)cable;
    grobo_i_sim_feed(sim, index);
    return 0;
}

void grobo_sim_set_supply(grobo_sim *sim, uint32_t supply_mv)
{
    if (sim == NULL) {
        return;
    }
    for (int i = 0; i < sim->n_servos; i++) {
        grobo_i_sim_settle(sim, i);
    }
    grobo_i_world_wake(sim);
    sim->supply_mv = supply_mv;
    for (int i = 0; i < sim->n_servos; i++) {
        grobo_i_sim_feed(sim, i);
        grobo_i_sim_go_on(sim, i);
    }
}

int grobo_sim_imu(const grobo_sim *sim, struct grobo_imu *imu)
{
    if (sim == NULL || imu == NULL) {
        return GROBO_ERR_ARG;
    }
    const grobo_sim_physics *physics = sim->config.physics;
    return physics == NULL ? GROBO_ERR_UNSUPPORTED : physics->ops->imu(physics, imu);
}

int grobo_i_sim_imu_at(grobo_sim *sim, int64_t now_us, grobo_imu *imu)
{
    if (grobo_sim_imu(sim, imu) == GROBO_ERR_UNSUPPORTED) {
        return GROBO_ERR_UNSUPPORTED;
    }
    grobo_sim_step(sim, now_us);
    return grobo_sim_imu(sim, imu);
}
