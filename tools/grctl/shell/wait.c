/* SPDX-License-Identifier: MIT */
/* Waiting for lines in the loop, so that the robot is looked after meanwhile. */
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/shell/shell.h"

volatile sig_atomic_t shell_noted;

int shell_wait(void *s)
{
    conn_link *link = &((shell *)s)->link;
    evutil_socket_t fd = os_input_await();
    bool readable = fd == (evutil_socket_t)EVUTIL_INVALID_SOCKET;
    struct event *input =
        readable ? NULL : event_new(link->base, fd, EV_READ, conn_note, &readable);
    if (!input || event_add(input, NULL) != 0) {
        readable = true; /* then the reading itself waits */
    }
    conn_link_watch(link);
    if (!link->signal) {
        link->signal = (int)shell_noted;
        shell_noted = 0;
    }
    while (!readable && !link->signal && !link->news) {
        if (event_base_loop(link->base, EVLOOP_ONCE) != 0) {
            break;
        }
    }
    conn_link_unwatch(link);
    conn_forget(input);
    return link->signal ? LINE_INTERRUPTED : link->news ? LINE_NEWS : 0;
}

/* ---- scripts -------------------------------------------------------------------------------- */

/* Waits for a block that is not empty. Returns 0, or why there is none. */
static int fill(shell *s, shell_script *in)
{
    int n = 0;
    in->at = in->held = 0;
    if (in->file) {
        in->held = fread(in->block, 1, sizeof in->block, in->file);
        return in->held > 0 ? 0 : LINE_END;
    }
    conn_link_idle(&s->link, s->a);
    while (n == 0) {
        int stopped = shell_wait(s);
        if (stopped) {
            return stopped;
        }
        n = os_input_read(in->block, sizeof in->block);
    }
    in->held = n > 0 ? (size_t)n : 0;
    return n > 0 ? 0 : LINE_END;
}

static void take(shell_script *in, char c)
{
    if (in->ended) {
        in->ended = false;
        in->used = 0;
        in->wrong = NULL;
    }
    in->ended = c == '\n';
    if (in->ended) {
        return;
    }
    if (c == '\0') {
        in->wrong = _("a NUL byte; is it text?");
    }
    if (in->used == sizeof in->line - 1) {
        in->wrong = _("the line is too long");
    } else {
        in->line[in->used++] = c;
    }
}

int shell_script_next(shell *s, shell_script *in)
{
    do {
        int stopped = in->at < in->held ? 0 : fill(s, in);
        if (stopped == LINE_END && in->used > 0 && !in->ended) {
            in->ended = true; /* the last line needs no end */
        } else if (stopped) {
            return stopped;
        } else {
            take(in, in->block[in->at++]);
        }
    } while (!in->ended);
    in->line[in->used] = '\0';
    return (int)in->used;
}
