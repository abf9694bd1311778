/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tools/grctl/decode/dialect.h"
#include "tools/grctl/servo/family.h"

static const dialect *const dialects[] = {&dialect_dxl2, &dialect_dxl1,  &dialect_sts,
                                          &dialect_scs,  &dialect_lx16a, &dialect_ics};

const dialect *dialect_named(const char *name)
{
    for (size_t i = 0; i < sizeof dialects / sizeof *dialects; i++) {
        if (strcmp(dialects[i]->name, name) == 0) {
            return dialects[i];
        }
    }
    return NULL;
}

const dialect *dialect_of_servo(const grobo_servo_model *servo)
{
    const grobo_robot_family *family = servo ? family_of_servo(servo) : NULL;
    const dialect *found = NULL;
    for (size_t i = 0; family && i < sizeof dialects / sizeof *dialects; i++) {
        if (strcmp(dialects[i]->family, family->name) == 0 &&
            (!found || dialects[i]->table == servo->table)) {
            found = dialects[i];
        }
    }
    return found;
}
