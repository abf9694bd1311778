/* SPDX-License-Identifier: MIT */
/* A runner's target and current motion: sent and played, its postures, its files. */
#include <grobo/core/robot.h>

#include "src/base/sized.h"
#include "src/link/runner/runner.h"
#include "src/link/session/session.h"
#include "src/motion/store/container.h"

/* ---- the whole ---------------------------------------------------------------------------- */

/* Increments count from where the robot is; joints that are not known, from the initial posture. */
static int resolve(grobo_runner *runner, grobo_motion *motion)
{
    grobo_posture start, sensed;

    if (grobo_motion_get_kind(motion) != GROBO_MOTION_STEPS) {
        return GROBO_OK;
    }
    grobo_posture_init_pose(&start, runner->driver->model);
    if (grobo_runner_get_current_posture(runner, &sensed) > 0) {
        for (int j = 0; j < start.n_joints; j++) {
            if ((sensed.set & GROBO_JOINT_BIT(j)) != 0) {
                start.angle_rad[j] = sensed.angle_rad[j];
            }
        }
    }
    return grobo_motion_resolve(motion, &start);
}

/* Makes a motion the current one; it belongs to the runner then, or is freed. */
static int adopt(grobo_runner *runner, grobo_motion *motion)
{
    int n_joints = runner->driver->model->n_joints;
    int r = grobo_motion_is_for(motion, runner->driver->model)
                ? grobo_motion_set_joints(motion, n_joints)
                : GROBO_ERR_ARG;

    if (r >= 0) {
        r = resolve(runner, motion);
    }
    if (r < 0) {
        grobo_motion_free(motion);
        return r;
    }
    r = (int)grobo_motion_size(motion);
    grobo_i_runner_lock(runner);
    grobo_motion *old = runner->motion;
    runner->motion = motion;
    grobo_i_runner_unlock(runner);
    grobo_motion_free(old);
    return r;
}

int grobo_runner_set_motion(grobo_runner *runner, const grobo_motion *motion)
{
    if (runner == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_motion *copy;
    int r = grobo_motion_dup(motion, &copy);

    return r < 0 ? r : adopt(runner, copy);
}

int grobo_runner_get_motion(grobo_runner *runner, grobo_motion **motion)
{
    if (runner == NULL || motion == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_runner_lock(runner);
    int r = grobo_motion_dup(runner->motion, motion);
    grobo_i_runner_unlock(runner);
    return r < 0 ? r : (int)grobo_motion_size(*motion);
}

void grobo_runner_clear_motion(grobo_runner *runner)
{
    if (runner != NULL) {
        grobo_i_runner_lock(runner);
        grobo_motion_renew(runner->motion, GROBO_MOTION_POSTURES);
        grobo_i_runner_unlock(runner);
    }
}

/* ---- sent and played ---------------------------------------------------------------------- */

/* Sends the target, which may have been replaced before: by `instead`. */
static int send_target(grobo_runner *runner, const grobo_posture *instead)
{
    grobo_i_runner_lock(runner);
    runner->target = instead != NULL ? *instead : runner->target;
    grobo_posture target = runner->target;
    bool up = runner->up;
    grobo_i_runner_unlock(runner);
    if (!up) {
        return GROBO_ERR_CLOSED;
    }
    return target.set == 0 ? GROBO_ERR_EMPTY : grobo_i_runner_move(runner, &target);
}

int grobo_runner_start_motion(grobo_runner *runner)
{
    return runner == NULL ? GROBO_ERR_ARG : send_target(runner, NULL);
}

int grobo_runner_init_position(grobo_runner *runner)
{
    grobo_posture init;

    if (runner == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_runner_get_init_posture(runner, &init);
    return send_target(runner, &init);
}

/* With the lock: a copy of the motion, and how it shall be played. */
static int prepare_play(grobo_runner *runner, grobo_play_options *options)
{
    if (!runner->up) {
        return GROBO_ERR_CLOSED;
    }
    if (grobo_motion_size(runner->motion) == 0) {
        return GROBO_ERR_EMPTY;
    }
    if (runner->play != PLAY_NONE) {
        return GROBO_ERR_STATE;
    }
    options->repeat = runner->motion_count;
    options->reverse = runner->reverse;
    options->default_time_us = grobo_i_runner_default_us(runner);
    int r = grobo_motion_dup(runner->motion, &runner->playing);
    if (r >= 0) {
        runner->play = PLAY_ASKED;
        runner->play_error = GROBO_OK;
        runner->play_postures =
            grobo_motion_size(runner->playing) * (uint64_t)grobo_play_passes(options->repeat);
    }
    return r;
}

int grobo_runner_play_motion(grobo_runner *runner, const grobo_play_options *options)
{
    grobo_play_options wanted;

    if (runner == NULL || grobo_i_sized_take(&wanted, sizeof wanted, options) < 0) {
        return GROBO_ERR_ARG;
    }
    grobo_i_runner_lock(runner);
    int r = prepare_play(runner, &wanted);
    grobo_i_runner_unlock(runner);
    return r < 0 ? r : grobo_i_runner_play(runner, &wanted);
}

bool grobo_runner_is_playing(grobo_runner *runner)
{
    RETURN_LOCKED(runner, bool, false, runner->play != PLAY_NONE);
}

/* ---- stopping, waiting -------------------------------------------------------------------- */

int grobo_runner_post_stop(grobo_runner *runner, bool at_once)
{
    return runner != NULL ? grobo_session_post_stop(runner->session, at_once) : GROBO_ERR_ARG;
}

/* Frames of the present pass and of those after it. */
static uint64_t frames_left(grobo_runner *runner)
{
    grobo_play_progress progress;

    grobo_robot_progress(runner_robot(runner), &progress);
    if (progress.steps > INT_MAX) {
        return INT_MAX;
    }
    return progress.steps - progress.step +
           progress.steps * (uint64_t)(progress.passes - progress.pass);
}

int grobo_runner_command_count(grobo_runner *runner)
{
    if (runner == NULL) {
        return GROBO_ERR_ARG;
    }
    bool sequencing = grobo_robot_is_playing(runner_robot(runner));
    uint64_t count = sequencing ? frames_left(runner) : 0;

    grobo_i_runner_lock(runner);
    count += runner->move_job != 0;
    count += !sequencing && runner->play_job != 0 ? runner->play_postures : 0;
    grobo_i_runner_unlock(runner);
    return count < INT_MAX ? (int)count : INT_MAX;
}

int grobo_runner_is_moving(grobo_runner *runner)
{
    if (runner == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_runner_lock(runner);
    bool asked = runner->play != PLAY_NONE || runner->move_job != 0;
    grobo_i_runner_unlock(runner);
    return asked || grobo_robot_moving(runner_robot(runner));
}

static int await_rest(void *arg, grobo_runner *runner)
{
    bool *at_rest = arg;

    if (grobo_runner_is_moving(runner) || grobo_robot_settling(runner_robot(runner)) ||
        grobo_robot_job(runner_robot(runner)) != GROBO_JOB_NONE) {
        return CALL_PENDING;
    }
    *at_rest = true;
    RETURN_LOCKED(runner, int, GROBO_ERR_ARG, runner->motion_result);
}

int grobo_runner_wait(grobo_runner *runner, int64_t timeout_us)
{
    bool at_rest = false;
    int r = grobo_i_runner_wait(runner, await_rest, &at_rest, timeout_us);

    return r == GROBO_ERR_TIMEOUT && !at_rest ? GROBO_ERR_PENDING : r;
}

/* ---- reading files ------------------------------------------------------------------------ */

static int find(grobo_runner *runner, const char *name, char *path, size_t path_bytes)
{
    char dir[GROBO_PATH_MAX_BYTES];
    int r = grobo_runner_get_motion_dir(runner, dir, sizeof dir);

    return r < 0 ? r : grobo_motion_find(grobo_files_os(), dir, name, path, path_bytes);
}

int grobo_runner_load_motion(grobo_runner *runner, const char *name, grobo_diagnostics *list)
{
    if (runner == NULL) {
        return GROBO_ERR_ARG;
    }
    char path[GROBO_PATH_MAX_BYTES];
    const grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .model = runner->driver->model,
                                        .mem = runner->mem};
    grobo_motion *motion = NULL;
    int r = name != NULL ? find(runner, name, path, sizeof path) : GROBO_ERR_ARG;

    if (r >= 0) {
        r = grobo_motion_read_file(path, &options, list, &motion);
    }
    if (r >= 0) {
        r = adopt(runner, motion);
    }
    if (r < 0) {
        grobo_runner_clear_motion(runner);
    }
    return r;
}
