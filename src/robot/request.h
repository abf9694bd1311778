/* SPDX-License-Identifier: MIT */
/* Requests that others begin (request.c). */
#ifndef GROBO_ROBOT_REQUEST_I_H
#define GROBO_ROBOT_REQUEST_I_H

#include <grobo/core/static.h>

/* Begins to carry an emergency stop out; the link is up. @return the job's number. */
int grobo_i_estop_start(grobo_robot *robot);

#endif
