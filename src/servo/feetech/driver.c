/* SPDX-License-Identifier: MIT */
/* Robots of Feetech's STS, SMS and SCS servos, on one bus too. */
#include <grobo/feetech.h>

#include "src/servo/dxl1/driver.h"

/* The phase says what a count of speed is, and whether positions count turns; only STS and SMS have
 * these bits (FTServo's tables). */
#define PHASE_BITS (GROBO_STS_PHASE_REVERSE | GROBO_STS_PHASE_FINE_SPEED | GROBO_STS_PHASE_TURNS)

static bool phase_fits(const grobo_joint *joint, const grobo_servo_model *servo, int32_t phase)
{
    if (servo->table != &grobo_sts_table) {
        return (phase & (int)GROBO_STS_PHASE_REVERSE) == 0;
    }
    unsigned wanted = GROBO_STS_PHASE_FINE_SPEED | (joint->turns ? GROBO_STS_PHASE_TURNS : 0);
    return ((unsigned)phase & PHASE_BITS) == wanted;
}

static int setup(const grobo_joint *joint, const grobo_servo_model *servo, uint16_t address,
                 const uint8_t *data, size_t n)
{
    int32_t model, mode = GROBO_STS_MODE_POSITION, phase, min, max;
    if (!grobo_i_table_value(servo, GROBO_ROLE_MODEL, address, data, n, &model)) {
        return GROBO_OK; /* not a reading of the setup */
    }
    (void)grobo_i_table_value(servo, GROBO_ROLE_MODE, address, data, n, &mode); /* SCS: none */
    bool phases = grobo_i_table_value(servo, GROBO_ROLE_DIRECTION, address, data, n, &phase) &&
                  phase_fits(joint, servo, phase);
    bool limits =
        grobo_i_table_value(servo, GROBO_ROLE_MIN_POSITION, address, data, n, &min) &&
        grobo_i_table_value(servo, GROBO_ROLE_MAX_POSITION, address, data, n, &max) &&
        (joint->turns ? min == 0 && max == 0 : grobo_i_table_within(joint, servo, min, max));
    return model == servo->number && mode == GROBO_STS_MODE_POSITION && phases && limits
               ? GROBO_OK
               : GROBO_ERR_SETUP;
}

/* SCS stay silent (LeRobot). */
static bool sync_read(const grobo_servo_model *servo)
{
    return servo->table == &grobo_sts_table;
}

/*
 * STS have no time of a move but a speed, SCS have one. An overload bounds the output, and is left
 * by another goal or by torque off and on; reports differ (feetech protection settings), so that it
 * is no loss of torque here. Torque 0 of SCS is damped, and 2 is free; of STS 0 is free.
 */
static const grobo_i_family family = {
    .tables = {&grobo_sts_table, &grobo_scs_table},
    .build = grobo_i_dxl1_build_as,
    .parse = grobo_i_dxl1_parse_as,
    .setup = setup,
    .frame_max_bytes = GROBO_DXL1_FRAME_MAX_BYTES,
    .time_max_ms = 32767,
    .overheated = GROBO_FEETECH_OVERHEATED,
    .sync_read = sync_read,
    .pace = GROBO_I_PACE_TIME,
};

int grobo_feetech_driver_init(grobo_driver *driver, const grobo_model *model)
{
    return grobo_i_table_driver(driver, model, &grobo_feetech_protocol, &family);
}
