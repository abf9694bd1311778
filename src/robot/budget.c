/* SPDX-License-Identifier: MIT */
/* How many motion frames a second leave time to read every joint: the one rule for all callers. */
#include <grobo/core/robot.h>

#include "src/robot/axis.h"
#include "src/robot/budget.h"
#include "src/robot/lines.h"
#include "src/robot/pace.h"
#include "src/robot/robot.h"

#define SECOND_US 1000000u

/*
 * With k whole readings between two frames, the largest rate is 1 / (motion + k readings), and k
 * readings a frame are enough where k * rate * watch_us >= joints. The smallest k that is
 * enough gives the largest rate.
 */
static uint16_t watched_rate(const grobo_budget *budget, uint32_t joints, uint32_t watch_us)
{
    for (uint32_t k = 1; k <= joints; k++) {
        uint32_t period_us = budget->motion_us + k * budget->reading_us;
        uint32_t hz = period_us == 0 ? GROBO_PLAY_RATE_MAX_HZ : SECOND_US / period_us;
        if ((uint64_t)k * hz * watch_us >= (uint64_t)joints * SECOND_US) {
            return (uint16_t)(hz < GROBO_PLAY_RATE_MAX_HZ ? hz : GROBO_PLAY_RATE_MAX_HZ);
        }
    }
    return 0;
}

static int budget_of(const grobo_i_line *line, grobo_budget *budget)
{
    const grobo_driver *driver = line->driver;
    grobo_budget found;
    bool answered = false;
    int result = grobo_i_motion_cost(line, GROBO_JOINTS_ALL(driver->model->n_joints),
                                     &found.motion_us, &answered);
    if (result >= 0) {
        result = grobo_i_reading_cost(line, &found.reading_us);
    }
    if (result < 0) {
        return result;
    }
    uint32_t readings = GROBO_I_EXTRA(driver, sense_many) != NULL ? 1 : driver->model->n_joints;
    uint32_t watch_us =
        GROBO_I_EXTRA(driver, goal_energises) && !answered ? GROBO_I_RESTART_US : GROBO_WATCH_US;
    found.watched_hz = watched_rate(&found, readings, watch_us);
    found.default_hz =
        found.watched_hz < GROBO_PLAY_RATE_HZ ? found.watched_hz : GROBO_PLAY_RATE_HZ;
    found.pace_us = grobo_i_pace_of(line, GROBO_JOINTS_ALL(driver->model->n_joints));
    *budget = found;
    return GROBO_OK;
}

/* With buses as an engine would have them. */
static int budget_on(const grobo_driver *driver, void *ctx, const grobo_bus_config *config,
                     grobo_budget *budget)
{
    grobo_bus bus;
    grobo_i_line line = {.bus = &bus, .driver = driver, .ctx = ctx};
    int result = GROBO_OK;
#if GROBO_LINES_MAX > 1
    grobo_robot_line more[GROBO_LINES_MAX - 1];
    line.lines = grobo_driver_lines(driver);
    line.more = more;
    for (int i = 1; line.lines != NULL && i < line.lines->n_lines && result >= 0; i++) {
        grobo_bus_config own = grobo_i_line_config(line.lines, i, config);
        result = grobo_bus_init(&more[i - 1].bus, &own);
    }
    const grobo_bus_config first = grobo_i_line_config(line.lines, 0, config);
#else
    const grobo_bus_config first = *config;
#endif
    result = result < 0 ? result : grobo_bus_init(&bus, &first);
    return result < 0 ? result : budget_of(&line, budget);
}

int grobo_budget_init(grobo_budget *budget, const grobo_driver *driver, void *ctx,
                      const grobo_bus_config *line)
{
    if (budget == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_bus_config config = {0};
    if (grobo_driver_check(driver) < 0) {
        return GROBO_ERR_ARG;
    }
    if (line != NULL) {
        config = *line;
    }
    config.protocol = driver->protocol;
    return budget_on(driver, ctx, &config, budget);
}

int grobo_robot_budget(const grobo_robot *robot, grobo_budget *budget)
{
    if (robot == NULL || budget == NULL) {
        return GROBO_ERR_ARG;
    }
    const grobo_i_line line = grobo_i_line_of_robot(robot);
    return budget_of(&line, budget);
}
