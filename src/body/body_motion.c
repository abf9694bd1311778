/* SPDX-License-Identifier: MIT */
/* From a motion's key poses to the body's, and back to frames. */
#include <string.h>

#include <grobo/core/body_motion.h>
#include <grobo/core/motion.h>

#include "src/base/sized.h"
#include "src/body/body.h"
#include "src/body/vec.h"

/* A motion's keys in the form the solver takes, in one block. */
struct key_block {
    const grobo_mem *mem;
    grobo_body_key *keys;
    double *q_rad;              /* n_joints a key */
    grobo_body_target *targets; /* as many as the motion has */
    size_t bytes;
};

static void *resize(const grobo_mem *mem, void *ptr, size_t old_bytes, size_t new_bytes)
{
    return mem->resize(mem->ctx, ptr, old_bytes, new_bytes);
}

static bool same_name(const char *a, const char *b)
{
    while (*a != '\0' && *a == *b) {
        a++;
        b++;
    }
    return *a == *b;
}

/* By its name; one that has none, or one that the body has not, by its index. */
static int link_of(const grobo_body_model *model, const grobo_ik_link *from)
{
    for (int i = 0; i < model->n_links && from->name[0] != '\0'; i++) {
        if (same_name(model->links[i].name, from->name)) {
            return i;
        }
    }
    return from->index;
}

bool grobo_body_wanted(const grobo_body_model *model, const grobo_motion *motion)
{
    for (size_t n = 0; model != NULL && n < grobo_motion_size(motion); n++) {
        size_t count = 0;
        const grobo_ik_link *links = grobo_motion_ik_links(motion, n, &count);

        for (size_t i = 0; i < count; i++) {
            const int link = link_of(model, &links[i]);

            if (link == 0 || link == model->feet[0].link || link == model->feet[1].link) {
                return true;
            }
        }
    }
    return false;
}

static int make_block(struct key_block *block, const grobo_body_model *model,
                      const grobo_motion *motion)
{
    const size_t size = grobo_motion_size(motion);
    const size_t n_angles = size * (size_t)model->n_joints;
    size_t n_targets = 0;
    char *memory;

    for (size_t n = 0; n < size; n++) {
        size_t count = 0;

        (void)grobo_motion_ik_links(motion, n, &count);
        n_targets += count;
    }
    block->bytes = size * sizeof *block->keys + n_targets * sizeof *block->targets +
                   n_angles * sizeof *block->q_rad;
    memory = resize(block->mem, NULL, 0, block->bytes);
    if (memory == NULL) {
        return GROBO_ERR_NOMEM;
    }
    memset(memory, 0, block->bytes);
    block->keys = (grobo_body_key *)(void *)memory;
    block->targets = (grobo_body_target *)(void *)(block->keys + size);
    block->q_rad = (double *)(void *)(block->targets + n_targets);
    return 0;
}

static void fill_target(const grobo_body_model *model, const grobo_ik_link *from,
                        grobo_body_target *target)
{
    memcpy(target->at.p_m, from->translation_m, sizeof target->at.p_m);
    memcpy(target->at.r, from->rotation, sizeof target->at.r);
    target->link = link_of(model, from);
    target->base = from->is_base;
    target->stationary = from->is_stationary;
    target->touching = from->is_touching;
    target->slave = from->is_slave;
}

/* Key n, its angles and targets where the block has room for them. */
static void fill_key(const grobo_body_model *model, const grobo_motion *motion, size_t n,
                     grobo_body_key *key, double *q_rad, grobo_body_target *targets)
{
    grobo_posture posture;
    grobo_key_info info;
    const grobo_ik_link *links = grobo_motion_ik_links(motion, n, &key->n_targets);

    (void)grobo_motion_time_s(motion, n, &key->time_s);
    (void)grobo_motion_get(motion, n, &posture);
    (void)grobo_motion_get_key(motion, n, &info);
    key->joints = posture.set & GROBO_JOINTS_ALL(model->n_joints);
    for (int j = 0; j < model->n_joints && j < posture.n_joints; j++) {
        q_rad[j] = posture.angle_rad[j];
    }
    key->q_rad = q_rad;
    key->max_transition_s = info.max_transition_s;
    key->stationary = info.stationary;
    key->has_zmp = info.has_zmp;
    key->zmp_stationary = info.zmp_stationary;
    memcpy(key->zmp_m, info.zmp_m, sizeof key->zmp_m);
    key->targets = targets;
    for (size_t i = 0; i < key->n_targets; i++) {
        fill_target(model, &links[i], &targets[i]);
    }
}

static void fill_block(struct key_block *block, const grobo_body_model *model,
                       const grobo_motion *motion)
{
    grobo_body_target *targets = block->targets;

    for (size_t n = 0; n < grobo_motion_size(motion); n++) {
        grobo_body_key *key = &block->keys[n];

        fill_key(model, motion, n, key, block->q_rad + n * (size_t)model->n_joints, targets);
        targets += key->n_targets;
    }
}

static int solve_block(grobo_body **body, const grobo_body_setup *setup, const grobo_mem *mem)
{
    size_t bytes = 0;
    void *workspace;
    int result = grobo_body_workspace_bytes(setup, &bytes);

    if (result < 0) {
        return result;
    }
    workspace = resize(mem, NULL, 0, bytes);
    if (workspace == NULL) {
        return GROBO_ERR_NOMEM;
    }
    result = grobo_body_init(setup, workspace, bytes, body);
    if (result < 0) {
        (void)resize(mem, workspace, bytes, 0);
        return result;
    }
    (*body)->mem = mem;
    (*body)->bytes = bytes;
    return 0;
}

int grobo_body_new(const grobo_body_model *model, const grobo_motion *motion,
                   const grobo_body_options *options, const grobo_mem *mem, grobo_body **body)
{
    if (body == NULL || motion == NULL) {
        return GROBO_ERR_ARG;
    }
    struct key_block block = {.mem = mem != NULL ? mem : grobo_mem_default()};
    grobo_body_setup setup = {.model = model, .n_keys = grobo_motion_size(motion)};
    int result = grobo_i_sized_take(&setup.options, sizeof setup.options, options);

    if (result < 0) {
        return result;
    }
    if (grobo_motion_get_kind(motion) != GROBO_MOTION_KEYS) {
        return GROBO_ERR_TYPE;
    }
    if (setup.n_keys == 0) {
        return GROBO_ERR_EMPTY;
    }
    if (grobo_body_model_check(model) < 0) {
        return GROBO_ERR_ARG;
    }
    result = make_block(&block, model, motion);
    if (result < 0) {
        return result;
    }
    fill_block(&block, model, motion);
    setup.keys = block.keys;
    result = solve_block(body, &setup, block.mem);
    (void)resize(block.mem, block.keys, block.bytes, 0);
    return result;
}

void grobo_body_free(grobo_body *body)
{
    if (body != NULL) {
        (void)resize(body->mem, body, body->bytes, 0);
    }
}

/* ---- playing ---- */

static int pose_at(grobo_body *body, double time_s, grobo_posture *posture)
{
    grobo_body_report report;

    (void)grobo_posture_init(posture, body->model->n_joints);
    (void)grobo_body_sample(body, time_s, posture->angle_rad, &report);
    posture->set = grobo_body_joints(body);
    return body->stop_unreachable && report.unreachable != 0 ? GROBO_ERR_UNREACHABLE : 0;
}

static int64_t us_from_s(double time_s)
{
    return (int64_t)llround(fmax(time_s, 0) * 1e6);
}

static int clip_key(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    grobo_body *body = ctx;
    int result;

    if (i >= body->n_poses) {
        return GROBO_ERR_ARG;
    }
    result = pose_at(body, body->time_s[i], posture);
    if (result < 0) {
        return result;
    }
    *at_us = us_from_s(body->time_s[i]);
    posture->time_us = *at_us - (i > 0 ? us_from_s(body->time_s[i - 1]) : 0);
    return 0;
}

static int clip_sample(void *ctx, int64_t t_us, grobo_posture *posture)
{
    return pose_at(ctx, (double)t_us * 1e-6, posture);
}

void grobo_body_clip(grobo_body *body, bool stop_unreachable, grobo_clip *clip)
{
    if (body == NULL || clip == NULL) {
        return;
    }
    const double last_s = (body->n_frames - 1) / body->options.rate_hz;

    body->stop_unreachable = stop_unreachable;
    *clip = (grobo_clip){.key = clip_key,
                         .sample = clip_sample,
                         .ctx = body,
                         .length_us = us_from_s(fmax(last_s, body->end_s)),
                         .n_keys = body->n_poses,
                         .n_joints = (uint8_t)body->model->n_joints};
}

int grobo_body_frames(grobo_body *body, const grobo_mem *mem, grobo_motion **frames)
{
    if (body == NULL || frames == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_motion *made = NULL;
    int unreached = 0;
    int result = grobo_motion_new(GROBO_MOTION_FRAMES, body->model->n_joints, mem, &made);

    if (result >= 0) {
        result = grobo_motion_set_frame_rate(made, body->options.rate_hz);
    }
    for (int i = 0; i < body->n_frames && result >= 0; i++) {
        grobo_posture posture;
        grobo_body_report report;

        (void)grobo_posture_init(&posture, body->model->n_joints);
        (void)grobo_body_frame(body, i, posture.angle_rad, &report);
        posture.set = grobo_body_joints(body);
        unreached += report.unreachable != 0;
        result = grobo_motion_append(made, &posture);
    }
    if (result < 0) {
        grobo_motion_free(made);
        return result;
    }
    *frames = made;
    return unreached;
}
