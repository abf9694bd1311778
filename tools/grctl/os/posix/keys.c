/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include "tools/grctl/os/keys.h"

/* The terminal is one for the process, and atexit() hands over no context. */
static struct termios before;
static bool raw;

static void restore(void)
{
    if (raw) {
        tcsetattr(STDIN_FILENO, TCSANOW, &before);
    }
    raw = false;
}

static bool in_foreground(void)
{
    return isatty(STDIN_FILENO) && tcgetpgrp(STDIN_FILENO) == getpgrp();
}

static bool make_raw(void)
{
    if (!in_foreground() || tcgetattr(STDIN_FILENO, &before) < 0) {
        return false;
    }
    struct termios now = before;
    now.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
    now.c_cc[VMIN] = 1;
    now.c_cc[VTIME] = 0;
    now.c_cc[VQUIT] = _POSIX_VDISABLE; /* nobody would put the terminal right */
    raw = tcsetattr(STDIN_FILENO, TCSANOW, &now) == 0;
    return raw;
}

static void on_input(evutil_socket_t fd, short what, void *ctx)
{
    keys *k = ctx;
    unsigned char bytes[64];
    ssize_t n = read(fd, bytes, sizeof bytes);
    (void)what;
    for (ssize_t i = 0; i < n && k->on_key; i++) {
        k->on_key(k->ctx, bytes[i]);
    }
    if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) {
        event_del(k->events[0]);
        if (k->on_key) {
            k->on_key(k->ctx, KEYS_END);
        }
    }
}

static void on_continue(evutil_socket_t number, short what, void *ctx)
{
    (void)number;
    (void)what;
    (void)ctx;
    if (!raw) {
        make_raw();
    }
}

static bool is_pipe(void)
{
    struct stat s;
    return fstat(STDIN_FILENO, &s) == 0 && (S_ISFIFO(s.st_mode) || S_ISSOCK(s.st_mode));
}

bool keys_can_come(void)
{
    struct pollfd input = {.fd = STDIN_FILENO, .events = POLLIN};
    int n = 0;
    if (!is_pipe()) {
        return in_foreground();
    }
    if (poll(&input, 1, 0) <= 0) {
        return true; /* nothing yet, and it is open */
    }
    return ioctl(STDIN_FILENO, FIONREAD, &n) == 0 && n > 0;
}

bool keys_start(keys *k, struct event_base *base, bool pipes, keys_fn on_key, void *ctx)
{
    static bool registered;
    int n = 1;
    memset(k, 0, sizeof *k);
    if (!(pipes && is_pipe())) {
        if (!registered && atexit(restore) != 0) {
            return false;
        }
        registered = true;
        if (!make_raw()) {
            return false;
        }
        k->events[1] = evsignal_new(base, SIGCONT, on_continue, k);
        n = KEYS_EVENTS;
    }
    k->on_key = on_key;
    k->ctx = ctx;
    k->events[0] = event_new(base, STDIN_FILENO, EV_READ | EV_PERSIST, on_input, k);
    bool heard = true;
    for (int i = 0; i < n && heard; i++) {
        heard = k->events[i] && event_add(k->events[i], NULL) == 0;
    }
    if (!heard) {
        keys_stop(k);
    }
    return heard;
}

void keys_pause(void)
{
    restore();
}

void keys_stop(keys *k)
{
    for (int i = 0; i < KEYS_EVENTS; i++) {
        if (k->events[i]) {
            event_free(k->events[i]);
        }
    }
    memset(k, 0, sizeof *k);
    restore();
}
