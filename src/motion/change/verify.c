/* SPDX-License-Identifier: MIT */
/* Whether a file that was written plays what its source plays. */
#include <math.h>
#include <stdlib.h>

#include "src/base/sized.h"
#include "src/model/joint.h"
#include "src/motion/play/clip.h"
#include "src/motion/store/diagnostics.h"

/* Numbers as text lose nothing; sums of increments and curves at whole microseconds, a little. */
#define NEAR_RAD 1e-7
#define NEAR_S 1e-6
/* What whole milliseconds and 0.1 degrees may differ by. */
#define WHOLE_RAD (0.0501 * 3.14159265358979323846 / 180)
#define WHOLE_S 0.000501

typedef struct verification {
    const grobo_motion *source, *copy;
    const grobo_write_options *options;
    grobo_diagnostics *list;
    grobo_clip source_view, copy_view;
    double near_rad, near_s;
    grobo_joint_mask told; /* joints that differ: each is said once */
    int n_lost;
} verification;

static void say_at(verification *v, uint32_t line, const char *code, const char *format, ...)
    GROBO_I_FORMAT(4, 5);

static void say_at(verification *v, uint32_t line, const char *code, const char *format, ...)
{
    char text[256];
    va_list args;

    va_start(args, format);
    grobo_i_format_message(text, sizeof text, format, args);
    va_end(args);
    v->n_lost++;
    grobo_i_say(v->list, &(grobo_i_said){v->options->name, code, line, 0, GROBO_SEVERITY_ERROR},
                "%s", text);
}

/* Tenths of a unit of a number, which a message can hold without a locale's point. */
static long long tenths(double value)
{
    return llround(value * 10);
}

static void expect_angles(verification *v, uint32_t line, double t_s, const grobo_posture *wanted,
                          const grobo_posture *found)
{
    const grobo_model *model = v->options->model;

    for (int j = 0; j < wanted->n_joints; j++) {
        grobo_joint_mask bit = GROBO_JOINT_BIT(j);
        bool there = j < found->n_joints && (found->set & bit) != 0;
        if ((wanted->set & bit & ~v->told) == 0 ||
            (there && fabs(found->angle_rad[j] - wanted->angle_rad[j]) <= v->near_rad)) {
            continue;
        }
        bool named = grobo_i_has_joints_of(v->source, model);
        long long deg = tenths(grobo_deg_from_rad(wanted->angle_rad[j]));
        v->told |= bit;
        say_at(v, line, "angle-lost", "%s%.*d at %lld ms: %s%lld.%lld degrees are not in the copy",
               named ? grobo_i_joint(model, j)->name : "joint ", named ? 0 : 1, named ? 0 : j,
               llround(t_s * 1e3), deg < 0 ? "-" : "", llabs(deg) / 10, llabs(deg) % 10);
    }
}

/* How much later the source's keys are: a first posture at 0 in both may take the default time. */
static double find_shift(const verification *v)
{
    bool at_0 = v->source->size > 0 && v->copy->size > 0 && grobo_i_time_s(v->source, 0) == 0 &&
                grobo_i_time_s(v->copy, 0) == 0;

    return at_0 ? grobo_i_clip_at_s(v->source_view.ctx, 0) - grobo_i_clip_at_s(v->copy_view.ctx, 0)
                : 0;
}

/* True for frames that stand elsewhere than the source's postures. */
static bool is_resampled(const verification *v)
{
    double shift_s = find_shift(v);
    bool same = v->copy->size == v->source->size;

    if (!grobo_i_at_rate(v->copy) || v->source_view.sample == NULL) {
        return false;
    }
    for (size_t i = 0; same && i < v->source->size; i++) {
        double source_s = grobo_i_clip_at_s(v->source_view.ctx, i);
        same = fabs(grobo_i_clip_at_s(v->copy_view.ctx, i) + shift_s - source_s) <= v->near_s;
    }
    return !same;
}

static void compare_keys(verification *v)
{
    const grobo_i_clip *source = v->source_view.ctx, *copy = v->copy_view.ctx;
    double shift_s = find_shift(v);

    for (size_t i = 0; i < v->source->size; i++) {
        grobo_posture wanted, found;
        int64_t at_us;
        double source_s = grobo_i_clip_at_s(source, i);
        double copy_s = grobo_i_clip_at_s(copy, i) + shift_s;
        uint32_t line = grobo_motion_line(v->source, grobo_i_clip_row(source, i));
        if (fabs(copy_s - source_s) > v->near_s) {
            say_at(v, line, "time-lost", "the posture at %lld ms is reached at %lld ms in the copy",
                   llround(source_s * 1e3), llround(copy_s * 1e3));
            return;
        }
        (void)v->source_view.key(v->source_view.ctx, i, &wanted, &at_us);
        (void)v->copy_view.key(v->copy_view.ctx, i, &found, &at_us);
        expect_angles(v, line, source_s, &wanted, &found);
    }
}

/* Frame by frame, and that they reach the end. */
static void compare_frames(verification *v)
{
    grobo_i_clip *source = v->source_view.ctx, *copy = v->copy_view.ctx;
    double end_s = v->source->size > 0 ? grobo_i_clip_at_s(source, v->source->size - 1) : 0;
    double last_s = v->copy->size > 0 ? grobo_i_clip_at_s(copy, v->copy->size - 1) : 0;

    for (size_t i = 0; i < v->copy->size; i++) {
        grobo_posture wanted, found;
        double t_s = grobo_i_clip_at_s(copy, i);
        grobo_i_clip_sample_s(source, t_s, &wanted);
        grobo_i_clip_sample_s(copy, t_s, &found);
        expect_angles(v, 0, t_s, &wanted, &found);
    }
    if (end_s - last_s > 1 / v->copy->frame_rate_hz + v->near_s) {
        say_at(v, 0, "time-lost", "the copy ends at %lld ms, %lld ms too early",
               llround(last_s * 1e3), llround((end_s - last_s) * 1e3));
    }
}

static void compare(verification *v)
{
    if (is_resampled(v)) {
        compare_frames(v);
    } else if (v->copy->size != v->source->size) {
        say_at(v, 0, "posture-lost", "%lu of %lu postures are in the copy",
               (unsigned long)v->copy->size, (unsigned long)v->source->size);
    } else {
        compare_keys(v);
    }
}

int grobo_motion_verify(const grobo_motion *source, const grobo_motion *copy,
                        const grobo_write_options *options, grobo_diagnostics *list)
{
    if (source == NULL || copy == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_write_options wanted;
    verification v = {
        .source = source, .copy = copy, .list = list, .near_rad = NEAR_RAD, .near_s = NEAR_S};
    grobo_posture start;

    if (grobo_i_sized_take(&wanted, sizeof wanted, options) < 0) {
        return GROBO_ERR_ARG;
    }
    v.options = &wanted;
    if (copy->kind == GROBO_MOTION_POSTURES && !v.options->exact) {
        v.near_rad = WHOLE_RAD;
        v.near_s = WHOLE_S;
    }
    grobo_i_start(source, v.options->model, v.options->start, &start);
    grobo_clip_options how = {GROBO_CLIP_OPTIONS_INIT, .style = wanted.style,
                              .default_us = wanted.default_us, .start = &start};
    int result = grobo_motion_clip(source, &how, &v.source_view);
    if (result < 0) {
        return result;
    }
    result = grobo_motion_clip(copy, &how, &v.copy_view);
    if (result == 0) {
        compare(&v);
        result = v.n_lost;
    }
    grobo_motion_clip_free(&v.source_view);
    grobo_motion_clip_free(&v.copy_view);
    return result;
}
