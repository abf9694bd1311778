/* SPDX-License-Identifier: MIT */
/* What a servo's registers say of its joint. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/model/joint.h"
#include "src/servo/table/family.h"
#include "src/servo/unit.h"

/* What a servo may say. A shaft may stand a little outside of its turn. */
enum { OUTSIDE_TICKS = 256, OUTSIDE_PART = 16, HEAT_MAX_C = 120, TORQUE_MAX = 2 };
#define VOLTAGE_MAX_MV 30000.0

static bool value_of(const grobo_i_block *b, grobo_register_role role, int32_t *value)
{
    return grobo_i_table_value(b->servo, role, b->address, b->data, b->n, value);
}

/* In the unit of the register's table. */
static bool measure_of(const grobo_i_block *b, grobo_register_role role, double *value)
{
    int32_t counts;
    if (!value_of(b, role, &counts)) {
        return false;
    }
    *value = counts * grobo_i_register_unit(grobo_servo_register_of(b->servo, role));
    return true;
}

static void take_angles(const grobo_driver *self, int joint, const grobo_i_block *b,
                        grobo_joint_state *state)
{
    const grobo_i_family *family = grobo_i_table_family(self, b->servo);
    const grobo_joint *moved = grobo_i_joint(self->model, joint);
    int32_t ticks, ms;
    double dps;
    if (value_of(b, GROBO_ROLE_POSITION, &ticks)) {
        state->angle_rad = grobo_i_table_angle(moved, b->servo, ticks);
        state->valid |= GROBO_FIELD_ANGLE;
    }
    if (value_of(b, GROBO_ROLE_GOAL, &ticks)) {
        bool timed = family->pace == GROBO_I_PACE_PROFILE ? value_of(b, GROBO_ROLE_SPEED, &ms)
                                                          : value_of(b, GROBO_ROLE_GOAL_TIME, &ms);
        state->goal_rad = grobo_i_table_angle(moved, b->servo, ticks);
        state->goal_time_us = timed ? (int64_t)ms * 1000 : 0;
        state->valid |= GROBO_FIELD_GOAL;
    }
    if (measure_of(b, GROBO_ROLE_PRESENT_SPEED, &dps)) {
        double ratio = grobo_joint_from_servo(moved, 1) - grobo_joint_from_servo(moved, 0);
        state->speed_dps = (int32_t)(dps * ratio);
        state->valid |= GROBO_FIELD_SPEED;
    }
}

/* A wheel's angle is that of the servo's shaft within one turn, whatever it is geared to. NULL:
 * the joint is no wheel. */
static void take_wheel(const grobo_joint *moved, const grobo_i_wheel *wheel, const grobo_i_block *b,
                       grobo_joint_state *state)
{
#if GROBO_DRIVERS_PLAIN
    (void)moved;
    (void)wheel;
    (void)b;
    (void)state;
#else
    const grobo_joint shaft = {.sign = moved->sign};
    int32_t counts;
    if (wheel == NULL) {
        return;
    }
    if (value_of(b, GROBO_ROLE_POSITION, &counts)) {
        double angle_rad = grobo_i_table_angle(&shaft, b->servo, counts);
        state->angle_rad = remainder(angle_rad, grobo_rad_from_deg(360));
        state->valid |= GROBO_FIELD_ANGLE;
    }
    state->goal_rad = state->angle_rad;
    state->goal_time_us = 0;
    state->valid &= (uint16_t)~GROBO_FIELD_GOAL;
    if (value_of(b, wheel->role, &counts)) {
        state->goal_rad_s = grobo_i_wheel_rad_s(moved, wheel, counts);
        state->valid |= GROBO_FIELD_GOAL;
    }
#endif
}

static void take_measures(const grobo_i_block *b, grobo_joint_state *state)
{
    double value;
    if (measure_of(b, GROBO_ROLE_CURRENT, &value)) {
        state->current_ma = (int32_t)fabs(value);
        state->valid |= GROBO_FIELD_CURRENT;
    }
    if (measure_of(b, GROBO_ROLE_VOLTAGE, &value)) {
        state->voltage_mv = (int32_t)value;
        state->valid |= GROBO_FIELD_VOLTAGE;
    }
    int32_t temperature_c;
    if (value_of(b, GROBO_ROLE_TEMPERATURE, &temperature_c)) {
        state->temperature_c = (int16_t)temperature_c;
        state->valid |= GROBO_FIELD_TEMPERATURE;
    }
}

/* A servo that has cut its torque for an error may still have the switch on. */
static void take_torque(const grobo_i_family *family, const grobo_i_block *b,
                        grobo_joint_state *state)
{
    int32_t torque, limit, error = 0, shutdown = 0;
    (void)value_of(b, GROBO_ROLE_ERROR, &error);
    error |= family->numbers_errors ? 0 : state->flags;
    state->overheated = (error & family->overheated) != 0;
    if (!value_of(b, GROBO_ROLE_TORQUE, &torque)) {
        return;
    }
    bool cut =
        value_of(b, GROBO_ROLE_SHUTDOWN, &shutdown) && (error & shutdown & family->cuts) != 0;
    cut = cut || (value_of(b, GROBO_ROLE_TORQUE_LIMIT, &limit) && limit == 0);
    state->torque = torque == 1 && !cut                                       ? GROBO_TORQUE_ON
                    : torque == family->brake && family->brake != family->off ? GROBO_TORQUE_BRAKE
                                                                              : GROBO_TORQUE_OFF;
    state->valid |= GROBO_FIELD_TORQUE;
}

static void take_limit(const grobo_joint *joint, const grobo_i_block *b, grobo_joint_state *state)
{
    int32_t most, found;
    const grobo_servo_register *reg = grobo_i_table_limit(joint, b->servo, &most);
    if (joint->torque_limit_pct > 0 && reg != NULL &&
        value_of(b, (grobo_register_role)reg->role, &found)) {
        state->torque_limited = found >= -most && found <= most;
        state->valid |= GROBO_FIELD_TORQUE_LIMIT;
    }
}

/* Within what the register can hold; of four bytes that is not all that they can say. */
static bool speed_fits(const grobo_i_block *b)
{
    const grobo_servo_register *reg = grobo_servo_register_of(b->servo, GROBO_ROLE_PRESENT_SPEED);
    int32_t counts;
    return !value_of(b, GROBO_ROLE_PRESENT_SPEED, &counts) ||
           (counts >= reg->min && counts <= reg->max);
}

static bool within_turn(const grobo_servo_model *servo, int32_t ticks)
{
    int32_t span = (int32_t)servo->span_ticks, first = grobo_i_first_tick(servo);
    int32_t outside = span / OUTSIDE_PART > OUTSIDE_TICKS ? span / OUTSIDE_PART : OUTSIDE_TICKS;
    return ticks >= first - outside && ticks < first + span + outside;
}

/* What a servo is made for is no lie. */
static double most_mv(const grobo_servo_model *servo)
{
    const grobo_servo_register *reg = grobo_servo_register_of(servo, GROBO_ROLE_MAX_VOLTAGE);
    double own_mv = reg != NULL ? reg->max * grobo_i_register_unit(reg) : 0;
    return fmax(own_mv, VOLTAGE_MAX_MV);
}

/* A sum of bytes does not notice what two faults make up for: what no servo says is not believed.
 * Where a status and a register tell the same errors, both must. */
static bool plausible(const grobo_i_family *family, bool turns, const grobo_i_block *b,
                      uint8_t flags)
{
    int32_t ticks = b->servo->middle, torque = 0, error = 0, celsius = 0;
    double mv = 0;
    (void)measure_of(b, GROBO_ROLE_VOLTAGE, &mv);
    (void)value_of(b, GROBO_ROLE_TEMPERATURE, &celsius);
    (void)value_of(b, GROBO_ROLE_TORQUE, &torque);
    (void)value_of(b, GROBO_ROLE_POSITION, &ticks);
    bool told = family->numbers_errors || !value_of(b, GROBO_ROLE_ERROR, &error) || error == flags;
    return told && (within_turn(b->servo, ticks) || turns) && speed_fits(b) &&
           mv <= most_mv(b->servo) && celsius <= HEAT_MAX_C && torque >= 0 && torque <= TORQUE_MAX;
}

int grobo_i_table_parse(const grobo_driver *self, void *ctx, int joint, const grobo_packet *reply,
                        grobo_joint_state *state)
{
    (void)ctx;
    const grobo_i_family *family = grobo_i_table_family(self, grobo_i_table_servo(self, joint));
    const grobo_joint *moved = grobo_i_joint(self->model, joint);
    grobo_packet part;
    if (reply->id != moved->motor && family->fast_part != NULL) {
        if (!family->fast_part(reply, self->model->n_joints, joint, &part) ||
            part.id != moved->motor) {
            return GROBO_ERR_MISMATCH;
        }
        reply = &part;
    }
    if (reply->refused) {
        return GROBO_ERR_NACK;
    }
    const grobo_i_block b = {.servo = grobo_i_table_servo(self, joint),
                             .address = reply->address,
                             .data = reply->data,
                             .n = reply->data_bytes};
    int32_t model, firmware;
    grobo_i_wheel how;
    const grobo_i_wheel *wheel = grobo_i_table_wheel(self, joint, &how) ? &how : NULL;
    if (!plausible(family, moved->turns || wheel != NULL, &b, reply->flags)) {
        return GROBO_ERR_MISMATCH;
    }
    bool whole = value_of(&b, GROBO_ROLE_MODEL, &model); /* the first reading of all */
    int result = whole ? grobo_i_table_setup(family, moved, wheel, &b, state) : GROBO_OK;
    state->flags = reply->flags;
    if (family->fast_part != NULL && value_of(&b, GROBO_ROLE_FIRMWARE, &firmware)) {
        state->fast = b.servo->fast_firmware > 0 && firmware >= b.servo->fast_firmware;
        state->valid |= GROBO_FIELD_FAST;
    }
    take_angles(self, joint, &b, state);
    take_wheel(moved, wheel, &b, state);
    take_measures(&b, state);
    take_torque(family, &b, state);
    take_limit(moved, &b, state);
    return result < 0 || state->valid != 0 ? result : GROBO_ERR_MISMATCH;
}
