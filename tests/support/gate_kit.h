/* SPDX-License-Identifier: MIT */
/* Frames that leave through the gate of the robot in a known state. */
#ifndef GROBO_TEST_GATE_KIT_H
#define GROBO_TEST_GATE_KIT_H

#include "tests/support/axes_kit.h"

/* The number of the target that waits. */
enum { NUMBER = 7 };

/* The frame that leaves. */
extern grobo_robot_slot *slot;

/* A target waits for this joint: so many degrees from where it is. */
void await(int joint, double way_deg, int64_t time_us);
/* A slot with this order; what its exchange holds is of no frame. */
void take(grobo_robot_order order);
/* The same, and it leaves. @return what the gate says */
int leave(grobo_robot_order order);
/* Gives the slot back. */
void drop(void);

/* The frame that left is this packet. */
void expect_packet(const uint8_t *packet, int size);
/* It has a goal for each of these joints, in the order of motors, so far from where it is. */
void expect_goals(grobo_joint_mask of, double way_deg, int64_t time_us);
extern int doubled_goal; /* of these the joint that goes twice as far; -1: none */
void expect_torque(int joint, grobo_torque torque);
/* Changes `before` to what a goal that leaves now makes of it. */
void note_goal(int joint, double way_deg, int64_t time_us);

#endif
