/* SPDX-License-Identifier: MIT */
/* The base of a simulated body is its own IMU. */
#ifndef GROBO_SIM_IMU_H
#define GROBO_SIM_IMU_H

#include <grobo/core/imu.h>
#include <grobo/core/sim.h>

/* What the base reads now. A world whose body reports nothing is not stepped for it.
 * Returns as grobo_sim_imu(). */
int grobo_i_sim_imu_at(grobo_sim *sim, int64_t now_us, grobo_imu *imu);

#endif
