/* SPDX-License-Identifier: MIT */
/**
 * @file core/imu.h
 * @brief How a robot's base stands: what an inertial measurement unit reports.
 *
 * A program that reads an IMU gives each reading to the engine, which hands the latest one to the
 * driver's stabilizer (grobo_driver.stabilize_by) before it judges and sends a target. A simulated
 * robot whose body is a program's own (grobo_sim_plant.imu, grobo_sim_imu()) reports the same:
 * grobo_virtual_run() and a session with the device "sim" hand it over by themselves.
 *
 * Axes of the base: x points ahead, y to the left, z up.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_IMU_H
#define GROBO_CORE_IMU_H

#include <grobo/robot.h>

GROBO_BEGIN_DECLS

/** A reading that is older is not handed to a stabilizer. */
#define GROBO_IMU_AGE_US 100000

/** A reading. Plain data. */
typedef struct grobo_imu {
    double roll_rad;      /**< about x, -pi..pi; positive: the left side is up */
    double pitch_rad;     /**< about y, before the roll, -pi/2..pi/2; positive: bent ahead */
    double rate_rad_s[3]; /**< of the base, about its own axes */
} grobo_imu;

/** Between the base's z and the vertical, 0..pi, in rad; 0 for NULL. Pure; thread safe. */
GROBO_API double grobo_imu_tilt(const grobo_imu *imu);

/**
 * Gives the engine a reading of now. It sends nothing and wakes nothing.
 * For the thread that pumps the engine, or with the lock of its host.
 * @return 0; GROBO_ERR_NAN (a number that is not finite); GROBO_ERR_LIMIT (an angle outside of its
 *         range); GROBO_ERR_UNSUPPORTED (a build for plain drivers, GROBO_DRIVERS_PLAIN)
 */
GROBO_API int grobo_robot_set_imu(grobo_robot *robot, const grobo_imu *imu);

/**
 * The reading given last.
 * @param[out] age_us since then; may be NULL
 * @return 0; GROBO_ERR_STALE: none was given yet; GROBO_ERR_UNSUPPORTED
 */
GROBO_API int grobo_robot_imu(const grobo_robot *robot, grobo_imu *imu, int64_t *age_us);

GROBO_END_DECLS

#endif
