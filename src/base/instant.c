/* SPDX-License-Identifier: MIT */
#include "src/base/instant.h"

int64_t grobo_i_later(int64_t a_us, int64_t b_us)
{
    return a_us > b_us ? a_us : b_us;
}

int64_t grobo_i_sooner(int64_t a_us, int64_t b_us)
{
    return a_us < b_us ? a_us : b_us;
}
