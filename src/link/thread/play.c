/* SPDX-License-Identifier: MIT */
/*
 * What a control has the engine do, and how that ended. A request is made without the lock, so its
 * end may be told before its number is noted: then the end is found among those that were told.
 */
#include "src/link/thread/thread.h"

int grobo_i_control_end_of_job(const grobo_control *control, int number)
{
    for (int i = 0; i < GROBO_CONTROL_ENDS; i++) {
        if (control->job_ends[i].number == number) {
            return control->job_ends[i].result;
        }
    }
    return CALL_PENDING;
}

/* With the lock: a job that may be the target's or the motion's has ended. */
static void take_end(grobo_control *control, int number, int result)
{
    if (control->move_job == number) {
        control->move_job = 0;
        control->motion_result = result;
    }
    if (control->play_job == number) {
        control->play_job = 0;
        control->play_error = result;
    }
}

void grobo_i_control_end_job(grobo_control *control, const grobo_event_job *ended)
{
    control->job_ends[control->next_end++ % GROBO_CONTROL_ENDS] = *ended;
    take_end(control, ended->number, ended->result);
}

/* Notes the number of a request in one of the two places. */
static void note(grobo_control *control, int *place, int number)
{
    grobo_i_control_lock(control);
    *place = number;
    int r = grobo_i_control_end_of_job(control, number);
    if (r != CALL_PENDING) {
        take_end(control, number, r);
    }
    grobo_i_control_unlock(control);
}

/* ---- the target --------------------------------------------------------------------------- */

int grobo_i_control_move(grobo_control *control, const grobo_posture *target)
{
    grobo_robot *robot = control_robot(control);
    int number = grobo_robot_retarget(robot, target);

    if (number < 0) { /* no move is under way, or it has other joints */
        number = grobo_robot_move(robot, target);
    }
    if (number < 0) {
        return number;
    }
    note(control, &control->move_job, number);
    return GROBO_OK;
}

/* ---- the motion --------------------------------------------------------------------------- */

void grobo_i_control_release_clip(grobo_control *control)
{
    if (control->clip.key != NULL) {
        grobo_motion_clip_free(&control->clip);
    }
    grobo_motion_free(control->playing);
    control->playing = NULL;
}

static void end_play(grobo_control *control, int result)
{
    grobo_i_control_release_clip(control);
    grobo_i_control_lock(control);
    control->play = PLAY_NONE;
    control->motion_result = result;
    grobo_i_control_unlock(control);
}

int grobo_i_control_play(grobo_control *control, const grobo_play_options *options)
{
    grobo_robot *robot = control_robot(control);
    grobo_clip_options clip_options = {GROBO_CLIP_OPTIONS_INIT,
                                       .default_us = options->default_time_us};
    grobo_posture start;

    /* By keys the sequencer counts a motion of increments from where the robot is then. */
    if (options->mode == GROBO_PLAY_RATE &&
        grobo_robot_posture(robot, GROBO_NEVER_US, &start) > 0) {
        clip_options.start = &start;
    }
    int number = grobo_motion_clip(control->playing, &clip_options, &control->clip);
    if (number >= 0) {
        number = grobo_robot_play(robot, &control->clip, options);
    }
    if (number < 0) {
        end_play(control, number);
        return number;
    }
    note(control, &control->play_job, number);
    grobo_i_control_lock(control);
    control->play = PLAY_BEGUN;
    grobo_i_control_unlock(control);
    return GROBO_OK;
}

/* How playing ended, when its preparation went well. */
static int play_result(grobo_control *control)
{
    grobo_play_progress progress;

    grobo_robot_progress(control_robot(control), &progress);
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

void grobo_i_control_look_at_play(grobo_control *control)
{
    grobo_i_control_lock(control);
    bool prepared = control->play == PLAY_BEGUN && control->play_job == 0;
    int error = control->play_error;
    grobo_i_control_unlock(control);
    if (prepared && !grobo_robot_is_playing(control_robot(control))) {
        end_play(control, error < 0 ? error : play_result(control));
    }
}
