/* SPDX-License-Identifier: MIT */
/*
 * A thread before the others: its priority, its CPUs, its memory. Priority and memory are POSIX;
 * CPUs and what a new process gets of the priority are Linux. The other systems' answer for these
 * is at the end.
 */
#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include "ports/posix/posix.h"

enum { PRIORITY_MAX = 99 };

/* Of the policy, for the calling thread: what it gives on to new processes is taken away. */
static int policy_of(grobo_realtime_policy policy);

/* The CPUs of the calling thread. */
static int set_cpus(uint64_t cpus);

static bool is_sound(const grobo_realtime *how)
{
    switch (how->policy) {
    case GROBO_REALTIME_NONE:
        return how->priority == 0;
    case GROBO_REALTIME_FIFO:
    case GROBO_REALTIME_RR:
        return how->priority >= 1 && how->priority <= PRIORITY_MAX;
    }
    return false;
}

/*
 * What is allocated later counts too, and where a limit stands between, an allocation would fail
 * in the midst of a motion: without a limit or not at all.
 */
static int lock_memory(void)
{
    struct rlimit limit;

    if (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
        limit.rlim_cur = limit.rlim_max = RLIM_INFINITY;
        if (setrlimit(RLIMIT_MEMLOCK, &limit) != 0) {
            return GROBO_ERR_PERM;
        }
    }
    if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
        return errno == ENOSYS ? GROBO_ERR_UNSUPPORTED : grobo_i_posix_error(errno);
    }
    return GROBO_OK;
}

static int set_policy(const grobo_realtime *how)
{
    struct sched_param param = {.sched_priority = how->priority};
    int code = pthread_setschedparam(pthread_self(), policy_of(how->policy), &param);

    if (code == ENOTSUP || code == EINVAL || code == ENOSYS) {
        return GROBO_ERR_UNSUPPORTED; /* a system with fewer priorities, or without any */
    }
    return code == 0 ? GROBO_OK : grobo_i_posix_error(code);
}

int grobo_thread_realtime(const grobo_realtime *how)
{
    int r = GROBO_OK;

    if (how == NULL || !is_sound(how)) {
        return GROBO_ERR_ARG;
    }
    if (how->mlock) {
        r = lock_memory();
    }
    if (r >= 0 && how->cpus != 0) {
        r = set_cpus(how->cpus);
    }
    if (r >= 0 && how->policy != GROBO_REALTIME_NONE) {
        r = set_policy(how);
    }
    return r;
}

static int plain_policy(grobo_realtime_policy policy)
{
    return policy == GROBO_REALTIME_RR ? SCHED_RR : SCHED_FIFO;
}

#ifdef __linux__

#include <sys/syscall.h>
#include <unistd.h>

/* Of the kernel, in headers with _GNU_SOURCE only: sched(7). */
enum { RESET_ON_FORK = 0x40000000 };

static int policy_of(grobo_realtime_policy policy)
{
    return plain_policy(policy) | RESET_ON_FORK;
}

/* Words of the kernel's are unsigned long; bits beyond its own CPUs are ignored. */
static int set_words(uint64_t cpus)
{
    unsigned long words[sizeof cpus / sizeof(unsigned long)];

    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        words[i] = (unsigned long)(cpus >> (i * sizeof words[0] * CHAR_BIT));
    }
    return (int)syscall(SYS_sched_setaffinity, 0, sizeof words, words);
}

static int set_cpus(uint64_t cpus)
{
    if (set_words(cpus) == 0) {
        return GROBO_OK;
    }
    return errno == EINVAL ? GROBO_ERR_NOTFOUND : grobo_i_posix_error(errno);
}

void grobo_i_posix_take_every_cpu(void)
{
    (void)set_words(UINT64_MAX);
}

#else

static int policy_of(grobo_realtime_policy policy)
{
    return plain_policy(policy);
}

static int set_cpus(uint64_t cpus)
{
    (void)cpus;
    return GROBO_ERR_UNSUPPORTED;
}

void grobo_i_posix_take_every_cpu(void)
{
}

#endif
