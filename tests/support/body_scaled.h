/* SPDX-License-Identifier: MIT */
/* Another humanoid with the same structure: GR001 scaled, in a table a test may change. */
#ifndef GROBO_TESTS_BODY_SCALED_H
#define GROBO_TESTS_BODY_SCALED_H

#include <grobo/core/body.h>

struct body_scaled {
    grobo_body_model model;
    grobo_body_link links[21];
};

/* Lengths times `length`, masses times `mass`. */
void body_scaled_init(struct body_scaled *scaled, double length, double mass);

#endif
