/* SPDX-License-Identifier: MIT */
/* Clock, threads, locks, waiting for a socket. */
#include <process.h>

#include "ports/win32/win32.h"

int64_t grobo_now_us(void)
{
    LARGE_INTEGER rate;
    LARGE_INTEGER now;

    /* Neither fails on Windows XP and later. */
    (void)QueryPerformanceFrequency(&rate);
    (void)QueryPerformanceCounter(&now);
    /* In two parts: the product of both would overflow after days. */
    return now.QuadPart / rate.QuadPart * 1000000 +
           now.QuadPart % rate.QuadPart * 1000000 / rate.QuadPart;
}

/* ---- threads ------------------------------------------------------------------------------ */

/* What a new thread takes over from the one that starts it. */
typedef struct {
    grobo_thread_fn fn;
    void *arg;
    HANDLE taken;
} start;

static unsigned __stdcall run(void *arg)
{
    start mine = *(const start *)arg;

    SetEvent(mine.taken);
    mine.fn(mine.arg);
    return 0;
}

int grobo_thread_start(grobo_thread *thread, grobo_thread_fn fn, void *arg)
{
    start its = {.fn = fn, .arg = arg};
    uintptr_t made;

    if (thread == NULL || fn == NULL) {
        return GROBO_ERR_ARG;
    }
    its.taken = CreateEventA(NULL, TRUE, FALSE, NULL);
    if (its.taken == NULL) {
        return GROBO_ERR_NOMEM;
    }
    made = _beginthreadex(NULL, 0, run, &its, CREATE_SUSPENDED, NULL);
    if (made != 0) {
        /* Known before it runs: its function may ask grobo_thread_is_self(). */
        *thread = (HANDLE)made;
        (void)ResumeThread((HANDLE)made);
        (void)WaitForSingleObject(its.taken, INFINITE);
    }
    CloseHandle(its.taken);
    return made != 0 ? GROBO_OK : GROBO_ERR_NOMEM;
}

int grobo_thread_join(grobo_thread thread)
{
    if (grobo_thread_is_self(thread) || WaitForSingleObject(thread, INFINITE) != WAIT_OBJECT_0) {
        return GROBO_ERR_STATE;
    }
    CloseHandle(thread);
    return GROBO_OK;
}

bool grobo_thread_is_self(grobo_thread thread)
{
    return GetThreadId(thread) == GetCurrentThreadId();
}

/* Windows has one priority above all others, and no such lock of a process's memory. */
int grobo_thread_realtime(const grobo_realtime *how)
{
    enum { PRIORITY_MAX = 99 };
    bool prior = how != NULL && how->policy != GROBO_REALTIME_NONE;

    if (how == NULL || how->policy > GROBO_REALTIME_RR ||
        (prior ? how->priority < 1 || how->priority > PRIORITY_MAX : how->priority != 0)) {
        return GROBO_ERR_ARG;
    }
    if (how->mlock) {
        return GROBO_ERR_UNSUPPORTED;
    }
    if (how->cpus != 0 && SetThreadAffinityMask(GetCurrentThread(), (DWORD_PTR)how->cpus) == 0) {
        return GROBO_ERR_NOTFOUND;
    }
    if (prior && !SetThreadPriority(GetCurrentThread(), THREAD_PRIORITY_TIME_CRITICAL)) {
        return GROBO_ERR_PERM;
    }
    return GROBO_OK;
}

/* ---- locks -------------------------------------------------------------------------------- */

_Static_assert(sizeof(grobo_mutex) == sizeof(SRWLOCK), "port_os.h has room for an SRWLOCK");

int grobo_mutex_init(grobo_mutex *mutex)
{
    if (mutex == NULL) {
        return GROBO_ERR_ARG;
    }
    InitializeSRWLock((SRWLOCK *)mutex);
    return GROBO_OK;
}

void grobo_mutex_lock(grobo_mutex *mutex)
{
    if (mutex != NULL) {
        AcquireSRWLockExclusive((SRWLOCK *)mutex);
    }
}

void grobo_mutex_unlock(grobo_mutex *mutex)
{
    if (mutex != NULL) {
        ReleaseSRWLockExclusive((SRWLOCK *)mutex);
    }
}

void grobo_mutex_deinit(grobo_mutex *mutex)
{
    /* Such a lock has nothing to give back. */
    (void)mutex;
}

/* ---- conditions --------------------------------------------------------------------------- */

_Static_assert(sizeof(grobo_cond) == sizeof(CONDITION_VARIABLE),
               "port_os.h has room for a CONDITION_VARIABLE");

int grobo_cond_init(grobo_cond *cond)
{
    if (cond == NULL) {
        return GROBO_ERR_ARG;
    }
    InitializeConditionVariable((CONDITION_VARIABLE *)cond);
    return GROBO_OK;
}

void grobo_cond_wait(grobo_cond *cond, grobo_mutex *mutex, int64_t until_us)
{
    const int64_t most_ms = 3600000;
    int64_t span_us = until_us - grobo_now_us();

    if (cond != NULL && mutex != NULL && span_us > 0) {
        int64_t span_ms = (span_us - 1) / 1000 + 1;

        (void)SleepConditionVariableSRW((CONDITION_VARIABLE *)cond, (SRWLOCK *)mutex,
                                        (DWORD)(span_ms < most_ms ? span_ms : most_ms), 0);
    }
}

void grobo_cond_wake_all(grobo_cond *cond)
{
    if (cond != NULL) {
        WakeAllConditionVariable((CONDITION_VARIABLE *)cond);
    }
}

void grobo_cond_deinit(grobo_cond *cond)
{
    /* Such a condition has nothing to give back. */
    (void)cond;
}

/* ---- waiting ------------------------------------------------------------------------------ */

/* Asks once, for at most span_us. Returns the ready ones of `what`, 0 none, or GROBO_ERR_IO. */
static int wait_once(SOCKET of, unsigned what, int64_t span_us)
{
    fd_set readable;
    fd_set writable;
    fd_set failed; /* a connection that was refused is reported here alone */
    struct timeval tv = {(long)(span_us / 1000000), (long)(span_us % 1000000)};

    FD_ZERO(&readable);
    FD_ZERO(&writable);
    FD_ZERO(&failed);
    FD_SET(of, &failed);
    if ((what & GROBO_PORT_READABLE) != 0) {
        FD_SET(of, &readable);
    }
    if ((what & GROBO_PORT_WRITABLE) != 0) {
        FD_SET(of, &writable);
    }
    if (select(0, &readable, &writable, &failed, &tv) == SOCKET_ERROR) {
        return GROBO_ERR_IO;
    }
    if (FD_ISSET(of, &failed)) {
        return (int)what;
    }
    return (FD_ISSET(of, &readable) ? (int)GROBO_PORT_READABLE : 0) |
           (FD_ISSET(of, &writable) ? (int)GROBO_PORT_WRITABLE : 0);
}

int grobo_port_wait(grobo_socket socket, unsigned what, int64_t timeout_us)
{
    const int64_t most_us = INT64_C(3600000000);
    int64_t begin_us = grobo_now_us();
    int64_t end_us = timeout_us <= 0                          ? begin_us
                     : timeout_us < GROBO_NEVER_US - begin_us ? begin_us + timeout_us
                                                              : GROBO_NEVER_US;
    int64_t rest_us = end_us - begin_us;
    int ready;

    /* select() counts ticks of the system and may be early by one. */
    do {
        rest_us = rest_us < 0 ? 0 : rest_us > most_us ? most_us : rest_us;
        ready = wait_once((SOCKET)socket, what, rest_us);
        rest_us = end_us - grobo_now_us();
    } while (ready == 0 && rest_us > 0);
    return ready;
}
