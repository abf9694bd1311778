/* SPDX-License-Identifier: MIT */
/* Standard input: the descriptor is what a loop waits on. */
#include <errno.h>
#include <signal.h>
#include <sys/select.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tools/grctl/os/os.h"

static bool is_stream(int fd)
{
    struct stat s;
    return fstat(fd, &s) == 0 && (S_ISFIFO(s.st_mode) || S_ISSOCK(s.st_mode));
}

static volatile sig_atomic_t ending;

static void note_ending(int number)
{
    ending = number;
}

int os_wait_to_read(void)
{
    const struct sigaction action = {.sa_handler = note_ending};
    struct sigaction before[OS_ENDINGS_MAX];
    sigset_t endings, mask;
    fd_set readable;
    int n = -1;
    sigemptyset(&endings);
    for (int i = 0; i < os_n_endings; i++) {
        sigaddset(&endings, os_endings[i]);
    }
    sigprocmask(SIG_BLOCK, &endings, &mask); /* but while it waits */
    for (int i = 0; i < os_n_endings; i++) {
        sigaction(os_endings[i], &action, &before[i]);
    }
    for (ending = 0; n < 0 && !ending;) { /* a stop and its end interrupt it too */
        FD_ZERO(&readable);
        FD_SET(STDIN_FILENO, &readable);
        n = pselect(STDIN_FILENO + 1, &readable, NULL, NULL, NULL, &mask);
        n = n < 0 && errno != EINTR ? 0 : n;
    }
    for (int i = 0; i < os_n_endings; i++) {
        sigaction(os_endings[i], &before[i], NULL);
    }
    sigprocmask(SIG_SETMASK, &mask, NULL);
    return ending;
}

bool os_input_take(FILE *from)
{
    int fd = fileno(from);
    return (is_stream(fd) || isatty(fd)) && dup2(fd, STDIN_FILENO) == STDIN_FILENO;
}

/* Files and /dev/null cannot be waited for everywhere, nor need they. */
evutil_socket_t os_input_await(void)
{
    bool waits = is_stream(STDIN_FILENO) || isatty(STDIN_FILENO);
    return waits ? STDIN_FILENO : EVUTIL_INVALID_SOCKET;
}

int os_input_read(void *bytes, size_t capacity)
{
    ssize_t n = read(STDIN_FILENO, bytes, capacity);
    if (n > 0) {
        return (int)n;
    }
    return n < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : -1;
}

static void on_readable(evutil_socket_t fd, short what, void *ctx)
{
    os_input *input = ctx;
    char bytes[512];
    int n = os_input_read(bytes, sizeof bytes);
    (void)fd;
    (void)what;
    if (n > 0) {
        input->fn(input->ctx, bytes, (size_t)n);
    }
    if (n < 0) { /* its end, or in the background */
        event_del(input->readable);
    }
}

/* Reading a terminal from the background would stop the process. */
static bool may_listen(void)
{
    if (isatty(STDIN_FILENO)) {
        return tcgetpgrp(STDIN_FILENO) == getpgrp();
    }
    return is_stream(STDIN_FILENO);
}

static void on_resumed(evutil_socket_t number, short what, void *ctx)
{
    os_input *input = ctx;
    (void)number;
    (void)what;
    if (may_listen() && event_add(input->readable, NULL) != 0) {
        input->fn(input->ctx, NULL, 0);
    }
}

bool os_input_start(os_input *input, struct event_base *base, os_input_fn fn, void *ctx)
{
    signal(SIGTTIN, SIG_IGN);
    *input = (os_input){.fn = fn, .ctx = ctx};
    input->readable = event_new(base, STDIN_FILENO, EV_READ | EV_PERSIST, on_readable, input);
    input->resumed = evsignal_new(base, SIGCONT, on_resumed, input);
    return input->readable && input->resumed && event_add(input->resumed, NULL) == 0 &&
           (!may_listen() || event_add(input->readable, NULL) == 0);
}

void os_input_stop(os_input *input)
{
    if (input->readable) {
        event_free(input->readable);
    }
    if (input->resumed) {
        event_free(input->resumed);
    }
}
