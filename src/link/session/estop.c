/* SPDX-License-Identifier: MIT */
/* A session obeys the emergency stops of other programs, and says what it did. */
#include "src/link/session/session.h"

void grobo_i_session_estop_begin(grobo_session *session, const char *device)
{
    if (session->estop.on && !session->was_up) { /* the port before it, of a scan */
        grobo_i_estop_watch_end(&session->estop);
    }
    grobo_i_estop_watch_begin(&session->estop, device);
}

/* Has the engine stop, unless it is about to anyway: that one serves for both. */
static void stop(grobo_session *session)
{
    int r = GROBO_OK;

    if (grobo_robot_job(&session->robot) != GROBO_JOB_ESTOP) {
        r = grobo_robot_estop(&session->robot, grobo_now_us());
    }
    session->estop.say = GROBO_ESTOP_HEARD;
    if (r < 0 && r != GROBO_ERR_CLOSED) { /* latched, but the driver has no way to stop */
        session->estop.say = GROBO_ESTOP_FAILED;
        session->estop.result = r;
    }
}

void grobo_i_session_estop_arm(grobo_session *session)
{
    bool pending = false;

    if (!session->estop.on || session->estop.armed) {
        return;
    }
    session->estop.armed = true;
    if (!grobo_i_estop_watch_look(&session->estop, &pending)) {
        return;
    }
    if (pending) {
        stop(session);
    } else {
        (void)grobo_robot_latch(&session->robot, grobo_now_us());
    }
}

int64_t grobo_i_session_estop_deadline(const grobo_session *session)
{
    return session->estop.armed ? session->estop.looked_us + GROBO_ESTOP_WATCH_US : GROBO_NEVER_US;
}

void grobo_i_session_estop_look(grobo_session *session)
{
    bool pending = false;

    if (grobo_now_us() >= grobo_i_session_estop_deadline(session) &&
        grobo_i_estop_watch_look(&session->estop, &pending)) {
        stop(session);
    }
}

void grobo_i_session_estop_ended(grobo_session *session, int result)
{
    /* Another one took its place, or the line went: it is carried out later. */
    if (result != GROBO_ERR_CANCELED && result != GROBO_ERR_UNPLUGGED) {
        session->estop.say = result < 0 ? GROBO_ESTOP_FAILED : GROBO_ESTOP_DONE;
        session->estop.result = result;
    }
}
