/* SPDX-License-Identifier: MIT */
/* Longer, shorter, backwards, and cut: what changes the times of a whole motion. */
#include <math.h>
#include <string.h>

#include "src/motion/play/clip.h"

/* ---- longer and shorter ------------------------------------------------------------------- */

/* Times of postures: steps grow, those that mean the default stay as they are. */
static int scale_steps(grobo_motion *motion, double factor)
{
    double old_s = 0, new_s = 0;
    grobo_i_row row;

    for (size_t n = 0; n < motion->size; n++) {
        int64_t step_us = grobo_motion_step_us(motion, n);
        if ((double)step_us * factor >= GROBO_MOTION_STEP_MAX_US) {
            return GROBO_ERR_CAP;
        }
    }
    for (size_t n = 0; grobo_i_row_at(motion, n, &row); n++) {
        double step_s = *row.time_s - old_s;
        bool defaults = grobo_i_step_us(motion->kind, old_s, *row.time_s) == 0;
        old_s = *row.time_s;
        new_s += defaults ? step_s : step_s * factor;
        *row.time_s = new_s;
    }
    return 0;
}

int grobo_motion_scale_time(grobo_motion *motion, double factor)
{
    if (motion == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_row row;

    if (!isfinite(factor) || !(factor > 0)) {
        return GROBO_ERR_ARG;
    }
    if (motion->kind == GROBO_MOTION_POSTURES || motion->kind == GROBO_MOTION_STEPS) {
        return scale_steps(motion, factor);
    }
    for (size_t n = 0; grobo_i_row_at(motion, n, &row); n++) {
        if (fabs(grobo_i_time_s(motion, n)) * factor > GROBO_I_TIME_MAX_S) {
            return GROBO_ERR_ARG;
        }
    }
    if (motion->kind == GROBO_MOTION_FRAMES) {
        int result = grobo_motion_set_frame_rate(motion, motion->frame_rate_hz / factor);
        if (result < 0) {
            return result;
        }
    }
    for (size_t n = 0; grobo_i_row_at(motion, n, &row); n++) {
        *row.time_s *= factor;
        if (*row.extra != NULL) {
            (*row.extra)->info.max_transition_s =
                fmin((*row.extra)->info.max_transition_s * factor, GROBO_I_TIME_MAX_S);
        }
    }
    return 0;
}

/* ---- waits of maxTransitionTime as keys of their own -------------------------------------- */

enum { LINKS_MAX = 64 }; /* different ones in a motion */

/* Where joints, links and ZMP had their last key. */
typedef struct last_keys {
    size_t joints[GROBO_JOINTS_MAX];
    struct {
        size_t row;
        const grobo_ik_link *link;
    } links[LINKS_MAX];
    int n_links;
    size_t zmp;
    grobo_joint_mask listed;
    bool has_zmp;
} last_keys;

static bool same_link(const grobo_ik_link *a, const grobo_ik_link *b)
{
    return a->index == b->index && strcmp(a->name, b->name) == 0;
}

/* The entry of a link, a new one if it has none; -1 if there are too many. */
static int entry_of(last_keys *last, const grobo_ik_link *link)
{
    for (int i = 0; i < last->n_links; i++) {
        if (same_link(last->links[i].link, link)) {
            return i;
        }
    }
    if (last->n_links == LINKS_MAX) {
        return -1;
    }
    last->links[last->n_links].link = NULL;
    return last->n_links++;
}

/* Joints of a key that wait: a hold row gets their old angles, and their last key is stationary. */
static int hold_joints(grobo_motion *motion, const last_keys *last, const grobo_i_row *key,
                       double hold_s, grobo_posture *hold)
{
    for (int j = 0; j < motion->n_joints; j++) {
        grobo_joint_mask bit = GROBO_JOINT_BIT(j);
        grobo_i_row before;
        if ((*key->set & last->listed & bit) == 0 ||
            !grobo_i_row_at(motion, last->joints[j], &before) || *before.time_s >= hold_s) {
            continue;
        }
        grobo_i_extra *extra = grobo_i_extra_of(motion->mem, &before);
        if (extra == NULL) {
            return GROBO_ERR_NOMEM;
        }
        extra->info.stationary |= bit;
        hold->angle_rad[j] = before.angle_rad[j];
        hold->set |= bit;
    }
    return 0;
}

/* Links of a key that wait: the hold row gets copies of their last entries. */
static int hold_links(grobo_motion *motion, last_keys *last, const grobo_i_extra *extra,
                      double hold_s, grobo_ik_link *held)
{
    int count = 0;

    for (int i = 0; i < extra->n_links; i++) {
        int entry = entry_of(last, &extra->links[i]);
        grobo_i_row before;
        if (entry < 0) {
            return GROBO_ERR_CAP;
        }
        if (last->links[entry].link == NULL) {
            last->links[entry].link = &extra->links[i];
            last->links[entry].row = SIZE_MAX;
        }
        if (!grobo_i_row_at(motion, last->links[entry].row, &before) || *before.time_s >= hold_s) {
            continue;
        }
        grobo_i_extra *old = *before.extra;
        for (int k = 0; k < old->n_links; k++) {
            if (same_link(&old->links[k], &extra->links[i])) {
                old->links[k].is_stationary = true;
                held[count++] = old->links[k];
            }
        }
    }
    return count;
}

static void hold_zmp(grobo_motion *motion, const last_keys *last, const grobo_i_extra *extra,
                     double hold_s, grobo_key_info *info)
{
    grobo_i_row before;

    if (extra->info.has_zmp && last->has_zmp && grobo_i_row_at(motion, last->zmp, &before) &&
        *before.time_s < hold_s) {
        (*before.extra)->info.zmp_stationary = true;
        info->has_zmp = true;
        info->zmp_stationary = true;
        memcpy(info->zmp_m, (*before.extra)->info.zmp_m, sizeof info->zmp_m);
    }
}

/* The wait before row n, if it has one, to the motion of waits. */
static int add_wait(grobo_motion *motion, size_t n, last_keys *last, grobo_motion *waits)
{
    grobo_i_row row;
    grobo_posture hold;
    grobo_ik_link held[GROBO_IK_LINKS_MAX];
    grobo_key_info info = {0};

    (void)grobo_i_row_at(motion, n, &row);
    if (*row.extra == NULL || !((*row.extra)->info.max_transition_s > 0)) {
        return 0;
    }
    grobo_i_extra *extra = *row.extra;
    double hold_s = *row.time_s - extra->info.max_transition_s;
    extra->info.max_transition_s = 0;
    (void)grobo_posture_init(&hold, motion->n_joints);
    int result = hold_joints(motion, last, &row, hold_s, &hold);
    if (result < 0) {
        return result;
    }
    int n_held = hold_links(motion, last, extra, hold_s, held);
    hold_zmp(motion, last, extra, hold_s, &info);
    if (n_held < 0 || (hold.set == 0 && n_held == 0 && !info.has_zmp)) {
        return n_held < 0 ? n_held : 0;
    }
    info.stationary = hold.set;
    result = grobo_motion_append_at(waits, hold_s, &hold);
    if (result == 0) {
        result = grobo_motion_set_key(waits, waits->size - 1, &info);
    }
    if (result == 0 && n_held > 0) {
        result = grobo_motion_set_ik_links(waits, waits->size - 1, held, (size_t)n_held);
    }
    return result;
}

/* Row n has been gone by: it is the last for all that it has. */
static int pass_row(grobo_motion *motion, size_t n, last_keys *last)
{
    grobo_i_row row;

    (void)grobo_i_row_at(motion, n, &row);
    for (int j = 0; j < motion->n_joints; j++) {
        if ((*row.set & GROBO_JOINT_BIT(j)) != 0) {
            last->joints[j] = n;
        }
    }
    last->listed |= *row.set;
    if (*row.extra == NULL) {
        return 0;
    }
    for (int i = 0; i < (*row.extra)->n_links; i++) {
        int entry = entry_of(last, &(*row.extra)->links[i]);
        if (entry < 0) {
            return GROBO_ERR_CAP;
        }
        last->links[entry].link = &(*row.extra)->links[i];
        last->links[entry].row = n;
    }
    if ((*row.extra)->info.has_zmp) {
        last->has_zmp = true;
        last->zmp = n;
    }
    return 0;
}

/* Appends row n of another motion, at a time of its own. */
static int copy_row(grobo_motion *motion, const grobo_motion *from, size_t n, double time_s)
{
    int result = grobo_i_copy_rows(motion, from, n, n + 1, 0);
    grobo_i_row row;

    if (result == 0 && grobo_i_row_at(motion, motion->size - 1, &row)) {
        *row.time_s = time_s;
    }
    return result;
}

/* Makes maxTransitionTime superfluous. */
static int expand_waits(grobo_motion *motion)
{
    last_keys last;
    grobo_motion *waits = NULL;
    int result = grobo_i_new_like(motion, &waits);

    memset(&last, 0, sizeof last);
    for (size_t n = 0; n < motion->size && result == 0; n++) {
        result = add_wait(motion, n, &last, waits);
        if (result == 0) {
            result = pass_row(motion, n, &last);
        }
    }
    for (size_t n = 0; result == 0 && n < waits->size; n++) {
        size_t at = motion->size;
        double time_s = grobo_i_time_s(waits, n);
        grobo_i_row from, to;
        while (at > 0 && grobo_i_time_s(motion, at - 1) > time_s) {
            at--;
        }
        result = grobo_i_row_insert(motion, at, &to);
        if (result == 0 && grobo_i_row_at(waits, n, &from)) {
            grobo_i_move_row(&to, &from, motion->n_joints);
        }
    }
    grobo_motion_free(waits);
    return result;
}

/* ---- backwards ---------------------------------------------------------------------------- */

/* The key poses in the order of time, their waits expanded. */
static int sorted_keys(const grobo_motion *motion, grobo_motion **sorted)
{
    grobo_motion *made;
    grobo_clip view = {0};
    int result = grobo_i_new_like(motion, &made);

    if (result < 0) {
        return result;
    }
    result = grobo_motion_clip(motion, NULL, &view);
    for (size_t i = 0; result == 0 && i < motion->size; i++) {
        const grobo_i_clip *clip = view.ctx;
        result = copy_row(made, motion, grobo_i_clip_row(clip, i), grobo_i_clip_at_s(clip, i));
    }
    if (result == 0) {
        result = expand_waits(made);
    }
    grobo_motion_clip_free(&view);
    if (result < 0) {
        grobo_motion_free(made);
        return result;
    }
    *sorted = made;
    return 0;
}

/* Rows of from, last first, to made. */
static int turn_rows(const grobo_motion *from, grobo_motion *made)
{
    bool steps = from->kind == GROBO_MOTION_STEPS;
    bool counts = steps || from->kind == GROBO_MOTION_POSTURES;
    double end_s = from->size > 0 ? grobo_i_time_s(from, from->size - 1) : 0;
    double time_s = 0;
    grobo_i_row row;

    for (size_t k = 0; k < from->size; k++) {
        size_t n = from->size - 1 - k;
        /* The step that leads to a posture leads back to the one before it. */
        size_t step = steps ? n : k == 0 ? 0 : n + 1;
        time_s += grobo_i_time_s(from, step) - (step > 0 ? grobo_i_time_s(from, step - 1) : 0);
        int result = copy_row(made, from, n, counts ? time_s : end_s - grobo_i_time_s(from, n));
        if (result < 0) {
            return result;
        }
        for (int j = 0; steps && grobo_i_row_at(made, k, &row) && j < made->n_joints; j++) {
            row.angle_rad[j] = 0 - row.angle_rad[j];
        }
    }
    return 0;
}

int grobo_motion_reverse(grobo_motion *motion)
{
    if (motion == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_motion *sorted = NULL, *made = NULL;
    int result = motion->kind == GROBO_MOTION_KEYS ? sorted_keys(motion, &sorted) : 0;

    if (result == 0) {
        result = grobo_i_new_like(motion, &made);
    }
    if (result == 0) {
        result = turn_rows(sorted != NULL ? sorted : motion, made);
    }
    if (result == 0) {
        grobo_i_swap(motion, made);
    }
    grobo_motion_free(made);
    grobo_motion_free(sorted);
    return result;
}
