/* SPDX-License-Identifier: MIT */
/* Opening a session's device, which the guard of a grctl that died may have a moment longer. */
#include <grobo/port.h>

#include "tools/grctl/conn/conn.h"
#include "tools/grctl/conn/guard.h"

/* How long a guard is waited for, and how often it is looked at. */
enum { GUARD_WAIT_US = 2500000, GUARD_LOOK_US = 50000 };

static bool opened(conn *c)
{
    return c->up;
}

static int try_once(conn *c)
{
    int error = grobo_session_open(c->session);
    return error ? error : conn_wait_until(c, opened);
}

/* With a last look when it has gone: it may have released the port since the port was tried. */
int conn_open_session(conn *c)
{
    int64_t until_us = grobo_now_us() + GUARD_WAIT_US;
    bool waits = true, waited = false;
    int error = try_once(c);
    while (waits && (error == GROBO_ERR_BUSY || error == GROBO_ERR_NOTFOUND)) {
        waits = guard_has(conn_is_auto(c->a) ? GROBO_DEVICE_AUTO : conn_device(c)) &&
                grobo_now_us() < until_us;
        if (!waits && !waited && error == GROBO_ERR_NOTFOUND)
            break;
        c->link_error = c->link->link_error = 0;
        if (waits && conn_sleep_until(c, grobo_now_us() + GUARD_LOOK_US) < 0)
            break;
        waited = true;
        error = try_once(c);
    }
    return error;
}
