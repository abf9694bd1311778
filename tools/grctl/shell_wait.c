/* SPDX-License-Identifier: MIT */
#include "shell.h"

static void on_readable(evutil_socket_t fd, short what, void *ctx)
{
    bool *readable = ctx;
    (void)fd;
    (void)what;
    *readable = true;
}

int line_wait(conn_link *link)
{
    bool readable = false;
    struct event *input = event_new(link->base, os_input_await(), EV_READ, on_readable, &readable);
    if (!input)
        return 1; /* then the reading itself waits */
    if (event_add(input, NULL) != 0)
        readable = true; /* a file is always */
    conn_link_watch(link);
    while (!readable && !link->signal)
        if (event_base_loop(link->base, EVLOOP_ONCE) != 0)
            break;
    conn_link_unwatch(link);
    event_free(input);
    return link->signal ? 0 : 1;
}
