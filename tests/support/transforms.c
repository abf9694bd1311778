/* SPDX-License-Identifier: MIT */
#include <math.h>

#include "tests/support/transforms.h"

double transforms_apart(const grobo_transform *a, const grobo_transform *b)
{
    double worst = 0;

    for (int i = 0; i < 3; i++) {
        worst = fmax(worst, fabs(a->p_m[i] - b->p_m[i]));
    }
    for (int i = 0; i < 9; i++) {
        worst = fmax(worst, fabs(a->r[i] - b->r[i]));
    }
    return worst;
}
