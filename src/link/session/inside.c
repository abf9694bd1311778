/* SPDX-License-Identifier: MIT */
/* Being inside of a session: calls that may call back, and the user's callbacks. */
#include "src/base/assert.h"
#include "src/link/session/session.h"

void grobo_i_session_enter(grobo_session *session)
{
    if (session->depth++ == 0) {
        session->turn_us = 0;
    }
}

int64_t grobo_i_session_now(grobo_session *session)
{
    if (session->depth == 0) {
        return grobo_now_us();
    }
    if (session->turn_us == 0) {
        session->turn_us = grobo_now_us();
    }
    return session->turn_us;
}

void grobo_i_session_leave(grobo_session *session)
{
    GROBO_ASSERT(session->depth > 0);
    session->on_leave(session);
}

/* ---- the user's callbacks, and how long they hold the loop -------------------------------- */

int64_t grobo_i_session_enter_callback(grobo_session *session)
{
    session->in_callback++;
    return grobo_i_session_now(session);
}

void grobo_i_session_leave_callback(grobo_session *session, grobo_callback callback,
                                    int64_t since_us)
{
    session->turn_us = grobo_now_us();
    int64_t held_us = session->turn_us - since_us;

    GROBO_ASSERT(session->in_callback > 0);
    session->in_callback--;
    if (session->in_callback > 0 || held_us <= GROBO_CALLBACK_SLOW_US) {
        return;
    }
    session->slow.count++;
    if (held_us > session->slow.held_us) {
        session->slow.callback = callback;
        session->slow.held_us = held_us;
    }
}

void grobo_i_session_report_slow(grobo_session *session)
{
    if (session->slow.count == 0) {
        return;
    }
    const grobo_event event = {
        .kind = GROBO_EVENT_SLOW_CALLBACK, .now_us = grobo_now_us(), .u.slow = session->slow};

    session->slow = (grobo_event_slow){.count = 0};
    if (session->config.on_robot != NULL) {
        /* Not measured: a report of a report would have no end. */
        session->config.on_robot(session->config.ctx, &event);
    }
}

void grobo_i_session_say(grobo_session *session, grobo_session_event event, int error)
{
    if (session->config.on_event != NULL && !session->closing) {
        int64_t since_us = grobo_i_session_enter_callback(session);

        session->config.on_event(session->config.ctx, session, event, error);
        grobo_i_session_leave_callback(session, GROBO_CALLBACK_EVENT, since_us);
    }
}

void grobo_i_session_tell_robot(grobo_session *session, const grobo_event *event)
{
    if (session->config.on_robot != NULL) {
        int64_t since_us = grobo_i_session_enter_callback(session);

        session->config.on_robot(session->config.ctx, event);
        grobo_i_session_leave_callback(session, GROBO_CALLBACK_ROBOT, since_us);
    }
}

void grobo_i_session_tell_tap(void *ctx, grobo_direction direction, int64_t now_us,
                              const uint8_t *bytes, size_t size)
{
    const session_wire *wire = ctx;
    grobo_session *session = wire->session;

    if (session->config.on_tap != NULL) {
        int64_t since_us = grobo_i_session_enter_callback(session);

        session->tapped = wire->line;
        session->config.on_tap(session->config.ctx, direction, now_us, bytes, size);
        grobo_i_session_leave_callback(session, GROBO_CALLBACK_TAP, since_us);
    }
}
