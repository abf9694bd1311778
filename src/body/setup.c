/* SPDX-License-Identifier: MIT */
/* From key poses to tracks, and the frames asked of them. choreonoid-whole-body.md, sections
 * "Frames", "Order", "Keys". */
#include <string.h>

#include "src/body/balance.h"
#include "src/body/body.h"
#include "src/body/vec.h"

#define RATE_DEFAULT_HZ 100.0
#define RATE_MAX_HZ 10000.0
/* With the balancer frames go on for this long after the last key. */
#define AFTER_END_S 1.0

/* Hands out the workspace. Without memory it only counts. */
struct arena {
    uint8_t *memory;
    size_t used;
};

static void *take(struct arena *arena, size_t count, size_t size)
{
    void *at = arena->memory == NULL ? NULL : arena->memory + arena->used;

    arena->used += (count * size + 15) / 16 * 16;
    return at;
}

/* How many keys each track begins with. */
struct counts {
    size_t joint[GROBO_JOINTS_MAX];
    size_t target[GROBO_I_TARGETS];
    size_t zmp;
    double end_s;
};

static int target_of_link(const grobo_body_model *model, int link)
{
    if (link == 0) {
        return GROBO_I_WAIST;
    }
    for (int foot = 0; foot < 2; foot++) {
        if (model->feet[foot].link == link) {
            return GROBO_I_RIGHT + foot;
        }
    }
    return -1;
}

/* Numbers a robot can be asked for. A time that is too large is left to the cap of frames. */
static int numbers_ok(const double *v, int n)
{
    for (int i = 0; i < n; i++) {
        if (!isfinite(v[i])) {
            return GROBO_ERR_NAN;
        }
        if (fabs(v[i]) > GROBO_BODY_NUMBER_MAX) {
            return GROBO_ERR_ARG;
        }
    }
    return 0;
}

static int count_joints(const grobo_body_model *model, const grobo_body_key *key,
                        struct counts *counts)
{
    int result = 0;

    for (int j = 0; j < model->n_joints && result == 0; j++) {
        if ((key->joints & GROBO_JOINT_BIT(j)) != 0) {
            counts->joint[j]++;
            result = numbers_ok(&key->q_rad[j], 1);
        }
    }
    return result;
}

static int count_targets(const grobo_body_model *model, const grobo_body_key *key,
                         struct counts *counts)
{
    int result = 0;

    for (size_t i = 0; i < key->n_targets && result == 0; i++) {
        const int target = target_of_link(model, key->targets[i].link);

        if (target >= 0) {
            counts->target[target]++;
            result = numbers_ok(key->targets[i].at.p_m, 3);
            result = result < 0 ? result : numbers_ok(key->targets[i].at.r, 9);
        }
    }
    return result;
}

/* Checks one key pose and counts what it holds. */
static int count_key(const grobo_body_model *model, const grobo_body_key *key,
                     struct counts *counts)
{
    int result = 0;

    if (!isfinite(key->time_s) || !isfinite(key->max_transition_s)) {
        return GROBO_ERR_NAN;
    }
    if (key->time_s < -GROBO_BODY_NUMBER_MAX) {
        return GROBO_ERR_ARG;
    }
    result = count_joints(model, key, counts);
    result = result < 0 ? result : count_targets(model, key, counts);
    if (key->has_zmp && result == 0) {
        counts->zmp++;
        result = numbers_ok(key->zmp_m, 3);
    }
    counts->end_s = fmax(counts->end_s, key->time_s);
    return result;
}

static bool options_ok(const grobo_body_options *options)
{
    if (options->balance != GROBO_BODY_BALANCE_OFF && options->ik == GROBO_BODY_IK_OFF) {
        return false; /* the balancer moves the waist over standing feet */
    }
    return options->ik <= GROBO_BODY_IK_OFF && options->step <= GROBO_BODY_STEP_STEALTHY &&
           options->zmp <= GROBO_BODY_ZMP_AUTO && options->balance <= GROBO_BODY_BALANCE_COMPAT11 &&
           options->rate_hz >= 0 && options->rate_hz <= RATE_MAX_HZ;
}

static int count_keys(const grobo_body_setup *setup, struct counts *counts)
{
    memset(counts, 0, sizeof *counts);
    if (setup->keys == NULL || setup->n_keys < 1 || !options_ok(&setup->options)) {
        return GROBO_ERR_ARG;
    }
    for (size_t i = 0; i < setup->n_keys; i++) {
        const int result = count_key(setup->model, &setup->keys[i], counts);

        if (result < 0) {
            return result;
        }
    }
    return 0;
}

/* N = (int)(rate t_last) + 1; with the balancer lround((t_last + 1) rate) + 1 */
static double frames_of(const grobo_body_options *options, double end_s)
{
    const double rate_hz = options->rate_hz > 0 ? options->rate_hz : RATE_DEFAULT_HZ;

    if (options->balance != GROBO_BODY_BALANCE_OFF) {
        return round((end_s + AFTER_END_S) * rate_hz) + 1;
    }
    return floor(rate_hz * end_s) + 1;
}

static void take_track(struct arena *arena, struct grobo_i_track *track, int dim, size_t capacity)
{
    *track = (struct grobo_i_track){.dim = dim, .capacity = (int)capacity};
    track->t_s = take(arena, capacity, sizeof *track->t_s);
    track->from_s = take(arena, capacity, sizeof *track->from_s);
    track->v = take(arena, capacity * (size_t)dim, sizeof *track->v);
    track->slope = take(arena, capacity * (size_t)dim, sizeof *track->slope);
    track->flags = take(arena, capacity, sizeof *track->flags);
}

/* Lays the body out in the arena. Capacities: holds make two keys of one. Of the 2 n keys of a foot
 * each may get one more by the automatic ZMP and one by the stealthy step; to the ZMP the former
 * adds at most three a foot key, one at the begin and one at the end. */
static void lay_out(struct arena *arena, grobo_body *body, const grobo_body_setup *setup,
                    const struct counts *counts)
{
    const grobo_body_model *model = setup->model;
    const size_t n_joints = (size_t)model->n_joints;
    const bool stealthy = setup->options.step == GROBO_BODY_STEP_STEALTHY;
    size_t foot_keys = 0;

    body->joints = take(arena, n_joints, sizeof *body->joints);
    for (size_t j = 0; j < n_joints; j++) {
        struct grobo_i_track track;

        take_track(arena, &track, 1, 2 * counts->joint[j]);
        if (arena->memory != NULL) {
            body->joints[j] = track;
        }
    }
    for (int i = 0; i < GROBO_I_TARGETS; i++) {
        const size_t factor = i == GROBO_I_WAIST ? 2 : 6;

        take_track(arena, &body->target[i], 6, factor * counts->target[i]);
        if (i != GROBO_I_WAIST) {
            take_track(arena, &body->height[i - GROBO_I_RIGHT], 1,
                       stealthy ? factor * counts->target[i] : 0);
            foot_keys += counts->target[i];
        }
    }
    take_track(arena, &body->zmp, 3, 2 * (counts->zmp + 3 * foot_keys + 2));
    body->q_rad = take(arena, n_joints, sizeof *body->q_rad);
    body->order = take(arena, setup->n_keys, sizeof *body->order);
    body->time_s = take(arena, setup->n_keys, sizeof *body->time_s);
    if (setup->options.balance != GROBO_BODY_BALANCE_OFF) {
        body->balance = take(arena, grobo_i_balance_doubles(body->n_frames), sizeof *body->balance);
    }
}

/* Everything about a setup that can be wrong, and the body as it will be laid out. */
static int measure(const grobo_body_setup *setup, struct counts *counts, grobo_body *body)
{
    double frames;
    int result;

    if (setup == NULL || grobo_body_model_check(setup->model) < 0) {
        return GROBO_ERR_ARG;
    }
    result = count_keys(setup, counts);
    if (result < 0) {
        return result;
    }
    frames = frames_of(&setup->options, counts->end_s);
    if (frames > GROBO_MOTION_FRAMES_MAX || setup->n_keys > GROBO_MOTION_FRAMES_MAX) {
        return GROBO_ERR_CAP;
    }
    memset(body, 0, sizeof *body);
    body->model = setup->model;
    body->options = setup->options;
    body->options.rate_hz = setup->options.rate_hz > 0 ? setup->options.rate_hz : RATE_DEFAULT_HZ;
    body->end_s = counts->end_s;
    body->n_frames = (int)fmax(frames, 1);
    for (int foot = 0; foot < 2; foot++) {
        (void)grobo_i_leg_find(setup->model, foot, &body->leg[foot]);
    }
    return 0;
}

int grobo_body_workspace_bytes(const grobo_body_setup *setup, size_t *bytes)
{
    struct arena arena = {NULL, 0};
    struct counts counts;
    grobo_body body;
    const int result = bytes == NULL ? GROBO_ERR_ARG : measure(setup, &counts, &body);

    if (result < 0) {
        return result;
    }
    (void)take(&arena, 1, sizeof body);
    lay_out(&arena, &body, setup, &counts);
    *bytes = arena.used;
    return 0;
}

/* Keys by time; one whose time equals an earlier one's goes before it. */
static void sort_keys(const grobo_body_setup *setup, uint32_t *order)
{
    for (size_t i = 0; i < setup->n_keys; i++) {
        size_t low = 0, high = i;

        while (low < high) {
            const size_t middle = low + (high - low) / 2;

            if (setup->keys[order[middle]].time_s < setup->keys[i].time_s) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        memmove(order + low + 1, order + low, (i - low) * sizeof *order);
        order[low] = (uint32_t)i;
    }
}

static void list_times(grobo_body *body, const grobo_body_setup *setup)
{
    for (size_t i = 0; i < setup->n_keys; i++) {
        const double time_s = setup->keys[body->order[i]].time_s;

        if (body->n_poses == 0 || time_s > body->time_s[body->n_poses - 1]) {
            body->time_s[body->n_poses++] = time_s;
        }
    }
}

static void append(struct grobo_i_track *track, const grobo_body_key *key, const double *v,
                   unsigned flags)
{
    grobo_i_track_hold(track, track->n, key->time_s, key->max_transition_s);
    grobo_i_track_insert(track, track->n, key->time_s, v, flags);
}

static void append_joints(grobo_body *body, const grobo_body_key *key)
{
    for (int j = 0; j < body->model->n_joints; j++) {
        if ((key->joints & GROBO_JOINT_BIT(j)) != 0) {
            const bool still = (key->stationary & GROBO_JOINT_BIT(j)) != 0;

            append(&body->joints[j], key, &key->q_rad[j], still ? TRACK_END : 0u);
        }
    }
}

static void append_target(grobo_body *body, const grobo_body_key *key,
                          const grobo_body_target *from)
{
    const int target = target_of_link(body->model, from->link);
    const unsigned flags = (from->base ? TRACK_BASE : 0u) | (from->touching ? TRACK_TOUCH : 0u) |
                           (from->slave && !from->touching ? TRACK_SLAVE : 0u) |
                           (from->stationary || from->touching ? TRACK_END : 0u);
    double v[6];

    if (target < 0) {
        return;
    }
    memcpy(v, from->at.p_m, sizeof from->at.p_m);
    grobo_i_rpy_of_rotation(v + 3, from->at.r);
    append(&body->target[target], key, v, flags);
    if (target != GROBO_I_WAIST && body->options.step == GROBO_BODY_STEP_STEALTHY) {
        append(&body->height[target - GROBO_I_RIGHT], key, &v[2], flags);
    }
}

/* The automatic ZMP looks at the author's keys before holds are added to them; in 1.1 after. */
static bool zmp_holds_late(const grobo_body *body)
{
    return body->options.zmp == GROBO_BODY_ZMP_AUTO &&
           body->options.balance != GROBO_BODY_BALANCE_COMPAT11;
}

static void append_zmp(grobo_body *body, const grobo_body_key *key)
{
    struct grobo_i_track *zmp = &body->zmp;

    if (!zmp_holds_late(body)) {
        grobo_i_track_hold(zmp, zmp->n, key->time_s, key->max_transition_s);
    }
    grobo_i_track_insert(zmp, zmp->n, key->time_s, key->zmp_m,
                         key->zmp_stationary ? TRACK_END : 0u);
}

/* The tracks as the author's keys make them. */
static void fill_tracks(grobo_body *body, const grobo_body_setup *setup)
{
    for (size_t i = 0; i < setup->n_keys; i++) {
        const grobo_body_key *key = &setup->keys[body->order[i]];

        append_joints(body, key);
        for (size_t k = 0; k < key->n_targets; k++) {
            append_target(body, key, &key->targets[k]);
        }
        if (key->has_zmp) {
            append_zmp(body, key);
        }
    }
}

/* Holds of the author's ZMP keys, which stand in the track among those that were added. */
static void hold_zmp(grobo_body *body, const grobo_body_setup *setup)
{
    struct grobo_i_track *zmp = &body->zmp;
    int at = 0;

    for (size_t i = 0; i < setup->n_keys; i++) {
        const grobo_body_key *key = &setup->keys[body->order[i]];
        const int before = zmp->n;

        if (!key->has_zmp) {
            continue;
        }
        while ((zmp->flags[at] & TRACK_ADDED) != 0) {
            at++;
        }
        grobo_i_track_hold(zmp, at, key->time_s, key->max_transition_s);
        at += 1 + zmp->n - before;
    }
}

/* What the options ask for beyond the author's keys. */
static void add_keys(grobo_body *body, const grobo_body_setup *setup)
{
    if (body->options.zmp == GROBO_BODY_ZMP_AUTO) {
        grobo_i_zmp_auto(body);
    }
    if (zmp_holds_late(body)) {
        hold_zmp(body, setup);
    }
    if (body->options.step == GROBO_BODY_STEP_STEALTHY) {
        grobo_i_stealthy_step(body);
    }
}

static bool overflowed(const grobo_body *body)
{
    bool overflow = body->zmp.overflow || body->height[0].overflow || body->height[1].overflow;

    for (int j = 0; j < body->model->n_joints; j++) {
        overflow = overflow || body->joints[j].overflow;
    }
    for (int i = 0; i < GROBO_I_TARGETS; i++) {
        overflow = overflow || body->target[i].overflow;
    }
    return overflow;
}

static void compute_slopes(grobo_body *body)
{
    for (int j = 0; j < body->model->n_joints; j++) {
        grobo_i_track_slopes(&body->joints[j], 1);
    }
    for (int i = 0; i < GROBO_I_TARGETS; i++) {
        grobo_i_track_slopes(&body->target[i], 3);
    }
    for (int foot = 0; foot < 2; foot++) {
        grobo_i_track_slopes(&body->height[foot], 1);
    }
    grobo_i_track_slopes(&body->zmp, 3);
}

int grobo_body_init(const grobo_body_setup *setup, void *workspace, size_t workspace_bytes,
                    grobo_body **body)
{
    struct arena arena = {workspace, 0};
    struct counts counts;
    grobo_body made;
    grobo_body *at = workspace;
    size_t needed = 0;
    int result = body == NULL ? GROBO_ERR_ARG : grobo_body_workspace_bytes(setup, &needed);

    if (result < 0) {
        return result;
    }
    if (workspace == NULL || (uintptr_t)workspace % _Alignof(max_align_t) != 0) {
        return GROBO_ERR_ARG;
    }
    if (workspace_bytes < needed) {
        return GROBO_ERR_SPACE;
    }
    (void)measure(setup, &counts, &made);
    memset(workspace, 0, needed);
    (void)take(&arena, 1, sizeof made);
    lay_out(&arena, &made, setup, &counts);
    *at = made;
    sort_keys(setup, at->order);
    list_times(at, setup);
    fill_tracks(at, setup);
    add_keys(at, setup);
    if (overflowed(at)) {
        return GROBO_ERR_CAP;
    }
    compute_slopes(at);
    if (at->options.balance != GROBO_BODY_BALANCE_OFF) {
        grobo_i_balance(at);
    }
    *body = at;
    return 0;
}
