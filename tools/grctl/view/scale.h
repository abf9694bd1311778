/* SPDX-License-Identifier: MIT */
/* From seconds and values of joints to pixels, round numbers along axes, and thinning of lines. */
#ifndef GRCTL_PLOT_SCALE_H
#define GRCTL_PLOT_SCALE_H

#include "tools/grctl/view/plot.h"

typedef struct plot_scale {
    double low, high; /* what is shown */
    double pixels;    /* how long it is drawn */
    double step;      /* between ticks, 0: none */
} plot_scale;

plot_scale plot_time_scale(double length_s, double pixels);
/* Shows all of a curve, and its limits where they are near. slim: no ticks. */
plot_scale plot_angle_scale(const plot_curve *curve, double pixels, bool slim);

/* Pixels from the low end. */
double plot_scale_at(const plot_scale *scale, double value);
/* "−12.5" and a unit; whole degrees where they are. */
void plot_degrees(double angle_deg, const char *unit, char *text, size_t capacity);

/* Both axes in a box: their ticks, and the texts of the value's. zero: the class of its 0. */
void plot_grid(svg *s, const svg_box *box, const plot_scale *time, const plot_scale *value,
               const char *unit, const char *zero);
/* The texts of a time axis whose low end is at x. */
void plot_time_texts(svg *s, const plot_scale *time, double x, double y);

/* A polyline without the points that lie on the straight line between their neighbours. */
typedef struct plot_thinner {
    svg *s;
    double x, y;           /* drawn last */
    double held_x, held_y; /* seen last, not drawn yet */
    double low, high;      /* slopes that pass all points since */
    bool begun, holds;
} plot_thinner;

void plot_thin_begin(plot_thinner *t, svg *s);
void plot_thin_point(plot_thinner *t, double x, double y);
void plot_thin_end(plot_thinner *t);

#endif
