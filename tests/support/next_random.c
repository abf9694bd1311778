/* SPDX-License-Identifier: MIT */
#include "tests/support/next_random.h"

uint32_t next_random(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u; /* Numerical Recipes */
    return *seed >> 8;
}
