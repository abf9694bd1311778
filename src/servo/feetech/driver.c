/* SPDX-License-Identifier: MIT */
/* Robots of Feetech's STS, SMS, HLS and SCS servos, on one bus too. */
#include <grobo/core/feetech.h>

#include "src/servo/dxl1/driver.h"
#include "src/servo/tables.h"
#include "src/servo/unit.h"

/* The phase says what a count of speed is, and whether positions count turns; only STS and SMS have
 * these bits (FTServo's tables). A servo is turned round by the senses of motor and sensor together
 * (wiki.juxitech.com, phase of STS): with one of them it would run away from its goal. */
#define PHASE_BITS                                                                                 \
    (GROBO_STS_PHASE_REVERSE | GROBO_STS_PHASE_FEEDBACK | GROBO_STS_PHASE_FINE_SPEED |             \
     GROBO_STS_PHASE_TURNS)

/* HLS have a current where the others have a PWM. Of their phase one bit says whether positions
 * count turns, the rest is of their bridge (the maker's memory table of HLS). */
static bool is_hls(const grobo_servo_model *servo)
{
    return grobo_servo_register_of(servo, GROBO_ROLE_GOAL_CURRENT) != NULL;
}

static int32_t wants(const grobo_joint *joint, const grobo_servo_model *servo,
                     grobo_register_role role, int32_t found)
{
    if (role == GROBO_ROLE_MODE) {
        return GROBO_STS_MODE_POSITION;
    }
    if (grobo_servo_series(servo) != &grobo_i_sts_table) {
        return found & ~(int32_t)GROBO_STS_PHASE_REVERSE;
    }
    if (is_hls(servo)) {
        unsigned turns = joint->turns ? GROBO_STS_PHASE_TURNS : 0;
        return (found & ~(int32_t)GROBO_STS_PHASE_TURNS) | (int32_t)turns;
    }
    unsigned bits = GROBO_STS_PHASE_FINE_SPEED | (joint->turns ? GROBO_STS_PHASE_TURNS : 0);
    return (found & ~(int32_t)PHASE_BITS) | (int32_t)bits;
}

/* STS and HLS have a mode for speeds (FTServo's tables, register 33); SCS are wheels where both
 * limits are 0, and then take an output of 1023 at most, its sense in bit 10, where a goal's time
 * is (FTServo's SCSCL::WritePWM). */
static bool wheel(const grobo_servo_model *servo, grobo_i_wheel *to)
{
    enum { OUTPUT_MOST = 1023, OUTPUT_BACK = 1024 };
    const grobo_servo_register *speed = grobo_servo_register_of(servo, GROBO_ROLE_SPEED);
    *to = grobo_servo_series(servo) == &grobo_i_sts_table
              ? (grobo_i_wheel){.role = GROBO_ROLE_SPEED,
                                .dps = grobo_i_register_unit(speed),
                                .most = speed->max,
                                .mode = GROBO_STS_MODE_SPEED}
              : (grobo_i_wheel){.role = GROBO_ROLE_GOAL_TIME,
                                .dps = (double)servo->speed_dps / OUTPUT_MOST,
                                .most = OUTPUT_MOST,
                                .sign = OUTPUT_BACK,
                                .by_limits = true};
    return true;
}

/* SCS stay silent (LeRobot). */
static bool sync_read(const grobo_servo_model *servo)
{
    return grobo_servo_series(servo) == &grobo_i_sts_table;
}

/*
 * STS have no time of a move but a speed, SCS have one. An overload bounds the output, and is left
 * by another goal or by torque off and on; reports differ (feetech protection settings), so that it
 * is no loss of torque here. Torque 0 of SCS is damped, and 2 is free; of STS 0 is free.
 */
static const grobo_i_family family = {
    .tables = {&grobo_i_sts_table, &grobo_i_scs_table},
    .build = grobo_i_dxl1_build_as,
    .parse = grobo_i_dxl1_parse_as,
    .wants = wants,
    .wheel = wheel,
    .limits_mode = GROBO_STS_MODE_POSITION,
    .frame_max_bytes = GROBO_DXL1_FRAME_MAX_BYTES,
    .time_max_ms = 32767,
    .overheated = GROBO_FEETECH_OVERHEATED,
    .sync_read = sync_read,
    .pace = GROBO_I_PACE_TIME,
};

int grobo_feetech_driver_init(grobo_driver *driver, const grobo_model *model)
{
    int result = grobo_i_table_driver(driver, model, &grobo_i_feetech_protocol, &family);
    if (result >= 0) {
        if (grobo_i_table_delay_us(driver) > grobo_i_feetech_protocol.return_delay_us) {
            driver->protocol = &grobo_i_feetech_delayed_protocol;
        }
        driver->goal_energises =
            true; /* measured on an STS3215 (feetech-cli 0.1.8, simulator.py) */
    }
    return result;
}
