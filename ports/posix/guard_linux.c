/* SPDX-License-Identifier: MIT */
/*
 * Linux: death by a pidfd, a stop by /proc, descriptors by close_range(), shared memory by memfd.
 * Systems with kqueue tell of a death by that; elsewhere the guard looks at its parent. Their
 * answers are at the end.
 */
#include <limits.h>
#include <unistd.h>

#include "ports/common/guard.h"
#include "ports/posix/posix.h"

/* Where the system cannot say which descriptors are open, so many are tried. */
enum { DESCRIPTORS_MAX = 4096 };

static void close_each(int first)
{
    long most = sysconf(_SC_OPEN_MAX);

    if (most < 0 || most > DESCRIPTORS_MAX) {
        most = DESCRIPTORS_MAX;
    }
    for (int fd = first; fd < most; fd++) {
        (void)close(fd);
    }
}

#ifdef __linux__

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/syscall.h>

/* In headers since Linux 5.3 and 5.9; the numbers are those of every architecture. */
#ifndef SYS_pidfd_open
#define SYS_pidfd_open 434
#endif
#ifndef SYS_close_range
#define SYS_close_range 436
#endif

/* MFD_CLOEXEC of the kernel, which headers hide or do not have. */
enum { CLOSED_ON_EXEC = 1 };

void grobo_i_posix_close_from(int first)
{
    if (syscall(SYS_close_range, (unsigned)first, UINT_MAX, 0) != 0) {
        close_each(first);
    }
}

void grobo_i_posix_call_it(const char *name)
{
    (void)prctl(PR_SET_NAME, name, 0, 0, 0);
}

int grobo_i_posix_watch_death(pid_t pid)
{
    return (int)syscall(SYS_pidfd_open, pid, 0); /* closed on exec */
}

int grobo_i_posix_watch_state(pid_t pid)
{
    char path[64];

    snprintf(path, sizeof path, "/proc/%ld/stat", (long)pid);
    return open(path, O_RDONLY | O_CLOEXEC);
}

int grobo_i_posix_watch_asked(void)
{
    sigset_t one;

    sigemptyset(&one);
    sigaddset(&one, GUARD_SIGNAL);
    /* Blocked it waits for being read; ignored it would be dropped. */
    if (sigprocmask(SIG_BLOCK, &one, NULL) != 0 || signal(GUARD_SIGNAL, SIG_DFL) == SIG_ERR) {
        return -1;
    }
    return signalfd(-1, &one, SFD_CLOEXEC | SFD_NONBLOCK);
}

void grobo_i_posix_take_asked(int fd)
{
    struct signalfd_siginfo info;

    while (read(fd, &info, sizeof info) == (ssize_t)sizeof info) {
    }
}

int grobo_i_guard_share(size_t size, void **at, grobo_handle *handle)
{
    int fd = (int)syscall(SYS_memfd_create, GROBO_GUARD_NAME, CLOSED_ON_EXEC);
    int r;

    if (fd < 0) {
        return grobo_i_posix_error(errno);
    }
    r = ftruncate(fd, (off_t)size) == 0 ? grobo_i_guard_map(fd, size, at)
                                        : grobo_i_posix_error(errno);
    if (r < 0) {
        (void)close(fd);
        return r;
    }
    *handle = fd;
    return GROBO_OK;
}

int grobo_i_guard_map(grobo_handle handle, size_t size, void **at)
{
    void *mapped = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, handle, 0);

    if (mapped == MAP_FAILED) {
        return grobo_i_posix_error(errno);
    }
    *at = mapped;
    return GROBO_OK;
}

void grobo_i_guard_unmap(void *at, size_t size)
{
    (void)munmap(at, size);
}

/* "1234 (name) T ...", see proc(5); the name may hold any character. */
bool grobo_i_posix_is_stopped(int fd)
{
    char text[256];
    ssize_t got = pread(fd, text, sizeof text - 1, 0);
    const char *end;

    if (got <= 0) {
        return false;
    }
    text[got] = '\0';
    end = strrchr(text, ')');
    return end != NULL && end[1] == ' ' && end[2] == 'T';
}

#else

#if defined(__APPLE__) || defined(__FreeBSD__) || defined(__OpenBSD__) || defined(__NetBSD__)

#include <fcntl.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/event.h>

int grobo_i_posix_watch_death(pid_t pid)
{
    struct kevent exit_of_it;
    int queue = kqueue();

    if (queue < 0) {
        return -1;
    }
    EV_SET(&exit_of_it, (uintptr_t)pid, EVFILT_PROC, EV_ADD, NOTE_EXIT, 0, NULL);
    (void)fcntl(queue, F_SETFD, FD_CLOEXEC);
    if (kevent(queue, &exit_of_it, 1, NULL, 0, NULL) != 0) {
        (void)close(queue);
        return -1;
    }
    return queue;
}

#else

int grobo_i_posix_watch_death(pid_t pid)
{
    (void)pid;
    return -1;
}

#endif

int grobo_i_posix_watch_asked(void)
{
    return -1;
}

void grobo_i_posix_take_asked(int fd)
{
    (void)fd;
}

int grobo_i_guard_share(size_t size, void **at, grobo_handle *handle)
{
    (void)size;
    (void)at;
    (void)handle;
    return GROBO_ERR_UNSUPPORTED;
}

int grobo_i_guard_map(grobo_handle handle, size_t size, void **at)
{
    (void)handle;
    (void)size;
    (void)at;
    return GROBO_ERR_UNSUPPORTED;
}

void grobo_i_guard_unmap(void *at, size_t size)
{
    (void)at;
    (void)size;
}

void grobo_i_posix_close_from(int first)
{
    close_each(first);
}

void grobo_i_posix_call_it(const char *name)
{
    (void)name;
}

int grobo_i_posix_watch_state(pid_t pid)
{
    (void)pid;
    return -1;
}

bool grobo_i_posix_is_stopped(int fd)
{
    (void)fd;
    return false;
}

#endif
