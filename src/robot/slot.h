/* SPDX-License-Identifier: MIT */
/* Frames under way: from an exchange to a transaction and back (slot.c). */
#ifndef GROBO_ROBOT_SLOT_I_H
#define GROBO_ROBOT_SLOT_I_H

#include <grobo/core/static.h>

/* What a frame under way is for. */
typedef enum grobo_i_use {
    GROBO_I_USE_FREE = 0,
    GROBO_I_USE_JOB,     /* its end goes to the job that is named in it */
    GROBO_I_USE_SENSE,   /* a reading of the background */
    GROBO_I_USE_MOTION,  /* a target; a played one if it has a due time */
    GROBO_I_USE_SEGMENT, /* further on the trajectories of targets that have left */
    GROBO_I_USE_HALT,    /* what moves is to stop */
    GROBO_I_USE_SPEED,   /* wheels turn on */
    GROBO_I_USE_PLAIN    /* sent for its effect; a later reading shows whether it took */
} grobo_i_use;

/* What a frame does to joints: grobo_robot_order.kind. */
typedef enum grobo_i_order_kind {
    GROBO_I_ORDER_NONE = 0, /* it reads, or writes what moves nothing */
    GROBO_I_ORDER_GOAL,     /* joints go to their targets, grobo_robot_axis.next */
    GROBO_I_ORDER_SEGMENT,  /* joints go further on the trajectories that they are on */
    GROBO_I_ORDER_HALT,     /* joints that move stop where they are by then */
    GROBO_I_ORDER_HOLD,     /* goals of joints without torque become where they are */
    GROBO_I_ORDER_TORQUE,   /* torque is switched */
    GROBO_I_ORDER_RAW,      /* what the driver reads in a frame of the user's */
    GROBO_I_ORDER_UNKNOWN,  /* nobody can read what: a raw frame, a motion of the robot's own */
    GROBO_I_ORDER_SETTING,  /* a goal means something else to these afterwards */
    GROBO_I_ORDER_COMMAND,  /* a servo is busy with itself; `joints` restart without torque */
    GROBO_I_ORDER_SPEED     /* wheels go on to the speeds that they were asked for */
} grobo_i_order_kind;

/* The index of a free slot, or -1; there is always one for a halt. */
int grobo_i_slot_find(const grobo_robot *robot, grobo_i_use use);
/* Takes it, with a zeroed order and grobo_robot.built (but for the bytes of the frame), or NULL. */
grobo_robot_slot *grobo_i_slot_take(grobo_robot *robot, grobo_i_use use);
/* Gives the bus this frame, which is copied; on error the slot is free again. */
int grobo_i_slot_send(grobo_robot_slot *slot, const grobo_exchange *exchange,
                      grobo_priority priority);
/* Puts grobo_robot.built in the place of the frame that waits. @return GROBO_OK, or GROBO_ERR_SPACE
 * where it is longer than that was at first. */
int grobo_i_slot_renew(grobo_robot_slot *slot);
/* Makes grobo_robot.built ask all of slot->unread, by the driver's sense_many(). @return GROBO_OK
 * or an error of the driver. */
int grobo_i_slot_ask_unread(grobo_robot_slot *slot);
/* Gives a slot back that was not sent. */
void grobo_i_slot_drop(grobo_robot_slot *slot);
/* A stop waits: the reply on the line gets no more time than the shortest margin. */
void grobo_i_slots_hurry(grobo_robot *robot);
/* Takes back every frame that has not left. */
void grobo_i_slots_cancel_all(grobo_robot *robot);
/* Takes back every frame of this use, but for one that waits to bring a motion to rest. */
void grobo_i_slots_cancel(grobo_robot *robot, grobo_i_use use);
/* Takes back every frame that a step of this job made. */
void grobo_i_slots_cancel_job(grobo_robot *robot, int number);
/* Takes back targets that have not left and move one of these joints; `played`: and those of the
 * motion that is played. Not what brings it to rest. */
void grobo_i_slots_cancel_goals(grobo_robot *robot, grobo_joint_mask joints, bool played);
/* Takes back targets that have not left and move none but these joints: what others wait for in the
 * same frame leaves. */
void grobo_i_slots_cancel_own(grobo_robot *robot, grobo_joint_mask joints);
/* Takes back the parts of an order that wait behind this one, which has failed. */
void grobo_i_slots_cancel_rest(const grobo_robot_slot *before);
/* Takes back every frame of this job that has not left. @return the joints of their orders. */
grobo_joint_mask grobo_i_slots_take_back(grobo_robot *robot, int number);
/* True if a frame of this job that reads one of these joints has left. */
bool grobo_i_slots_read(const grobo_robot *robot, int number, grobo_joint_mask joints);
/* Takes back frames that would switch the torque of one of these joints on. */
void grobo_i_slots_keep_off(grobo_robot *robot, grobo_joint_mask joints);
/* True if such an order to the joint waits for the line; `torque` OFF where it switches none. */
bool grobo_i_slots_wait(const grobo_robot *robot, grobo_joint_mask joint, grobo_i_order_kind kind,
                        grobo_torque torque);
/* True if a frame of this use is under way. */
bool grobo_i_slots_busy(const grobo_robot *robot, grobo_i_use use);

#endif
