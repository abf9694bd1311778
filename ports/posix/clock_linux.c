/* SPDX-License-Identifier: MIT */
/*
 * The clock. That of Linux stands still while the machine sleeps unless it is this one: a motion
 * would go on hours later as if no time had passed.
 */
#include <time.h>

#include "ports/posix/posix.h"

#ifdef __linux__
#define SLEEPLESS CLOCK_BOOTTIME
#else
#define SLEEPLESS CLOCK_MONOTONIC
#endif

int64_t grobo_i_posix_us(clockid_t clock)
{
    struct timespec now;

    /* Cannot fail: POSIX systems without the clock do not compile this. */
    (void)clock_gettime(clock, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

int64_t grobo_now_us(void)
{
    return grobo_i_posix_us(SLEEPLESS);
}
