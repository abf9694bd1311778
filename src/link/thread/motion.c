/* SPDX-License-Identifier: MIT */
/* A control's target and current motion: sent and played, its postures, its files. */
#include <stdio.h>
#include <string.h>

#include "src/base/sized.h"
#include "src/link/session/session.h"
#include "src/link/thread/thread.h"
#include "src/motion/store/container.h"

/* ---- the whole ---------------------------------------------------------------------------- */

/* Increments count from where the robot is; joints that are not known, from the initial posture. */
static int resolve(grobo_control *control, grobo_motion *motion)
{
    grobo_posture start, sensed;

    if (grobo_motion_get_kind(motion) != GROBO_MOTION_STEPS) {
        return GROBO_OK;
    }
    grobo_posture_init_pose(&start, control->driver->model);
    if (grobo_control_get_current_posture(control, &sensed) > 0) {
        for (int j = 0; j < start.n_joints; j++) {
            if ((sensed.set & GROBO_JOINT_BIT(j)) != 0) {
                start.angle_rad[j] = sensed.angle_rad[j];
            }
        }
    }
    return grobo_motion_resolve(motion, &start);
}

/* Makes a motion the current one; it belongs to the control then, or is freed. */
static int adopt(grobo_control *control, grobo_motion *motion)
{
    int n_joints = control->driver->model->n_joints;
    int r = grobo_motion_is_for(motion, control->driver->model)
                ? grobo_motion_set_joints(motion, n_joints)
                : GROBO_ERR_ARG;

    if (r >= 0) {
        r = resolve(control, motion);
    }
    if (r < 0) {
        grobo_motion_free(motion);
        return r;
    }
    r = (int)grobo_motion_size(motion);
    grobo_i_control_lock(control);
    grobo_motion *old = control->motion;
    control->motion = motion;
    grobo_i_control_unlock(control);
    grobo_motion_free(old);
    return r;
}

int grobo_control_set_motion(grobo_control *control, const grobo_motion *motion)
{
    if (control == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_motion *copy;
    int r = grobo_motion_dup(motion, &copy);

    return r < 0 ? r : adopt(control, copy);
}

int grobo_control_get_motion(grobo_control *control, grobo_motion **motion)
{
    if (control == NULL || motion == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_control_lock(control);
    int r = grobo_motion_dup(control->motion, motion);
    grobo_i_control_unlock(control);
    return r < 0 ? r : (int)grobo_motion_size(*motion);
}

void grobo_control_clear_motion(grobo_control *control)
{
    if (control != NULL) {
        grobo_i_control_lock(control);
        grobo_motion_renew(control->motion, GROBO_MOTION_POSTURES);
        grobo_i_control_unlock(control);
    }
}

/* ---- sent and played ---------------------------------------------------------------------- */

/* Sends the target, which may have been replaced before: by `instead`. */
static int send_target(grobo_control *control, const grobo_posture *instead)
{
    grobo_i_control_lock(control);
    control->target = instead != NULL ? *instead : control->target;
    grobo_posture target = control->target;
    bool up = control->up;
    grobo_i_control_unlock(control);
    if (!up) {
        return GROBO_ERR_CLOSED;
    }
    return target.set == 0 ? GROBO_ERR_EMPTY : grobo_i_control_move(control, &target);
}

int grobo_control_start_motion(grobo_control *control)
{
    return control == NULL ? GROBO_ERR_ARG : send_target(control, NULL);
}

int grobo_control_init_position(grobo_control *control)
{
    grobo_posture init;

    if (control == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_control_get_init_posture(control, &init);
    return send_target(control, &init);
}

/* With the lock: a copy of the motion, and how it shall be played. */
static int prepare_play(grobo_control *control, grobo_play_options *options)
{
    if (!control->up) {
        return GROBO_ERR_CLOSED;
    }
    if (grobo_motion_size(control->motion) == 0) {
        return GROBO_ERR_EMPTY;
    }
    if (control->play != PLAY_NONE) {
        return GROBO_ERR_STATE;
    }
    options->repeat = control->motion_count;
    options->reverse = control->reverse;
    options->default_time_us = grobo_i_control_default_us(control);
    int r = grobo_motion_dup(control->motion, &control->playing);
    if (r >= 0) {
        control->play = PLAY_ASKED;
        control->play_error = GROBO_OK;
        control->play_postures =
            grobo_motion_size(control->playing) * (uint64_t)grobo_play_passes(options->repeat);
    }
    return r;
}

int grobo_control_play_motion(grobo_control *control, const grobo_play_options *options)
{
    grobo_play_options wanted;

    if (control == NULL || grobo_i_sized_take(&wanted, sizeof wanted, options) < 0) {
        return GROBO_ERR_ARG;
    }
    grobo_i_control_lock(control);
    int r = prepare_play(control, &wanted);
    grobo_i_control_unlock(control);
    return r < 0 ? r : grobo_i_control_play(control, &wanted);
}

bool grobo_control_is_playing(grobo_control *control)
{
    RETURN_LOCKED(control, bool, false, control->play != PLAY_NONE);
}

/* ---- stopping, waiting -------------------------------------------------------------------- */

int grobo_control_post_stop(grobo_control *control, bool at_once)
{
    return control != NULL ? grobo_session_post_stop(control->session, at_once) : GROBO_ERR_ARG;
}

/* Frames of the present pass and of those after it. */
static uint64_t frames_left(grobo_control *control)
{
    grobo_play_progress progress;

    grobo_robot_progress(control_robot(control), &progress);
    if (progress.steps > INT_MAX) {
        return INT_MAX;
    }
    return progress.steps - progress.step +
           progress.steps * (uint64_t)(progress.passes - progress.pass);
}

int grobo_control_command_count(grobo_control *control)
{
    if (control == NULL) {
        return GROBO_ERR_ARG;
    }
    bool sequencing = grobo_robot_is_playing(control_robot(control));
    uint64_t count = sequencing ? frames_left(control) : 0;

    grobo_i_control_lock(control);
    count += control->move_job != 0;
    count += !sequencing && control->play_job != 0 ? control->play_postures : 0;
    grobo_i_control_unlock(control);
    return count < INT_MAX ? (int)count : INT_MAX;
}

int grobo_control_is_moving(grobo_control *control)
{
    if (control == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_control_lock(control);
    bool asked = control->play != PLAY_NONE || control->move_job != 0;
    grobo_i_control_unlock(control);
    return asked || grobo_robot_moving(control_robot(control));
}

static int await_rest(void *arg, grobo_control *control)
{
    (void)arg;
    if (grobo_control_is_moving(control) || grobo_robot_settling(control_robot(control)) ||
        grobo_robot_job(control_robot(control)) != GROBO_JOB_NONE) {
        return CALL_PENDING;
    }
    RETURN_LOCKED(control, int, GROBO_ERR_ARG, control->motion_result);
}

int grobo_control_wait(grobo_control *control, int64_t timeout_us)
{
    return grobo_i_control_wait(control, await_rest, NULL, timeout_us);
}

/* ---- its postures ------------------------------------------------------------------------- */

static int append(grobo_control *control, grobo_posture *sensed, int64_t time_us)
{
    int r = grobo_control_get_current_posture(control, sensed);

    if (r <= 0) {
        return r < 0 ? r : GROBO_ERR_STALE;
    }
    sensed->time_us = time_us;
    grobo_i_control_lock(control);
    r = grobo_i_record(control->motion, sensed);
    if (r >= 0) {
        r = (int)grobo_motion_size(control->motion);
    }
    grobo_i_control_unlock(control);
    return r;
}

int grobo_control_append_current_posture(grobo_control *control)
{
    grobo_posture sensed;
    int64_t time_us = grobo_control_get_default_time_us(control);

    /* A step that long cannot be told from "the default time", which 0 means as well. */
    return append(control, &sensed, time_us < GROBO_MOTION_STEP_MAX_US ? time_us : 0);
}

int grobo_control_append_current_posture_us(grobo_control *control, int64_t time_us)
{
    grobo_posture sensed;

    return time_us < 0 ? GROBO_ERR_ARG : append(control, &sensed, time_us);
}

/* With the lock: posture n in playing direction. */
static int get_nth(const grobo_control *control, size_t n, grobo_posture *posture)
{
    size_t size = grobo_motion_size(control->motion);
    bool reverse = control->reverse || control->motion_count < 0;

    if (posture == NULL || n >= size) {
        return posture == NULL ? GROBO_ERR_ARG : GROBO_ERR_EMPTY;
    }
    return grobo_motion_get(control->motion, reverse ? size - 1 - n : n, posture);
}

int grobo_control_get_nth_posture(grobo_control *control, size_t n, grobo_posture *posture)
{
    RETURN_LOCKED(control, int, GROBO_ERR_ARG, get_nth(control, n, posture));
}

int grobo_control_get_first_posture(grobo_control *control, grobo_posture *posture)
{
    return grobo_control_get_nth_posture(control, 0, posture);
}

int grobo_control_get_last_posture(grobo_control *control, grobo_posture *posture)
{
    /* Of an empty motion the number wraps around, to one that is not there. */
    RETURN_LOCKED(control, int, GROBO_ERR_ARG,
                  get_nth(control, grobo_motion_size(control->motion) - 1, posture));
}

int grobo_control_do_nth_motion(grobo_control *control, size_t n)
{
    grobo_posture posture;
    int r = grobo_control_get_nth_posture(control, n, &posture);

    if (r >= 0) {
        posture.time_us = 0; /* the default */
        r = grobo_control_set_target_posture(control, &posture);
    }
    return r < 0 ? r : send_target(control, &posture);
}

/* ---- reading files ------------------------------------------------------------------------ */

/* NAME, or NAME and the extension of a format where it has none. */
static int with_extension(grobo_motion_format format, const char *name, char *to, size_t bytes)
{
    bool has =
        format == GROBO_FORMAT_AUTO || grobo_motion_format_of_path(name) != GROBO_FORMAT_AUTO;
    int length = snprintf(to, bytes, "%s%s%s", name, has ? "" : ".",
                          has ? "" : grobo_motion_format_name(format));

    return length < 0 || (size_t)length >= bytes ? GROBO_ERR_SPACE : GROBO_OK;
}

static int find(grobo_control *control, const char *name, char *path, size_t path_bytes)
{
    char dir[GROBO_PATH_MAX_BYTES];
    int r = grobo_control_get_motion_dir(control, dir, sizeof dir);

    return r < 0 ? r : grobo_motion_find(grobo_files_os(), dir, name, path, path_bytes);
}

int grobo_control_load_motion_format(grobo_control *control, grobo_motion_format format,
                                     const char *name, grobo_diagnostics *list)
{
    if (control == NULL) {
        return GROBO_ERR_ARG;
    }
    char path[GROBO_PATH_MAX_BYTES];
    char file[GROBO_PATH_MAX_BYTES];
    const grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .format = format,
                                        .model = control->driver->model, .mem = control->mem};
    grobo_motion *motion = NULL;
    int r = GROBO_ERR_ARG;

    if (name != NULL) {
        r = with_extension(format, name, file, sizeof file);
    }
    if (r >= 0) {
        r = find(control, file, path, sizeof path);
    }
    if (r >= 0) {
        r = grobo_motion_read_file(path, &options, list, &motion);
    }
    if (r >= 0) {
        r = adopt(control, motion);
    }
    if (r < 0) {
        grobo_control_clear_motion(control);
    }
    return r;
}

int grobo_control_load_motion(grobo_control *control, const char *name, grobo_diagnostics *list)
{
    return grobo_control_load_motion_format(control, GROBO_FORMAT_AUTO, name, list);
}

/* ---- writing files ------------------------------------------------------------------------ */

/* Where a motion is saved: a plain name, so that it stays in the folder. */
static int path_of(grobo_control *control, grobo_motion_format format, const char *name, char *path,
                   size_t path_bytes)
{
    char file[GROBO_PATH_MAX_BYTES];
    char dir[GROBO_PATH_MAX_BYTES];
    int length;
    int r = with_extension(format, name, file, sizeof file);

    if (name[0] == '\0' || strpbrk(name, "/\\:") != NULL || strcmp(name, "..") == 0 ||
        strcmp(name, ".") == 0) {
        return name[0] == '\0' ? GROBO_ERR_ARG : GROBO_ERR_PERM;
    }
    if (r >= 0) {
        r = grobo_control_get_motion_dir(control, dir, sizeof dir);
    }
    if (r < 0) {
        return r;
    }
    length = snprintf(path, path_bytes, "%s/%s", dir, file);
    return length < 0 || (size_t)length >= path_bytes ? GROBO_ERR_SPACE : GROBO_OK;
}

static int save_next(grobo_control *control, const grobo_motion *motion,
                     const grobo_write_options *options, char *path, size_t path_bytes)
{
    char dir[GROBO_PATH_MAX_BYTES];
    int r = grobo_control_get_motion_dir(control, dir, sizeof dir);

    return r < 0 ? r
                 : grobo_motion_save_next(motion, grobo_files_os(), dir, options, path, path_bytes);
}

int grobo_control_save_motion(grobo_control *control, grobo_motion_format format, const char *name,
                              char *path, size_t path_bytes)
{
    if (control == NULL) {
        return GROBO_ERR_ARG;
    }
    char used[GROBO_PATH_MAX_BYTES];
    const grobo_write_options options = {
        GROBO_WRITE_OPTIONS_INIT,
        .format = format,
        .model = control->driver->model,
        .default_us = grobo_control_get_default_time_us(control),
    };
    size_t room = path != NULL && path_bytes < sizeof used ? path_bytes : sizeof used;
    grobo_motion *motion = NULL;
    int r = GROBO_ERR_ARG;

    if (name != NULL) {
        r = path_of(control, format, name, used, sizeof used);
    } else if (format == GROBO_FORMAT_M) {
        r = GROBO_OK;
    }
    if (r >= 0) {
        r = grobo_control_get_motion(control, &motion);
    }
    if (r >= 0 && name != NULL) {
        r = strlen(used) < room ? grobo_motion_save(motion, grobo_files_os(), used, &options, NULL)
                                : GROBO_ERR_SPACE;
    } else if (r >= 0) {
        r = save_next(control, motion, &options, used, room);
    }
    if (r >= 0 && path != NULL) {
        memcpy(path, used, strlen(used) + 1);
    }
    if (r >= 0) {
        r = (int)grobo_motion_size(motion);
    }
    grobo_motion_free(motion);
    return r;
}
