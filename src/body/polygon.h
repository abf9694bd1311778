/* SPDX-License-Identifier: MIT */
/* Convex polygons in the plane. */
#ifndef GROBO_SRC_BODY_POLYGON_H
#define GROBO_SRC_BODY_POLYGON_H

#include <stdbool.h>

/* Convex hull of n >= 1 points, which are sorted. hull: room for 2 n + 1 points, counter-clockwise.
 * Returns how many there are. */
int grobo_i_convex_hull(double (*points)[2], int n, double (*hull)[2]);

/* Distance to the nearest edge, positive inside, negative outside. */
double grobo_i_polygon_margin(double (*hull)[2], int n, const double point[2]);

#endif
