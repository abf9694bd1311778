/* SPDX-License-Identifier: MIT */
/*
 * Lines of a robot that has several (grobo/core/lines.h). Each has a bus of its own, with its own
 * frames on the wire; slots, orders, jobs and what is known of joints are one for all. A frame is
 * for the line of the joints that it is about.
 *
 * A line that is down while others are there is one whose servos are silent: its frames are taken
 * from its bus as they are due, go nowhere, and time out as any frame does that is not answered. So
 * whatever waits for a joint of it ends as for a servo that is not there.
 */
#include "src/robot/axis.h"
#include "src/robot/lines.h"
#include "src/robot/robot.h"

#if GROBO_LINES_MAX > 1

grobo_bus_config grobo_i_line_config(const grobo_lines *lines, int line,
                                     const grobo_bus_config *whole)
{
    grobo_bus_config config = *whole;
    if (lines != NULL) {
        const grobo_lines_line *own = &lines->line[line];
        config.protocol = own->driver.protocol;
        config.baud_bps = own->baud_bps != 0 ? own->baud_bps : config.baud_bps;
        config.echo = own->echo;
    }
    return config;
}

int grobo_i_lines_init(grobo_robot *robot)
{
    robot->lines = grobo_driver_lines(robot->driver);
    int result = GROBO_OK;
    for (int i = 0; i < grobo_i_lines(robot) && result >= 0; i++) {
        const grobo_bus_config config = grobo_i_line_config(robot->lines, i, &robot->config.bus);
        result = grobo_bus_init(grobo_i_bus(robot, i), &config);
    }
    return result < 0 ? GROBO_ERR_ARG : GROBO_OK;
}

grobo_joint_mask grobo_i_woken(const grobo_robot *robot, grobo_joint_mask joints)
{
    grobo_joint_mask woken = 0;
    if (!robot->driver->goal_energises) {
        return 0;
    }
    for (int i = 0; i < grobo_i_lines(robot); i++) {
        bool all = robot->lines == NULL || robot->lines->line[i].driver.goal_energises;
        woken |= all ? joints & grobo_i_joints_on(robot, i) : 0;
    }
    return woken;
}

void grobo_i_slot_aim(grobo_robot_slot *slot)
{
    const grobo_robot *robot = slot->robot;
    grobo_joint_mask joints = slot->reads  ? GROBO_JOINT_BIT(slot->joint)
                              : slot->many ? slot->unread
                                           : slot->order.joints;
    if (joints != 0 && robot->lines != NULL) {
        slot->line = robot->lines->line_of[grobo_i_lowest(joints)];
    }
}

int grobo_i_joint_on(const grobo_robot *robot, int line, int motor)
{
    const grobo_model *model = robot->driver->model;
    for (int j = 0; j < model->n_joints; j++) {
        if (grobo_i_joint(model, j)->motor == motor && grobo_i_line_of(robot, j) == line) {
            return j;
        }
    }
    return GROBO_ERR_NOTFOUND;
}

/* Frames that were given to a line that is down go nowhere. */
static void waste(grobo_robot *robot)
{
    for (int i = 0; i < grobo_i_lines(robot); i++) {
        grobo_bus *bus = grobo_i_bus(robot, i);
        uint8_t frame[GROBO_FRAME_MAX_BYTES];
        if ((robot->lines_gone & 1u << i) != 0) {
            (void)grobo_bus_tx(bus, frame, sizeof frame, robot->now_us);
        }
    }
}

void grobo_i_lines_step(grobo_robot *robot)
{
    for (int i = 1; i < grobo_i_lines(robot); i++) {
        grobo_bus_step(grobo_i_bus(robot, i), robot->now_us);
    }
    if (robot->lines_gone != 0) {
        waste(robot);
    }
}

int64_t grobo_i_lines_deadline(const grobo_robot *robot, int64_t now_us)
{
    int64_t at_us = GROBO_NEVER_US;
    for (int i = 1; i < grobo_i_lines(robot); i++) {
        int64_t own_us = grobo_bus_deadline(grobo_i_bus_read(robot, i), now_us);
        at_us = own_us < at_us ? own_us : at_us;
    }
    return at_us;
}

void grobo_i_reserve_more(grobo_robot *robot, int64_t at_us, uint32_t duration_us)
{
    for (int i = 1; i < grobo_i_lines(robot); i++) {
        grobo_bus_reserve(grobo_i_bus(robot, i), at_us, duration_us);
    }
}

int grobo_i_lines_check(grobo_robot *robot, int part)
{
    void *ctx;
    const grobo_driver *driver = grobo_i_line_driver(robot, robot->check_line, &ctx);
    return driver->check(driver, ctx, part, &robot->built);
}

/* ---- the pump -------------------------------------------------------------------------------- */

static bool is_line(const grobo_robot *robot, int line)
{
    return robot != NULL && line >= 0 && line < grobo_i_lines(robot);
}

int grobo_robot_lines(const grobo_robot *robot)
{
    return robot == NULL ? GROBO_ERR_ARG : grobo_i_lines(robot);
}

const grobo_bus_stats *grobo_robot_line_stats(const grobo_robot *robot, int line)
{
    return is_line(robot, line) ? &grobo_i_bus_read(robot, line)->stats : NULL;
}

#endif
