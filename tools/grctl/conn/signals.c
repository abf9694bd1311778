/* SPDX-License-Identifier: MIT */
/* Signals while a command has the robot: those that end it, and Ctrl-Z. */
#include <grobo/core/port.h>

#include "tools/grctl/conn/conn.h"
#include "tools/grctl/os/keys.h"
#include "tools/grctl/term/screen.h"

static void note(conn_link *link, int number)
{
    int *signal = link->user ? &link->user->signal : &link->signal;
    if (!*signal) {
        *signal = number;
    }
}

static void on_signal(evutil_socket_t number, short what, void *ctx)
{
    (void)what;
    for (conn_link *link = ctx; link; link = link->beside) {
        note(link, (int)number);
    }
}

/* The terminal is as it was while the process is suspended. */
void conn_suspend(void)
{
    keys_pause();
    screen_pause();
    os_suspend();
}

static bool moves(const conn *c)
{
    return c->up && !c->link_error && (c->moving || grobo_robot_moving(c->robot));
}

/*
 * What moves is stopped first: that ends the command, as Ctrl-C does, and conn_close() suspends the
 * process when every robot of the loop stands. While none moves it is suspended at once, and
 * continues.
 */
static void on_suspend(evutil_socket_t number, short what, void *ctx)
{
    bool any_moves = false, any_leaves = false;
    for (const conn_link *link = ctx; link; link = link->beside) {
        const conn *c = link->user;
        if (c && c->a->stops) {
            return; /* in a moment it has ended */
        }
        any_moves |= c && moves(c);
        any_leaves |= c && c->leaving;
    }
    if (!any_moves) {
        conn_suspend();
    } else if (!any_leaves) {
        on_signal(number, what, ctx);
    }
}

/* One of these to be heard: false where there is no memory. */
static bool hear(conn_link *link, int number, event_callback_fn fn)
{
    struct event *event = evsignal_new(link->base, number, fn, link);
    if (event) {
        link->signals[link->n_signals++] = event;
    }
    return event != NULL;
}

bool conn_signals_init(conn_link *link)
{
    os_take_signals();
    for (int i = 0; i < os_n_endings; i++) {
        if (!hear(link, os_endings[i], on_signal)) {
            return false;
        }
    }
    return !os_suspension || os_is_ignored(os_suspension) || hear(link, os_suspension, on_suspend);
}

void conn_signals_deinit(conn_link *link)
{
    for (int i = 0; i < link->n_signals; i++) {
        event_free(link->signals[i]);
    }
    link->n_signals = 0;
}

/* A command that stops the robot hears them itself (run.c): it opens more than one loop. */
void conn_link_watch(conn_link *link)
{
    if (link->user && link->user->a->stops && !link->user->a->link) {
        return;
    }
    for (int i = 0; i < link->n_signals; i++) {
        if (event_add(link->signals[i], NULL) != 0) { /* it could not be ended in order */
            link->link_error = GROBO_ERR_NOMEM;
            if (link->user) {
                link->user->link_error = GROBO_ERR_NOMEM;
            }
        }
    }
}

void conn_link_unwatch(conn_link *link)
{
    for (int i = 0; i < link->n_signals; i++) {
        event_del(link->signals[i]);
    }
}
