/* SPDX-License-Identifier: MIT */
#ifndef GROBO_TESTS_TRANSFORMS_H
#define GROBO_TESTS_TRANSFORMS_H

#include <grobo/core/body.h>

/* Largest difference of position and of attitude. */
double transforms_apart(const grobo_transform *a, const grobo_transform *b);

#endif
