/* SPDX-License-Identifier: MIT */
/* What a control has sent: the target posture, the current motion. */
#include "src/link/session_i.h"
#include "src/link/thread_i.h"

static grobo_robot *robot_of(grobo_control *control)
{
    return grobo_session_robot(control->session);
}

/* True while the robot does something that has to be over before it is sent somewhere. */
static bool is_at_work(grobo_control *control)
{
    return grobo_robot_job(robot_of(control)) != GROBO_JOB_NONE ||
           grobo_robot_is_playing(robot_of(control));
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
static int send_target(grobo_control *control, void *arg)
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
        r = control->move_job != 0 ? grobo_session_retarget(control->session, &target)
                                   : GROBO_ERR_STATE;
        if (r < 0) {
            return CALL_PENDING;
        }
    } else {
        r = is_up(control) ? grobo_session_move(control->session, &target) : GROBO_ERR_UNPLUGGED;
    }
    if (r > 0 && control->last_job != r) {
        control->move_job = r;
    }
    grobo_i_control_lock(control);
    control->move_wanted = false;
    if (r < 0 || control->last_job == r) {
        control->motion_result = r < 0 ? r : control->last_result;
    }
    grobo_i_control_unlock(control);
    return GROBO_OK;
}

int grobo_i_control_want_move(grobo_control *control)
{
    int r = GROBO_OK;

    if (!control->up) {
        return GROBO_ERR_CLOSED;
    }
    if (control->target.set == 0) {
        return GROBO_ERR_EMPTY;
    }
    if (!control->move_wanted) {
        r = grobo_i_control_post(control, send_target, NULL, false);
        control->move_wanted = r >= 0;
    }
    control->move_after = grobo_i_session_asked(control->session);
    return r;
}

int grobo_control_start_motion(grobo_control *control)
{
    int r;

    grobo_i_control_lock(control);
    r = grobo_i_control_want_move(control);
    grobo_i_control_unlock(control);
    return r;
}

int grobo_control_init_position(grobo_control *control)
{
    int r;

    grobo_i_control_lock(control);
    control->target = control->init;
    r = grobo_i_control_want_move(control);
    grobo_i_control_unlock(control);
    return r;
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
        grobo_robot_posture(robot_of(control), grobo_now_us(), GROBO_NEVER_US, &start) > 0) {
        options.start = &start;
    }
    r = grobo_motion_clip(control->playing, &options, &control->clip);
    if (r >= 0) {
        control->play_error = GROBO_OK;
        r = grobo_session_play(control->session, &control->clip, &control->play_options);
    }
    if (r > 0 && control->last_job == r) {
        control->play_error = control->last_result;
    } else if (r > 0) {
        control->play_job = r;
    }
    return r;
}

/* On the loop: begins to play when the robot is free for it. */
static int start_play(grobo_control *control, void *arg)
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

    grobo_robot_progress(robot_of(control), grobo_now_us(), &progress);
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
    if (begun && control->play_job == 0 && !grobo_robot_is_playing(robot_of(control))) {
        end_play(control, control->play_error < 0 ? control->play_error : play_result(control));
    }
}

/* With the lock: a copy of the motion, to be played. */
static int want_play(grobo_control *control, const grobo_play_options *options)
{
    static const grobo_play_options defaults;
    grobo_play_options wanted = options != NULL ? *options : defaults;
    int r;

    if (!control->up) {
        return GROBO_ERR_CLOSED;
    }
    if (grobo_motion_size(control->motion) == 0) {
        return GROBO_ERR_EMPTY;
    }
    if (control->play != PLAY_NONE) {
        return GROBO_ERR_STATE;
    }
    wanted.repeat = control->motion_count;
    wanted.reverse = control->reverse;
    wanted.default_time_us = grobo_i_control_default_us(control);
    r = grobo_motion_dup(control->motion, &control->playing);
    if (r >= 0) {
        r = grobo_i_control_post(control, start_play, NULL, false);
        if (r < 0) {
            grobo_motion_free(control->playing);
            control->playing = NULL;
        }
    }
    if (r >= 0) {
        control->play_options = wanted;
        control->play = PLAY_WANTED;
        control->play_after = grobo_i_session_asked(control->session);
    }
    return r;
}

int grobo_control_play_motion(grobo_control *control, const grobo_play_options *options)
{
    int r;

    grobo_i_control_lock(control);
    r = want_play(control, options);
    grobo_i_control_unlock(control);
    return r;
}

bool grobo_control_is_playing(grobo_control *control)
{
    bool playing;

    grobo_i_control_lock(control);
    playing = control->play != PLAY_NONE;
    grobo_i_control_unlock(control);
    return playing;
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

static int stop_motion(grobo_control *control, void *arg)
{
    const bool *at_once = arg;
    bool stopped = grobo_i_control_forget(control);

    stopped = grobo_session_stop(control->session, *at_once) >= 0 || stopped;
    return stopped ? GROBO_OK : GROBO_ERR_STATE;
}

int grobo_control_stop_motion(grobo_control *control, bool at_once)
{
    int r = grobo_i_control_urgent_call(control, stop_motion, &at_once);

    if (r == GROBO_ERR_TIMEOUT || r == GROBO_ERR_FULL) {
        (void)grobo_control_post_stop(control, at_once); /* nobody waits, the stop stands */
    }
    return r;
}

int grobo_control_post_stop(grobo_control *control, bool at_once)
{
    return control != NULL ? grobo_session_post_stop(control->session, at_once) : GROBO_ERR_ARG;
}

/* Frames of the present pass and of those after it. */
static uint64_t frames_left(grobo_control *control)
{
    grobo_play_progress progress;

    grobo_robot_progress(robot_of(control), grobo_now_us(), &progress);
    if (progress.steps > INT_MAX) {
        return INT_MAX;
    }
    return progress.steps - progress.step +
           progress.steps * (uint64_t)(progress.passes - progress.pass);
}

static int count_commands(grobo_control *control, void *arg)
{
    bool sequencing = grobo_robot_is_playing(robot_of(control));
    uint64_t count = sequencing ? frames_left(control) : 0;

    (void)arg;
    grobo_i_control_lock(control);
    count += control->move_wanted;
    if (control->play == PLAY_WANTED || (control->play_job != 0 && !sequencing)) {
        /* it waits, or is being prepared */
        count += grobo_motion_size(control->playing) *
                 (uint64_t)grobo_play_passes(control->play_options.repeat);
    }
    grobo_i_control_unlock(control);
    return count < INT_MAX ? (int)count : INT_MAX;
}

int grobo_control_command_count(grobo_control *control)
{
    return grobo_i_control_call(control, count_commands, NULL);
}

static int is_moving(grobo_control *control, void *arg)
{
    bool wanted;

    (void)arg;
    grobo_i_control_lock(control);
    wanted = control->move_wanted || control->play != PLAY_NONE;
    grobo_i_control_unlock(control);
    return wanted || control->move_job != 0 ||
           grobo_robot_moving(robot_of(control), grobo_now_us());
}

int grobo_control_is_moving(grobo_control *control)
{
    return grobo_i_control_call(control, is_moving, NULL);
}

static int await_rest(grobo_control *control, void *arg)
{
    int result;

    if (is_moving(control, arg) || grobo_robot_settling(robot_of(control)) ||
        grobo_robot_job(robot_of(control)) != GROBO_JOB_NONE) {
        return CALL_PENDING;
    }
    grobo_i_control_lock(control);
    result = control->motion_result;
    grobo_i_control_unlock(control);
    return result;
}

int grobo_control_wait(grobo_control *control, int64_t timeout_us)
{
    return grobo_i_control_wait(control, await_rest, NULL, timeout_us);
}
