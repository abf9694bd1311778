/* SPDX-License-Identifier: MIT */
/* Lines of a robot that has several: which frame and which joint is on which (lines.c). */
#ifndef GROBO_ROBOT_LINES_I_H
#define GROBO_ROBOT_LINES_I_H

#include <grobo/core/static.h>

#include "src/robot/robot.h"

#if GROBO_LINES_MAX > 1
static inline int grobo_i_lines(const grobo_robot *robot)
{
    return robot->lines == NULL ? 1 : robot->lines->n_lines;
}
static inline grobo_bus *grobo_i_bus(grobo_robot *robot, int line)
{
    return line == 0 ? &robot->bus : &robot->more[line - 1].bus;
}
static inline const grobo_bus *grobo_i_bus_read(const grobo_robot *robot, int line)
{
    return line == 0 ? &robot->bus : &robot->more[line - 1].bus;
}
/* The line of a joint, and of a frame. */
static inline int grobo_i_line_of(const grobo_robot *robot, int joint)
{
    return robot->lines == NULL ? 0 : robot->lines->line_of[joint];
}
static inline int grobo_i_slot_line(const grobo_robot_slot *slot)
{
    return slot->line;
}
/* Joints of a line. */
static inline grobo_joint_mask grobo_i_joints_on(const grobo_robot *robot, int line)
{
    return robot->lines == NULL ? GROBO_JOINTS_ALL(robot->driver->model->n_joints)
                                : robot->lines->on[line];
}
static inline void grobo_i_slot_on(grobo_robot_slot *slot, int line)
{
    slot->line = (uint8_t)line;
}
/* The driver of a line, its first one where there is no such, and what its functions get. */
static inline const grobo_driver *grobo_i_line_driver(const grobo_robot *robot, int line,
                                                      void **ctx)
{
    const grobo_lines *lines = robot->lines;
    int i = lines != NULL && line > 0 && line < lines->n_lines ? line : 0;
    if (ctx != NULL) {
        *ctx = lines != NULL ? lines->line[i].ctx : robot->driver_ctx;
    }
    return lines != NULL ? &lines->line[i].driver : robot->driver;
}
/* Of these joints, those that a goal gives torque. */
grobo_joint_mask grobo_i_woken(const grobo_robot *robot, grobo_joint_mask joints);
/* Makes what a robot of several lines has, where its driver is of such. */
int grobo_i_lines_init(grobo_robot *robot);
/* What the bus of a line is made of, which `whole` has where the line does not say otherwise. */
grobo_bus_config grobo_i_line_config(const grobo_lines *lines, int line,
                                     const grobo_bus_config *whole);
/* The line that a frame is for, by the joints that it is about. */
void grobo_i_slot_aim(grobo_robot_slot *slot);
/* The joint of a motor on a line, or an error. */
int grobo_i_joint_on(const grobo_robot *robot, int line, int motor);
/* Time passes for the lines behind the first one, and when it is to pass next. */
void grobo_i_lines_step(grobo_robot *robot);
int64_t grobo_i_lines_deadline(const grobo_robot *robot, int64_t now_us);
/* grobo_bus_reserve() of these. */
void grobo_i_reserve_more(grobo_robot *robot, int64_t at_us, uint32_t duration_us);
static inline void grobo_i_lines_reserve(grobo_robot *robot, int64_t at_us, uint32_t duration_us)
{
    if (robot->lines != NULL) {
        grobo_i_reserve_more(robot, at_us, duration_us);
    }
}
/* grobo_driver.check() of the line that is asked whether its servos are there. */
int grobo_i_lines_check(grobo_robot *robot, int part);
/* When the last frame of a line was given out, and that it was answered. */
static inline int64_t *grobo_i_left_us(grobo_robot *robot, int line)
{
    return line == 0 ? &robot->left_us : &robot->more[line - 1].left_us;
}
static inline bool *grobo_i_answered(grobo_robot *robot, int line)
{
    return line == 0 ? &robot->answered : &robot->more[line - 1].answered;
}
#else
static inline int grobo_i_lines(const grobo_robot *robot)
{
    (void)robot;
    return 1;
}
static inline void grobo_i_lines_reserve(const grobo_robot *robot, int64_t at_us,
                                         uint32_t duration_us)
{
    (void)robot;
    (void)at_us;
    (void)duration_us;
}
static inline grobo_bus *grobo_i_bus(grobo_robot *robot, int line)
{
    (void)line;
    return &robot->bus;
}
static inline const grobo_bus *grobo_i_bus_read(const grobo_robot *robot, int line)
{
    (void)line;
    return &robot->bus;
}
static inline int grobo_i_line_of(const grobo_robot *robot, int joint)
{
    (void)robot;
    (void)joint;
    return 0;
}
static inline int grobo_i_slot_line(const grobo_robot_slot *slot)
{
    (void)slot;
    return 0;
}
static inline grobo_joint_mask grobo_i_joints_on(const grobo_robot *robot, int line)
{
    (void)line;
    return GROBO_JOINTS_ALL(robot->driver->model->n_joints);
}
static inline grobo_joint_mask grobo_i_woken(const grobo_robot *robot, grobo_joint_mask joints)
{
    return GROBO_I_EXTRA(robot->driver, goal_energises) ? joints : 0;
}
static inline const grobo_driver *grobo_i_line_driver(const grobo_robot *robot, int line,
                                                      void **ctx)
{
    (void)line;
    if (ctx != NULL) {
        *ctx = robot->driver_ctx;
    }
    return robot->driver;
}
static inline void grobo_i_slot_on(grobo_robot_slot *slot, int line)
{
    (void)slot;
    (void)line;
}
static inline void grobo_i_slot_aim(grobo_robot_slot *slot)
{
    (void)slot;
}
static inline int grobo_i_joint_on(const grobo_robot *robot, int line, int motor)
{
    (void)line;
    return grobo_model_joint_of_motor(robot->driver->model, motor);
}
static inline int64_t *grobo_i_left_us(grobo_robot *robot, int line)
{
    (void)line;
    return &robot->left_us;
}
static inline bool *grobo_i_answered(grobo_robot *robot, int line)
{
    (void)line;
    return &robot->answered;
}
#endif
/* The bus of a frame. */
static inline grobo_bus *grobo_i_bus_of(const grobo_robot_slot *slot)
{
    return grobo_i_bus(slot->robot, grobo_i_slot_line(slot));
}
/* True of a frame that is on its wire. */
static inline bool grobo_i_is_active(const grobo_robot_slot *slot)
{
    return grobo_i_bus_of(slot)->active == &slot->txn;
}

#endif
