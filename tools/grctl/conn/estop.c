/* SPDX-License-Identifier: MIT */
/* Emergency stops on a connection: one that is being carried out, one that stands. */
#include <grobo/estop.h>

#include "tools/grctl/conn/conn.h"

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

int conn_open_to_move(conn *c, app *a)
{
    int status;
    a->moves = true;
    status = conn_open(c, a);
    if (status)
        return status;
    conn_watch(c, true);
    if (grobo_estop_stands(conn_device(c)))
        return app_fail(a, EXIT_SAFETY, grobo_error_name(GROBO_ERR_LATCHED),
                        "%s: stopped by 'grctl estop'; 'grctl estop --reset' takes it back",
                        conn_device(c));
    return EXIT_DONE;
}
