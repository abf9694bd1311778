/* SPDX-License-Identifier: MIT */
/* Two instants compared: functions where a word has 32 bits, since the comparison is long there. */
#ifndef GROBO_CORE_INSTANT_H
#define GROBO_CORE_INSTANT_H

#include <stdint.h>

#if SIZE_MAX > UINT32_MAX
#define GROBO_I_INSTANT static inline
#else
#define GROBO_I_INSTANT
int64_t grobo_i_later(int64_t a_us, int64_t b_us);
int64_t grobo_i_sooner(int64_t a_us, int64_t b_us);
#endif

#if SIZE_MAX > UINT32_MAX || defined(GROBO_I_INSTANT_HERE)
GROBO_I_INSTANT int64_t grobo_i_later(int64_t a_us, int64_t b_us)
{
    return a_us > b_us ? a_us : b_us;
}

GROBO_I_INSTANT int64_t grobo_i_sooner(int64_t a_us, int64_t b_us)
{
    return a_us < b_us ? a_us : b_us;
}
#endif

#endif
