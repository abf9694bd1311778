/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "src/motion/store/container.h"

static bool rows_equal(const grobo_motion *a, const grobo_motion *b, size_t n)
{
    grobo_i_row left, right;

    (void)grobo_i_row_at(a, n, &left);
    (void)grobo_i_row_at(b, n, &right);
    if (*left.set != *right.set || !grobo_i_extra_equal(*left.extra, *right.extra)) {
        return false;
    }
    if (!grobo_i_at_rate(a) && memcmp(left.time_s, right.time_s, sizeof *left.time_s) != 0) {
        return false;
    }
    for (int j = 0; j < a->n_joints; j++) {
        if ((*left.set & GROBO_JOINT_BIT(j)) != 0 &&
            memcmp(&left.angle_rad[j], &right.angle_rad[j], sizeof left.angle_rad[j]) != 0) {
            return false;
        }
    }
    return true;
}

bool grobo_motion_equal(const grobo_motion *a, const grobo_motion *b)
{
    if (a->kind != b->kind || a->size != b->size || a->n_joints != b->n_joints ||
        a->frame_rate_hz != b->frame_rate_hz || a->frame_times != b->frame_times ||
        strcmp(grobo_motion_name(a), grobo_motion_name(b)) != 0 ||
        strcmp(grobo_motion_target_body(a), grobo_motion_target_body(b)) != 0 ||
        !grobo_i_kept_equal(a->kept, b->kept)) {
        return false;
    }
    for (size_t n = 0; n < a->size; n++) {
        if (!rows_equal(a, b, n)) {
            return false;
        }
    }
    return true;
}

static bool rows_near(const grobo_motion *a, const grobo_motion *b, size_t n, double delta_rad)
{
    grobo_i_row left, right;

    (void)grobo_i_row_at(a, n, &left);
    (void)grobo_i_row_at(b, n, &right);
    if (*left.set != *right.set) {
        return false;
    }
    for (int j = 0; j < GROBO_JOINTS_MAX; j++) {
        if ((*left.set & GROBO_JOINT_BIT(j)) != 0 &&
            !(fabs(left.angle_rad[j] - right.angle_rad[j]) < delta_rad)) {
            return false;
        }
    }
    return true;
}

bool grobo_motion_near(const grobo_motion *a, const grobo_motion *b, double delta_rad,
                       double delta_s)
{
    if (a->kind != b->kind || a->size != b->size) {
        return false;
    }
    for (size_t n = 0; n < a->size; n++) {
        if (!(fabs(grobo_i_time_s(a, n) - grobo_i_time_s(b, n)) < delta_s) ||
            !rows_near(a, b, n, delta_rad)) {
            return false;
        }
    }
    return true;
}
