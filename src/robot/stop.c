/* SPDX-License-Identifier: MIT */
/* What ends the engine's own work, and what stops joints that move. */
#include "src/robot/axis.h"
#include "src/robot/couple.h"
#include "src/robot/job.h"
#include "src/robot/orders.h"
#include "src/robot/query.h"
#include "src/robot/slot.h"
#include "src/robot/stop.h"

void grobo_i_make_way(grobo_robot *robot)
{
    robot->settling = false;
    if (robot->job->kind == GROBO_JOB_SETTLE) {
        grobo_i_job_end(robot, GROBO_ERR_CANCELED);
    }
}

/* Joints that the sequencer moves, or brings to rest: then those of its last frame alone. One that
 * a clip before has left behind is none of them. */
static grobo_joint_mask joints_of_motion(const grobo_robot *robot)
{
    const grobo_sequencer *sequencer = &robot->sequencer;
    if (!grobo_i_is_playing(robot)) {
        return 0;
    }
    return grobo_sequencer_get_state(sequencer) == GROBO_SEQUENCER_STOPPING
               ? robot->played_joints & grobo_i_coupled(robot, sequencer->to.set)
               : robot->played_joints;
}

void grobo_i_stop_moves(grobo_robot *robot)
{
    /* The frame that ends a motion leaves out those that it would wake. */
    grobo_joint_mask rest = joints_of_motion(robot) & ~grobo_i_unknown(robot);
    grobo_joint_mask joints = grobo_i_all_joints(robot) & ~rest;
    grobo_i_slots_cancel_goals(robot, grobo_i_all_joints(robot), true);
    if (joints != 0) {
        grobo_i_gate_halt(robot, joints);
    }
}

bool grobo_i_job_moves(const grobo_robot_task *job)
{
    return job->kind == GROBO_JOB_MOVE || job->kind == GROBO_JOB_PLAY || job->order.moves;
}

/* Playing ends with what it could not do, and the preparation of it by itself. */
static bool moves_beside(const grobo_robot_task *job)
{
    return job->kind != GROBO_JOB_PLAY && grobo_i_job_moves(job);
}

void grobo_i_stop_broken(grobo_robot *robot)
{
    grobo_i_jobs_end(robot, moves_beside, GROBO_ERR_CANCELED);
    grobo_i_queue_end(robot, GROBO_ERR_CANCELED);
    grobo_i_gate_halt(robot, grobo_i_all_joints(robot));
}
