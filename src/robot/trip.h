/* SPDX-License-Identifier: MIT */
/* Stops for safety (trip.c). */
#ifndef GROBO_ROBOT_TRIP_I_H
#define GROBO_ROBOT_TRIP_I_H

#include <grobo/core/static.h>

/* Stops for safety. Latched ones end a job that moves or switches on. */
void grobo_i_trip(grobo_robot *robot, grobo_trip reason, int joint, double value, bool latched);

#endif
