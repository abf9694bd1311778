/* SPDX-License-Identifier: MIT */
/* Values of registers: out of blocks, in their units, as angles. */
#include <math.h>

#include "src/base/sized.h"
#include "src/model/joint.h"
#include "src/servo/table/family.h"

#define RAD_PER_DEG 0.017453292519943295

const grobo_servo_model *grobo_i_table_servo(const grobo_driver *self, int joint)
{
    const grobo_i_family *family = self->family;
    const grobo_joint *moved = grobo_i_joint(self->model, joint);
    const grobo_servo_model *found = GROBO_I_MEMBER(moved, self->model->joint_size, servo);
    for (int i = 0; found == NULL && i < GROBO_I_TABLES; i++) {
        found = grobo_servo_model_numbered(family->tables[i], moved->servo_model);
    }
    return found;
}

const grobo_i_family *grobo_i_table_family(const grobo_driver *self, const grobo_servo_model *servo)
{
    const grobo_i_family *family = self->family;
    return family->of != NULL ? family->of(servo) : family;
}

int grobo_i_table_joint_of_part(const grobo_driver *self, grobo_joint_mask joints, int part)
{
    for (int j = 0; j < self->model->n_joints; j++) {
        if ((joints & GROBO_JOINT_BIT(j)) != 0 && part-- == 0) {
            return j;
        }
    }
    return -1;
}

bool grobo_i_table_value(const grobo_servo_model *servo, grobo_register_role role, uint16_t address,
                         const uint8_t *data, size_t n, int32_t *value)
{
    const grobo_servo_register *reg = grobo_servo_register_of(servo, role);
    if (reg == NULL || reg->address < address ||
        (size_t)(reg->address - address) + reg->bytes > n) {
        return false;
    }
    *value = grobo_servo_register_get(servo, reg, data + (reg->address - address));
    return true;
}

double grobo_i_table_speed_dps(const grobo_driver *self, const grobo_target *target, int joint)
{
    const grobo_joint *moved = grobo_i_joint(self->model, joint);
    double ratio = grobo_joint_to_servo(moved, 1) - grobo_joint_to_servo(moved, 0);
    double way_rad = fabs(target->posture.angle_rad[joint] - target->from_rad[joint]);
    int64_t us = target->joint_time_us[joint] > 0 ? target->joint_time_us[joint] : 1;
    double rad_s = way_rad < self->angle_step_rad
                       ? fmin(self->limits.approach_rad_s, moved->max_speed_rad_s)
                       : way_rad * 1e6 / (double)us;
    return grobo_deg_from_rad(fabs(rad_s * ratio));
}

/* The current of DYNAMIXEL X that measure it, the PWM of the others. */
const grobo_servo_register *grobo_i_table_limit(const grobo_joint *joint,
                                                const grobo_servo_model *servo, int32_t *counts)
{
    static const grobo_register_role roles[] = {GROBO_ROLE_TORQUE_LIMIT, GROBO_ROLE_GOAL_CURRENT,
                                                GROBO_ROLE_GOAL_PWM, GROBO_ROLE_MAX_TORQUE};
    const grobo_servo_register *reg = NULL;
    for (size_t i = 0; reg == NULL && i < sizeof roles / sizeof roles[0]; i++) {
        reg = grobo_servo_register_of(servo, roles[i]);
    }
    *counts = reg == NULL ? 0 : (int32_t)((int64_t)reg->max * joint->torque_limit_pct / 100);
    return reg;
}

bool grobo_i_table_wheel(const grobo_driver *self, int joint, grobo_i_wheel *wheel)
{
    const grobo_servo_model *servo = grobo_i_table_servo(self, joint);
    const grobo_i_family *family = grobo_i_table_family(self, servo);
    return grobo_i_joint_is_wheel(self->model, joint) && family->wheel != NULL &&
           family->wheel(servo, wheel);
}

/* Turns of the servo for one of the joint, with the sense. */
static double turns_of(const grobo_joint *joint)
{
    return grobo_joint_to_servo(joint, 1) - grobo_joint_to_servo(joint, 0);
}

int32_t grobo_i_wheel_counts(const grobo_joint *joint, const grobo_i_wheel *wheel, double rad_s)
{
    double counts = grobo_deg_from_rad(rad_s) * turns_of(joint) / wheel->dps;
    int32_t size = (int32_t)lround(fmin(fabs(counts), wheel->most));
    return counts >= 0 ? size : wheel->sign == 0 ? -size : size == 0 ? 0 : size | wheel->sign;
}

double grobo_i_wheel_rad_s(const grobo_joint *joint, const grobo_i_wheel *wheel, int32_t counts)
{
    bool back = wheel->sign != 0 && (counts & wheel->sign) != 0;
    double size = wheel->sign != 0 ? counts & (wheel->sign - 1) : counts;
    return grobo_rad_from_deg((back ? -size : size) * wheel->dps) / turns_of(joint);
}

static double tick_rad(const grobo_servo_model *servo)
{
    return servo->span_deg * RAD_PER_DEG / servo->span_ticks;
}

double grobo_i_table_angle(const grobo_joint *joint, const grobo_servo_model *servo, int32_t ticks)
{
    return grobo_joint_from_servo(joint, (ticks - (double)servo->middle) * tick_rad(servo));
}

int32_t grobo_i_table_ticks(const grobo_joint *joint, const grobo_servo_model *servo,
                            double angle_rad)
{
    double ticks = grobo_joint_to_servo(joint, angle_rad) / tick_rad(servo) + servo->middle;
    return (int32_t)floor(fmin(fmax(ticks, INT32_MIN), INT32_MAX - 1) + 0.5);
}

double grobo_i_table_step_rad(const grobo_driver *self)
{
    double step_rad = 0;
    for (int j = 0; j < self->model->n_joints; j++) {
        const grobo_joint *joint = grobo_i_joint(self->model, j);
        const grobo_servo_model *servo = grobo_i_table_servo(self, j);
        double own_rad =
            fabs(grobo_i_table_angle(joint, servo, 1) - grobo_i_table_angle(joint, servo, 0));
        step_rad = fmax(step_rad, own_rad);
    }
    return step_rad;
}
