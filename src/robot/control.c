/* SPDX-License-Identifier: MIT */
/* The public controls of a motion that is played. */
#include "src/robot/axis.h"
#include "src/robot/couple.h"
#include "src/robot/job.h"
#include "src/robot/orders.h"
#include "src/robot/play.h"
#include "src/robot/query.h"
#include "src/robot/queue.h"
#include "src/robot/stop.h"
#include "src/robot/turn.h"

/* A clip may break under a command while the key that was sent last is still seconds away. */
static int controlled(grobo_robot *robot, int result)
{
    if (grobo_sequencer_get_state(&robot->sequencer) == GROBO_SEQUENCER_FAILED &&
        robot->told_state != GROBO_SEQUENCER_FAILED) {
        grobo_i_stop_broken(robot);
    }
    grobo_i_end(robot);
    return result;
}

int grobo_robot_pause(grobo_robot *robot)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    int result = grobo_sequencer_pause(&robot->sequencer, robot->now_us);
    /* A clip before may have left joints on their trajectory that this one does not move; and the
     * frame of the pause leaves out those that it would wake. */
    grobo_joint_mask own = grobo_i_coupled(robot, robot->sequencer.to.set);
    grobo_joint_mask left = (robot->played_joints | own) & (~own | grobo_i_unknown(robot));
    if (result >= 0 && left != 0) {
        grobo_i_gate_halt(robot, left);
    }
    return controlled(robot, result);
}

int grobo_robot_resume(grobo_robot *robot)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    int result = grobo_i_is_latched(robot)
                     ? GROBO_ERR_LATCHED
                     : grobo_sequencer_resume(&robot->sequencer, robot->now_us);
    return controlled(robot, result);
}

int grobo_robot_stop(grobo_robot *robot, bool at_once)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    int result = grobo_sequencer_stop(&robot->sequencer, at_once, robot->now_us), joint;
    grobo_i_make_way(robot); /* it might send again what is stopped here */
    bool moves = grobo_i_externally_moved(robot, grobo_i_all_joints(robot), &joint) ||
                 grobo_i_jobs_any(robot, grobo_i_job_moves) || robot->queued > 0 ||
                 grobo_i_moving(robot, robot->now_us);
    grobo_i_jobs_end(robot, grobo_i_job_moves, GROBO_ERR_CANCELED);
    grobo_i_queue_end(robot, GROBO_ERR_CANCELED);
    grobo_i_stop_moves(robot);
    grobo_i_end(robot);
    return moves || robot->halts_owed != 0 ? GROBO_OK : result;
}

int grobo_robot_seek(grobo_robot *robot, int64_t clip_us)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    return controlled(robot, grobo_sequencer_seek(&robot->sequencer, clip_us, robot->now_us));
}

int grobo_robot_speed(grobo_robot *robot, int speed_pct)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    return controlled(robot,
                      grobo_sequencer_set_speed(&robot->sequencer, speed_pct, robot->now_us));
}

int grobo_robot_enqueue(grobo_robot *robot, const grobo_clip *clip,
                        const grobo_play_options *options)
{
    if (clip == NULL || robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    grobo_play_options chosen;
    grobo_joint_mask joints = 0;
    int result = grobo_i_play_options(robot, options, &chosen);
    if (result >= 0) {
        result = grobo_i_is_latched(robot) ? GROBO_ERR_LATCHED : grobo_i_play_rate(robot, &chosen);
    }
    if (result >= 0) {
        result = grobo_i_play_joints(robot, clip, &chosen, &joints);
    }
    if (result >= 0 && (grobo_i_joints_of_moves(robot) & joints) != 0) {
        result = GROBO_ERR_STATE; /* it moves them beside the motion */
    }
    if (result >= 0 && !grobo_i_gate_ready(robot, joints)) {
        result = GROBO_ERR_STATE; /* it would move in frames only */
    }
    if (result >= 0) {
        result = grobo_sequencer_enqueue(&robot->sequencer, clip, &chosen);
        robot->clip_joints |= result >= 0 ? joints : 0;
    }
    grobo_i_end(robot);
    return result;
}
