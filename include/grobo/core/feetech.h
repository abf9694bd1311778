/* SPDX-License-Identifier: MIT */
/**
 * @file feetech.h
 * @brief Registers of Feetech's bus servos: STS and SMS, SCS.
 *
 * Their frame is that of DYNAMIXEL Protocol 1.0 (dxl1.h), with instructions of their own there.
 * STS and SMS put the low byte of a value first, SCS the high one; SCS have no SYNC_READ.
 *
 * Source of the constants: LeRobot motors/feetech/tables.py, the maker's FTServo SDK, its memory
 * tables, and a dump of a real SO-101 arm's registers.
 */
#ifndef GROBO_CORE_FEETECH_H
#define GROBO_CORE_FEETECH_H

#include <grobo/core/dxl1.h>

GROBO_BEGIN_DECLS

/** Bits of a status' error, and of the registers status, unload and led_alarm. */
#define GROBO_FEETECH_VOLTAGE 0x01u     /**< outside its limits */
#define GROBO_FEETECH_SENSOR 0x02u      /**< the sensor of the angle fails */
#define GROBO_FEETECH_OVERHEATED 0x04u  /**< above its limit */
#define GROBO_FEETECH_OVERCURRENT 0x08u /**< above its limit */
#define GROBO_FEETECH_OVERLOAD 0x20u    /**< a load that lasts */

/** Values of the register mode of STS and SMS. */
typedef enum grobo_sts_mode {
    GROBO_STS_MODE_POSITION = 0,
    GROBO_STS_MODE_SPEED = 1,
    GROBO_STS_MODE_PWM = 2,
    GROBO_STS_MODE_STEP = 3
} grobo_sts_mode;

/** Value of the register torque of STS and SMS: the present position becomes the middle. */
#define GROBO_STS_TORQUE_CALIBRATE 128

/** Bits of the register phase of STS and SMS. */
#define GROBO_STS_PHASE_REVERSE 0x01u
#define GROBO_STS_PHASE_FINE_SPEED 0x04u /**< a count of speed is 1 step/s, else 50 */
#define GROBO_STS_PHASE_ZERO_FULL 0x08u  /**< a speed of 0 is full speed, else none */
#define GROBO_STS_PHASE_TURNS 0x10u      /**< the position counts turns */
#define GROBO_STS_PHASE_FEEDBACK 0x80u   /**< the position counts backwards, with REVERSE only */

/** The protocol, for the bus. Servos must have a reply level of 1, as they leave the factory. */
GROBO_API const grobo_protocol *grobo_feetech_protocol(void);

/** Registers of STS and SMS, and their models. */
GROBO_API const grobo_servo_table *grobo_sts_table(void);

/** Registers of SCS, and their models. */
GROBO_API const grobo_servo_table *grobo_scs_table(void);

GROBO_END_DECLS

#endif
