/* SPDX-License-Identifier: MIT */
/* A control's facts, settings and postures. */
#include <string.h>

#include "src/link/thread/thread.h"

/* Shortest default time: a unit of what the servos take. */
#define TIME_MIN_US GROBO_PLAY_TIME_UNIT_US

/* How often the engine reads where nothing else is configured (robot.h). */
#define SENSE_US INT64_C(1000000)

const char *grobo_control_name(const grobo_control *control)
{
    return control == NULL ? NULL : control->name;
}

int grobo_control_joints(const grobo_control *control)
{
    return control == NULL ? GROBO_ERR_ARG : control->driver->model->n_joints;
}

/* ---- settings ----------------------------------------------------------------------------- */

int grobo_control_set_motion_dir(grobo_control *control, const char *dir)
{
    if (control == NULL || dir == NULL) {
        return GROBO_ERR_ARG;
    }
    if (strlen(dir) >= sizeof control->motion_dir) {
        return GROBO_ERR_CAP;
    }
    grobo_i_control_lock(control);
    memcpy(control->motion_dir, dir, strlen(dir) + 1);
    grobo_i_control_unlock(control);
    return GROBO_OK;
}

int grobo_control_get_motion_dir(grobo_control *control, char *dir, size_t dir_bytes)
{
    if (control == NULL || dir == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_control_lock(control);
    size_t length = strlen(control->motion_dir);
    if (length < dir_bytes) {
        memcpy(dir, control->motion_dir, length + 1);
    }
    grobo_i_control_unlock(control);
    return length < dir_bytes ? (int)length : GROBO_ERR_SPACE;
}

/* Gives the engine a configuration, and keeps it when it was taken. */
static int configure(void *arg, grobo_control *control)
{
    const grobo_robot_config *change = arg;
    grobo_robot_config config;

    grobo_i_control_copy(control, &config, &control->robot_config, sizeof config);
    if (change->default_time_us != 0) {
        config.default_time_us = change->default_time_us;
    }
    if (change->sense_interval_us != 0) {
        config.sense_interval_us = change->sense_interval_us;
    }
    int r = grobo_session_configure(control->session, &config);
    if (r >= 0) {
        grobo_i_control_copy(control, &control->robot_config, &config, sizeof config);
    }
    return r;
}

int grobo_control_set_default_time_us(grobo_control *control, int64_t time_us)
{
    grobo_robot_config change = {GROBO_ROBOT_CONFIG_INIT, .default_time_us = time_us};

    return time_us < TIME_MIN_US || time_us > GROBO_PLAY_TIME_MAX_US
               ? GROBO_ERR_ARG
               : grobo_i_control_call(control, configure, &change);
}

int64_t grobo_i_control_default_us(const grobo_control *control)
{
    int64_t time_us = control->robot_config.default_time_us;

    return time_us != 0 ? time_us : GROBO_POSTURE_TIME_US;
}

int64_t grobo_control_get_default_time_us(grobo_control *control)
{
    RETURN_LOCKED(control, int64_t, 0, grobo_i_control_default_us(control));
}

int grobo_control_set_sense_interval_us(grobo_control *control, int64_t interval_us)
{
    grobo_robot_config change = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = interval_us};

    return interval_us <= 0 && interval_us != GROBO_SENSE_NEVER
               ? GROBO_ERR_ARG
               : grobo_i_control_call(control, configure, &change);
}

/* With the lock. */
static int64_t sense_interval_us(const grobo_control *control)
{
    int64_t interval_us = control->robot_config.sense_interval_us;

    return interval_us != 0 ? interval_us : SENSE_US;
}

int64_t grobo_control_get_sense_interval_us(grobo_control *control)
{
    RETURN_LOCKED(control, int64_t, 0, sense_interval_us(control));
}

int grobo_control_set_motion_count(grobo_control *control, int count)
{
    if (control == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_control_copy(control, &control->motion_count, &count, sizeof count);
    return GROBO_OK;
}

void grobo_control_set_reverse(grobo_control *control, bool reverse)
{
    if (control != NULL) {
        grobo_i_control_copy(control, &control->reverse, &reverse, sizeof reverse);
    }
}

bool grobo_control_is_reverse(grobo_control *control)
{
    RETURN_LOCKED(control, bool, false, control->reverse || control->motion_count < 0);
}

/* ---- postures ----------------------------------------------------------------------------- */

/* With the lock: may this be a target? */
static int check_posture(const grobo_control *control, const grobo_posture *posture)
{
    int r = grobo_posture_check(posture, control->driver->model, NULL);

    if (r == GROBO_ERR_LIMIT && control->robot_config.limit_policy == GROBO_LIMIT_CLAMP) {
        r = GROBO_OK; /* the engine will clamp it */
    }
    if (r >= 0 && (posture->time_us < 0 || posture->time_us > GROBO_PLAY_TIME_MAX_US)) {
        r = GROBO_ERR_ARG;
    }
    return r;
}

/* With the lock. */
static int set_posture(const grobo_control *control, grobo_posture *to,
                       const grobo_posture *posture)
{
    int r = check_posture(control, posture);

    if (r >= 0) {
        *to = *posture;
    }
    return r;
}

int grobo_control_set_init_posture(grobo_control *control, const grobo_posture *posture)
{
    RETURN_LOCKED(control, int, GROBO_ERR_ARG, set_posture(control, &control->init, posture));
}

void grobo_control_get_init_posture(grobo_control *control, grobo_posture *posture)
{
    if (control != NULL && posture != NULL) {
        grobo_i_control_copy(control, posture, &control->init, sizeof *posture);
    }
}

int grobo_control_set_target_posture(grobo_control *control, const grobo_posture *posture)
{
    RETURN_LOCKED(control, int, GROBO_ERR_ARG, set_posture(control, &control->target, posture));
}

void grobo_control_get_target_posture(grobo_control *control, grobo_posture *posture)
{
    if (control != NULL && posture != NULL) {
        grobo_i_control_copy(control, posture, &control->target, sizeof *posture);
    }
}

/* With the lock. */
static int set_joint(grobo_control *control, int joint, double angle_rad)
{
    grobo_posture changed = control->target;
    int r = grobo_posture_set_rad(&changed, joint, angle_rad);

    return r < 0 ? r : set_posture(control, &control->target, &changed);
}

int grobo_control_set_joint(grobo_control *control, int joint, double angle_rad)
{
    RETURN_LOCKED(control, int, GROBO_ERR_ARG, set_joint(control, joint, angle_rad));
}

int grobo_control_set_motion_time_us(grobo_control *control, int64_t time_us)
{
    if (control == NULL || time_us < 0 || time_us > GROBO_PLAY_TIME_MAX_US) {
        return GROBO_ERR_ARG;
    }
    grobo_i_control_copy(control, &control->target.time_us, &time_us, sizeof time_us);
    return GROBO_OK;
}
