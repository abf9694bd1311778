/* SPDX-License-Identifier: MIT */
/*
 * Standard input for an event loop, which cannot wait on a console or a pipe here: a thread reads
 * it, once each time that it is asked, and sends what comes through a socket pair. Between two
 * questions it leaves a console to others.
 */
#include <winsock2.h>
#include <windows.h>
#include <io.h>
#include <process.h>

#include "tools/grctl/os/os.h"

enum { BLOCK_BYTES = 512 };

static struct {
    evutil_socket_t near_end, far_end;
    HANDLE wanted;         /* asks for a read */
    volatile LONG reading; /* asked, and not yet answered */
    bool started;
} stdin_pump;

static unsigned __stdcall pump(void *arg)
{
    HANDLE in = GetStdHandle(STD_INPUT_HANDLE);
    (void)arg;
    for (;;) {
        char bytes[BLOCK_BYTES];
        DWORD n = 0;
        WaitForSingleObject(stdin_pump.wanted, INFINITE);
        SetLastError(ERROR_SUCCESS);
        /* Ctrl-C ends a read of a console without its being the end of it. */
        if (!ReadFile(in, bytes, sizeof bytes, &n, NULL) ||
            (n == 0 && GetLastError() != ERROR_OPERATION_ABORTED)) {
            break;
        }
        InterlockedExchange(&stdin_pump.reading, 0);
        if (n > 0 && send((SOCKET)stdin_pump.far_end, bytes, (int)n, 0) < 0) {
            break;
        }
    }
    shutdown((SOCKET)stdin_pump.far_end, SD_SEND);
    return 0;
}

/* For the life of the process: nothing can end a read of a pipe. */
static bool start(void)
{
    evutil_socket_t pair[2];
    uintptr_t thread = 0;
    if (evutil_socketpair(AF_INET, SOCK_STREAM, 0, pair) != 0) {
        return false;
    }
    stdin_pump.near_end = pair[0];
    stdin_pump.far_end = pair[1];
    stdin_pump.wanted = CreateEventA(NULL, FALSE, FALSE, NULL);
    if (stdin_pump.wanted && evutil_make_socket_nonblocking(pair[0]) == 0) {
        thread = _beginthreadex(NULL, 0, pump, NULL, 0, NULL);
    }
    if (thread) {
        CloseHandle((HANDLE)thread);
        return true;
    }
    evutil_closesocket(pair[0]);
    evutil_closesocket(pair[1]);
    return false;
}

int os_wait_to_read(void)
{
    return 0;
}

bool os_input_take(FILE *from)
{
    HANDLE handle = (HANDLE)_get_osfhandle(_fileno(from));
    return GetFileType(handle) != FILE_TYPE_DISK && _dup2(_fileno(from), _fileno(stdin)) == 0;
}

evutil_socket_t os_input_await(void)
{
    u_long there = 0;
    if (!stdin_pump.started && !(stdin_pump.started = start())) {
        return EVUTIL_INVALID_SOCKET;
    }
    if (ioctlsocket((SOCKET)stdin_pump.near_end, (long)FIONREAD, &there) == 0 && there == 0 &&
        InterlockedCompareExchange(&stdin_pump.reading, 1, 0) == 0) {
        SetEvent(stdin_pump.wanted);
    }
    return stdin_pump.near_end;
}

int os_input_read(void *bytes, size_t capacity)
{
    int n = recv((SOCKET)stdin_pump.near_end, bytes, (int)capacity, 0);
    if (n > 0) {
        return n;
    }
    return n < 0 && WSAGetLastError() == WSAEWOULDBLOCK ? 0 : -1;
}

static void on_readable(evutil_socket_t fd, short what, void *ctx)
{
    os_input *input = ctx;
    char bytes[BLOCK_BYTES];
    int n = os_input_read(bytes, sizeof bytes);
    (void)fd;
    (void)what;
    if (n > 0) {
        input->fn(input->ctx, bytes, (size_t)n);
    }
    if (n < 0) {
        event_del(input->readable);
    } else {
        os_input_await();
    }
}

/* A file has all its bytes at once, which is not how somebody speaks. */
static bool may_listen(void)
{
    HANDLE in = GetStdHandle(STD_INPUT_HANDLE);
    DWORD mode;
    return GetFileType(in) == FILE_TYPE_PIPE || GetConsoleMode(in, &mode);
}

bool os_input_start(os_input *input, struct event_base *base, os_input_fn fn, void *ctx)
{
    *input = (os_input){.fn = fn, .ctx = ctx};
    if (!may_listen()) {
        return true;
    }
    input->readable = event_new(base, os_input_await(), EV_READ | EV_PERSIST, on_readable, input);
    return input->readable && event_add(input->readable, NULL) == 0;
}

void os_input_stop(os_input *input)
{
    if (input->readable) {
        event_free(input->readable);
    }
}
