/* SPDX-License-Identifier: MIT */
/* Processes by number and start time. The other systems' answer, by number alone, is at the end. */
#include <errno.h>
#include <signal.h>
#include <unistd.h>

#include "ports/common/notes.h"
#include "ports/posix/posix.h"

#ifdef __linux__

#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/fsuid.h>
#include <sys/syscall.h>

/* proc(5), /proc/PID/stat: field 3 is the state, field 22 the start time in ticks. */
static bool read_stat(int pid, char *state, uint64_t *started)
{
    char path[32];
    char text[1024];
    const char *end;
    ssize_t got;
    int fd;

    snprintf(path, sizeof path, "/proc/%d/stat", pid);
    fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) {
        return false;
    }
    got = read(fd, text, sizeof text - 1);
    (void)close(fd);
    text[got > 0 ? got : 0] = '\0';
    /* The name in parentheses before it may hold anything. */
    end = strrchr(text, ')');
    return end != NULL && sscanf(end + 1,
                                 " %c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %*u %*u %*d %*d "
                                 "%*d %*d %*d %*d %" SCNu64,
                                 state, started) == 2;
}

/* From now on its number stays its own. -1: a kernel before 5.3. */
static int open_process(int pid)
{
#ifdef SYS_pidfd_open
    return (int)syscall(SYS_pidfd_open, pid, 0);
#else
    (void)pid;
    errno = ENOSYS;
    return -1;
#endif
}

int grobo_i_posix_open_process(int pid)
{
    int pidfd = open_process(pid);

    if (pidfd >= 0) {
        return pidfd;
    }
    return errno == ESRCH || errno == EINVAL ? GROBO_ERR_NOENT
           : errno == ENOSYS                 ? GROBO_ERR_UNSUPPORTED
                                             : GROBO_ERR_NOMEM;
}

int grobo_i_posix_signal(int pidfd, int number)
{
#ifdef SYS_pidfd_send_signal
    if (syscall(SYS_pidfd_send_signal, pidfd, number, NULL, 0) == 0) {
        return GROBO_OK;
    }
    return errno == ESRCH   ? GROBO_ERR_NOENT
           : errno == EPERM ? GROBO_ERR_PERM
                            : GROBO_ERR_UNSUPPORTED;
#else
    (void)pidfd;
    (void)number;
    return GROBO_ERR_UNSUPPORTED;
#endif
}

/* Of the thread alone, see setfsuid(2): other threads stay who they are. */
int grobo_i_posix_be_user(uid_t user, gid_t group)
{
    (void)setfsgid(group);
    (void)setfsuid(user);
    /* They tell who it was, and an impossible user changes nothing. */
    if (setfsuid((uid_t)-1) == (int)user && setfsgid((gid_t)-1) == (int)group) {
        return GROBO_OK;
    }
    (void)setfsuid(geteuid());
    (void)setfsgid(getegid());
    return GROBO_ERR_PERM;
}

static int proceed(int pidfd, int pid)
{
#ifdef SYS_pidfd_send_signal
    if (pidfd >= 0) {
        return (int)syscall(SYS_pidfd_send_signal, pidfd, SIGCONT, NULL, 0);
    }
#endif
    (void)pidfd;
    return kill(pid, SIGCONT);
}

void grobo_i_process_self(grobo_i_process *self)
{
    char state;

    self->pid = (int)getpid();
    self->started = 0;
    if (!read_stat(self->pid, &state, &self->started)) {
        self->started = 0;
    }
}

static int look(const grobo_i_process *process, int pidfd, bool wake)
{
    uint64_t started = 0;
    char state = '?';

    if (!read_stat(process->pid, &state, &started)) {
        return kill(process->pid, 0) == 0 ? 0 : GROBO_ERR_NOENT;
    }
    if ((process->started != 0 && started != process->started) || strchr("ZXx", state) != NULL) {
        return GROBO_ERR_NOENT;
    }
    if (state != 'T') {
        return 0;
    }
    return !wake || proceed(pidfd, process->pid) == 0 ? 1 : GROBO_ERR_PERM;
}

int grobo_i_process_look(const grobo_i_process *process, bool wake)
{
    int pidfd = open_process(process->pid);
    int r;

    if (pidfd < 0 && (errno == ESRCH || errno == EINVAL)) {
        return GROBO_ERR_NOENT;
    }
    r = look(process, pidfd, wake);
    if (pidfd >= 0) {
        (void)close(pidfd);
    }
    return r;
}

#else

void grobo_i_process_self(grobo_i_process *self)
{
    self->pid = (int)getpid();
    self->started = 0;
}

int grobo_i_posix_open_process(int pid)
{
    (void)pid;
    return GROBO_ERR_UNSUPPORTED;
}

int grobo_i_posix_signal(int pidfd, int number)
{
    (void)pidfd;
    (void)number;
    return GROBO_ERR_UNSUPPORTED;
}

int grobo_i_posix_be_user(uid_t user, gid_t group)
{
    (void)user;
    (void)group;
    return GROBO_ERR_UNSUPPORTED;
}

/* Whether it is stopped is not known here; a process that runs does not mind. */
int grobo_i_process_look(const grobo_i_process *process, bool wake)
{
    if (kill(process->pid, wake ? SIGCONT : 0) == 0) {
        return 0;
    }
    return errno == ESRCH ? GROBO_ERR_NOENT : GROBO_ERR_PERM;
}

#endif
