/* SPDX-License-Identifier: MIT */
/* Not here: what would be a process of its own stays in this one. */
#include "tools/grctl/os/child.h"

bool os_child_begin(os_child *child, const char *program, const char *word)
{
    (void)program;
    (void)word;
    child->socket = EVUTIL_INVALID_SOCKET;
    return false;
}

void os_child_end(os_child *child, const void *bytes, size_t size, int patience_ms)
{
    (void)child;
    (void)bytes;
    (void)size;
    (void)patience_ms;
}

evutil_socket_t os_child_settle(void)
{
    return EVUTIL_INVALID_SOCKET;
}

void os_child_expect(unsigned seconds)
{
    (void)seconds;
}

bool os_child_send(evutil_socket_t socket, const void *bytes, size_t size)
{
    (void)socket;
    (void)bytes;
    (void)size;
    return false;
}
