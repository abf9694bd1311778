/* SPDX-License-Identifier: MIT */
/* How long the line is taken by frames: one, a motion's for some joints, a reading of all. */
#include "src/robot/robot.h"

uint32_t grobo_i_line_us(const grobo_bus *bus, const grobo_exchange *exchange)
{
    const grobo_txn txn = {
        .frame = exchange->frame, .frame_bytes = exchange->frame_bytes, .reply = exchange->reply};
    grobo_bus_cost cost;
    grobo_bus_cost_of(bus, &txn, &cost);
    return cost.total_us;
}

int grobo_i_motion_cost(const grobo_bus *bus, const grobo_driver *driver, void *ctx,
                        grobo_joint_mask joints, uint32_t *us, bool *answered)
{
    grobo_target target = {0};
    int more = 1;
    grobo_posture_init_pose(&target.posture, driver->model);
    target.posture.set = joints;
    for (int j = 0; j < driver->model->n_joints; j++) {
        target.joint_time_us[j] = driver->time_step_us;
    }
    *us = 0;
    for (int part = 0; more > 0 && part < GROBO_ROBOT_SLOTS; part++) {
        grobo_exchange exchange = {0};
        more = driver->posture(driver, ctx, &target, part, &exchange);
        *answered = part == 0 ? exchange.reply.kind != GROBO_REPLY_NONE : *answered;
        *us += more > 0 ? grobo_i_line_us(bus, &exchange) : 0;
    }
    return more;
}

int grobo_i_reading_cost(const grobo_bus *bus, const grobo_driver *driver, void *ctx, uint32_t *us)
{
    int result = GROBO_OK;
    *us = 0;
    if (GROBO_I_EXTRA(driver, sense_many) != NULL) {
        grobo_exchange exchange = {0};
        result = driver->sense_many(driver, ctx, GROBO_JOINTS_ALL(driver->model->n_joints),
                                    GROBO_SENSE_FULL, &exchange);
        *us = result < 0 ? 0 : grobo_i_line_us(bus, &exchange);
        return result;
    }
    for (int j = 0; j < driver->model->n_joints && result >= 0; j++) {
        grobo_exchange exchange = {0};
        result = driver->sense(driver, ctx, j, GROBO_SENSE_FULL, &exchange);
        uint32_t one_us = result < 0 ? 0 : grobo_i_line_us(bus, &exchange);
        for (int part = 1; result >= 0 && GROBO_I_EXTRA(driver, sense_more) != NULL; part++) {
            exchange = (grobo_exchange){0};
            result = driver->sense_more(driver, ctx, j, GROBO_SENSE_FULL, part, &exchange);
            if (result == 0) {
                break;
            }
            one_us += result < 0 ? 0 : grobo_i_line_us(bus, &exchange);
        }
        *us = one_us > *us ? one_us : *us;
    }
    return result;
}
