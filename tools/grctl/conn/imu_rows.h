/* SPDX-License-Identifier: MIT */
/* How the base stood at each posture of a recorded motion: kept beside it, as a table. */
#ifndef GRCTL_IMU_ROWS_H
#define GRCTL_IMU_ROWS_H

#include <grobo/core/imu.h>

#include "tools/grctl/cli/app.h"

typedef struct imu_rows {
    /* private */
    struct imu_row *row;
    size_t n, capacity;
} imu_rows;

/* A posture that takes so long to reach; reading NULL: none was there. 0, or GROBO_ERR_NOMEM. */
int imu_rows_add(imu_rows *rows, int64_t time_us, const grobo_imu *reading);
void imu_rows_drop(imu_rows *rows);
void imu_rows_free(imu_rows *rows);

/* Writes MOTION.imu.csv: a row a posture, with its time in the motion; numbers are empty where
 * there was no reading. 0, or the exit status with the reason said. */
int imu_rows_save(const imu_rows *rows, app *a, const char *motion);

#endif
