/* SPDX-License-Identifier: MIT */
/* Numbers that look random and are the same in every run. */
#ifndef GROBO_TESTS_NEXT_RANDOM_H
#define GROBO_TESTS_NEXT_RANDOM_H

#include <stdint.h>

/* 24 bits: 0..16777215. */
uint32_t next_random(uint32_t *seed);

#endif
