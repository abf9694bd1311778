/* SPDX-License-Identifier: MIT */
/*
 * Goals in segments, in time. Of a long move a frame asks for the next GROBO_SEGMENT_US only, and
 * every GROBO_SEGMENT_RENEW_US another one asks for more, so that a joint stops soon when none
 * comes; less often where the line is slow (pace.c). trajectories.c says what a frame asks for.
 *
 * A joint whose segment was over before the next one left stands where it ended. Then the host was
 * away: the move is over, and does not continue by itself.
 */
#include "src/base/instant.h"
#include "src/robot/axis.h"
#include "src/robot/job.h"
#include "src/robot/orders.h"
#include "src/robot/query.h"
#include "src/robot/segments.h"
#include "src/robot/slot.h"
#include "src/robot/speed.h"
#include "src/robot/stand.h"
#include "src/robot/state.h"
#include "src/robot/trajectories.h"
#include "src/robot/trip.h"

static bool has_stopped(const grobo_robot_axis *axis, int64_t now_us)
{
    return grobo_i_trajectory_is_short(axis) && axis->told_to_us <= now_us;
}

static bool is_in_segments(const grobo_robot_axis *axis, int64_t now_us)
{
    (void)now_us;
    return grobo_i_is_in_segments(axis);
}

/* The first of the joints that stopped because their servos did not answer; -1: none. One that was
 * not asked is silent for want of its host. */
static int silent_joint(const grobo_robot *robot)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        if (has_stopped(axis, robot->now_us) && grobo_i_may_sleep(robot, j) && axis->lost > 0) {
            return j;
        }
    }
    return -1;
}

static bool goes_on(const grobo_robot_task *job)
{
    return job->kind == GROBO_JOB_MOVE || job->kind == GROBO_JOB_PLAY ||
           job->kind == GROBO_JOB_SETTLE;
}

/* How long a frame has been due for a joint that stopped; its segment was a whole one. */
static int64_t late_us(const grobo_robot *robot)
{
    int64_t most_us = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        int64_t since_us = robot->now_us - axis->told_to_us + GROBO_SEGMENT_US - robot->renew_us;
        most_us = has_stopped(axis, robot->now_us) ? grobo_i_later(most_us, since_us) : most_us;
    }
    return most_us;
}

/* As where the host stalls in a motion: what moves is over, and nothing is latched. */
static void give_up(grobo_robot *robot)
{
    int silent = silent_joint(robot);
    double late_ms = (double)late_us(robot) / 1000.0;
    grobo_joint_mask cut = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        grobo_robot_axis *axis = &robot->axes[j];
        if (grobo_i_trajectory_is_short(axis)) {
            grobo_i_axis_cut(axis);
            cut |= GROBO_JOINT_BIT(j);
        }
    }
    if (!GROBO_DRIVERS_PLAIN) { /* one that lost a frame is behind, and on its way yet */
        grobo_i_halt_owe(robot, cut);
    }
    grobo_i_gate_soften(robot);
    if (grobo_i_is_playing(robot)) {
        grobo_sequencer_reset(&robot->sequencer); /* what it sends next is from elsewhere */
    }
    if (silent >= 0) {
        grobo_i_trip(robot, GROBO_TRIP_LOST_REPLIES, silent, robot->axes[silent].lost, true);
        return;
    }
    robot->counters.stalls++;
    grobo_i_trip(robot, GROBO_TRIP_HOST_STALL, -1, late_ms, false);
    grobo_i_jobs_end(robot, goes_on, GROBO_ERR_CANCELED);
}

/* True if a joint that had missed its part of the trajectory is to get it before the others. */
static bool renews_early(const grobo_robot *robot)
{
    return !GROBO_DRIVERS_PLAIN &&
           (grobo_i_trajectories_renewed(robot) & robot->renews_owed) != 0 &&
           !grobo_i_slots_busy(robot, GROBO_I_USE_SEGMENT);
}

void grobo_i_segments_step(grobo_robot *robot)
{
    if (robot->halts_owed != 0) {
        grobo_i_gate_halt_owed(robot);
    }
    if (!robot->in_segments) {
        return;
    }
    robot->in_segments = grobo_i_joints_that(robot, is_in_segments) != 0;
    if (grobo_i_joints_that(robot, has_stopped) != 0) {
        give_up(robot);
    }
    int64_t due_us = grobo_i_segments_due(robot);
    if (due_us <= robot->now_us && !grobo_i_slots_busy(robot, GROBO_I_USE_SEGMENT)) {
        bool late = due_us + robot->renew_us <= robot->now_us;
        robot->renewed_us = late ? robot->now_us : due_us; /* on its grid, so that ends are exact */
        robot->renews_owed = 0;
        grobo_i_gate_renew(robot, grobo_i_trajectories_renewed(robot));
    } else if (renews_early(robot)) {
        grobo_joint_mask joints = grobo_i_trajectories_renewed(robot) & robot->renews_owed;
        robot->renews_owed = 0;
        grobo_i_gate_renew(robot, joints);
    }
}

int64_t grobo_i_segments_deadline(const grobo_robot *robot)
{
    int64_t at_us = robot->halts_owed != 0 ? grobo_i_gate_halt_at(robot) : GROBO_NEVER_US;
    if (!robot->in_segments) {
        return at_us;
    }
    at_us = grobo_i_slots_busy(robot, GROBO_I_USE_SEGMENT)
                ? at_us
                : grobo_i_sooner(at_us, grobo_i_segments_due(robot));
    at_us = renews_early(robot) ? robot->now_us : at_us;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        if (grobo_i_trajectory_is_short(axis) && axis->told_to_us < at_us) {
            at_us = axis->told_to_us;
        }
    }
    return at_us;
}
