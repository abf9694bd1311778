/* SPDX-License-Identifier: MIT */
/* Changing single postures. */
#include <math.h>
#include <string.h>

#include "src/motion/store/container.h"

static int check_posture(const grobo_motion *motion, const grobo_posture *posture)
{
    if (posture->n_joints > GROBO_JOINTS_MAX ||
        (posture->set & ~GROBO_JOINTS_ALL(posture->n_joints)) != 0 ||
        (posture->set & ~GROBO_JOINTS_ALL(motion->n_joints)) != 0 || posture->time_us < 0 ||
        posture->time_us > INT64_MAX / 4) {
        return GROBO_ERR_ARG;
    }
    for (int j = 0; j < posture->n_joints; j++) {
        if ((posture->set & GROBO_JOINT_BIT(j)) != 0 && !isfinite(posture->angle_rad[j])) {
            return GROBO_ERR_NAN;
        }
        if ((posture->set & GROBO_JOINT_BIT(j)) != 0 &&
            fabs(posture->angle_rad[j]) > GROBO_I_ANGLE_MAX_RAD) {
            return GROBO_ERR_ARG;
        }
    }
    return 0;
}

static int check_time(double time_s)
{
    if (!isfinite(time_s)) {
        return GROBO_ERR_NAN;
    }
    return fabs(time_s) <= GROBO_I_TIME_MAX_S ? 0 : GROBO_ERR_ARG;
}

/* time_s + step_us, as clean a decimal number as time_s is. */
static double later(double time_s, int64_t step_us)
{
    double whole_us = round(time_s * 1e6);

    if (fabs(time_s * 1e6 - whole_us) < 1e-3) {
        return (whole_us + (double)step_us) / 1e6;
    }
    return time_s + (double)step_us / 1e6;
}

static void put_angles(const grobo_i_row *row, const grobo_posture *posture)
{
    for (int j = 0; j < posture->n_joints && j < row->width; j++) {
        row->angle_rad[j] = posture->angle_rad[j];
    }
    *row->set = posture->set;
}

static int insert_row(grobo_motion *motion, size_t n, double time_s, const grobo_posture *posture)
{
    grobo_i_row row;
    int result = check_posture(motion, posture);

    if (result == 0) {
        result = check_time(time_s);
    }
    if (result == 0) {
        result = grobo_i_row_insert(motion, n, &row);
    }
    if (result < 0) {
        return result;
    }
    *row.time_s = time_s;
    put_angles(&row, posture);
    return 0;
}

/* The time of a posture put before posture n with its own step. */
static int time_of_step(const grobo_motion *motion, size_t n, const grobo_posture *posture,
                        double *time_s)
{
    bool defaults = motion->kind == GROBO_MOTION_POSTURES || motion->kind == GROBO_MOTION_STEPS;

    if (n > motion->size || posture->time_us < 0 ||
        (defaults && posture->time_us >= GROBO_MOTION_STEP_MAX_US)) {
        return GROBO_ERR_ARG;
    }
    *time_s = later(n > 0 ? grobo_i_time_s(motion, n - 1) : 0, posture->time_us);
    return 0;
}

int grobo_motion_append(grobo_motion *motion, const grobo_posture *posture)
{
    return motion == NULL ? GROBO_ERR_ARG : grobo_motion_insert(motion, motion->size, posture);
}

int grobo_i_record(grobo_motion *motion, const grobo_posture *sensed)
{
    if (motion->size == 0 && (motion->kind == GROBO_MOTION_STEPS || grobo_i_at_rate(motion))) {
        motion->kind = GROBO_MOTION_POSTURES;
        motion->frame_rate_hz = 0;
    }
    return motion->kind == GROBO_MOTION_STEPS || grobo_i_at_rate(motion)
               ? GROBO_ERR_TYPE
               : grobo_motion_append(motion, sensed);
}

int grobo_motion_append_at(grobo_motion *motion, double time_s, const grobo_posture *posture)
{
    return motion == NULL || posture == NULL ? GROBO_ERR_ARG
                                             : insert_row(motion, motion->size, time_s, posture);
}

int grobo_motion_insert(grobo_motion *motion, size_t n, const grobo_posture *posture)
{
    if (motion == NULL || posture == NULL) {
        return GROBO_ERR_ARG;
    }
    double time_s;
    int result = time_of_step(motion, n, posture, &time_s);

    if (result == 0) {
        result = insert_row(motion, n, time_s, posture);
    }
    if (result == 0 && !grobo_i_at_rate(motion)) {
        grobo_i_shift_times(motion, n + 1, (double)posture->time_us / 1e6);
    }
    return result;
}

int grobo_motion_insert_at(grobo_motion *motion, double time_s, const grobo_posture *posture)
{
    if (posture == NULL || motion == NULL) {
        return GROBO_ERR_ARG;
    }
    size_t n = motion->size;

    if (motion->kind != GROBO_MOTION_KEYS && !motion->frame_times) {
        return GROBO_ERR_TYPE;
    }
    while (n > 0 && grobo_i_time_s(motion, n - 1) > time_s) {
        n--;
    }
    int result = insert_row(motion, n, time_s, posture);
    return result < 0 ? result : (int)n;
}

int grobo_motion_delete(grobo_motion *motion, size_t n)
{
    if (motion == NULL || n >= motion->size) {
        return GROBO_ERR_ARG;
    }
    double step_s = grobo_i_time_s(motion, n) - (n > 0 ? grobo_i_time_s(motion, n - 1) : 0);
    grobo_i_row_remove(motion, n);
    if (!grobo_i_at_rate(motion)) {
        grobo_i_shift_times(motion, n, -step_s);
    }
    return 0;
}

int grobo_motion_delete_keep_times(grobo_motion *motion, size_t n)
{
    if (motion == NULL || n >= motion->size) {
        return GROBO_ERR_ARG;
    }
    grobo_i_row_remove(motion, n);
    return 0;
}

int grobo_motion_set(grobo_motion *motion, size_t n, const grobo_posture *posture)
{
    if (motion == NULL || posture == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_row row;
    int result = check_posture(motion, posture);

    if (result == 0) {
        result = grobo_i_row_wide(motion, n, &row);
    }
    if (result == 0) {
        put_angles(&row, posture);
    }
    return result;
}

int grobo_motion_set_time_s(grobo_motion *motion, size_t n, double time_s)
{
    if (motion == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_row row;

    if (!grobo_i_row_at(motion, n, &row) || grobo_i_at_rate(motion)) {
        return GROBO_ERR_ARG;
    }
    int result = check_time(time_s);
    if (result == 0) {
        *row.time_s = time_s;
    }
    return result;
}

void grobo_i_move_row(const grobo_i_row *to, const grobo_i_row *from, int n_joints)
{
    *to->time_s = *from->time_s;
    *to->line = *from->line;
    *to->set = *from->set;
    *to->extra = *from->extra;
    *from->extra = NULL;
    for (int j = 0; j < n_joints && j < from->width; j++) {
        to->angle_rad[j] = from->angle_rad[j];
    }
}

int grobo_i_copy_rows(grobo_motion *motion, const grobo_motion *from, size_t first, size_t last,
                      double shift_s)
{
    for (size_t n = first; n < last; n++) {
        grobo_i_row old, row;
        (void)grobo_i_row_at(from, n, &old);
        grobo_i_extra *extra = NULL;
        if (*old.extra != NULL) {
            extra = grobo_i_extra_dup(motion->mem, *old.extra);
            if (extra == NULL) {
                return GROBO_ERR_NOMEM;
            }
        }
        int result = grobo_i_row_insert(motion, motion->size, &row);
        if (result < 0) {
            grobo_i_extra_free(motion->mem, extra);
            return result;
        }
        (void)grobo_i_row_at(from, n, &old); /* it may have moved: a motion copied to itself */
        *row.extra = extra;
        *row.line = *old.line;
        *row.time_s = grobo_i_time_s(from, n) + shift_s;
        for (int j = 0; j < motion->n_joints && j < old.width; j++) {
            row.angle_rad[j] = old.angle_rad[j];
        }
        *row.set = *old.set & GROBO_JOINTS_ALL(motion->n_joints);
    }
    return 0;
}
