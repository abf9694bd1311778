/* SPDX-License-Identifier: MIT */
/* Two motions: the same to the bit, or near each other. */
#include <math.h>
#include <string.h>

#include "src/motion/store/container.h"

static bool kept_equal(const grobo_i_kept *a, const grobo_i_kept *b)
{
    while (a != NULL && b != NULL) {
        if (a->level != b->level || a->link != b->link || a->key_bytes != b->key_bytes ||
            a->value_bytes != b->value_bytes ||
            memcmp(a->text, b->text, a->key_bytes + a->value_bytes) != 0) {
            return false;
        }
        a = a->next;
        b = b->next;
    }
    return a == b;
}

static bool same_doubles(const double *a, const double *b, size_t count)
{
    return memcmp(a, b, count * sizeof *a) == 0;
}

static bool link_equal(const grobo_ik_link *a, const grobo_ik_link *b)
{
    return same_doubles(a->translation_m, b->translation_m, 3) &&
           same_doubles(a->rotation, b->rotation, 9) && a->index == b->index &&
           strcmp(a->name, b->name) == 0 && a->is_base == b->is_base &&
           a->is_stationary == b->is_stationary && a->is_touching == b->is_touching &&
           a->is_slave == b->is_slave && a->has_parting_direction == b->has_parting_direction &&
           (!a->has_parting_direction ||
            same_doubles(a->parting_direction, b->parting_direction, 3));
}

static bool info_equal(const grobo_key_info *a, const grobo_key_info *b)
{
    return same_doubles(&a->max_transition_s, &b->max_transition_s, 1) &&
           a->stationary == b->stationary && a->has_zmp == b->has_zmp &&
           a->zmp_stationary == b->zmp_stationary &&
           (!a->has_zmp || same_doubles(a->zmp_m, b->zmp_m, 3));
}

static bool extra_equal(const grobo_i_extra *a, const grobo_i_extra *b)
{
    static const grobo_i_extra nothing;

    a = a != NULL ? a : &nothing;
    b = b != NULL ? b : &nothing;
    if (!info_equal(&a->info, &b->info) || a->n_links != b->n_links ||
        strcmp(a->name != NULL ? a->name : "", b->name != NULL ? b->name : "") != 0 ||
        !kept_equal(a->kept, b->kept)) {
        return false;
    }
    for (size_t i = 0; i < a->n_links; i++) {
        if (!link_equal(&a->links[i], &b->links[i])) {
            return false;
        }
    }
    return true;
}

static bool rows_equal(const grobo_motion *a, const grobo_motion *b, size_t n)
{
    grobo_i_row left, right;

    (void)grobo_i_row_at(a, n, &left);
    (void)grobo_i_row_at(b, n, &right);
    if (*left.set != *right.set || !extra_equal(*left.extra, *right.extra)) {
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
    if (a == NULL || b == NULL || a->kind != b->kind || a->size != b->size ||
        a->n_joints != b->n_joints || a->frame_rate_hz != b->frame_rate_hz ||
        a->frame_times != b->frame_times ||
        strcmp(grobo_motion_name(a), grobo_motion_name(b)) != 0 ||
        strcmp(grobo_motion_target_body(a), grobo_motion_target_body(b)) != 0 ||
        !kept_equal(a->kept, b->kept)) {
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
    if (a == NULL || b == NULL || a->kind != b->kind || a->size != b->size) {
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
