/* SPDX-License-Identifier: MIT */
/* Raw frames for the engine of a rig, on either wiring; the last one asked for is remembered. */
#ifndef GROBO_TEST_RAW_FRAMES_H
#define GROBO_TEST_RAW_FRAMES_H

#include "tests/support/rig.h"

/* Sends a joint somewhere. @return what grobo_robot_raw() says. */
int raw_goal(grobo_test_rig *rig, int joint, double deg, int time_ms);
/* The same, and asks for an ACK: it is tried again without one. */
int raw_goal_with_ack(grobo_test_rig *rig, int joint, double deg, int time_ms);
int raw_torque(grobo_test_rig *rig, int joint, grobo_torque torque);
/* Requests of another kind, remembered as the packets that they make. */
int raw_reboot(grobo_test_rig *rig, int joint);
int raw_cw_limit(grobo_test_rig *rig, int joint, int deg);
/* How often the last one asked for was sent since the last rig_forget(). */
size_t raw_times_sent(const grobo_test_rig *rig);

#endif
