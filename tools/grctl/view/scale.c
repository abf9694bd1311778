/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>

#include <grobo/core/unit.h>

#include "tools/grctl/view/scale.h"

/* A line may pass so far from a point it leaves out. */
static const double thin_px = 0.06;

/* ---- axes ---------------------------------------------------------------------------------- */

/* 1, 2 or 5 times a power of ten, at least `least`. */
static double round_step(double least)
{
    double power = pow(10, floor(log10(least)));
    double part = least / power;
    return power * (part <= 1 ? 1 : part <= 2 ? 2 : part <= 5 ? 5 : 10);
}

/* As people divide a circle. */
static double angle_step(double least_deg)
{
    static const double steps[] = {10, 15, 30, 45, 60, 90, 180, 360};
    if (least_deg <= 5) {
        return round_step(least_deg);
    }
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        if (steps[i] >= least_deg) {
            return steps[i];
        }
    }
    return 360 * round_step(least_deg / 360);
}

plot_scale plot_time_scale(double length_s, double pixels)
{
    double high = length_s > 0 ? length_s : 1;
    return (plot_scale){0, high, pixels, round_step(high * 52 / pixels)};
}

/* Takes a limit into the picture when it is near what is shown. */
static void take_limit(plot_scale *scale, double limit_deg, double span_deg)
{
    if (limit_deg < scale->low && limit_deg > scale->low - span_deg * 0.3) {
        scale->low = limit_deg;
    }
    if (limit_deg > scale->high && limit_deg < scale->high + span_deg * 0.3) {
        scale->high = limit_deg;
    }
}

plot_scale plot_angle_scale(const plot_curve *curve, double pixels, bool slim)
{
    enum { LEAST = 20 }; /* degrees, mm or percent */
    double first = plot_value(curve, curve->min_deg), last = plot_value(curve, curve->max_deg);
    double span = fmax(fabs(last - first), LEAST), middle = (first + last) / 2;
    plot_scale scale = {middle - span / 2, middle + span / 2, pixels, 0};
    if (curve->limits && !slim) {
        take_limit(&scale, plot_value(curve, grobo_deg_from_rad(curve->limits->min_rad)), span);
        take_limit(&scale, plot_value(curve, grobo_deg_from_rad(curve->limits->max_rad)), span);
    }
    span = scale.high - scale.low;
    scale.low -= span * 0.08;
    scale.high += span * 0.08;
    if (!slim) {
        double least = (scale.high - scale.low) * 20 / pixels;
        bool in_deg =
            !curve->model || grobo_model_unit(curve->model, curve->joint) == GROBO_UNIT_DEG;
        scale.step = in_deg ? angle_step(least) : round_step(least);
    }
    return scale;
}

double plot_scale_at(const plot_scale *scale, double value)
{
    return (value - scale->low) / (scale->high - scale->low) * scale->pixels;
}

static int ticks(const plot_scale *scale)
{
    if (scale->step <= 0) {
        return 0;
    }
    return (int)(floor(scale->high / scale->step + 1e-9) - ceil(scale->low / scale->step - 1e-9)) +
           1;
}

static double tick_at(const plot_scale *scale, int i)
{
    double tick = (ceil(scale->low / scale->step - 1e-9) + i) * scale->step;
    return tick == 0 ? 0 : tick; /* no -0 */
}

/* A number with a true minus sign. */
static void format(double value, int decimals, const char *unit, char *text, size_t capacity)
{
    char digits[24]; /* what is longer is no label */
    snprintf(digits, sizeof digits, "%.*f", decimals, fabs(value));
    snprintf(text, capacity, "%s%s%s", value < 0 ? "−" : "", digits, unit);
}

/* A tick's value as text with the decimals its step needs. */
static void tick_text(const plot_scale *scale, double value, const char *unit, char *text,
                      size_t capacity)
{
    int decimals = (int)ceil(-log10(scale->step) - 1e-9);
    format(value, decimals > 0 ? decimals : 0, unit, text, capacity);
}

void plot_degrees(double angle_deg, const char *unit, char *text, size_t capacity)
{
    double tenths = round(angle_deg * 10) / 10;
    format(tenths, tenths == round(tenths) ? 0 : 1, unit, text, capacity);
}

void plot_grid(svg *s, const svg_box *box, const plot_scale *time, const plot_scale *value,
               const char *unit, const char *zero)
{
    for (int i = 0; i < ticks(time); i++) {
        double x = box->x + plot_scale_at(time, tick_at(time, i));
        svg_line(s, "grid", x, box->y, x, box->y + box->height);
    }
    for (int i = 0; i < ticks(value); i++) {
        char text[32];
        double tick = tick_at(value, i);
        double y = box->y + box->height - plot_scale_at(value, tick);
        tick_text(value, tick, unit, text, sizeof text);
        svg_line(s, tick == 0 ? zero : "grid", box->x, y, box->x + box->width, y);
        svg_text(s, "tick", box->x - 5, y + 3.5, "end", text);
    }
}

void plot_time_texts(svg *s, const plot_scale *time, double x, double y)
{
    for (int i = 0; i < ticks(time); i++) {
        char text[32];
        double tick = tick_at(time, i);
        tick_text(time, tick, " s", text, sizeof text);
        svg_text(s, "tick", x + plot_scale_at(time, tick), y, "middle", text);
    }
}

/* ---- thinning ------------------------------------------------------------------------------ */

void plot_thin_begin(plot_thinner *t, svg *s)
{
    *t = (plot_thinner){.s = s};
}

static void draw(plot_thinner *t, double x, double y)
{
    svg_point(t->s, x, y);
    t->x = x;
    t->y = y;
    t->low = -INFINITY;
    t->high = INFINITY;
    t->begun = true;
    t->holds = false;
}

/* True if a line from the last drawn point to here passes every point between. */
static bool reaches(const plot_thinner *t, double x, double y)
{
    double slope = (y - t->y) / (x - t->x);
    return x > t->x && slope >= t->low && slope <= t->high;
}

void plot_thin_point(plot_thinner *t, double x, double y)
{
    if (!t->begun) {
        draw(t, x, y);
        return;
    }
    if (t->holds && !reaches(t, x, y)) {
        draw(t, t->held_x, t->held_y);
    }
    if (x > t->x) {
        t->low = fmax(t->low, (y - thin_px - t->y) / (x - t->x));
        t->high = fmin(t->high, (y + thin_px - t->y) / (x - t->x));
    }
    t->held_x = x;
    t->held_y = y;
    t->holds = true;
}

void plot_thin_end(plot_thinner *t)
{
    if (t->holds) {
        draw(t, t->held_x, t->held_y);
    }
}
