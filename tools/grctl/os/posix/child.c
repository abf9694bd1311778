/* SPDX-License-Identifier: MIT */
/* Starts this program again as a child with a socket to it, ends it, and settles in as one. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tools/grctl/os/child.h"

extern char **environ;

/* ---- who begins it --------------------------------------------------------------------------- */

/* A group of its own: what a terminal says to the other's group is not for it. */
static int set_attributes(posix_spawnattr_t *attributes)
{
    sigset_t all, none;
    sigfillset(&all);
    sigemptyset(&none);
    int error = posix_spawnattr_setflags(
        attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
    error = error ? error : posix_spawnattr_setsigdefault(attributes, &all);
    error = error ? error : posix_spawnattr_setsigmask(attributes, &none);
    return error ? error : posix_spawnattr_setpgroup(attributes, 0);
}

static int set_actions(posix_spawn_file_actions_t *actions, int socket)
{
    int error = posix_spawn_file_actions_adddup2(actions, socket, STDIN_FILENO);
    error =
        error ? error
              : posix_spawn_file_actions_addopen(actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    return error
               ? error
               : posix_spawn_file_actions_addopen(actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
}

static pid_t spawn(const char *program, const char *word, int socket)
{
    /* It does not write to the words. */
    char *words[] = {(char *)(uintptr_t) "grctl", (char *)(uintptr_t)word, NULL};
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    pid_t child = -1;
    if (posix_spawn_file_actions_init(&actions) != 0) {
        return -1;
    }
    if (posix_spawnattr_init(&attributes) == 0) {
        int error = set_attributes(&attributes);
        error = error ? error : set_actions(&actions, socket);
        error =
            error ? error : posix_spawnp(&child, program, &actions, &attributes, words, environ);
        child = error ? -1 : child;
        posix_spawnattr_destroy(&attributes);
    }
    posix_spawn_file_actions_destroy(&actions);
    return child;
}

bool os_child_begin(os_child *child, const char *program, const char *word)
{
    int ends[2];
    child->socket = EVUTIL_INVALID_SOCKET;
    signal(SIGPIPE, SIG_IGN); /* its end is read */
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) {
        return false;
    }
    bool ready = ends[1] > STDERR_FILENO && fcntl(ends[0], F_SETFD, FD_CLOEXEC) == 0 &&
                 fcntl(ends[1], F_SETFD, FD_CLOEXEC) == 0 &&
                 evutil_make_socket_nonblocking(ends[0]) == 0;
    pid_t program_id = ready ? spawn(program, word, ends[1]) : -1;
    close(ends[1]);
    if (program_id < 0) {
        close(ends[0]);
        return false;
    }
    *child = (os_child){.socket = ends[0], .program = program_id};
    return true;
}

static int64_t now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/* Until it has ended: then its socket is at its end. What it still says is dropped. */
static void await_end(int fd, const char *from, size_t size, int patience_ms)
{
    int64_t until_ms = now_ms() + patience_ms;
    for (int64_t rest_ms = patience_ms; rest_ms > 0; rest_ms = until_ms - now_ms()) {
        struct pollfd one = {.fd = fd, .events = (short)(POLLIN | (size ? POLLOUT : 0))};
        char dropped[4096];
        if (poll(&one, 1, (int)rest_ms) < 0 && errno != EINTR) {
            return;
        }
        if (one.revents & POLLOUT) {
            ssize_t n = send(fd, from, size, 0);
            from += n > 0 ? n : 0;
            size -= n > 0 ? (size_t)n : 0;
        }
        if (one.revents & (POLLIN | POLLHUP | POLLERR)) {
            ssize_t n = recv(fd, dropped, sizeof dropped, 0);
            if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) {
                return;
            }
        }
    }
}

void os_child_end(os_child *child, const void *bytes, size_t size, int patience_ms)
{
    pid_t program = (pid_t)child->program;
    if (child->socket == EVUTIL_INVALID_SOCKET) {
        return;
    }
    await_end(child->socket, bytes, size, patience_ms);
    close(child->socket);
    child->socket = EVUTIL_INVALID_SOCKET;
    kill(program, SIGKILL); /* it is not waited for yet: the number is its own */
    while (waitpid(program, NULL, 0) < 0 && errno == EINTR) {
        continue;
    }
}

/* ---- the process itself ---------------------------------------------------------------------- */

static void close_others(void)
{
    DIR *list = opendir("/dev/fd");
    const struct dirent *entry;
    while (list && (entry = readdir(list)) != NULL) {
        long fd = strtol(entry->d_name, NULL, 10); /* of ".": 0 */
        if (fd > STDERR_FILENO && fd != dirfd(list)) {
            close((int)fd);
        }
    }
    if (list) {
        closedir(list);
    }
}

static void ignore_signals(void)
{
    static const int numbers[] = {SIGHUP,  SIGINT,  SIGQUIT, SIGTERM, SIGPIPE, SIGTSTP,
                                  SIGTTIN, SIGTTOU, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        signal(numbers[i], SIG_IGN);
    }
}

evutil_socket_t os_child_settle(void)
{
    static const struct rlimit no_core = {0, 0};
    struct stat s;
    if (fstat(STDIN_FILENO, &s) != 0 || !S_ISSOCK(s.st_mode)) {
        return EVUTIL_INVALID_SOCKET;
    }
    ignore_signals();
    setrlimit(RLIMIT_CORE, &no_core);
    close_others();
    return STDIN_FILENO;
}

void os_child_expect(unsigned seconds)
{
    alarm(seconds);
}

bool os_child_send(evutil_socket_t socket, const void *bytes, size_t size)
{
    const char *from = bytes;
    while (size > 0) {
        ssize_t n = send(socket, from, size, 0);
        if (n < 0 && errno != EINTR) {
            return false;
        }
        from += n > 0 ? n : 0;
        size -= n > 0 ? (size_t)n : 0;
    }
    return true;
}
