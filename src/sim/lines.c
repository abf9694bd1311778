/* SPDX-License-Identifier: MIT */
/* What a simulator of one line of a robot is made of. */
#include "src/sim/lines.h"

#if GROBO_LINES_MAX > 1

void grobo_i_sim_of_line(const grobo_lines *lines, int line, const grobo_sim_config *whole,
                         grobo_i_sim_line *own)
{
    const grobo_lines_line *on = &lines->line[line];
    own->config = *whole;
    own->config.model = &on->model;
    own->config.wiring = grobo_driver_wiring(&on->driver);
    own->config.baud_bps = on->baud_bps != 0 ? on->baud_bps : whole->baud_bps;
    own->config.echo = on->echo;
    own->config.seed = whole->seed + (uint32_t)line;
    own->config.physics = NULL;
    if (whole->servos == NULL) {
        return;
    }
    int n = 0;
    for (int j = 0; j < GROBO_JOINTS_MAX; j++) {
        if ((lines->on[line] & GROBO_JOINT_BIT(j)) != 0) {
            own->servos[n++] = whole->servos[j];
        }
    }
    own->config.servos = own->servos;
    const grobo_servo_model *robot = whole->servos[0], *first = own->servos[0];
    if (robot != NULL && first != NULL && whole->supply_mv == (uint32_t)robot->voltage_mv) {
        own->config.supply_mv = (uint32_t)first->voltage_mv;
    }
}

#endif
