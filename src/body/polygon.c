/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "src/body/polygon.h"

/* Twice the area of the triangle o, a, b; positive if it turns left. */
static double turn(const double o[2], const double a[2], const double b[2])
{
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
}

static bool left_of(const double a[2], const double b[2])
{
    return a[0] < b[0] || (!(b[0] < a[0]) && a[1] < b[1]);
}

static void sort_points(double (*points)[2], int n)
{
    for (int i = 1; i < n; i++) {
        for (int k = i; k > 0 && left_of(points[k], points[k - 1]); k--) {
            double kept[2];

            memcpy(kept, points[k], sizeof kept);
            memcpy(points[k], points[k - 1], sizeof kept);
            memcpy(points[k - 1], kept, sizeof kept);
        }
    }
}

/* Andrew's monotone chain: the lower side from left to right, then the upper one back. */
int grobo_i_convex_hull(double (*points)[2], int n, double (*hull)[2])
{
    int size = 0;

    sort_points(points, n);
    for (int side = 0; side < 2; side++) {
        const int start = size;

        for (int k = 0; k < n; k++) {
            const double *p = points[side == 0 ? k : n - 1 - k];

            while (size >= start + 2 && turn(hull[size - 2], hull[size - 1], p) <= 0) {
                size--;
            }
            memcpy(hull[size++], p, sizeof *hull);
        }
        size--; /* the end of one side begins the other */
    }
    return size;
}

static double segment_distance(const double a[2], const double b[2], const double p[2])
{
    const double along[2] = {b[0] - a[0], b[1] - a[1]};
    const double square = along[0] * along[0] + along[1] * along[1];
    double part = 0;

    if (square > 0) {
        part = ((p[0] - a[0]) * along[0] + (p[1] - a[1]) * along[1]) / square;
        part = fmin(1, fmax(0, part));
    }
    return hypot(p[0] - a[0] - part * along[0], p[1] - a[1] - part * along[1]);
}

double grobo_i_polygon_margin(double (*hull)[2], int n, const double point[2])
{
    double nearest = INFINITY;
    bool inside = n >= 3;

    for (int i = 0; i < n; i++) {
        const double *a = hull[i];
        const double *b = hull[(i + 1) % n];

        nearest = fmin(nearest, segment_distance(a, b, point));
        inside = inside && turn(a, b, point) >= 0;
    }
    return inside ? nearest : -nearest;
}
