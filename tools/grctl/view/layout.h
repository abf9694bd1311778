/* SPDX-License-Identifier: MIT */
/* Where everything of a plot stands. Lengths are pixels, y grows downwards. */
#ifndef GRCTL_PLOT_LAYOUT_H
#define GRCTL_PLOT_LAYOUT_H

#include "tools/grctl/view/plot.h"

enum {
    PLOT_WIDTH = 960,
    PLOT_MARGIN = 28,
    PLOT_GUTTER = 40, /* left of a panel, for the angles */
    PLOT_GAP = 20,    /* between the two columns */
    PLOT_HEAD = 104,  /* title, summary and legend */
    PLOT_NAME = 17,   /* above a panel, for its name */
    PLOT_SECTIONS = 2 * 3
};

/* The plotting area of one joint. */
typedef struct plot_panel {
    const plot_curve *curve;
    const char *side; /* class that tells the colour */
    svg_box box;
    bool slim; /* a joint that stands still: a strip without angles */
} plot_panel;

/* A heading and the time axis of a column of panels. */
typedef struct plot_section {
    const char *title, *side;
    double x, y;           /* of the heading */
    double axis_y;         /* bottom of the last panel */
    double plot_x, plot_w; /* extent of the time axis; width 0: no axis */
} plot_section;

typedef struct plot_layout {
    double height;
    int n_panels, n_sections;
    plot_panel panels[GROBO_JOINTS_MAX];
    plot_section sections[PLOT_SECTIONS];
} plot_layout;

void plot_arrange(plot_layout *layout, const plot_data *data);
/* True if the joint does not move as far as a picture shows. */
bool plot_is_still(const plot_curve *curve);

#endif
