/* SPDX-License-Identifier: MIT */
/* The layouts of registers behind the frames of DYNAMIXEL 2.0, told by where a model has
 * them. */
#ifndef GROBO_CORE_SERVO_DXL2_SERIES_H
#define GROBO_CORE_SERVO_DXL2_SERIES_H

#include <grobo/core/registers.h>

typedef enum grobo_i_dxl2_series {
    GROBO_I_DXL2_X,    /* X, 2X, and MX with Protocol 2.0 */
    GROBO_I_DXL2_P,    /* P and PRO(A): RAM begins at 512; a goal current bounds each mode */
    GROBO_I_DXL2_PRO,  /* PRO before (A): so too, but a speed instead of a profile, no drive mode */
    GROBO_I_DXL2_XL320 /* registers of an AX: a speed instead of a profile, no drive mode */
} grobo_i_dxl2_series;

static inline grobo_i_dxl2_series grobo_i_dxl2_series_of(const grobo_servo_model *servo)
{
    enum { P_RAM = 512 };
    bool far = grobo_servo_register_of(servo, GROBO_ROLE_TORQUE)->address >= P_RAM;
    if (grobo_servo_register_of(servo, GROBO_ROLE_DIRECTION) == NULL) {
        return far ? GROBO_I_DXL2_PRO : GROBO_I_DXL2_XL320;
    }
    return far ? GROBO_I_DXL2_P : GROBO_I_DXL2_X;
}

#endif
