/* SPDX-License-Identifier: MIT */
/* A runner's current motion: played, waited for, read of files. */
#include <grobo/core/robot.h>

#include "src/base/sized.h"
#include "src/link/runner/runner.h"
#include "src/link/session/session.h"
#include "src/motion/store/container.h"
#include "src/robot/query.h"

/* ---- the whole ---------------------------------------------------------------------------- */

/* Increments count from where the robot is; joints that are not known, from the initial posture. */
static int resolve(grobo_runner *runner, grobo_motion *motion)
{
    grobo_posture start, sensed;

    if (grobo_motion_get_kind(motion) != GROBO_MOTION_STEPS) {
        return GROBO_OK;
    }
    grobo_posture_init_pose(&start, runner->driver->model);
    if (grobo_robot_posture(runner_robot(runner), GROBO_NEVER_US, &sensed) > 0) {
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

/* ---- played ------------------------------------------------------------------------------ */

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
    if (options->default_time_us == 0) {
        options->default_time_us = grobo_i_runner_default_us(runner);
    }
    int r = grobo_motion_dup(runner->motion, &runner->playing);
    if (r >= 0) {
        runner->play = PLAY_ASKED;
        runner->play_error = GROBO_OK;
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

/* ---- stopping, waiting -------------------------------------------------------------------- */

int grobo_runner_post_stop(grobo_runner *runner, bool at_once)
{
    return runner != NULL ? grobo_session_post_stop(runner->session, at_once) : GROBO_ERR_ARG;
}

/* Whether postures are still to be sent or under way. */
static bool is_moving(grobo_runner *runner)
{
    grobo_i_runner_lock(runner);
    bool asked = runner->play != PLAY_NONE;
    grobo_i_runner_unlock(runner);
    return asked || grobo_robot_moving(runner_robot(runner));
}

/* On the loop: tells what the engine has to tell. A request of another thread may end a move before
 * it wakes the loop. @return true if there was something: what is told may ask for more. */
static bool tell(grobo_runner *runner)
{
    if (!grobo_i_has_to_tell(runner_robot(runner))) {
        return false;
    }
    grobo_i_session_enter(runner->session);
    grobo_robot_step(runner_robot(runner), grobo_i_session_now(runner->session));
    grobo_i_session_leave(runner->session);
    return true;
}

/* How the last move ended is known when that was told. */
static int await_rest(void *arg, grobo_runner *runner)
{
    bool *rests = arg;

    if (is_moving(runner) || grobo_robot_settling(runner_robot(runner)) ||
        grobo_robot_job(runner_robot(runner)) != GROBO_JOB_NONE || tell(runner)) {
        return CALL_PENDING;
    }
    *rests = true;
    RETURN_LOCKED(runner, int, GROBO_ERR_ARG, runner->motion_result);
}

int grobo_runner_wait(grobo_runner *runner, int64_t timeout_us)
{
    bool rests = false;
    int r = grobo_i_runner_wait(runner, await_rest, &rests, timeout_us);

    return r == GROBO_ERR_TIMEOUT && !rests ? GROBO_ERR_PENDING : r;
}

/* ---- reading files ------------------------------------------------------------------------ */

int grobo_runner_load_motion(grobo_runner *runner, const char *name, grobo_diagnostics *list)
{
    if (runner == NULL) {
        return GROBO_ERR_ARG;
    }
    char path[GROBO_PATH_MAX_BYTES];
    const grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .model = runner->driver->model,
                                        .mem = runner->mem};
    grobo_motion *motion = NULL;
    int r = name != NULL
                ? grobo_motion_find(grobo_files_os(), runner->motion_dir, name, path, sizeof path)
                : GROBO_ERR_ARG;

    if (r >= 0) {
        r = grobo_motion_read_file(path, &options, list, &motion);
    }
    if (r >= 0) {
        r = adopt(runner, motion);
    }
    if (r < 0) {
        grobo_i_runner_lock(runner);
        grobo_motion_renew(runner->motion, GROBO_MOTION_POSTURES);
        grobo_i_runner_unlock(runner);
    }
    return r;
}
