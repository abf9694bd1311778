/* SPDX-License-Identifier: MIT */
/* The simulator of one line of a robot that has several. */
#ifndef GROBO_SIM_LINES_H
#define GROBO_SIM_LINES_H

#include <grobo/core/lines.h>
#include <grobo/core/sim.h>

#if GROBO_LINES_MAX > 1

/* A configuration, and the servos that it points to. */
typedef struct grobo_i_sim_line {
    grobo_sim_config config;
    const grobo_servo_model *servos[GROBO_JOINTS_MAX];
} grobo_i_sim_line;

/* The part of a robot's simulator that is on a line: its joints, rate, wiring and echo; the supply
 * is that of its servos where the robot's is the one of its first servo. There is no weight: a
 * world has one simulator. */
void grobo_i_sim_of_line(const grobo_lines *lines, int line, const grobo_sim_config *whole,
                         grobo_i_sim_line *own);

#endif

#endif
