/* SPDX-License-Identifier: MIT */
/*
 * A robot in a known state, to look at what one function does to which joint: as many joints as
 * there may be, none like another, and all that is known of each compared, so that nothing happens
 * beside it. No time passes, and nothing is sent.
 */
#ifndef GROBO_TEST_AXES_KIT_H
#define GROBO_TEST_AXES_KIT_H

#include "src/robot/axis.h"
#include "src/robot/budget.h"
#include "src/robot/couple.h"
#include "src/robot/gate.h"
#include "src/robot/halted.h"
#include "src/robot/job.h"
#include "src/robot/lines.h"
#include "src/robot/orders.h"
#include "src/robot/pace.h"
#include "src/robot/query.h"
#include "src/robot/queue.h"
#include "src/robot/reading.h"
#include "src/robot/request.h"
#include "src/robot/robot.h"
#include "src/robot/segments.h"
#include "src/robot/sense.h"
#include "src/robot/slot.h"
#include "src/robot/stand.h"
#include "src/robot/state.h"
#include "src/robot/steps.h"
#include "src/robot/stop.h"
#include "src/robot/trajectories.h"
#include "src/robot/trip.h"
#include "src/robot/turn.h"
#include "src/robot/watch.h"
#include "src/robot/weight.h"
#include "tests/support/rig.h"

#define RAD(deg) ((deg)*0.017453292519943295)

enum { MS = 1000, S = 1000000, NOW = 50 * S };

/* How many joints there are: as many as there may be, or one less on a bus, which is odd. */
#define N (GROBO_JOINTS_MAX - (rig_wiring == GROBO_WIRING_BUS))

extern grobo_robot robot;
extern grobo_driver driver;
extern grobo_robot_axis before[GROBO_JOINTS_MAX]; /* what robot.axes should be */
extern int inspected; /* what reading a raw frame results in, where it is an error */

/* Of so many joints, none of which was read; the link is up. */
void make_robot(int n, const grobo_robot_config *config);
/* N joints hold where they were sent, and whatever a frame that leaves sets is set otherwise. */
void start_with(const grobo_robot_config *config);
void start(void);

double here_rad(int joint);
double speed_dps(int joint);
/* Two joints besides this one. */
int other_of(int joint);
int third_of(int joint);
grobo_joint_mask bits(int joint, int other);
grobo_joint_mask all_but(int joint);

void make_limp(int joint);
/* It moves 20 degrees on, at 10 degrees a second, and has been for a second. */
void set_going(int joint);
void latch(grobo_trip reason);
/* The joints that the halts that wait would stop if they left now. */
grobo_joint_mask halting(void);

/* From here on, what robot.axes is. */
void keep_axes(void);
/* It is as in `before`, which the test has changed to what should be. */
void expect_axes(void);
/* Two numbers are the same but for rounding. */
void expect_equal(double is, double be, const char *what);

#endif
