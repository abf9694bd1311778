/* SPDX-License-Identifier: MIT */
/* What one count of a register is worth, as its unit says. */
#ifndef GROBO_CORE_SERVO_UNIT_H
#define GROBO_CORE_SERVO_UNIT_H

#include <grobo/core/registers.h>

/* In deg/s of a speed, in mV of a voltage, else in what the unit names. */
double grobo_i_register_unit(const grobo_servo_register *reg);

/* The first count of a turn of a servo that turns around; 0 of another one. */
int32_t grobo_i_first_tick(const grobo_servo_model *servo);

#endif
