/* SPDX-License-Identifier: MIT */
/*
 * A process of this very program for what may end a process: it has a socket to the one that began
 * it, and nothing else of it but its environment.
 */
#ifndef GRCTL_OS_CHILD_H
#define GRCTL_OS_CHILD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <event2/util.h>

/* EVUTIL_INVALID_SOCKET is unsigned on Windows, where the type of a socket is not. */
static inline bool os_is_socket(evutil_socket_t socket)
{
    return socket != (evutil_socket_t)EVUTIL_INVALID_SOCKET;
}

typedef struct os_child {
    evutil_socket_t socket; /* it never waits; EVUTIL_INVALID_SOCKET: none */
    intptr_t program;
} os_child;

/* Starts that program with that word. False: it cannot be started, or this system has no way to. */
bool os_child_begin(os_child *child, const char *program, const char *word);
/* Gives it these bytes and, for so long in all, the time to end by itself; then it is ended. Waits.
 * What was begun is ended once. */
void os_child_end(os_child *child, const void *bytes, size_t size, int patience_ms);

/*
 * In the process: it lets go of all that it got, hears no signal that is meant for the other, and
 * leaves no core. The socket, or EVUTIL_INVALID_SOCKET: it was started by somebody else.
 */
evutil_socket_t os_child_settle(void);
/* Ends this process in so many seconds, unless it is called again before: it hangs. */
void os_child_expect(unsigned seconds);
/* Gives the other side all of it. Waits. False: it is gone. */
bool os_child_send(evutil_socket_t socket, const void *bytes, size_t size);

#endif
