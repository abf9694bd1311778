/* SPDX-License-Identifier: MIT */
/* Which jobs run side by side, what waits for its turn, what joins (queue.c, join.c). */
#ifndef GROBO_ROBOT_QUEUE_I_H
#define GROBO_ROBOT_QUEUE_I_H

#include <grobo/core/static.h>

/* May a job of this kind begin on these joints? GROBO_I_LATER: when others have ended. */
#define GROBO_I_LATER 1
int grobo_i_admit(grobo_robot *robot, grobo_job_kind kind, grobo_joint_mask joints, bool moves);
/* A move that runs takes these joints besides its own, from the moves that have them.
 * @return 0, or GROBO_ERR_STATE where they are a motion's or another job's: none is taken. */
int grobo_i_move_takes(grobo_robot *robot, grobo_joint_mask joints);
/* Joints of the moves that run or wait. */
grobo_joint_mask grobo_i_joints_of_moves(const grobo_robot *robot);
/* Begins a move, a reading or torque on, joins it to another one, or has it wait. @return its
 * number, or the reason why not. */
int grobo_i_queue_ask(grobo_robot *robot, const grobo_robot_request *request);
/* Begins what waits and may go; ends what has waited too long. */
void grobo_i_queue_step(grobo_robot *robot);
/* When that is next. */
int64_t grobo_i_queue_deadline(const grobo_robot *robot);

/* Joins a request to a job or to one that waits, where it is as if both had been asked for at once:
 * a reading or torque on to one that has not read these joints yet, a move of a joint to one that
 * has not read its joints yet. @return the number of that job; 0: there is none. */
int grobo_i_join_job(grobo_robot *robot, const grobo_robot_request *request);
int grobo_i_join_waiting(grobo_robot *robot, const grobo_robot_request *request);
/* Joins torque off or brake to a job that does the same; `sent`: to one that has sent its frames,
 * too, which begins anew. @return the number of that job; 0: there is none. */
int grobo_i_join_off(grobo_robot *robot, grobo_joint_mask joints, grobo_torque mode, bool sent);

#endif
