/* SPDX-License-Identifier: MIT */
/* Registers of the servos as people and scripts read them: in degrees, ms, mA, by name. */
#ifndef GRCTL_REGISTERS_H
#define GRCTL_REGISTERS_H

#include <grobo/core/registers.h>

#include "tools/grctl/cli/app.h"

enum { REGISTERS_TEXT_BYTES = 48 };

/* "-1.0 deg", "1000 ms", "on", "115200 bps", "RS301CR"; plain numbers as they are. Positions are
 * those of the servo, from the middle of its span. */
void registers_text(const grobo_servo_model *servo, const grobo_servo_register *reg, int32_t counts,
                    char *text, size_t capacity);

/* The name with its unit, as keys of JSON are spelled: "goal_deg", "goal_time_ms", "torque". */
void registers_key(const grobo_servo_register *reg, char *key, size_t capacity);

/* The value that stands behind that key: a number, or a word as registers_text() has it. */
json_t *registers_json(const grobo_servo_model *servo, const grobo_servo_register *reg,
                       int32_t counts);

#endif
