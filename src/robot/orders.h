/* SPDX-License-Identifier: MIT */
/* Orders to motors, in frames that wait for the line (orders.c). */
#ifndef GROBO_ROBOT_ORDERS_I_H
#define GROBO_ROBOT_ORDERS_I_H

#include <grobo/core/static.h>

/* How a target is sent. */
typedef struct grobo_i_motion {
    grobo_priority priority;
    int64_t due_us; /* GROBO_NEVER_US, or when it should leave: it is a played one */
    bool each;      /* more time only for joints that need it, not for all alike */
    bool as_is;     /* not for the stabilizer */
    bool single;    /* from a stream of the caller's own */
    bool stops;     /* leaves after a latched stop as well */
    bool rests;     /* ends a motion: each joint comes to rest near where it is by then */
    const int32_t *joint_time_us; /* as asked for each joint; NULL: as for all */
} grobo_i_motion;
/* Checks a target and has it wait for the line; its time is found when it leaves.
 * @return 0 or an error of the gate, the driver or the bus: then none of it is sent. */
int grobo_i_gate_send(grobo_robot *robot, const grobo_posture *target, const grobo_i_motion *how);
/* Tells these joints more of the trajectories in segments that they are on. */
void grobo_i_gate_renew(grobo_robot *robot, grobo_joint_mask joints);
/* Stops those of the joints that are being moved where they are, softly; targets that wait are
 * cancelled. One that may have restarted is owed its halt until it was heard, or is silent for
 * longer than that takes. */
void grobo_i_gate_halt(grobo_robot *robot, grobo_joint_mask joints);
/* Halts these once more, behind a latch as well; nothing else is cancelled for it. */
void grobo_i_gate_halt_again(grobo_robot *robot, grobo_joint_mask joints);
/* Joints of which nobody knows where they are: a stop reads them before it halts them. */
grobo_joint_mask grobo_i_unknown(const grobo_robot *robot);
/* Halts those that are owed it, where it is time; when it is. */
void grobo_i_gate_halt_owed(grobo_robot *robot);
int64_t grobo_i_gate_halt_at(const grobo_robot *robot);
/* Joints in a frame; small frames get through a line that loses bytes. */
typedef enum grobo_i_chunk { GROBO_I_WHOLE = GROBO_JOINTS_MAX, GROBO_I_SMALL = 4 } grobo_i_chunk;
/* Takes up to `chunk` joints out of *joints. */
grobo_joint_mask grobo_i_take_chunk(grobo_joint_mask *joints, grobo_i_chunk chunk);
/* Sets goal := present for `joints` without torque; not for those that stand too far outside their
 * limits. */
int grobo_i_gate_hold(grobo_robot *robot, grobo_joint_mask joints, grobo_i_chunk chunk);
/* Switches torque. ON leaves out joints whose goal was not read back to be where they are;
 * GROBO_ERR_STATE where none is left. */
int grobo_i_gate_torque(grobo_robot *robot, grobo_joint_mask joints, grobo_torque mode,
                        grobo_i_chunk chunk);
/* True if all of these were sensed and hold. */
bool grobo_i_gate_ready(const grobo_robot *robot, grobo_joint_mask joints);

/* Tells these wheels the speeds that they were asked for. */
void grobo_i_gate_speeds(grobo_robot *robot, grobo_joint_mask wheels);

#endif
