/* SPDX-License-Identifier: MIT */
/* How the base stands: the latest reading of an IMU, kept for the stabilizer. */
#include <math.h>

#include <grobo/core/imu.h>

#include "src/robot/query.h"

#define PI 3.14159265358979323846
/* A reading in single precision may exceed a right angle by so much. */
#define ROUNDED_RAD 1e-6

double grobo_imu_tilt(const grobo_imu *imu)
{
    return imu == NULL ? 0 : acos(fmax(-1, fmin(1, cos(imu->roll_rad) * cos(imu->pitch_rad))));
}

#if GROBO_DRIVERS_PLAIN

int grobo_robot_set_imu(grobo_robot *robot, const grobo_imu *imu)
{
    return robot == NULL || imu == NULL ? GROBO_ERR_ARG : GROBO_ERR_UNSUPPORTED;
}

int grobo_robot_imu(const grobo_robot *robot, grobo_imu *imu, int64_t *age_us)
{
    (void)age_us;
    return robot == NULL || imu == NULL ? GROBO_ERR_ARG : GROBO_ERR_UNSUPPORTED;
}

#else

int grobo_robot_set_imu(grobo_robot *robot, const grobo_imu *imu)
{
    if (robot == NULL || imu == NULL) {
        return GROBO_ERR_ARG;
    }
    if (!isfinite(imu->roll_rad) || !isfinite(imu->pitch_rad) || !isfinite(imu->rate_rad_s[0]) ||
        !isfinite(imu->rate_rad_s[1]) || !isfinite(imu->rate_rad_s[2])) {
        return GROBO_ERR_NAN;
    }
    if (fabs(imu->roll_rad) > PI + ROUNDED_RAD || fabs(imu->pitch_rad) > PI / 2 + ROUNDED_RAD) {
        return GROBO_ERR_LIMIT;
    }
    robot->imu = *imu;
    robot->imu_us = grobo_i_now(robot);
    robot->has_imu = true;
    return GROBO_OK;
}

int grobo_robot_imu(const grobo_robot *robot, grobo_imu *imu, int64_t *age_us)
{
    if (robot == NULL || imu == NULL) {
        return GROBO_ERR_ARG;
    }
    if (!robot->has_imu) {
        return GROBO_ERR_STALE;
    }
    *imu = robot->imu;
    if (age_us != NULL) {
        *age_us = grobo_i_now(robot) - robot->imu_us;
    }
    return GROBO_OK;
}

#endif
