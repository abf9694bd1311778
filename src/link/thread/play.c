/* SPDX-License-Identifier: MIT */
/* What a control has the robot do, on the loop: the target posture, the current motion. */
#include "src/link/session/session.h"
#include "src/link/thread/thread.h"

/* True while the robot does something that has to be over before it is sent somewhere. */
static bool is_at_work(grobo_control *control)
{
    return grobo_robot_job(control_robot(control)) != GROBO_JOB_NONE ||
           grobo_robot_is_playing(control_robot(control));
}

static void set_result(grobo_control *control, int result)
{
    grobo_i_control_lock(control);
    control->motion_result = result;
    grobo_i_control_unlock(control);
}

static bool is_up(const grobo_control *control)
{
    return grobo_session_get_state(control->session) == GROBO_SESSION_UP;
}

/* ---- the target --------------------------------------------------------------------------- */

/* On the loop: sends the target when the robot is free for it. */
int grobo_i_control_send_target(grobo_control *control, void *arg)
{
    grobo_posture target;
    bool wanted;
    int r;

    (void)arg;
    grobo_i_control_lock(control);
    wanted = control->move_wanted;
    target = control->target;
    grobo_i_control_unlock(control);
    if (!wanted) {
        return GROBO_OK;
    }
    if (is_up(control) && is_at_work(control)) {
        /* The target before it makes way once it was sent; anything else comes to its end. */
        r = control->move_job != 0
                ? grobo_robot_retarget(grobo_session_robot(control->session), &target)
                : GROBO_ERR_STATE;
        if (r < 0) {
            return CALL_PENDING;
        }
    } else {
        r = is_up(control) ? grobo_robot_move(grobo_session_robot(control->session), &target)
                           : GROBO_ERR_UNPLUGGED;
    }
    if (r > 0) {
        control->move_job = r;
    }
    grobo_i_control_lock(control);
    control->move_wanted = false;
    control->motion_result = r < 0 ? r : control->motion_result;
    grobo_i_control_unlock(control);
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
    control->play_job = 0;
    grobo_i_control_release_clip(control);
    grobo_i_control_lock(control);
    control->play = PLAY_NONE;
    control->motion_result = result;
    grobo_i_control_unlock(control);
}

static int begin_play(grobo_control *control)
{
    grobo_posture start;
    grobo_clip_options options = {.default_us = control->play_options.default_time_us};
    int r;

    /* By keys the sequencer counts a motion of increments from where the robot is then. */
    if (control->play_options.mode == GROBO_PLAY_RATE &&
        grobo_robot_posture(control_robot(control), GROBO_NEVER_US, &start) > 0) {
        options.start = &start;
    }
    r = grobo_motion_clip(control->playing, &options, &control->clip);
    if (r >= 0) {
        control->play_error = GROBO_OK;
        r = grobo_robot_play(grobo_session_robot(control->session), &control->clip,
                             &control->play_options);
    }
    if (r > 0) {
        control->play_job = r;
    }
    return r;
}

/* On the loop: begins to play when the robot is free for it. */
int grobo_i_control_start_play(grobo_control *control, void *arg)
{
    bool wanted;
    int r;

    (void)arg;
    grobo_i_control_lock(control);
    wanted = control->play == PLAY_WANTED;
    grobo_i_control_unlock(control);
    if (!wanted) {
        return GROBO_OK;
    }
    if (is_up(control) && is_at_work(control)) {
        return CALL_PENDING;
    }
    /* From here on a callback that stops the robot must not free what is played. */
    grobo_i_control_lock(control);
    control->play = PLAY_BEGUN;
    grobo_i_control_unlock(control);
    r = is_up(control) ? begin_play(control) : GROBO_ERR_UNPLUGGED;
    if (r < 0) {
        end_play(control, r);
    }
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
    bool begun;

    grobo_i_control_lock(control);
    begun = control->play == PLAY_BEGUN;
    grobo_i_control_unlock(control);
    if (begun && control->play_job == 0 && !grobo_robot_is_playing(control_robot(control))) {
        end_play(control, control->play_error < 0 ? control->play_error : play_result(control));
    }
}

/* ---- stopping, waiting -------------------------------------------------------------------- */

static bool forget(grobo_control *control, bool move, bool play)
{
    grobo_i_control_lock(control);
    move = move && control->move_wanted;
    play = play && control->play == PLAY_WANTED;
    control->move_wanted = control->move_wanted && !move;
    grobo_i_control_unlock(control);
    if (play) {
        end_play(control, GROBO_ERR_CANCELED);
    } else if (move) {
        set_result(control, GROBO_ERR_CANCELED);
    }
    return move || play;
}

bool grobo_i_control_forget(grobo_control *control)
{
    return forget(control, true, true);
}

/* The counts wrap around. */
static bool is_before(unsigned asked, unsigned obeyed)
{
    return (int)(obeyed - asked) > 0;
}

void grobo_i_control_forget_stopped(grobo_control *control)
{
    unsigned obeyed = control->session->obeyed;
    bool move;
    bool play;

    if (obeyed != control->obeyed) {
        control->obeyed = obeyed;
        grobo_i_control_lock(control);
        move = is_before(control->move_after, obeyed);
        play = is_before(control->play_after, obeyed);
        grobo_i_control_unlock(control);
        (void)forget(control, move, play);
    }
}
