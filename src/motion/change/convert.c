/* SPDX-License-Identifier: MIT */
/* A motion as one of another kind: its postures seen through a clip, put down one by one. */
#include <math.h>
#include <string.h>

#include "src/base/sized.h"
#include "src/motion/change/convert.h"
#include "src/motion/play/clip.h"
#include "src/motion/store/columns.h"
#include "src/motion/store/diagnostics.h"

/* Postures further apart are resampled to become frames. */
#define FRAME_RATE_LEAST_HZ 25

/* What is being made of what. */
typedef struct conversion {
    const grobo_motion *from;
    grobo_motion *to;
    const grobo_write_options *options;
    grobo_diagnostics *list;
    grobo_clip view;
    const grobo_i_clip *clip;           /* view's */
    double shift_s;                     /* added to the clip's times */
    double angle_rad[GROBO_JOINTS_MAX]; /* of the posture before */
    grobo_posture start;
} conversion;

static void note(const conversion *conv, const char *code, uint32_t line, const char *text,
                 size_t count)
{
    grobo_i_say(
        conv->list, &(grobo_i_said){conv->options->name, code, line, 0, GROBO_SEVERITY_NOTE},
        "%s (%lu of %lu postures)", text, (unsigned long)count, (unsigned long)conv->from->size);
}

/* ---- what is lost ------------------------------------------------------------------------- */

typedef enum loss {
    LOSS_LINKS = 0,
    LOSS_ZMP,
    LOSS_TRANSITION,
    LOSS_STATIONARY,
    LOSS_NAME,
    LOSS_KEPT,
    LOSS_COUNT
} loss;

static bool loses(const grobo_i_extra *extra, loss what)
{
    switch (what) {
    case LOSS_LINKS:
        return extra->n_links > 0;
    case LOSS_ZMP:
        return extra->info.has_zmp;
    case LOSS_TRANSITION:
        return extra->info.max_transition_s > 0;
    case LOSS_STATIONARY:
        return extra->info.stationary != 0;
    case LOSS_NAME:
        return extra->name != NULL;
    case LOSS_KEPT:
        return extra->kept != NULL;
    case LOSS_COUNT:
        return false;
    }
    return false;
}

/* Notes what key poses have and postures and frames have no place for. */
static void note_losses(const conversion *conv)
{
    static const struct {
        const char *code, *text;
    } texts[LOSS_COUNT] = {
        {"ik-links-dropped", "ikLinks are dropped: only listed joints move"},
        {"zmp-dropped", "zmp is dropped"},
        {"transition-dropped", "maxTransitionTime is dropped"},
        {"sp-joints-dropped", "spJoints are dropped"},
        {"name-dropped", "names of poses are dropped"},
        {"keys-dropped", "keys of no known meaning are dropped"},
    };
    size_t counts[LOSS_COUNT] = {0};
    uint32_t lines[LOSS_COUNT] = {0};
    grobo_i_row row;

    for (size_t n = 0; grobo_i_row_at(conv->from, n, &row); n++) {
        for (int what = 0; what < LOSS_COUNT && *row.extra != NULL; what++) {
            if (loses(*row.extra, (loss)what)) {
                lines[what] = counts[what]++ == 0 ? *row.line : lines[what];
            }
        }
    }
    for (int what = 0; what < LOSS_COUNT; what++) {
        if (counts[what] > 0) {
            note(conv, texts[what].code, lines[what], texts[what].text, counts[what]);
        }
    }
}

/* Notes steps that postures cannot hold: they would mean the default time. */
static void note_steps(const conversion *conv)
{
    size_t count = 0, first = 0;

    for (size_t n = 1; n < conv->to->size; n++) {
        if (grobo_motion_step_us(conv->to, n) == 0) {
            first = count++ == 0 ? n : first;
        }
    }
    if (count > 0) {
        note(conv, "step-default", grobo_motion_line(conv->to, first),
             "steps of 0 or 10 s and more become the default time", count);
    }
}

/* Notes joints that no posture sets. */
static void note_unset(const conversion *conv)
{
    int unset = 0;

    for (int j = 0; j < conv->to->n_joints; j++) {
        unset += (conv->clip->listed & GROBO_JOINT_BIT(j)) == 0;
    }
    if (unset > 0 && conv->from->size > 0) {
        grobo_i_say(conv->list,
                    &(grobo_i_said){conv->options->name, "joints-unset", 0, 0, GROBO_SEVERITY_NOTE},
                    "%d joint%s that no posture sets stay%s where the motion starts", unset,
                    unset == 1 ? "" : "s", unset == 1 ? "s" : "");
    }
}

/* ---- postures one by one ------------------------------------------------------------------ */

/* Before its first key a joint has its first value; one that is never set: see `unset`. */
static void first_values(conversion *conv, const double *unset_rad)
{
    grobo_joint_mask found = 0;

    memcpy(conv->angle_rad, unset_rad, sizeof conv->angle_rad);
    for (size_t i = 0; i < conv->from->size && found != conv->clip->listed; i++) {
        grobo_i_row row;
        (void)grobo_i_row_at(conv->from, grobo_i_clip_row(conv->clip, i), &row);
        for (int j = 0; j < conv->from->n_joints; j++) {
            if ((*row.set & ~found & GROBO_JOINT_BIT(j)) != 0) {
                conv->angle_rad[j] = grobo_i_clip_angle(conv->clip, i, &row, j);
            }
        }
        found |= *row.set;
    }
}

/* The increment that takes a reader's sum from before to exactly after, if there is one. */
static double increment(double before_rad, double after_rad)
{
    double step_rad = after_rad - before_rad;
    double low_rad = step_rad, high_rad = step_rad;

    for (int i = 0; i < 4; i++) {
        if (before_rad + low_rad == after_rad) {
            return low_rad;
        }
        if (before_rad + high_rad == after_rad) {
            return high_rad;
        }
        low_rad = nextafter(low_rad, -HUGE_VAL);
        high_rad = nextafter(high_rad, HUGE_VAL);
    }
    return step_rad;
}

/* The angle of joint j for key i, whose row is old: its own, or the one it keeps. */
static double next_angle(conversion *conv, size_t i, const grobo_i_row *old, int j)
{
    double before_rad = conv->angle_rad[j];
    double after_rad = before_rad;

    if ((*old->set & GROBO_JOINT_BIT(j)) != 0) {
        after_rad = grobo_i_clip_angle(conv->clip, i, old, j);
    }
    if (conv->to->kind != GROBO_MOTION_STEPS) {
        conv->angle_rad[j] = after_rad;
        return after_rad;
    }
    double step_rad = increment(before_rad, after_rad);
    conv->angle_rad[j] = before_rad + step_rad; /* what a reader adds up */
    return step_rad;
}

/* When posture i of the source is reached in what it becomes. */
static double new_time_s(const conversion *conv, size_t i)
{
    return grobo_i_clip_at_s(conv->clip, i) + conv->shift_s;
}

/* A row for key i. */
static int put_key(conversion *conv, size_t i)
{
    grobo_motion *to = conv->to;
    bool full = to->kind == GROBO_MOTION_POSTURES || to->kind == GROBO_MOTION_FRAMES;
    grobo_i_row old, row;
    int result = grobo_i_row_insert(to, to->size, &row);

    if (result < 0) {
        return result;
    }
    (void)grobo_i_row_at(conv->from, grobo_i_clip_row(conv->clip, i), &old);
    *row.time_s = new_time_s(conv, i);
    *row.line = *old.line;
    *row.set = full ? GROBO_JOINTS_ALL(to->n_joints) : *old.set;
    for (int j = 0; j < to->n_joints; j++) {
        row.angle_rad[j] = next_angle(conv, i, &old, j);
    }
    if (!full && *old.extra != NULL) {
        *row.extra = grobo_i_extra_dup(to->mem, *old.extra);
        return *row.extra != NULL ? 0 : GROBO_ERR_NOMEM;
    }
    return 0;
}

/* The rate at which the times are those of frames, or 0. */
static double find_rate(const conversion *conv)
{
    size_t size = conv->from->size;
    double last_s = size >= 2 ? new_time_s(conv, size - 1) : 0;

    if (!(last_s > 0)) {
        return 0;
    }
    double rate_hz = (double)(size - 1) / last_s;
    double whole_hz = round(rate_hz);
    rate_hz = fabs(rate_hz - whole_hz) < 1e-6 * rate_hz ? whole_hz : rate_hz;
    if (rate_hz < 0.1) {
        return 0; /* even steps, but no frames */
    }
    for (size_t i = 0; i < size; i++) {
        if (!(fabs(new_time_s(conv, i) * rate_hz - (double)i) < 1e-6)) {
            return 0;
        }
    }
    return rate_hz;
}

/* A rate for frames that have times of their own: none is lost at it. */
static double finest_rate(const grobo_motion *motion)
{
    double least_s = 1;

    for (size_t n = 1; n < motion->size; n++) {
        int64_t step_us = grobo_i_step_us(GROBO_MOTION_KEYS, grobo_i_time_s(motion, n - 1),
                                          grobo_i_time_s(motion, n));
        if (step_us > 0) {
            least_s = fmin(least_s, (double)step_us / 1e6);
        }
    }
    return ceil(1 / least_s);
}

static int one_by_one(conversion *conv)
{
    grobo_motion_kind kind = conv->to->kind;

    if (kind == GROBO_MOTION_STEPS) {
        memcpy(conv->angle_rad, conv->start.angle_rad, sizeof conv->angle_rad);
    } else {
        first_values(conv, conv->start.angle_rad);
    }
    for (size_t i = 0; i < conv->from->size; i++) {
        int result = put_key(conv, i);
        if (result < 0) {
            return result;
        }
    }
    return 0;
}

/* Of frames, those of the motion as they are; the others at a rate, or 0 where they have none. */
static int frame_by_frame(conversion *conv, double rate_hz)
{
    grobo_motion *to = conv->to;
    int result = one_by_one(conv);

    if (result < 0) {
        return result;
    }
    if (conv->from->kind == GROBO_MOTION_FRAMES) {
        to->frame_times = conv->from->frame_times;
        return grobo_motion_set_frame_rate(to, rate_hz);
    }
    to->frame_times = rate_hz == 0;
    return grobo_motion_set_frame_rate(to, rate_hz > 0 ? rate_hz : finest_rate(to));
}

/* ---- frames at a rate --------------------------------------------------------------------- */

/* Joints that nothing sets stay at the start. */
static int complete_rows(conversion *conv)
{
    grobo_motion *to = conv->to;
    int result = 0;

    for (size_t n = 0; result == 0 && n < to->size; n++) {
        grobo_i_row row;
        result = grobo_i_row_wide(to, n, &row);
        for (int j = 0; result == 0 && j < to->n_joints; j++) {
            if ((*row.set & GROBO_JOINT_BIT(j)) == 0) {
                row.angle_rad[j] = conv->start.angle_rad[j];
            }
        }
        *row.set = GROBO_JOINTS_ALL(to->n_joints);
    }
    return result;
}

/* Where the motion ends between two frames, one more has the posture in which it ends. */
static int add_end(const conversion *conv, grobo_motion *frames)
{
    grobo_posture end;
    double last_s = frames->size > 0 ? grobo_i_time_s(frames, frames->size - 1) : 0;

    if (frames->size == 0 || (double)conv->view.length_us / 1e6 - last_s < 1e-6) {
        return 0;
    }
    int result = conv->view.sample(conv->view.ctx, conv->view.length_us, &end);
    end.time_us = 0;
    return result < 0 ? result : grobo_motion_append(frames, &end);
}

static int resample(conversion *conv, double rate_hz)
{
    grobo_motion *frames;
    int result = grobo_i_clip_fill(&conv->view, &conv->start);

    if (result < 0) {
        return result;
    }
    result = grobo_motion_resample(&conv->view, rate_hz, conv->to->mem, &frames);

    if (result < 0) {
        return result;
    }
    conv->to->frame_rate_hz = frames->frame_rate_hz;
    conv->to->frame_times = false;
    result = add_end(conv, frames);
    if (result == 0) {
        grobo_i_take_rows(conv->to, frames);
    }
    grobo_motion_free(frames);
    return result < 0 ? result : complete_rows(conv);
}

/* The lowest rate at which the motion ends on a frame, as those of .m and most others do at one of
 * these; else the first. */
static int rate_of_end(const conversion *conv)
{
    for (int rate_hz = GROBO_MOTION_RATE_HZ; rate_hz <= 4 * GROBO_MOTION_RATE_HZ; rate_hz *= 2) {
        if (conv->view.length_us * rate_hz % 1000000 == 0) {
            return rate_hz;
        }
    }
    return GROBO_MOTION_RATE_HZ;
}

/*
 * Frames without a rate asked for: those of a motion that has them, or postures that are as close
 * as frames; anything else is resampled, since programs that read frames hold each until the next.
 */
static int to_frames(conversion *conv)
{
    const grobo_write_options *options = conv->options;

    if (options->rate_hz > 0) {
        return resample(conv, options->rate_hz);
    }
    bool framed = conv->from->kind == GROBO_MOTION_FRAMES;
    double rate_hz = framed ? conv->from->frame_rate_hz : find_rate(conv);
    if (framed || options->exact || rate_hz >= FRAME_RATE_LEAST_HZ) {
        return frame_by_frame(conv, rate_hz);
    }
    int even_hz = rate_of_end(conv);
    int result = resample(conv, even_hz);
    if (result == 0 && conv->to->size > 0) {
        grobo_i_say(conv->list,
                    &(grobo_i_said){options->name, "resampled", 0, 0, GROBO_SEVERITY_NOTE},
                    "resampled: %d frames per second", even_hz);
    }
    return result;
}

/* ---- all of it ---------------------------------------------------------------------------- */

/* A line of .m has the joints of the first motors. A motion with others gets them all. */
static bool lacks_columns(const grobo_motion *motion, const grobo_model *model)
{
    uint8_t joints[GROBO_JOINTS_MAX];
    bool lacks = false;

    if (model == NULL || motion->n_joints >= model->n_joints) {
        return false;
    }
    (void)grobo_i_motor_order(model, motion->n_joints, joints);
    for (int c = 0; c < motion->n_joints; c++) {
        lacks |= joints[c] >= motion->n_joints;
    }
    return lacks;
}

static int begin(conversion *conv, grobo_motion_kind kind)
{
    const grobo_motion *from = conv->from;
    const grobo_write_options *options = conv->options;
    grobo_clip_options how = {GROBO_CLIP_OPTIONS_INIT, .style = options->style,
                              .default_us = options->default_us};

    grobo_i_start(from, options->model, options->start, &conv->start);
    how.start = &conv->start;
    int result = grobo_i_new_like(from, &conv->to);
    if (result < 0) {
        return result;
    }
    bool full = kind == GROBO_MOTION_POSTURES || kind == GROBO_MOTION_FRAMES;
    if (full && conv->start.n_joints > from->n_joints) {
        (void)grobo_motion_set_joints(conv->to, conv->start.n_joints);
    }
    if (kind == GROBO_MOTION_POSTURES && from->size > 0 &&
        lacks_columns(conv->to, options->model)) {
        (void)grobo_motion_set_joints(conv->to, options->model->n_joints);
    }
    conv->to->kind = kind;
    conv->to->frame_times = false;
    conv->to->frame_rate_hz = 0;
    result = grobo_i_clip_keys(from, &how, &conv->view);
    conv->clip = conv->view.ctx;
    /* A first posture at 0 stays there, though it has no step to be reached by. */
    if (result == 0 && from->size > 0 && grobo_i_time_s(from, 0) == 0) {
        conv->shift_s = -grobo_i_clip_at_s(conv->clip, 0);
    }
    return result;
}

static int run(conversion *conv, grobo_motion_kind kind)
{
    int result = begin(conv, kind);

    if (result == 0) {
        result = kind == GROBO_MOTION_FRAMES ? to_frames(conv) : one_by_one(conv);
    }
    if (result < 0) {
        return result;
    }
    if (kind == GROBO_MOTION_POSTURES || kind == GROBO_MOTION_FRAMES) {
        note_losses(conv);
        note_unset(conv);
    }
    if (kind == GROBO_MOTION_POSTURES || kind == GROBO_MOTION_STEPS) {
        note_steps(conv);
    }
    return 0;
}

int grobo_motion_resolve(grobo_motion *motion, const grobo_posture *start)
{
    if (start == NULL || motion == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_clip view;
    int64_t at_us;

    if (motion->kind != GROBO_MOTION_STEPS) {
        return 0;
    }
    int result = grobo_i_clip_keys(
        motion, &(grobo_clip_options){GROBO_CLIP_OPTIONS_INIT, .start = start}, &view);
    if (result < 0) {
        return result;
    }
    for (size_t n = 0; n < motion->size; n++) {
        grobo_posture posture;
        grobo_i_row row;
        (void)view.key(view.ctx, n, &posture, &at_us);
        (void)grobo_i_row_at(motion, n, &row);
        memcpy(row.angle_rad, posture.angle_rad, row.width * sizeof *row.angle_rad);
        grobo_i_extra_free(motion->mem, *row.extra);
        *row.extra = NULL;
    }
    grobo_motion_clip_free(&view);
    motion->kind = GROBO_MOTION_POSTURES;
    return 0;
}

bool grobo_i_is_as_written(const grobo_motion *motion, grobo_motion_kind kind,
                           const grobo_write_options *options)
{
    uint8_t joints[GROBO_JOINTS_MAX];

    if (kind != motion->kind) {
        return false;
    }
    if (kind == GROBO_MOTION_POSTURES && motion->size > 0) {
        return grobo_i_m_columns(motion, options->model, joints) > 0;
    }
    return kind != GROBO_MOTION_FRAMES || !(options->rate_hz > 0);
}

int grobo_motion_convert(const grobo_motion *motion, grobo_motion_kind kind,
                         const grobo_write_options *options, grobo_diagnostics *list,
                         grobo_motion **converted)
{
    if (motion == NULL || converted == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_write_options how;
    conversion conv = {.from = motion, .options = &how, .list = list};

    if (grobo_i_sized_take(&how, sizeof how, options) < 0) {
        return GROBO_ERR_ARG;
    }
    double rate_hz = how.rate_hz;
    if (kind < GROBO_MOTION_POSTURES || kind > GROBO_MOTION_FRAMES || !isfinite(rate_hz) ||
        rate_hz < 0) {
        return GROBO_ERR_ARG;
    }
    if (grobo_i_is_as_written(motion, kind, conv.options)) {
        return grobo_motion_dup(motion, converted);
    }
    int result = run(&conv, kind);
    grobo_motion_clip_free(&conv.view);
    if (result < 0) {
        grobo_motion_free(conv.to);
        return result;
    }
    *converted = conv.to;
    return 0;
}
