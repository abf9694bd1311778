/* SPDX-License-Identifier: MIT */
/* A servo's registers, and which servo it is by them. */
#ifndef GROBO_SIM_REGISTERS_H
#define GROBO_SIM_REGISTERS_H

#include <grobo/sim_static.h>

int32_t grobo_i_sim_value(const grobo_sim_servo *servo, uint8_t address);
/* Sets a register, to the end of its range where the value is beyond. */
void grobo_i_sim_hold(grobo_sim_servo *servo, uint8_t address, int64_t value);
/* types.c: the row of what its register MODEL says. */
const grobo_sim_type *grobo_i_sim_type_of(const grobo_sim_servo *servo);

#endif
