/* SPDX-License-Identifier: MIT */
/* The mark of `grctl estop`: who has the port must stop the robot. */
#include "conn.h"
#include "latch.h"

enum { LOOK_US = 50000 };

static void on_look(evutil_socket_t fd, short what, void *ctx)
{
    conn_link *link = ctx;
    grobo_trip_info trip;
    bool marked, fresh;
    (void)fd;
    (void)what;
    if (!link->session || !link->up)
        return;
    marked = latch_is_set(grobo_session_device(link->session));
    fresh = marked && !link->marked;
    link->marked = marked;
    grobo_robot_tripped(grobo_session_robot(link->session), &trip);
    if (fresh && trip.trip != GROBO_TRIP_ESTOP)
        grobo_session_estop(link->session);
}

int conn_heed_mark(conn_link *link)
{
    struct timeval period = {0, LOOK_US};
    link->mark_timer = event_new(link->base, -1, EV_PERSIST, on_look, link);
    return link->mark_timer && event_add(link->mark_timer, &period) == 0 ? GROBO_OK
                                                                         : GROBO_ERR_NOMEM;
}

bool conn_is_idle(conn *c)
{
    return grobo_robot_job(c->robot) == GROBO_JOB_NONE;
}

int conn_end_estop(conn *c)
{
    if (c->trip.trip != GROBO_TRIP_ESTOP || !c->up)
        return GROBO_OK;
    c->moving = false;
    c->leaving = true;
    return conn_wait_until(c, conn_is_idle);
}
