/* SPDX-License-Identifier: MIT */
/* Threads, locks, waiting for a descriptor. */
#include <errno.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/select.h>
#include <termios.h>
#include <time.h>
#include <unistd.h> /* says whether locks inherit priorities */

#include "ports/posix/posix.h"

int grobo_port_start(void)
{
    return GROBO_OK;
}

int grobo_thread_start(grobo_thread *thread, grobo_thread_fn fn, void *arg)
{
    sigset_t all;
    sigset_t before;
    grobo_thread made;
    int r;

    if (thread == NULL || fn == NULL) {
        return GROBO_ERR_ARG;
    }
    sigfillset(&all);
    /* A new thread inherits the mask: with all blocked, signals stay with the program's own. */
    pthread_sigmask(SIG_SETMASK, &all, &before);
    r = pthread_create(&made, NULL, fn, arg);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (r != 0) {
        return GROBO_ERR_NOMEM;
    }
    *thread = made;
    return GROBO_OK;
}

int grobo_thread_join(grobo_thread thread)
{
    if (grobo_thread_is_self(thread)) {
        return GROBO_ERR_STATE;
    }
    return pthread_join(thread, NULL) == 0 ? GROBO_OK : GROBO_ERR_STATE;
}

bool grobo_thread_is_self(grobo_thread thread)
{
    return pthread_equal(thread, pthread_self()) != 0;
}

int grobo_mutex_init(grobo_mutex *mutex)
{
    if (mutex == NULL) {
        return GROBO_ERR_ARG;
    }
    pthread_mutexattr_t how;
    int r = pthread_mutexattr_init(&how);

    if (r == 0) {
/* musl has it and does not say so in unistd.h; glibc has no macro of this name. */
#if defined(PTHREAD_PRIO_INHERIT) ||                                                               \
    (defined(_POSIX_THREAD_PRIO_INHERIT) && _POSIX_THREAD_PRIO_INHERIT > 0)
        (void)pthread_mutexattr_setprotocol(&how, PTHREAD_PRIO_INHERIT);
#endif
        r = pthread_mutex_init(mutex, &how);
        (void)pthread_mutexattr_destroy(&how);
    }
    return r == 0 ? GROBO_OK : GROBO_ERR_NOMEM;
}

void grobo_mutex_lock(grobo_mutex *mutex)
{
    if (mutex != NULL) {
        (void)pthread_mutex_lock(mutex);
    }
}

void grobo_mutex_unlock(grobo_mutex *mutex)
{
    if (mutex != NULL) {
        (void)pthread_mutex_unlock(mutex);
    }
}

void grobo_mutex_deinit(grobo_mutex *mutex)
{
    if (mutex != NULL) {
        (void)pthread_mutex_destroy(mutex);
    }
}

/* ---- conditions --------------------------------------------------------------------------- */

/* Longest sleep at once; whoever sleeps looks again after it. */
#define SLEEP_MAX_US INT64_C(3600000000)

static struct timespec timespec_of(int64_t us)
{
    struct timespec made = {.tv_sec = (time_t)(us / 1000000),
                            .tv_nsec = (long)(us % 1000000) * 1000};

    return made;
}

#ifdef __APPLE__
/* A condition there knows no clock but the date, and takes a span instead. */
static int make_cond(grobo_cond *cond)
{
    return pthread_cond_init(cond, NULL);
}

static void sleep_at(grobo_cond *cond, grobo_mutex *mutex, int64_t span_us)
{
    struct timespec span = timespec_of(span_us);

    (void)pthread_cond_timedwait_relative_np(cond, mutex, &span);
}
#else
static int make_cond(grobo_cond *cond)
{
    pthread_condattr_t how;
    int r = pthread_condattr_init(&how);

    if (r == 0) {
        r = pthread_condattr_setclock(&how, CLOCK_MONOTONIC);
        if (r == 0) {
            r = pthread_cond_init(cond, &how);
        }
        (void)pthread_condattr_destroy(&how);
    }
    return r;
}

/* By the clock of conditions, which is not that of grobo_now_us() everywhere. */
static void sleep_at(grobo_cond *cond, grobo_mutex *mutex, int64_t span_us)
{
    struct timespec until = timespec_of(grobo_i_posix_us(CLOCK_MONOTONIC) + span_us);

    (void)pthread_cond_timedwait(cond, mutex, &until);
}
#endif

int grobo_cond_init(grobo_cond *cond)
{
    if (cond == NULL) {
        return GROBO_ERR_ARG;
    }
    return make_cond(cond) == 0 ? GROBO_OK : GROBO_ERR_NOMEM;
}

void grobo_cond_wait(grobo_cond *cond, grobo_mutex *mutex, int64_t until_us)
{
    int64_t span_us = until_us - grobo_now_us();

    if (cond != NULL && mutex != NULL && span_us > 0) {
        sleep_at(cond, mutex, span_us < SLEEP_MAX_US ? span_us : SLEEP_MAX_US);
    }
}

void grobo_cond_wake_all(grobo_cond *cond)
{
    if (cond != NULL) {
        (void)pthread_cond_broadcast(cond);
    }
}

void grobo_cond_deinit(grobo_cond *cond)
{
    if (cond != NULL) {
        (void)pthread_cond_destroy(cond);
    }
}

/* ---- waiting for a descriptor ------------------------------------------------------------- */

/* A number of one type, which the systems' own is not. */
enum { SET_SIZE = FD_SETSIZE };

/* Notes who is asked about an event. The highest descriptor, -1: none, SET_SIZE: too high. */
static int choose(const struct pollfd *what, int n, short event, fd_set *chosen)
{
    int most = -1;

    FD_ZERO(chosen);
    for (int i = 0; i < n; i++) {
        if (what[i].fd >= SET_SIZE) {
            return SET_SIZE;
        }
        if (what[i].fd >= 0 && (what[i].events & event) != 0) {
            FD_SET(what[i].fd, chosen);
            most = what[i].fd > most ? what[i].fd : most;
        }
    }
    return most;
}

static bool is_hung_up(int fd)
{
    int left;

    return ioctl(fd, TIOCOUTQ, &left) != 0 && errno == EIO;
}

/* select() for poll(): who is asked about no event is looked at for a hang-up, at the end. */
static int select_each(struct pollfd *what, int n, int limit_ms)
{
    struct timeval span = {limit_ms / 1000, limit_ms % 1000 * 1000};
    fd_set in;
    fd_set out;
    int to_read = choose(what, n, POLLIN, &in);
    int to_write = choose(what, n, POLLOUT, &out);
    int most = to_read > to_write ? to_read : to_write;
    int ready =
        most < SET_SIZE ? select(most + 1, &in, &out, NULL, limit_ms < 0 ? NULL : &span) : -1;

    for (int i = 0; i < n; i++) {
        what[i].revents = 0;
        if (ready >= 0 && what[i].fd >= 0) {
            what[i].revents = (short)((FD_ISSET(what[i].fd, &in) ? POLLIN : 0) |
                                      (FD_ISSET(what[i].fd, &out) ? POLLOUT : 0));
        }
        if (ready >= 0 && what[i].events == 0 && is_hung_up(what[i].fd)) {
            what[i].revents = POLLHUP;
            ready++;
        }
    }
    return ready;
}

int grobo_i_posix_poll(struct pollfd *what, int n, int limit_ms)
{
    int ready = poll(what, (nfds_t)n, limit_ms);

    return ready < 0 && errno == EINVAL ? select_each(what, n, limit_ms) : ready;
}

int grobo_port_wait(grobo_socket socket, unsigned what, int64_t timeout_us)
{
    struct pollfd one = {.fd = socket, .events = 0};
    int64_t ms = timeout_us <= 0 ? 0 : (timeout_us - 1) / 1000 + 1;
    int ready;

    if ((what & GROBO_PORT_READABLE) != 0) {
        one.events |= POLLIN;
    }
    if ((what & GROBO_PORT_WRITABLE) != 0) {
        one.events |= POLLOUT;
    }
    ready = grobo_i_posix_poll(&one, 1, ms > INT_MAX ? INT_MAX : (int)ms);
    if (ready < 0) {
        return errno == EINTR ? 0 : GROBO_ERR_IO;
    }
    if (ready == 0) {
        return 0;
    }
    if ((one.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) {
        return (int)what;
    }
    return ((one.revents & POLLIN) != 0 ? (int)GROBO_PORT_READABLE : 0) |
           ((one.revents & POLLOUT) != 0 ? (int)GROBO_PORT_WRITABLE : 0);
}
