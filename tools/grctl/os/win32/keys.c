/* SPDX-License-Identifier: MIT */
/* Single keys of a console: a thread takes its events and sends characters through a pair. */
#include <winsock2.h>
#include <windows.h>
#include <process.h>
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/os/keys.h"
#include "tools/grctl/os/os.h"

/* The console is one for the process. */
static struct {
    HANDLE in, stop, thread;
    DWORD before;
    bool raw;
    evutil_socket_t near_end, far_end;
} console;

static void restore(void)
{
    if (console.raw) {
        SetConsoleMode(console.in, console.before);
    }
    console.raw = false;
}

/* Ctrl-C stays what it is; keys without a character come as the sequences of a terminal. */
static bool make_raw(void)
{
    console.in = GetStdHandle(STD_INPUT_HANDLE);
    if (!GetConsoleMode(console.in, &console.before)) {
        return false;
    }
    console.raw =
        SetConsoleMode(console.in, ENABLE_PROCESSED_INPUT | ENABLE_VIRTUAL_TERMINAL_INPUT) ||
        SetConsoleMode(console.in, ENABLE_PROCESSED_INPUT);
    return console.raw;
}

static unsigned __stdcall listen_to_keys(void *arg)
{
    const HANDLE either[] = {console.stop, console.in};
    (void)arg;
    while (WaitForMultipleObjects(2, either, FALSE, INFINITE) == WAIT_OBJECT_0 + 1) {
        INPUT_RECORD record;
        DWORD n = 0;
        const KEY_EVENT_RECORD *key = &record.Event.KeyEvent;
        if (!ReadConsoleInputA(console.in, &record, 1, &n)) {
            break;
        }
        if (n == 1 && record.EventType == KEY_EVENT && key->bKeyDown && key->uChar.AsciiChar) {
            send((SOCKET)console.far_end, &key->uChar.AsciiChar, 1, 0);
        }
    }
    return 0;
}

static void stop_listening(void)
{
    if (!console.thread) {
        return;
    }
    SetEvent(console.stop);
    WaitForSingleObject(console.thread, INFINITE);
    CloseHandle(console.thread);
    CloseHandle(console.stop);
    evutil_closesocket(console.near_end);
    evutil_closesocket(console.far_end);
    console.thread = NULL;
}

static bool listen_to_console(void)
{
    evutil_socket_t pair[2];
    if (evutil_socketpair(AF_INET, SOCK_STREAM, 0, pair) != 0) {
        return false;
    }
    console.near_end = pair[0];
    console.far_end = pair[1];
    console.stop = CreateEventA(NULL, TRUE, FALSE, NULL);
    if (console.stop && evutil_make_socket_nonblocking(pair[0]) == 0) {
        console.thread = (HANDLE)_beginthreadex(NULL, 0, listen_to_keys, NULL, 0, NULL);
    }
    if (console.thread) {
        return true;
    }
    if (console.stop) {
        CloseHandle(console.stop);
    }
    evutil_closesocket(pair[0]);
    evutil_closesocket(pair[1]);
    return false;
}

static void on_input(evutil_socket_t fd, short what, void *ctx)
{
    keys *k = ctx;
    unsigned char bytes[64];
    int n = console.thread ? recv((SOCKET)fd, (char *)bytes, sizeof bytes, 0)
                           : os_input_read(bytes, sizeof bytes);
    (void)what;
    for (int i = 0; i < n && k->on_key; i++) {
        k->on_key(k->ctx, bytes[i]);
    }
    if (console.thread) {
        return;
    }
    if (n >= 0) {
        os_input_await();
        return;
    }
    event_del(k->events[0]);
    if (k->on_key) {
        k->on_key(k->ctx, KEYS_END);
    }
}

bool keys_can_come(void)
{
    HANDLE input = GetStdHandle(STD_INPUT_HANDLE);
    DWORD mode;
    if (GetFileType(input) == FILE_TYPE_PIPE) {
        return PeekNamedPipe(input, NULL, 0, NULL, NULL, NULL) != 0; /* else it is at its end */
    }
    return GetConsoleMode(input, &mode) != 0;
}

bool keys_start(keys *k, struct event_base *base, bool pipes, keys_fn on_key, void *ctx)
{
    static bool registered;
    bool pipe = pipes && GetFileType(GetStdHandle(STD_INPUT_HANDLE)) == FILE_TYPE_PIPE;
    memset(k, 0, sizeof *k);
    if (!pipe) {
        if (!registered && atexit(restore) != 0) {
            return false;
        }
        registered = true;
        if (!make_raw()) {
            return false;
        }
        if (!listen_to_console()) {
            restore();
            return false;
        }
    }
    k->on_key = on_key;
    k->ctx = ctx;
    k->events[0] = event_new(base, pipe ? os_input_await() : console.near_end, EV_READ | EV_PERSIST,
                             on_input, k);
    if (!k->events[0] || event_add(k->events[0], NULL) != 0) {
        keys_stop(k);
        return false;
    }
    return true;
}

void keys_pause(void)
{
}

void keys_stop(keys *k)
{
    if (k->events[0]) {
        event_free(k->events[0]);
    }
    memset(k, 0, sizeof *k);
    stop_listening();
    restore();
}
