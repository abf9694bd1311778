/* SPDX-License-Identifier: MIT */
/* Robots of any number of joints. */
#ifndef GROBO_TEST_MANY_JOINTS_H
#define GROBO_TEST_MANY_JOINTS_H

#include <grobo/core/driver.h>

/* A driver for n joints: those of GR001, again from the first where there are more, without groups
 * and mirrors. Static: the next call makes it anew, whatever was changed. */
grobo_driver *many_joints(grobo_wiring wiring, int n);

/* The same, but no joint is like another: joint j goes to 70 + j degrees to both sides, at
 * 100 + 5 j degrees a second, and starts at 0. */
grobo_driver *many_unlike_joints(grobo_wiring wiring, int n);

#endif
