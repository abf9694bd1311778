/* SPDX-License-Identifier: MIT */
/*
 * Virtual time for a test program of one thread whose robot is in the same event loop: the clock
 * moves on when that loop would sleep, so that what takes minutes is over at once, and a busy
 * machine makes nothing late. Definitions, for one file of the program: they take the place of
 * those of the C library, also for libevent, which gets no timer of the kernel. Where the
 * Makefile does not define GROBO_VIRTUAL_CLOCK (64-bit Linux with glibc) time is real.
 */
#ifndef GROBO_TESTS_VIRTUAL_CLOCK_H
#define GROBO_TESTS_VIRTUAL_CLOCK_H

#ifdef GROBO_VIRTUAL_CLOCK

#include <errno.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/epoll.h>
#include <sys/syscall.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

enum { VIRTUAL_TICK_NS = 1000 }; /* of each look at the clock: a loop that only looks ends */

/* Seen by shared libraries; weak, so that programs of several such files can be made (mutants). */
#define VIRTUAL __attribute__((weak, visibility("default")))

static int64_t virtual_ns = INT64_C(1000000000000);

VIRTUAL int clock_gettime(clockid_t clock, struct timespec *now)
{
    if (clock == CLOCK_REALTIME) {
        return (int)syscall(SYS_clock_gettime, clock, now);
    }
    virtual_ns += VIRTUAL_TICK_NS;
    now->tv_sec = virtual_ns / 1000000000;
    now->tv_nsec = virtual_ns % 1000000000;
    return 0;
}

VIRTUAL int timerfd_create(int clock, int flags)
{
    (void)clock;
    (void)flags;
    errno = EINVAL;
    return -1;
}

VIRTUAL int epoll_wait(int epoll, struct epoll_event *events, int most, int timeout_ms)
{
    int real_ms = timeout_ms > 0 ? 0 : timeout_ms;
    int n = (int)syscall(SYS_epoll_pwait, epoll, events, most, real_ms, NULL, 8);

    if (n == 0 && timeout_ms > 0) {
        virtual_ns += (int64_t)timeout_ms * 1000000;
    }
    return n;
}

#endif

#endif
