/* SPDX-License-Identifier: MIT */
/* A runner's facts, settings and postures. */
#include <string.h>

#include "src/link/runner/runner.h"

/* Shortest default time: a unit of what the servos take. */
#define TIME_MIN_US GROBO_PLAY_TIME_UNIT_US

/* How often the engine reads where nothing else is configured (robot.h). */
#define SENSE_US INT64_C(1000000)

const char *grobo_runner_name(const grobo_runner *runner)
{
    return runner == NULL ? NULL : runner->name;
}

int grobo_runner_joints(const grobo_runner *runner)
{
    return runner == NULL ? GROBO_ERR_ARG : runner->driver->model->n_joints;
}

/* ---- settings ----------------------------------------------------------------------------- */

int grobo_runner_set_motion_dir(grobo_runner *runner, const char *dir)
{
    if (runner == NULL || dir == NULL) {
        return GROBO_ERR_ARG;
    }
    if (strlen(dir) >= sizeof runner->motion_dir) {
        return GROBO_ERR_CAP;
    }
    grobo_i_runner_lock(runner);
    memcpy(runner->motion_dir, dir, strlen(dir) + 1);
    grobo_i_runner_unlock(runner);
    return GROBO_OK;
}

int grobo_runner_get_motion_dir(grobo_runner *runner, char *dir, size_t dir_bytes)
{
    if (runner == NULL || dir == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_runner_lock(runner);
    size_t length = strlen(runner->motion_dir);
    if (length < dir_bytes) {
        memcpy(dir, runner->motion_dir, length + 1);
    }
    grobo_i_runner_unlock(runner);
    return length < dir_bytes ? (int)length : GROBO_ERR_SPACE;
}

/* Gives the engine a configuration, and keeps it when it was taken. */
static int configure(void *arg, grobo_runner *runner)
{
    const grobo_robot_config *change = arg;
    grobo_robot_config config;

    grobo_i_runner_copy(runner, &config, &runner->robot_config, sizeof config);
    if (change->default_time_us != 0) {
        config.default_time_us = change->default_time_us;
    }
    if (change->sense_interval_us != 0) {
        config.sense_interval_us = change->sense_interval_us;
    }
    int r = grobo_session_configure(runner->session, &config);
    if (r >= 0) {
        grobo_i_runner_copy(runner, &runner->robot_config, &config, sizeof config);
    }
    return r;
}

int grobo_runner_set_default_time_us(grobo_runner *runner, int64_t time_us)
{
    grobo_robot_config change = {GROBO_ROBOT_CONFIG_INIT, .default_time_us = time_us};

    return time_us < TIME_MIN_US || time_us > GROBO_PLAY_TIME_MAX_US
               ? GROBO_ERR_ARG
               : grobo_i_runner_call(runner, configure, &change);
}

int64_t grobo_i_runner_default_us(const grobo_runner *runner)
{
    int64_t time_us = runner->robot_config.default_time_us;

    return time_us != 0 ? time_us : GROBO_POSTURE_TIME_US;
}

int64_t grobo_runner_get_default_time_us(grobo_runner *runner)
{
    RETURN_LOCKED(runner, int64_t, 0, grobo_i_runner_default_us(runner));
}

int grobo_runner_set_sense_interval_us(grobo_runner *runner, int64_t interval_us)
{
    grobo_robot_config change = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = interval_us};

    return interval_us <= 0 && interval_us != GROBO_SENSE_NEVER
               ? GROBO_ERR_ARG
               : grobo_i_runner_call(runner, configure, &change);
}

/* With the lock. */
static int64_t sense_interval_us(const grobo_runner *runner)
{
    int64_t interval_us = runner->robot_config.sense_interval_us;

    return interval_us != 0 ? interval_us : SENSE_US;
}

int64_t grobo_runner_get_sense_interval_us(grobo_runner *runner)
{
    RETURN_LOCKED(runner, int64_t, 0, sense_interval_us(runner));
}

int grobo_runner_set_motion_count(grobo_runner *runner, int count)
{
    if (runner == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_runner_copy(runner, &runner->motion_count, &count, sizeof count);
    return GROBO_OK;
}

void grobo_runner_set_reverse(grobo_runner *runner, bool reverse)
{
    if (runner != NULL) {
        grobo_i_runner_copy(runner, &runner->reverse, &reverse, sizeof reverse);
    }
}

bool grobo_runner_is_reverse(grobo_runner *runner)
{
    RETURN_LOCKED(runner, bool, false, runner->reverse || runner->motion_count < 0);
}

/* ---- postures ----------------------------------------------------------------------------- */

/* With the lock: may this be a target? */
static int check_posture(const grobo_runner *runner, const grobo_posture *posture)
{
    int r = grobo_posture_check(posture, runner->driver->model, NULL);

    if (r == GROBO_ERR_LIMIT && runner->robot_config.limit_policy == GROBO_LIMIT_CLAMP) {
        r = GROBO_OK; /* the engine will clamp it */
    }
    if (r >= 0 && (posture->time_us < 0 || posture->time_us > GROBO_PLAY_TIME_MAX_US)) {
        r = GROBO_ERR_ARG;
    }
    return r;
}

/* With the lock. */
static int set_posture(const grobo_runner *runner, grobo_posture *to, const grobo_posture *posture)
{
    int r = check_posture(runner, posture);

    if (r >= 0) {
        *to = *posture;
    }
    return r;
}

int grobo_runner_set_init_posture(grobo_runner *runner, const grobo_posture *posture)
{
    RETURN_LOCKED(runner, int, GROBO_ERR_ARG, set_posture(runner, &runner->init, posture));
}

void grobo_runner_get_init_posture(grobo_runner *runner, grobo_posture *posture)
{
    if (runner != NULL && posture != NULL) {
        grobo_i_runner_copy(runner, posture, &runner->init, sizeof *posture);
    }
}

int grobo_runner_set_target_posture(grobo_runner *runner, const grobo_posture *posture)
{
    RETURN_LOCKED(runner, int, GROBO_ERR_ARG, set_posture(runner, &runner->target, posture));
}

void grobo_runner_get_target_posture(grobo_runner *runner, grobo_posture *posture)
{
    if (runner != NULL && posture != NULL) {
        grobo_i_runner_copy(runner, posture, &runner->target, sizeof *posture);
    }
}

/* With the lock. */
static int set_joint(grobo_runner *runner, int joint, double angle_rad)
{
    grobo_posture changed = runner->target;
    int r = grobo_posture_set_rad(&changed, joint, angle_rad);

    return r < 0 ? r : set_posture(runner, &runner->target, &changed);
}

int grobo_runner_set_joint(grobo_runner *runner, int joint, double angle_rad)
{
    RETURN_LOCKED(runner, int, GROBO_ERR_ARG, set_joint(runner, joint, angle_rad));
}

int grobo_runner_set_motion_time_us(grobo_runner *runner, int64_t time_us)
{
    if (runner == NULL || time_us < 0 || time_us > GROBO_PLAY_TIME_MAX_US) {
        return GROBO_ERR_ARG;
    }
    grobo_i_runner_copy(runner, &runner->target.time_us, &time_us, sizeof time_us);
    return GROBO_OK;
}
