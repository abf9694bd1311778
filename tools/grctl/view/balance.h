/* SPDX-License-Identifier: MIT */
/* Whether the robot will fall: soles, ZMP and centre of mass from above, the margin over time. */
#ifndef GRCTL_PLOT_BALANCE_H
#define GRCTL_PLOT_BALANCE_H

#include <grobo/core/body.h>

#include "tools/grctl/view/svg.h"

/* One frame; metres, x ahead, y to the left. */
typedef struct plot_balance_point {
    double t_s, com_m[2], zmp_m[2];
    double margin_m; /* ZMP inside the standing soles; meaningful while a foot stands */
    bool standing[2];
} plot_balance_point;

/* Where a foot came to stand. */
typedef struct plot_sole {
    int foot; /* 0 right, 1 left */
    double corner_m[4][2];
} plot_sole;

enum { PLOT_SOLES_MOST = 256, PLOT_BALANCE_HEIGHT = 352 };

typedef struct plot_balance {
    plot_balance_point *points;
    size_t n_points, capacity;
    plot_sole soles[PLOT_SOLES_MOST];
    int n_soles;
    bool stands_always, stands_ever;
    size_t worst; /* the point with the smallest margin; meaningful with stands_ever */
    bool assumed; /* no targets: both feet are taken to stand */
    int n_problems;
} plot_balance;

/* How often a body is looked at for a motion so long, frames a second. */
double plot_balance_rate(double length_s);
/* Solves every frame of the body. Returns 0 or a library error. plot_balance_free() in any case. */
int plot_balance_collect(plot_balance *balance, grobo_body *body, bool assumed);
void plot_balance_free(plot_balance *balance);

/* Draws it from y on, PLOT_BALANCE_HEIGHT high. */
void plot_balance_draw(svg *s, const plot_balance *balance, double length_s, double y);

#endif
