/* SPDX-License-Identifier: MIT */
/* What ends the engine's own work, and what stops joints that move. */
#include "src/robot/robot.h"

void grobo_i_make_way(grobo_robot *robot)
{
    robot->settling = false;
    if (robot->job->kind == GROBO_JOB_SETTLE) {
        grobo_i_job_end(robot, GROBO_ERR_CANCELED);
    }
}

void grobo_i_stop_moves(grobo_robot *robot)
{
    grobo_joint_mask joints = grobo_i_all_joints(robot);
    if (grobo_robot_is_playing(robot)) {
        joints &= ~robot->played_joints; /* the sequencer brings these to rest */
    }
    grobo_i_slots_cancel_goals(robot, grobo_i_all_joints(robot), true);
    if (joints != 0) {
        grobo_i_gate_halt(robot, joints);
    }
}

bool grobo_i_job_moves(const grobo_robot_task *job)
{
    return job->kind == GROBO_JOB_MOVE || job->kind == GROBO_JOB_PLAY || job->order.moves;
}
