/* SPDX-License-Identifier: MIT */
/* Scripts of jobs, and the steps they are made of (steps.c, check.c). */
#ifndef GROBO_ROBOT_STEPS_I_H
#define GROBO_ROBOT_STEPS_I_H

#include <grobo/core/static.h>

extern const grobo_robot_step_fn grobo_i_script_sense[];
extern const grobo_robot_step_fn grobo_i_script_torque_on[];
extern const grobo_robot_step_fn grobo_i_script_torque_off[]; /* brake as well */
extern const grobo_robot_step_fn grobo_i_script_move[];
extern const grobo_robot_step_fn grobo_i_script_play[];
extern const grobo_robot_step_fn grobo_i_script_settle[];
extern const grobo_robot_step_fn grobo_i_script_ask[];
extern const grobo_robot_step_fn grobo_i_script_exit_off[];
extern const grobo_robot_step_fn grobo_i_script_exit_hold[];
extern const grobo_robot_step_fn grobo_i_script_exit_sit[];

/* True of a move that is done, and whose joints come to rest yet. */
bool grobo_i_move_settles(const grobo_robot_task *job);
/* True if the target of a move has been sent. */
bool grobo_i_move_is_sent(const grobo_robot_task *job);
/* Sends the joints of such a move, robot.job, to another target, and goes on from there; of one
 * asked for joint by joint these joints alone. */
void grobo_i_move_retarget(grobo_robot *robot, const grobo_posture *target);

extern const grobo_robot_step_fn grobo_i_script_check[];

#endif
