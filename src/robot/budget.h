/* SPDX-License-Identifier: MIT */
/* How many motion frames a second leave time to read (budget.c). */
#ifndef GROBO_ROBOT_BUDGET_I_H
#define GROBO_ROBOT_BUDGET_I_H

#include <grobo/core/static.h>

#include "src/robot/robot.h"

/* A line, or all of a robot, and what drives servos on it. */
typedef struct grobo_i_line {
    const grobo_bus *bus;
    const grobo_driver *driver;
#if GROBO_LINES_MAX > 1
    const grobo_lines *lines;     /* NULL: it is the only one */
    const grobo_robot_line *more; /* the buses of the others */
#endif
    void *ctx;   /* the driver's */
    bool unread; /* nothing is read in the background */
} grobo_i_line;

/* Of an engine. */
grobo_i_line grobo_i_line_of_robot(const grobo_robot *robot);

/* How long an exchange has the line, in microseconds. */
uint32_t grobo_i_line_us(const grobo_bus *bus, const grobo_exchange *exchange);

/* What a goal of all these joints costs, in as many frames as it takes. *answered: servos answer
 * their goals. @return 0, or an error of the driver. */
int grobo_i_motion_cost(const grobo_i_line *line, grobo_joint_mask joints, uint32_t *us,
                        bool *answered);
/* The costliest reading of one joint, or of all where one frame reads all; of several lines the
 * mean of one joint. */
int grobo_i_reading_cost(const grobo_i_line *line, uint32_t *us);

#endif
