/* SPDX-License-Identifier: MIT */
/* Following a motion through time: what each joint does, in as many points as a picture shows. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/unit.h>

#include "tools/grctl/view/plot.h"

/* Curves are sampled so often that speed peaks show, but only so many times. */
static const double angle_most_deg = 1e9; /* beyond this a picture says nothing */
enum { STEP_MOST_US = 5000, SAMPLES_MOST = 200000, POINTS_A_COLUMN = 4 };

/* What the time of a column holds: its ends and its extremes draw the same as all of it. */
typedef struct bin {
    plot_point first, low, high, last;
    int column;
    bool open;
} bin;

typedef struct collector {
    plot_data *data;
    bin bins[GROBO_JOINTS_MAX]; /* by curve */
    int columns;
} collector;

/* ---- when to look -------------------------------------------------------------------------- */

typedef struct walk {
    const grobo_clip *clip;
    bool keys; /* look at every key */
    size_t key;
    double grid_us; /* look so often, 0: at keys only */
    int64_t grid;   /* number of the next look */
} walk;

static walk begin_walk(const plot_data *data, double rate_hz)
{
    bool curved = grobo_motion_get_kind(data->of.motion) == GROBO_MOTION_KEYS;
    walk w = {.clip = data->of.clip, .keys = rate_hz <= 0};
    if (rate_hz > 0) {
        w.grid_us = 1e6 / rate_hz;
    } else if (curved) {
        w.grid_us = fmax(fmin(STEP_MOST_US, (double)w.clip->length_us / 1000),
                         (double)w.clip->length_us / SAMPLES_MOST);
    }
    if (w.grid_us < 1) {
        w.grid_us = w.clip->length_us > 0 && (rate_hz > 0 || curved) ? 1 : 0;
    }
    return w;
}

/* The next time to look at, or -1. 0 always is one: what comes first is held until its time. */
static int64_t next_time(walk *w, int64_t before_us)
{
    int64_t at_us = before_us < 0 ? 0 : GROBO_NEVER_US;
    grobo_posture posture;
    while (w->grid_us > 0 && at_us == GROBO_NEVER_US) {
        int64_t grid_us = (int64_t)round((double)w->grid * w->grid_us);
        if (grid_us > w->clip->length_us) {
            break;
        }
        if (grid_us > before_us) {
            at_us = grid_us;
        } else {
            w->grid++;
        }
    }
    while (w->keys && w->key < w->clip->n_keys) {
        int64_t key_us = 0;
        if (w->clip->key(w->clip->ctx, w->key, &posture, &key_us) < 0) {
            break;
        }
        if (key_us > before_us) {
            return key_us < at_us ? key_us : at_us;
        }
        w->key++;
    }
    return at_us == GROBO_NEVER_US ? -1 : at_us;
}

/* ---- what is seen -------------------------------------------------------------------------- */

static void emit(plot_curve *curve, const plot_point *point)
{
    const plot_point *before = curve->n_points ? &curve->points[curve->n_points - 1] : NULL;
    if (!before || before->t_s < point->t_s) {
        curve->points[curve->n_points++] = *point;
    }
}

static void close_bin(plot_curve *curve, bin *b)
{
    bool rising = b->low.t_s < b->high.t_s;
    if (!b->open) {
        return;
    }
    emit(curve, &b->first);
    emit(curve, rising ? &b->low : &b->high);
    emit(curve, rising ? &b->high : &b->low);
    emit(curve, &b->last);
    b->open = false;
}

/* Stretches that a picture cannot tell apart are one. */
static void add_fast(plot_curve *curve, double from_s, double to_s, double column_s)
{
    plot_span *last = curve->n_fast ? &curve->fast[curve->n_fast - 1] : NULL;
    if (last && from_s - last->to_s <= 2 * column_s) {
        last->to_s = to_s;
    } else {
        curve->fast[curve->n_fast++] = (plot_span){from_s, to_s};
    }
}

/* As in grctl check: a little more than the servo can is none, nor is half of a wire's unit. */
static void see_speed(const collector *c, plot_curve *curve, const plot_point *before,
                      const plot_point *now)
{
    double way_deg = fabs(now->angle_deg - before->angle_deg);
    double speed_dps = way_deg / (now->t_s - before->t_s);
    curve->peak_speed_dps = fmax(curve->peak_speed_dps, speed_dps);
    if (curve->limits && way_deg > 0.05 &&
        grobo_rad_from_deg(speed_dps) > curve->limits->max_speed_rad_s * 1.001) {
        add_fast(curve, before->t_s, now->t_s, c->data->length_s / c->columns);
    }
}

static void see(collector *c, int i, const plot_point *now)
{
    plot_curve *curve = &c->data->curves[i];
    bin *b = &c->bins[i];
    double length_s = c->data->length_s;
    int column = length_s > 0 ? (int)(now->t_s / length_s * c->columns) : 0;
    if (curve->set) {
        see_speed(c, curve, &b->last, now);
    } else {
        curve->min_deg = curve->max_deg = now->angle_deg;
    }
    curve->min_deg = fmin(curve->min_deg, now->angle_deg);
    curve->max_deg = fmax(curve->max_deg, now->angle_deg);
    curve->set = true;
    if (b->open && b->column != column) {
        close_bin(curve, b);
    }
    if (!b->open) {
        *b = (bin){.first = *now, .low = *now, .high = *now, .column = column, .open = true};
    }
    if (now->angle_deg < b->low.angle_deg) {
        b->low = *now;
    }
    if (now->angle_deg > b->high.angle_deg) {
        b->high = *now;
    }
    b->last = *now;
}

static int follow(collector *c, double rate_hz)
{
    plot_data *data = c->data;
    walk w = begin_walk(data, rate_hz);
    grobo_posture posture;
    if (data->length_s * rate_hz > GROBO_MOTION_FRAMES_MAX) {
        return GROBO_ERR_CAP;
    }
    for (int64_t t_us = next_time(&w, -1); t_us >= 0; t_us = next_time(&w, t_us)) {
        int error = data->of.clip->sample(data->of.clip->ctx, t_us, &posture);
        if (error) {
            return error;
        }
        for (int i = 0; i < data->n_curves; i++) {
            plot_point now = {(double)t_us / 1e6, 0};
            if (grobo_posture_get_deg(&posture, data->curves[i].joint, &now.angle_deg) < 0) {
                continue;
            }
            now.angle_deg = fmin(fmax(now.angle_deg, -angle_most_deg), angle_most_deg);
            see(c, i, &now);
        }
    }
    for (int i = 0; i < data->n_curves; i++) {
        close_bin(&data->curves[i], &c->bins[i]);
    }
    return 0;
}

/* ---- all of it ----------------------------------------------------------------------------- */

/* The model's, else "j12". */
static void joint_name(const grobo_model *model, int joint, char *name, size_t capacity)
{
    if (model && joint < model->n_joints) {
        snprintf(name, capacity, "%s", grobo_model_joint(model, joint)->name);
    } else {
        snprintf(name, capacity, "j%d", joint);
    }
}

double plot_value(const plot_curve *curve, double angle_deg)
{
    return curve->model
               ? grobo_model_value(curve->model, curve->joint, grobo_rad_from_deg(angle_deg))
               : angle_deg;
}

const char *plot_unit(const plot_curve *curve)
{
    switch (curve->model ? grobo_model_unit(curve->model, curve->joint) : GROBO_UNIT_DEG) {
    case GROBO_UNIT_DEG:
        return "°";
    case GROBO_UNIT_MM:
        return " mm";
    case GROBO_UNIT_PCT:
        return " %";
    }
    return "";
}

bool plot_beyond(const plot_curve *curve)
{
    return curve->set && curve->limits &&
           (grobo_ddeg_from_rad(grobo_rad_from_deg(curve->min_deg)) <
                grobo_ddeg_from_rad(curve->limits->min_rad) ||
            grobo_ddeg_from_rad(grobo_rad_from_deg(curve->max_deg)) >
                grobo_ddeg_from_rad(curve->limits->max_rad));
}

static int add_curve(plot_data *data, int joint, int columns)
{
    plot_curve *curve = &data->curves[data->n_curves++];
    curve->joint = joint;
    joint_name(data->of.model, joint, curve->name, sizeof curve->name);
    if (data->of.model && joint < data->of.model->n_joints) {
        curve->limits = grobo_model_joint(data->of.model, joint);
        curve->model = data->of.model;
    }
    curve->points = calloc((size_t)(columns + 1) * POINTS_A_COLUMN, sizeof *curve->points);
    curve->fast = calloc((size_t)columns + 2, sizeof *curve->fast);
    return curve->points && curve->fast ? 0 : GROBO_ERR_NOMEM;
}

size_t plot_keys(const plot_data *data)
{
    return grobo_motion_size(data->of.motion);
}

/* A pose with link targets is a key of the joints they move, at the angles they come to. */
static int solved_key(const plot_data *data, size_t i, grobo_posture *posture, double *t_s)
{
    grobo_joint_mask set;
    size_t links = 0;
    int error = grobo_motion_get(data->of.motion, i, posture);
    if (!error) {
        error = grobo_motion_time_s(data->of.motion, i, t_s);
    }
    if (error) {
        return error;
    }
    set = posture->set;
    if (grobo_motion_ik_links(data->of.motion, i, &links) && links) {
        set |= data->of.solved;
    }
    error = data->of.clip->sample(data->of.clip->ctx, (int64_t)round(*t_s * 1e6), posture);
    posture->set &= set;
    return error;
}

int plot_key(const plot_data *data, size_t i, grobo_posture *posture, double *t_s)
{
    int64_t at_us = 0;
    if (data->of.solved) {
        return solved_key(data, i, posture, t_s);
    }
    int error = data->of.clip->key(data->of.clip->ctx, i, posture, &at_us);
    *t_s = (double)at_us / 1e6;
    return error;
}

int plot_collect(plot_data *data, const plot_subject *subject, const plot_options *options)
{
    collector c = {.data = data, .columns = options->columns};
    int error = 0;
    memset(data, 0, sizeof *data);
    data->of = *subject;
    data->length_s = (double)subject->clip->length_us / 1e6;
    for (int j = 0; j < GROBO_JOINTS_MAX && !error; j++) {
        if (options->joints & GROBO_JOINT_BIT(j)) {
            error = add_curve(data, j, c.columns);
        }
    }
    if (!error && subject->clip->n_keys) {
        error = follow(&c, options->rate_hz);
    }
    if (error) {
        plot_free(data);
    }
    return error;
}

void plot_free(plot_data *data)
{
    for (int i = 0; i < data->n_curves; i++) {
        free(data->curves[i].points);
        free(data->curves[i].fast);
    }
    memset(data, 0, sizeof *data);
}
