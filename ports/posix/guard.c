/* SPDX-License-Identifier: MIT */
/* A guard process: spawned, spoken with over a socket pair, and what it watches. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdint.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ports/common/guard.h"
#include "ports/posix/posix.h"

#ifdef __APPLE__ /* a shared library has no other way to it */
#include <crt_externs.h>
#define environ (*_NSGetEnviron())
#else
extern char **environ;
#endif

/* Most arguments of a guard, its name and the NULL among them. */
enum { ARGUMENTS_MAX = 16 };

/* How often the program is looked at where no descriptor tells of its death, or of a stop. */
enum { LOOK_DEATH_MS = 20, LOOK_STATE_MS = 50, STILL_LOOKS = 2 };

/* More than stopping a robot takes: 256 joints, and what a report of it is printed with. */
enum { STACK_BYTES = 256 * 1024, PAGE_BYTES = 1024 };

#ifndef MSG_NOSIGNAL /* then SO_NOSIGPIPE, or SIGPIPE is ignored */
#define MSG_NOSIGNAL 0
#endif

/* ---- the program's side ------------------------------------------------------------------- */

/* The Makefile says where `make install` puts it. */
const char *grobo_i_guard_default(void)
{
    return GROBO_GUARD_PROGRAM;
}

/* One end of a pair: closed on exec, never waited for, and none of the three standard streams. */
static int prepare_end(int *end)
{
    grobo_os_cause cause;

    if (*end <= STDERR_FILENO) {
        int moved = fcntl(*end, F_DUPFD, STDERR_FILENO + 1);

        if (moved < 0) {
            return grobo_i_posix_error(errno);
        }
        (void)close(*end);
        *end = moved;
    }
#ifdef SO_NOSIGPIPE
    int on = 1;

    (void)setsockopt(*end, SOL_SOCKET, SO_NOSIGPIPE, &on, sizeof on);
#endif
    return grobo_i_posix_prepare(*end, &cause);
}

static int make_pair(int ends[2])
{
    int r = socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0 ? GROBO_OK : grobo_i_posix_error(errno);

    for (int i = 0; i < 2 && r >= 0; i++) {
        r = prepare_end(&ends[i]);
        if (r < 0) {
            (void)close(ends[0]);
            (void)close(ends[1]);
        }
    }
    return r;
}

/* Signals as a new program expects them, whatever this one ignores or blocks. */
static int set_signals(posix_spawnattr_t *attributes)
{
    sigset_t all;
    sigset_t none;
    int code;

    sigfillset(&all);
    sigemptyset(&none);
    code = posix_spawnattr_setflags(attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
    if (code == 0) {
        code = posix_spawnattr_setsigdefault(attributes, &all);
    }
    return code != 0 ? code : posix_spawnattr_setsigmask(attributes, &none);
}

static int spawn(const char *program, char *const *words, int socket, int *pid)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    pid_t child = 0;
    int code = posix_spawn_file_actions_init(&actions);

    if (code != 0) {
        return code;
    }
    code = posix_spawnattr_init(&attributes);
    if (code == 0) {
        code = set_signals(&attributes);
        if (code == 0) {
            code = posix_spawn_file_actions_adddup2(&actions, socket, STDIN_FILENO);
        }
        if (code == 0) {
            code =
                posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
        }
        if (code == 0) {
            code = posix_spawnp(&child, program, &actions, &attributes, words, environ);
        }
        (void)posix_spawnattr_destroy(&attributes);
    }
    (void)posix_spawn_file_actions_destroy(&actions);
    *pid = (int)child;
    return code;
}

int grobo_i_guard_spawn(const char *program, const char *const *arguments,
                        grobo_i_guard_process *process)
{
    /* posix_spawn() takes them as they are: it does not write to the words. */
    char *words[ARGUMENTS_MAX] = {(char *)(uintptr_t)program};
    int ends[2];
    int code;
    int n = 1;
    int r;

    while (*arguments != NULL) {
        if (n == ARGUMENTS_MAX - 1) {
            return GROBO_ERR_CAP;
        }
        words[n++] = (char *)(uintptr_t)*arguments++;
    }
    r = make_pair(ends);
    if (r < 0) {
        return r;
    }
    code = spawn(program, words, ends[1], &process->pid);
    (void)close(ends[1]);
    if (code != 0) {
        (void)close(ends[0]);
        return grobo_i_posix_error(code);
    }
    process->socket = ends[0];
    process->owner = (int)getpid();
    return GROBO_OK;
}

bool grobo_i_guard_is_owner(const grobo_i_guard_process *process)
{
    return process->owner == (int)getpid();
}

/* True once it is gone; a program that reaps all its children may have taken it from us. */
static bool is_gone(grobo_i_guard_process *process)
{
    pid_t r = 0;

    if (process->pid != 0) {
        do {
            r = waitpid(process->pid, NULL, WNOHANG);
        } while (r < 0 && errno == EINTR);
        /* From then on the number may be another's. */
        process->pid = r != 0 ? 0 : process->pid;
    }
    return process->pid == 0;
}

void grobo_i_guard_kill(grobo_i_guard_process *process)
{
    if (grobo_i_guard_is_owner(process) && !is_gone(process)) {
        (void)kill(process->pid, SIGKILL);
        (void)waitpid(process->pid, NULL, 0);
        process->pid = 0;
    }
}

void grobo_i_guard_end(grobo_i_guard_process *process, int64_t patience_us)
{
    int64_t end_us = grobo_now_us() + patience_us;

    if (grobo_i_guard_is_owner(process)) {
        /* Also where a child of ours has the socket too: for the guard it is at its end. */
        (void)shutdown(process->socket, SHUT_WR);
        while (!is_gone(process) && grobo_now_us() < end_us) {
            (void)poll(NULL, 0, 1);
        }
        grobo_i_guard_kill(process);
    }
    (void)close(process->socket);
    process->socket = GROBO_SOCKET_NULL;
}

/* ---- both sides --------------------------------------------------------------------------- */

/* Room for one descriptor in a control message, aligned as it wants to be. */
typedef union one_descriptor {
    struct cmsghdr head;
    char room[CMSG_SPACE(sizeof(int))];
} one_descriptor;

int grobo_i_guard_send(grobo_socket socket, const void *bytes, size_t size, grobo_handle handle)
{
    struct iovec part = {.iov_base = (void *)(uintptr_t)bytes, .iov_len = size};
    struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1};
    one_descriptor control;
    ssize_t sent;

    if (handle != GROBO_HANDLE_NULL) {
        memset(&control, 0, sizeof control);
        message.msg_control = control.room;
        message.msg_controllen = sizeof control.room;
        struct cmsghdr *head = CMSG_FIRSTHDR(&message);

        head->cmsg_level = SOL_SOCKET;
        head->cmsg_type = SCM_RIGHTS;
        head->cmsg_len = CMSG_LEN(sizeof handle);
        memcpy(CMSG_DATA(head), &handle, sizeof handle);
    }
    do {
        sent = sendmsg(socket, &message, MSG_NOSIGNAL);
    } while (sent < 0 && errno == EINTR);
    if (sent == (ssize_t)size) {
        return GROBO_OK;
    }
    if (sent >= 0 || errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS ||
        errno == ENOMEM) {
        return GROBO_ERR_FULL;
    }
    return errno == EPIPE || errno == ECONNRESET ? GROBO_ERR_CLOSED : GROBO_ERR_IO;
}

static int take_descriptor(struct msghdr *message)
{
    const struct cmsghdr *head = CMSG_FIRSTHDR(message);
    int handle = GROBO_HANDLE_NULL;

    /* One comes at a time: the control message that holds it is the first. */
    if (head != NULL && head->cmsg_level == SOL_SOCKET && head->cmsg_type == SCM_RIGHTS &&
        head->cmsg_len == CMSG_LEN(sizeof handle)) {
        memcpy(&handle, CMSG_DATA(head), sizeof handle);
        (void)fcntl(handle, F_SETFD, FD_CLOEXEC);
    }
    return handle;
}

int grobo_i_guard_receive(grobo_socket socket, void *bytes, size_t size, grobo_handle *handle)
{
    struct iovec part = {.iov_base = bytes, .iov_len = size};
    struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1};
    one_descriptor control;
    ssize_t got;

    if (handle != NULL) {
        message.msg_control = control.room;
        message.msg_controllen = sizeof control.room;
    }
    do {
        got = recvmsg(socket, &message, 0);
    } while (got < 0 && errno == EINTR);
    if (got > 0 && handle != NULL) {
        int came = take_descriptor(&message);

        if (came != GROBO_HANDLE_NULL) {
            *handle = came;
        }
    }
    if (got > 0) {
        return (int)got;
    }
    if (got == 0 || errno == ECONNRESET) {
        return GROBO_ERR_CLOSED;
    }
    return errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOMEM ? 0 : GROBO_ERR_IO;
}

/* ---- the process's side ------------------------------------------------------------------- */

static bool is_socket(int fd)
{
    struct stat st;

    return fstat(fd, &st) == 0 && S_ISSOCK(st.st_mode);
}

/* It ends with its program, and by nothing that is meant for that program. */
static void ignore_signals(void)
{
    static const int numbers[] = {SIGHUP,  SIGINT,  SIGQUIT, SIGTERM, SIGPIPE, SIGTSTP,
                                  SIGTTIN, SIGTTOU, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ};

    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        (void)signal(numbers[i], SIG_IGN);
    }
}

/* What the stack may grow to later is there now: then there may be no memory for it. */
static void fill_stack(void)
{
    volatile char room[STACK_BYTES];

    for (size_t i = 0; i < sizeof room; i += PAGE_BYTES) {
        room[i] = 0;
    }
}

int grobo_i_guard_begin(grobo_i_guard_watch *watch)
{
    pid_t parent = getppid();
    grobo_os_cause cause;

    if (!is_socket(STDIN_FILENO)) {
        return GROBO_ERR_ARG;
    }
    fill_stack();
    ignore_signals();
    if (setsid() < 0 && getsid(0) != getpid()) {
        return GROBO_ERR_IO;
    }
    if (chdir("/") != 0) {
        return GROBO_ERR_IO;
    }
    grobo_i_posix_close_from(STDERR_FILENO + 1);
    grobo_i_posix_call_it(GROBO_GUARD_NAME);
    grobo_i_posix_take_every_cpu(); /* the program's may be the one of a thread that spins */
    *watch = (grobo_i_guard_watch){.socket = STDIN_FILENO, .parent = (int)parent};
    watch->death = grobo_i_posix_watch_death(parent);
    watch->state = grobo_i_posix_watch_state(parent);
    watch->asked = grobo_i_posix_watch_asked();
    /* Looked at last: what was opened before is this very process's, and no other's number. */
    if (getppid() != parent) {
        grobo_i_guard_cease(watch);
        return GROBO_ERR_CLOSED;
    }
    return grobo_i_posix_prepare(STDIN_FILENO, &cause);
}

void grobo_i_guard_cease(grobo_i_guard_watch *watch)
{
    int *const descriptors[] = {&watch->death, &watch->state, &watch->asked, &watch->socket};

    for (size_t i = 0; i < sizeof descriptors / sizeof descriptors[0]; i++) {
        if (*descriptors[i] >= 0) {
            (void)close(*descriptors[i]);
        }
        *descriptors[i] = -1;
    }
}

static unsigned look_at_state(grobo_i_guard_watch *watch)
{
    bool stopped = grobo_i_posix_is_stopped(watch->state);

    watch->stillness = stopped ? watch->stillness + 1 : 0;
    return watch->stillness >= STILL_LOOKS ? GROBO_I_GUARD_STOPPED : 0;
}

unsigned grobo_i_guard_await(grobo_i_guard_watch *watch, grobo_handle line, bool moves)
{
    struct pollfd what[] = {{.fd = watch->socket, .events = POLLIN},
                            {.fd = watch->death, .events = POLLIN},
                            {.fd = line, .events = 0},
                            {.fd = watch->asked, .events = POLLIN}};
    int limit_ms = watch->death < 0 ? LOOK_DEATH_MS : moves ? LOOK_STATE_MS : -1;
    unsigned found = 0;

    (void)grobo_i_posix_poll(what, sizeof what / sizeof what[0], limit_ms);
    if ((what[0].revents & (POLLIN | POLLHUP | POLLERR)) != 0) {
        found |= GROBO_I_GUARD_NEWS;
    }
    if ((what[1].revents & (POLLIN | POLLHUP | POLLERR)) != 0 || getppid() != watch->parent) {
        found |= GROBO_I_GUARD_DEAD;
    }
    if ((what[2].revents & (POLLHUP | POLLERR | POLLNVAL)) != 0) {
        found |= GROBO_I_GUARD_HUNG_UP;
    }
    if ((what[3].revents & POLLIN) != 0) {
        grobo_i_posix_take_asked(watch->asked);
        found |= GROBO_I_GUARD_ASKED;
    }
    if (found == 0 && moves && watch->state >= 0) {
        found = look_at_state(watch);
    } else {
        watch->stillness = 0;
    }
    return found;
}

void grobo_i_port_adopt(grobo_port *port, grobo_handle handle)
{
    memset(port, 0, sizeof *port);
    port->fd = handle;
    port->slave = GROBO_HANDLE_NULL;
}

void grobo_i_guard_drop(grobo_handle handle)
{
    (void)close(handle);
}

void grobo_i_port_abandon(grobo_port *port)
{
    port->abandoned = true;
}
