/* SPDX-License-Identifier: MIT */
/* A servo's position loop as its registers have it now. */
#ifndef GROBO_SIM_LOOPS_H
#define GROBO_SIM_LOOPS_H

#include "src/sim/physics/motor.h"
#include "src/sim/servo/world.h"

/* Fills loop, and in the servo's body what registers say of strain. */
void grobo_i_loop_read(const grobo_sim_servo *servo, const grobo_sim_motor *motor,
                       grobo_i_loop *loop);

#endif
