/* SPDX-License-Identifier: MIT */
/* How long the line is taken by frames: one, a motion's for some joints, a reading of all. Lines of
 * a robot of several have their frames at the same time: a motion takes what it takes on the
 * slowest, while joints are read one after the other. */
#include "src/robot/budget.h"
#include "src/robot/robot.h"

uint32_t grobo_i_line_us(const grobo_bus *bus, const grobo_exchange *exchange)
{
    const grobo_txn txn = {
        .frame = exchange->frame, .frame_bytes = exchange->frame_bytes, .reply = exchange->reply};
    grobo_bus_cost cost;
    grobo_bus_cost_of(bus, &txn, &cost);
    return cost.total_us;
}

#if GROBO_LINES_MAX > 1
static int count(const grobo_i_line *line)
{
    return line->lines == NULL ? 1 : line->lines->n_lines;
}

static const grobo_bus *bus_at(const grobo_i_line *line, int i)
{
    return i == 0 ? line->bus : &line->more[i - 1].bus;
}

static grobo_joint_mask joints_at(const grobo_i_line *line, int i)
{
    return line->lines == NULL ? ~(grobo_joint_mask)0 : line->lines->on[i];
}

static const grobo_bus *bus_of(const grobo_i_line *line, int joint)
{
    return bus_at(line, line->lines == NULL ? 0 : line->lines->line_of[joint]);
}
#else
static int count(const grobo_i_line *line)
{
    (void)line;
    return 1;
}

static const grobo_bus *bus_at(const grobo_i_line *line, int i)
{
    (void)i;
    return line->bus;
}

static grobo_joint_mask joints_at(const grobo_i_line *line, int i)
{
    (void)line;
    (void)i;
    return ~(grobo_joint_mask)0;
}

static const grobo_bus *bus_of(const grobo_i_line *line, int joint)
{
    (void)joint;
    return line->bus;
}
#endif

/* A target of these joints on a line. */
static int cost_on(const grobo_i_line *line, const grobo_bus *bus, const grobo_target *target,
                   uint32_t *us, bool *answered)
{
    const grobo_driver *driver = line->driver;
    int more = 1;
    *us = 0;
    for (int part = 0; more > 0 && part < GROBO_ROBOT_SLOTS; part++) {
        grobo_exchange exchange = {0};
        more = driver->posture(driver, line->ctx, target, part, &exchange);
        *answered = part == 0 ? exchange.reply.kind != GROBO_REPLY_NONE : *answered;
        *us += more > 0 ? grobo_i_line_us(bus, &exchange) : 0;
    }
    return more;
}

int grobo_i_motion_cost(const grobo_i_line *line, grobo_joint_mask joints, uint32_t *us,
                        bool *answered)
{
    const grobo_driver *driver = line->driver;
    grobo_target target = {0};
    int result = GROBO_OK;
    grobo_posture_init_pose(&target.posture, driver->model);
    for (int j = 0; j < driver->model->n_joints; j++) {
        target.joint_time_us[j] = driver->time_step_us;
    }
    *us = 0;
    for (int i = 0; i < count(line) && result >= 0; i++) {
        uint32_t own_us = 0;
        bool all = *answered || i == 0;
        target.posture.set = joints & joints_at(line, i);
        if (target.posture.set == 0) {
            continue;
        }
        result = cost_on(line, bus_at(line, i), &target, &own_us, answered);
        *answered = *answered && all;
        *us = own_us > *us ? own_us : *us;
    }
    return result;
}

int grobo_i_reading_cost(const grobo_i_line *line, uint32_t *us)
{
    const grobo_driver *driver = line->driver;
    void *ctx = line->ctx;
    int result = GROBO_OK;
    uint32_t all_us = 0;
    *us = 0;
    if (GROBO_I_EXTRA(driver, sense_many) != NULL) {
        grobo_exchange exchange = {0};
        result = driver->sense_many(driver, ctx, GROBO_JOINTS_ALL(driver->model->n_joints),
                                    GROBO_SENSE_FULL, &exchange);
        *us = result < 0 ? 0 : grobo_i_line_us(line->bus, &exchange);
        return result;
    }
    for (int j = 0; j < driver->model->n_joints && result >= 0; j++) {
        const grobo_bus *bus = bus_of(line, j);
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
        all_us += one_us;
    }
    if (count(line) > 1) { /* one after the other, of lines that are not alike */
        *us = (all_us + driver->model->n_joints - 1) / driver->model->n_joints;
    }
    return result;
}
