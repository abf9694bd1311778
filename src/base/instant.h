/* SPDX-License-Identifier: MIT */
/* Two instants compared: functions, because the comparison is long where a word has 32 bits. */
#ifndef GROBO_CORE_INSTANT_H
#define GROBO_CORE_INSTANT_H

#include <stdint.h>

int64_t grobo_i_later(int64_t a_us, int64_t b_us);
int64_t grobo_i_sooner(int64_t a_us, int64_t b_us);

#endif
