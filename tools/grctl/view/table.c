/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include <grobo/core/unit.h>

#include "tools/grctl/os/os.h"
#include "tools/grctl/view/show.h"

/* On a terminal rows that do not fit its width are split, so many at a time. */
enum { NARROWEST = 7, PAGE_ROWS = 40, NAME_BYTES = 64 };

typedef struct table {
    const app *a;
    const show_rows *rows;
    int terminal; /* columns of the terminal, 0: none */
    int time_width;
    int decimals; /* of times */
    int width[GROBO_JOINTS_MAX];
} table;

const char *show_joint_name(const show_rows *rows, int c, char *buffer, size_t capacity)
{
    int joint = rows->joint[c];
    if (rows->model && joint < rows->model->n_joints) {
        return grobo_model_joint(rows->model, joint)->name;
    }
    snprintf(buffer, capacity, "j%d", joint);
    return buffer;
}

bool show_is_steps(const show_rows *rows)
{
    return grobo_motion_get_kind(rows->motion) == GROBO_MOTION_STEPS && !rows->as_played;
}

int show_row(const show_rows *rows, size_t i, grobo_posture *posture, double *time_s)
{
    const grobo_clip *clip = &rows->played.clip;
    int64_t at_us = 0;
    int error;
    if (!rows->as_played) {
        error = grobo_motion_get(rows->motion, i, posture);
        if (!error && rows->reached_s) {
            *time_s = rows->reached_s[i];
            return 0;
        }
        return error ? error : grobo_motion_time_s(rows->motion, i, time_s);
    }
    if (rows->rate_hz > 0) {
        at_us = (int64_t)round((double)i * 1e6 / rows->rate_hz);
        error = clip->sample(clip->ctx, at_us, posture);
    } else {
        error = clip->key(clip->ctx, i, posture, &at_us);
    }
    *time_s = (double)at_us / 1e6;
    return error;
}

/* A joint's value in its unit; of a body that nobody knows degrees. */
static bool value_of(const show_rows *rows, int c, const grobo_posture *posture, double *value)
{
    double deg;
    int joint = rows->joint[c];
    bool known = rows->model && joint < rows->model->n_joints && !show_is_steps(rows);
    if (grobo_posture_get_deg(posture, joint, &deg) < 0) {
        return false;
    }
    *value = known ? grobo_model_value(rows->model, joint, posture->angle_rad[joint]) : deg;
    return true;
}

/* ---- names ---------------------------------------------------------------------------------- */

/* Part k of a name split at its underscores: R_KNEE_P is R, KNEE, P. */
static const char *name_part(const char *name, int k, size_t *length)
{
    while (k > 0 && name) {
        name = strchr(name, '_');
        name = name ? name + 1 : NULL;
        k--;
    }
    *length = name ? strcspn(name, "_") : 0;
    return name ? name : "";
}

static int name_parts(const char *name)
{
    int n = 1;
    for (; *name; name++) {
        n += *name == '_';
    }
    return n;
}

/* How wide the name is printed: whole, or on a terminal its longest part. */
static int name_width(const table *t, int c)
{
    char buffer[NAME_BYTES];
    const char *name = show_joint_name(t->rows, c, buffer, sizeof buffer);
    size_t longest = t->terminal ? 0 : strlen(name), length;
    for (int k = 0; k < name_parts(name) && t->terminal; k++) {
        name_part(name, k, &length);
        longest = length > longest ? length : longest;
    }
    return (int)longest;
}

/* ---- widths --------------------------------------------------------------------------------- */

/* What is printed for an angle: one decimal, no -0.0. */
static double tenths(double deg)
{
    double rounded = round(deg * 10) / 10;
    return rounded == 0 ? 0 : rounded;
}

static void widen(int *width, int least)
{
    if (*width < least) {
        *width = least;
    }
}

static void measure(table *t)
{
    grobo_posture posture;
    double time_s = 0, value;
    t->time_width = (int)strlen("time_ms") + 2;
    for (int c = 0; c < t->rows->n_joints; c++) {
        t->width[c] = NARROWEST;
        widen(&t->width[c], name_width(t, c) + 2);
    }
    for (size_t i = 0; i < t->rows->n && show_row(t->rows, i, &posture, &time_s) == 0; i++) {
        if (fabs(time_s * 1e3 - round(time_s * 1e3)) > 1e-6) {
            t->decimals = 1;
        }
        widen(&t->time_width, snprintf(NULL, 0, "%.*f", t->decimals, time_s * 1e3) + 1);
        for (int c = 0; c < t->rows->n_joints; c++) {
            if (value_of(t->rows, c, &posture, &value)) {
                widen(&t->width[c], snprintf(NULL, 0, "%.1f", tenths(value)) + 2);
            }
        }
    }
}

/* True if two neighbouring columns belong to one limb: R_HIP_Y, R_HIP_R. */
static bool same_limb(const table *t, int c, int d)
{
    char buffers[2][NAME_BYTES];
    size_t lengths[2];
    const char *first =
        name_part(show_joint_name(t->rows, c, buffers[0], NAME_BYTES), 0, &lengths[0]);
    const char *second =
        name_part(show_joint_name(t->rows, d, buffers[1], NAME_BYTES), 0, &lengths[1]);
    return lengths[0] == lengths[1] && memcmp(first, second, lengths[0]) == 0;
}

/* The column behind the last one that fits with `from`; a limb is split only if it has to be. */
static int fits(const table *t, int from)
{
    int used = t->time_width, to, limb;
    for (to = from; to < t->rows->n_joints; to++) {
        used += t->width[to];
        if (t->terminal && used > t->terminal && to > from) {
            break;
        }
    }
    for (limb = to; limb > from && limb < t->rows->n_joints && same_limb(t, limb - 1, to); limb--) {
        continue;
    }
    return limb > from ? limb : to;
}

/* ---- printing ------------------------------------------------------------------------------- */

static void print_part(const table *t, int c, int k, int lines)
{
    char buffer[NAME_BYTES];
    const char *name = show_joint_name(t->rows, c, buffer, sizeof buffer);
    int first = lines - name_parts(name); /* names stand on the rows below */
    size_t length = 0;
    const char *part = k >= first ? name_part(name, k - first, &length) : "";
    app_print("%*.*s", t->width[c], (int)length, part);
}

static void print_names(const table *t, int from, int to)
{
    char buffer[NAME_BYTES];
    int lines = 1;
    for (int c = from; c < to && t->terminal; c++) {
        widen(&lines, name_parts(show_joint_name(t->rows, c, buffer, sizeof buffer)));
    }
    for (int k = 0; k < lines; k++) {
        app_print("%*s", t->time_width, k + 1 < lines ? "" : "time_ms");
        for (int c = from; c < to; c++) {
            if (t->terminal) {
                print_part(t, c, k, lines);
            } else {
                app_print("%*s", t->width[c], show_joint_name(t->rows, c, buffer, sizeof buffer));
            }
        }
        app_print("\n");
    }
}

static bool is_outside(const table *t, int c, double deg)
{
    const grobo_joint *joint;
    int ddeg = grobo_ddeg_from_rad(grobo_rad_from_deg(deg));
    if (!t->rows->model || t->rows->joint[c] >= t->rows->model->n_joints) {
        return false;
    }
    if (show_is_steps(t->rows)) {
        return false;
    }
    joint = grobo_model_joint(t->rows->model, t->rows->joint[c]);
    return ddeg < grobo_ddeg_from_rad(joint->min_rad) || ddeg > grobo_ddeg_from_rad(joint->max_rad);
}

static void print_angle(const table *t, int c, const grobo_posture *posture)
{
    double deg, value;
    if (grobo_posture_get_deg(posture, t->rows->joint[c], &deg) < 0 ||
        !value_of(t->rows, c, posture, &value)) {
        app_print("%*s", t->width[c], ".");
        return;
    }
    bool red = t->a->color_out && is_outside(t, c, deg);
    app_print("%s%*.1f%s", red ? "\033[31m" : "", t->width[c], tenths(value), red ? "\033[0m" : "");
}

static void print_rows(const table *t, size_t first, size_t last, int from, int to)
{
    grobo_posture posture;
    double time_s = 0;
    print_names(t, from, to);
    for (size_t i = first; i < last && show_row(t->rows, i, &posture, &time_s) == 0; i++) {
        app_print("%*.*f", t->time_width, t->decimals, time_s * 1e3);
        for (int c = from; c < to; c++) {
            print_angle(t, c, &posture);
        }
        app_print("\n");
    }
}

void show_table(const app *a, const show_rows *rows)
{
    static table t;
    t.a = a;
    t.rows = rows;
    t.terminal = a->tty_out ? os_columns(stdout) : 0;
    measure(&t);
    bool split = fits(&t, 0) < rows->n_joints;
    for (size_t first = 0, last; first < rows->n; first = last) {
        last = split && rows->n - first > PAGE_ROWS ? first + PAGE_ROWS : rows->n;
        for (int from = 0, to; from < rows->n_joints; from = to) {
            to = fits(&t, from);
            if (first || from) {
                app_print("\n");
            }
            print_rows(&t, first, last, from, to);
        }
    }
}
