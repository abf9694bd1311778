/* SPDX-License-Identifier: MIT */
/*
 * What a runner has the engine do, and how that ended. A request is made without the lock, so its
 * end may be told before its number is noted: then the end is found among those that were told.
 */
#include <grobo/core/robot.h>

#include "src/link/runner/runner.h"

/* How it has ended for these joints, of which others may have joined it; 0: for all. */
static int result_for(const grobo_event_job *ended, grobo_joint_mask joints)
{
    bool others = joints != 0 && ended->failed != 0 && (ended->failed & joints) == 0;

    return ended->result < 0 && others ? GROBO_OK : ended->result;
}

int grobo_i_runner_end_of_job(const grobo_runner *runner, int number, grobo_joint_mask joints)
{
    for (int i = 0; i < GROBO_RUNNER_ENDS; i++) {
        const grobo_event_job *ended = &runner->job_ends[i];
        if (ended->number == number) {
            return result_for(ended, joints);
        }
    }
    return CALL_PENDING;
}

/* With the lock: a job that may be the motion's has ended. */
static void take_end(grobo_runner *runner, int number, int result)
{
    if (runner->play_job == number) {
        runner->play_job = 0;
        runner->play_error = result;
    }
}

bool grobo_i_runner_end_job(grobo_runner *runner, const grobo_event_job *ended)
{
    bool awaited = false;

    runner->job_ends[runner->next_end++ % GROBO_RUNNER_ENDS] = *ended;
    if (ended->kind == GROBO_JOB_MOVE) {
        runner->motion_result = ended->result;
    }
    take_end(runner, ended->number, ended->result);
    for (runner_job *job = runner->waiting; job != NULL; job = job->next) {
        if (job->number == ended->number) {
            job->result = result_for(ended, job->joints);
            job->ended = awaited = true;
        }
    }
    return awaited;
}

/* Notes the number of the request that plays. */
static void note(grobo_runner *runner, int number)
{
    grobo_i_runner_lock(runner);
    runner->play_job = number;
    int r = grobo_i_runner_end_of_job(runner, number, 0);
    if (r != CALL_PENDING) {
        take_end(runner, number, r);
    }
    grobo_i_runner_unlock(runner);
}

/* ---- the motion --------------------------------------------------------------------------- */

void grobo_i_runner_release_clip(grobo_runner *runner)
{
    if (runner->clip.key != NULL) {
        grobo_motion_clip_free(&runner->clip);
    }
    grobo_motion_free(runner->playing);
    runner->playing = NULL;
}

static void end_play(grobo_runner *runner, int result)
{
    grobo_i_runner_release_clip(runner);
    grobo_i_runner_lock(runner);
    runner->play = PLAY_NONE;
    runner->motion_result = result;
    grobo_i_runner_unlock(runner);
}

int grobo_i_runner_play(grobo_runner *runner, const grobo_play_options *options)
{
    grobo_robot *robot = runner_robot(runner);
    grobo_clip_options clip_options = {GROBO_CLIP_OPTIONS_INIT,
                                       .default_us = options->default_time_us};
    grobo_posture start;

    /* By keys the sequencer counts a motion of increments from where the robot is then. */
    if (options->mode == GROBO_PLAY_RATE &&
        grobo_robot_posture(robot, GROBO_NEVER_US, &start) > 0) {
        clip_options.start = &start;
    }
    int number = grobo_motion_clip(runner->playing, &clip_options, &runner->clip);
    if (number >= 0) {
        number = grobo_robot_play(robot, &runner->clip, options);
    }
    if (number < 0) {
        end_play(runner, number);
        return number;
    }
    note(runner, number);
    grobo_i_runner_lock(runner);
    runner->play = PLAY_BEGUN;
    grobo_i_runner_unlock(runner);
    return GROBO_OK;
}

/* How playing ended, when its preparation went well. */
static int play_result(grobo_runner *runner)
{
    grobo_play_progress progress;

    grobo_robot_progress(runner_robot(runner), &progress);
    switch (progress.state) {
    case GROBO_SEQUENCER_FAILED:
        return progress.error;
    case GROBO_SEQUENCER_FINISHED:
        return GROBO_OK;
    case GROBO_SEQUENCER_IDLE:
    case GROBO_SEQUENCER_APPROACHING:
    case GROBO_SEQUENCER_PLAYING:
    case GROBO_SEQUENCER_PAUSED:
    case GROBO_SEQUENCER_STOPPING:
        break;
    }
    return GROBO_ERR_CANCELED;
}

void grobo_i_runner_look_at_play(grobo_runner *runner)
{
    if (runner->play != PLAY_BEGUN) {
        return;
    }
    grobo_i_runner_lock(runner);
    bool prepared = runner->play == PLAY_BEGUN && runner->play_job == 0;
    int error = runner->play_error;
    grobo_i_runner_unlock(runner);
    if (prepared && !grobo_robot_is_playing(runner_robot(runner))) {
        end_play(runner, error < 0 ? error : play_result(runner));
    }
}
