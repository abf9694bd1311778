/* SPDX-License-Identifier: MIT */
/* What the tables of all families have in common that name their servos by a table of registers. */
#include <grobo/core/sequencer.h>

#include "src/model/joint.h"
#include "src/servo/table/family.h"
#include "src/servo/unit.h"

#define MS_US 1000

/* Within the range that the goal's register has, and within one turn where it counts no turns. */
static bool reaches(const grobo_joint *joint, const grobo_servo_model *servo, double angle_rad)
{
    int32_t ticks = grobo_i_table_ticks(joint, servo, angle_rad);
    const grobo_servo_register *goal = grobo_servo_register_of(servo, GROBO_ROLE_GOAL);
    bool around = servo->span_deg >= 360;
    int32_t first = grobo_i_first_tick(servo);
    bool turn = !around || (ticks >= first && ticks < first + (int32_t)servo->span_ticks);
    return ticks >= goal->min && ticks <= goal->max && (joint->turns ? around : turn);
}

/* Whether a servo is of one of the family's series. */
static bool talks(const grobo_i_family *family, const grobo_servo_model *servo)
{
    const grobo_servo_table *series = grobo_servo_series(servo);
    bool known = false;
    for (int i = 0; i < GROBO_I_TABLES; i++) {
        known = known || (series != NULL && series == family->tables[i]);
    }
    return known;
}

/* A family without times keeps its unit all the same: it is what a speed is computed of. */
int grobo_i_table_make(grobo_driver *made, const grobo_model *model, const grobo_protocol *protocol,
                       const grobo_i_family *family)
{
    if (model == NULL || grobo_model_check(model) < 0) {
        return GROBO_ERR_ARG;
    }
    made->name = model->name;
    made->model = model;
    made->protocol = protocol;
    made->family = family;
    made->time_step_us = MS_US;
    made->time_max_us = (int64_t)family->time_max_ms * MS_US;
    made->limits =
        (grobo_safety_limits){.temperature_c = 65,
                              .lost_replies = 5,
                              .approach_rad_s = grobo_rad_from_deg(GROBO_PLAY_APPROACH_DEG_S)};
    made->on_exit = GROBO_EXIT_HOLD;
    made->arm = made->keeps_setup = true;
    for (int j = 0; j < model->n_joints; j++) {
        const grobo_joint *joint = grobo_i_joint(model, j);
        const grobo_servo_model *servo = grobo_i_table_servo(made, j);
        if (servo != NULL && (servo->flags & GROBO_MODEL_NO_JOINT) != 0) {
            return GROBO_ERR_UNSUPPORTED;
        }
        grobo_i_wheel wheel;
        if (grobo_i_joint_is_wheel(model, j) &&
            (!talks(family, servo) || !grobo_i_table_wheel(made, j, &wheel))) {
            return GROBO_ERR_ARG;
        }
        bool kept = !joint->calibrated || !family->offset_trims; /* where its middle is */
        if (!talks(family, servo) || !kept || !reaches(joint, servo, joint->min_rad) ||
            !reaches(joint, servo, joint->max_rad)) {
            return GROBO_ERR_ARG;
        }
    }
    made->angle_step_rad = grobo_i_table_step_rad(made);
    return grobo_driver_check(made);
}

uint32_t grobo_i_table_delay_us(const grobo_driver *self)
{
    uint32_t most_us = 0;
    for (int j = 0; j < self->model->n_joints; j++) {
        const grobo_servo_register *delay =
            grobo_servo_register_of(grobo_i_table_servo(self, j), GROBO_ROLE_RETURN_DELAY);
        if (delay != NULL) {
            uint32_t own_us = (uint32_t)(delay->factory * grobo_i_register_unit(delay));
            most_us = own_us > most_us ? own_us : most_us;
        }
    }
    return most_us;
}

int grobo_i_table_give(grobo_driver *driver, const grobo_driver *made, int result)
{
    if (result < 0 || driver == NULL) {
        return result < 0 ? result : GROBO_ERR_ARG;
    }
    return grobo_driver_copy(driver, made);
}

int grobo_i_table_finish(const grobo_driver *self, int size, grobo_exchange *exchange)
{
    if (size < 0) {
        return size;
    }
    exchange->frame_bytes = (uint16_t)size;
    int reply = self->protocol->reply_to(exchange->frame, (size_t)size, &exchange->reply);
    return reply < 0 ? reply : GROBO_OK;
}
