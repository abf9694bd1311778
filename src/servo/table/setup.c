/* SPDX-License-Identifier: MIT */
/* Whether a servo is set up as its joint needs it: its registers say what its angles mean. */
#include <math.h>

#include "src/servo/table/family.h"

/* A servo that goes all the way around lacks the last counts of it. */
enum { ROUND_TICKS = 2 };

static bool value_of(const grobo_i_block *b, grobo_register_role role, int32_t *value)
{
    return grobo_i_table_value(b->servo, role, b->address, b->data, b->n, value);
}

/* The first register that is wrong is the one that is named, the others are counted. */
static int refuse_register(const grobo_servo_register *reg, int32_t found, int32_t low,
                           int32_t high, grobo_joint_state *state)
{
    if (state->setup.reg == NULL) {
        state->setup = (grobo_setup_fault){reg, found, low, high, 0};
    } else {
        state->setup.more++;
    }
    return GROBO_ERR_SETUP;
}

static int refuse(const grobo_i_block *b, grobo_register_role role, int32_t found, int32_t low,
                  int32_t high, grobo_joint_state *state)
{
    return refuse_register(grobo_servo_register_of(b->servo, role), found, low, high, state);
}

static int32_t wanted_of(const grobo_i_family *family, const grobo_joint *joint,
                         const grobo_i_wheel *wheel, const grobo_i_block *b,
                         grobo_register_role role, int32_t found)
{
    if (role == GROBO_ROLE_MODE && wheel != NULL) {
        return wheel->mode;
    }
    if (role == GROBO_ROLE_MODEL) {
        return b->servo->number;
    }
    if (role == GROBO_ROLE_OFFSET) {
        bool any = joint->calibrated || family->offset_trims;
        return any ? found : grobo_servo_register_of(b->servo, role)->factory;
    }
    int32_t any = wheel != NULL && role == GROBO_ROLE_DIRECTION ? wheel->any : 0;
    return (family->wants(joint, b->servo, role, found) & ~any) | (found & any);
}

/* Nobody has told this servo where the middle of its joint is. */
static bool is_new(const grobo_i_block *b)
{
    static const grobo_register_role kept[] = {GROBO_ROLE_OFFSET, GROBO_ROLE_MIN_POSITION,
                                               GROBO_ROLE_MAX_POSITION};
    for (size_t i = 0; i < sizeof kept / sizeof kept[0]; i++) {
        int32_t found;
        if (value_of(b, kept[i], &found) &&
            found != grobo_servo_register_of(b->servo, kept[i])->factory) {
            return false;
        }
    }
    return true;
}

/* min, max: the limits that the servo keeps. */
static void take_range(const grobo_joint *joint, const grobo_i_block *b, int32_t min, int32_t max,
                       grobo_joint_state *state)
{
    double a_rad = grobo_i_table_angle(joint, b->servo, min - ROUND_TICKS);
    double b_rad = grobo_i_table_angle(joint, b->servo, max + ROUND_TICKS);
    state->low_rad = fmin(a_rad, b_rad);
    state->high_rad = fmax(a_rad, b_rad);
    state->valid |= GROBO_FIELD_RANGE;
}

/* A calibrated joint goes as far as its servo, any other servo as far as its joint. */
static int judge_limits(const grobo_joint *joint, const grobo_i_block *b, int32_t min, int32_t max,
                        grobo_joint_state *state)
{
    int32_t one = grobo_i_table_ticks(joint, b->servo, joint->min_rad);
    int32_t other = grobo_i_table_ticks(joint, b->servo, joint->max_rad);
    int32_t low = one < other ? one : other, high = one < other ? other : one;
    int32_t from = joint->calibrated ? high - 1 : low; /* some of its way must be left */
    int32_t to = !joint->calibrated ? high : low > min ? low + 1 : min + 1;
    if (min > from) {
        int32_t least = grobo_servo_register_of(b->servo, GROBO_ROLE_MIN_POSITION)->min;
        return refuse(b, GROBO_ROLE_MIN_POSITION, min, least, from, state);
    }
    if (max < to) {
        int32_t most = grobo_servo_register_of(b->servo, GROBO_ROLE_MAX_POSITION)->max;
        return refuse(b, GROBO_ROLE_MAX_POSITION, max, to, most, state);
    }
    return GROBO_OK;
}

/* What a servo keeps of its torque over power-off. */
static int judge_kept_torque(const grobo_joint *joint, const grobo_i_block *b,
                             grobo_joint_state *state)
{
    int32_t most, limit;
    const grobo_servo_register *reg = grobo_i_table_limit(joint, b->servo, &most);
    if (joint->torque_limit_pct > 0 && reg != NULL && (reg->flags & GROBO_REGISTER_KEPT) != 0 &&
        value_of(b, (grobo_register_role)reg->role, &limit) && limit > most) {
        return refuse(b, (grobo_register_role)reg->role, limit, most, most, state);
    }
    return GROBO_OK;
}

/* Model, mode, sense and middle. The registers of another model are not looked at. */
static int judge_values(const grobo_i_family *family, const grobo_joint *joint,
                        const grobo_i_wheel *wheel, const grobo_i_block *b,
                        grobo_joint_state *state)
{
    static const grobo_register_role roles[] = {GROBO_ROLE_MODEL, GROBO_ROLE_MODE,
                                                GROBO_ROLE_DIRECTION, GROBO_ROLE_OFFSET};
    int result = GROBO_OK;
    for (size_t i = 0; i < sizeof roles / sizeof roles[0]; i++) {
        int32_t found;
        if (value_of(b, roles[i], &found)) {
            int32_t wanted = wanted_of(family, joint, wheel, b, roles[i], found);
            if (wanted != found) {
                result = refuse(b, roles[i], found, wanted, wanted, state);
            }
            if (result < 0 && roles[i] == GROBO_ROLE_MODEL) {
                return result;
            }
        }
    }
    if (judge_kept_torque(joint, b, state) < 0) {
        result = GROBO_ERR_SETUP;
    }
    if (joint->calibrated && wheel == NULL && is_new(b)) {
        int32_t found = 0;
        bool offset = value_of(b, GROBO_ROLE_OFFSET, &found);
        bool min = !offset && value_of(b, GROBO_ROLE_MIN_POSITION, &found);
        if (offset || min) {
            result =
                refuse(b, offset ? GROBO_ROLE_OFFSET : GROBO_ROLE_MIN_POSITION, found, 1, 0, state);
        }
    }
    return result;
}

/* A count of a position is worth what the table says: of STS, and of MX that count turns (FTServo's
 * tables; emanual resolution_divider). */
static int judge_scale(const grobo_joint *joint, const grobo_i_block *b, grobo_joint_state *state)
{
    const grobo_servo_register *reg = grobo_servo_register_named(b->servo, "angular_resolution");
    if (reg == NULL && joint->turns) {
        reg = grobo_servo_register_named(b->servo, "resolution_divider");
    }
    if (reg == NULL || reg->address < b->address || reg->address >= b->address + b->n) {
        return GROBO_OK;
    }
    int32_t found = grobo_servo_register_get(b->servo, reg, b->data + (reg->address - b->address));
    if (found == reg->factory) {
        return GROBO_OK;
    }
    return refuse_register(reg, found, reg->factory, reg->factory, state);
}

/* Both limits must be the same value, which is no angle. */
static int judge_both(const grobo_i_block *b, int32_t both, int32_t min, int32_t max,
                      grobo_joint_state *state)
{
    return min != both   ? refuse(b, GROBO_ROLE_MIN_POSITION, min, both, both, state)
           : max != both ? refuse(b, GROBO_ROLE_MAX_POSITION, max, both, both, state)
                         : GROBO_OK;
}

int grobo_i_table_setup(const grobo_i_family *family, const grobo_joint *joint,
                        const grobo_i_wheel *wheel, const grobo_i_block *block,
                        grobo_joint_state *state)
{
    int32_t min, max, mode = 0;
    state->setup = (grobo_setup_fault){NULL, 0, 0, 0, 0};
    int result = judge_values(family, joint, wheel, block, state);
    if (result == GROBO_OK || state->setup.reg->role != GROBO_ROLE_MODEL) {
        int scale = judge_scale(joint, block, state);
        result = result < 0 ? result : scale;
    }
    if (result < 0 || !value_of(block, GROBO_ROLE_MIN_POSITION, &min) ||
        !value_of(block, GROBO_ROLE_MAX_POSITION, &max)) {
        return result;
    }
    if (wheel != NULL) {
        return wheel->by_limits ? judge_both(block, 0, min, max, state) : result;
    }
    (void)value_of(block, GROBO_ROLE_MODE, &mode);
    if (mode == family->limits_mode) {
        result = joint->turns ? judge_both(block, family->turns_limits, min, max, state)
                              : judge_limits(joint, block, min, max, state);
    }
    if (result == GROBO_OK && joint->calibrated && min < max) {
        take_range(joint, block, min, max, state);
    }
    return result;
}
