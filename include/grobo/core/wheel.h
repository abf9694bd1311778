/* SPDX-License-Identifier: MIT */
/**
 * @file core/wheel.h
 * @brief Wheels: joints with speeds.
 *
 * A wheel (grobo_joint.wheel; `type: wheel` of a robot file) turns on and on. It is read, switched
 * on and off, watched and stopped as other joints are; postures, motions and free mode leave it
 * out, or refuse it with GROBO_ERR_UNSUPPORTED.
 *
 * What holds on every path, judged as the bytes leave:
 * - Its servo was read to be set up as a wheel: one that is set up for positions is read with
 *   GROBO_ERR_SETUP, and so is a wheel's servo of a joint that is none.
 * - Torque comes on only where the servo's speed was read back to be 0.
 * - No speed exceeds the limit; it changes by no more than the acceleration of the joint allows.
 * - A speed ends by itself: see grobo_robot_drive().
 * - A stop of any kind, a trip, an exit: speed 0 at once, read back, told again where it was lost.
 *   A wheel stands where two positions, 0.5 s apart and more, are the same, its speed was read to
 *   be 0 and the speed that its servo was told too.
 * - A wheel that turns as the line is lost is told to stand as soon as the line is there again;
 *   meanwhile only a servo with a watchdog (DYNAMIXEL X: 0.5 s) stops by itself.
 * - A wheel that is told to turn and does not for 1 s stops the robot (GROBO_TRIP_BLOCKED).
 *
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_WHEEL_H
#define GROBO_CORE_WHEEL_H

#include <grobo/robot.h>

GROBO_BEGIN_DECLS

/** How long a speed holds that is not asked for again. */
#define GROBO_DRIVE_US 500000

/** The wheels of a model; 0: it has none. Thread safe. */
GROBO_API grobo_joint_mask grobo_model_wheels(const grobo_model *model);

/**
 * Has wheels turn at these speeds. No job and no event: for a control loop, which calls it several
 * times a second. Each call holds for GROBO_DRIVE_US; then its wheels are halted, and
 * GROBO_EVENT_HALTED tells whether they stand. Wheels must have been read and have torque
 * (grobo_robot_torque(), once). What else runs continues: wheels turn beside moves and motions.
 * @param wheels one at least; others keep what they were asked for.
 * @param rad_s by joint, n_joints of them; those of other joints are not looked at. 0 leads the
 *   wheel to rest by its acceleration.
 * @return 0, and all are taken; or an error, and none is: GROBO_ERR_CLOSED, GROBO_ERR_LATCHED,
 *   GROBO_ERR_STATE (an exit or another job that is alone runs; a wheel has no torque),
 *   GROBO_ERR_STALE (not read), GROBO_ERR_SETUP (its servo is not set up as a wheel),
 *   GROBO_ERR_LIMIT (unless limits clamp), GROBO_ERR_NAN, GROBO_ERR_UNSUPPORTED (not a wheel),
 *   GROBO_ERR_UNWATCHED (the line is too slow to renew the speeds and read the joints in time),
 *   GROBO_ERR_ARG. grobo_robot_fault() has the joint, and the speed in degrees a second.
 */
GROBO_API int grobo_robot_drive(grobo_robot *robot, grobo_joint_mask wheels, const double *rad_s);

/** What a wheel is to do. grobo_robot_joint() has what was read of it. Plain data. */
typedef struct grobo_wheel_info {
    double asked_rad_s; /**< the speed asked for; 0 where that is over */
    double told_rad_s;  /**< the speed that its servo was told last */
    int64_t left_us;    /**< for how long that still holds */
    bool stands;        /**< it was read to stand since it was told so */
} grobo_wheel_info;

/** What is known of a wheel. @return 0, GROBO_ERR_ARG, GROBO_ERR_UNSUPPORTED: it is no wheel. */
GROBO_API int grobo_robot_wheel(const grobo_robot *robot, int joint, grobo_wheel_info *info);

GROBO_END_DECLS

#endif
