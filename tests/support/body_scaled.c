/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tests/support/body_scaled.h"
#include "tests/support/tables.h"

void body_scaled_init(struct body_scaled *scaled, double length, double mass)
{
    scaled->model = grobo_i_gr001_body;
    scaled->model.name = "scaled";
    scaled->model.links = scaled->links;
    memcpy(scaled->links, grobo_i_gr001_body.links, sizeof scaled->links);
    for (int i = 0; i < 21; i++) {
        grobo_body_link *link = &scaled->links[i];

        link->mass_kg *= mass;
        for (int k = 0; k < 3; k++) {
            link->offset_m[k] *= length;
            link->com_m[k] *= length;
        }
        for (int k = 0; k < 9; k++) {
            link->inertia_kgm2[k] *= mass * length * length;
        }
    }
    for (int foot = 0; foot < 2; foot++) {
        for (int k = 0; k < 3; k++) {
            scaled->model.feet[foot].sole_m[k] *= length;
        }
        scaled->model.feet[foot].half_m[0] *= length;
        scaled->model.feet[foot].half_m[1] *= length;
    }
}
