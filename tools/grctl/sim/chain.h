/* SPDX-License-Identifier: MIT */
/* A chain of servos to simulate, as `sim --servo 1=RS304MD,2=XL330-M288` names it. */
#ifndef GRCTL_SIM_CHAIN_H
#define GRCTL_SIM_CHAIN_H

#include "tools/grctl/cli/app.h"

enum { SIM_CHAIN_NAME_BYTES = 12 };

typedef struct sim_chain {
    grobo_model model; /* joints SERVO_1, SERVO_2, ... by the ids; it points into this */
    grobo_joint joints[GROBO_SIM_SERVOS_MAX];
    char names[GROBO_SIM_SERVOS_MAX][SIM_CHAIN_NAME_BYTES];
    const grobo_servo_model *servos[GROBO_SIM_SERVOS_MAX];
} sim_chain;

/* Makes the model of a list ID=TYPE,... Returns 0, or the exit status with the reason printed. */
int sim_chain_read(app *a, sim_chain *chain, const char *list);

#endif
