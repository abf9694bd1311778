/* SPDX-License-Identifier: MIT */
/* The bytes of a session: engine to line, line to engine, and when to look again. */
#include "src/base/assert.h"
#include "src/base/instant.h"
#include "src/link/session/session.h"

/* How long to leave a line alone that takes no more bytes; it also tells when it does. */
#define BUSY_US 1000

/* ---- line to engine ----------------------------------------------------------------------- */

int grobo_i_session_step(grobo_session *session)
{
    int64_t until_us = 0;
    int r = session->line->take(session, &until_us);

    if (r >= 0) {
        grobo_robot_step(&session->robot, until_us);
    }
    return r;
}

void grobo_i_session_on_data(grobo_serial *serial, const uint8_t *bytes, size_t size, void *ctx)
{
    grobo_session *session = ctx;

    (void)serial;
    grobo_i_session_enter(session);
    grobo_robot_rx(&session->robot, bytes, size, grobo_now_us());
    (void)grobo_i_session_step(session);
    grobo_i_session_leave(session);
}

/* ---- engine to line ----------------------------------------------------------------------- */

/* Bytes of a frame behind its sum; all of them where it has none. */
static size_t behind_sum(const grobo_session *session, const uint8_t *frame, size_t size)
{
    if (grobo_driver_wiring(grobo_robot_driver(&session->robot)) == GROBO_WIRING_BUS ||
        frame[0] == 'S') {
        return 0;
    }
    return frame[0] == 'T' ? 1 : size;
}

static void give(grobo_session *session, const uint8_t *frame, size_t size, bool stops)
{
    GROBO_ASSERT(size > 0 && size <= GROBO_FRAME_MAX_BYTES);
    session->given_bytes = stops ? 0 : size;
    session->given_behind = behind_sum(session, frame, size);
    session->line->give(session, frame, size);
}

/* The line holds a frame back that should have left, and the robot is to stop: what has not left of
 * it is from before. */
static void take_back(grobo_session *session)
{
    size_t size = session->given_bytes;

    session->given_bytes = 0;
    session->line->take_back(session, size, session->given_behind);
}

/* When to look again. */
static int64_t deadline_of(const grobo_session *session, bool busy)
{
    int64_t now_us = grobo_now_us();
    int64_t deadline_us = grobo_robot_deadline(&session->robot, now_us);

    /* The engine's frame cannot leave yet, however long it has been due. */
    if (busy && deadline_us < now_us + BUSY_US) {
        deadline_us = now_us + BUSY_US;
    }
    return grobo_i_sooner(deadline_us, session->line->deadline(session));
}

void grobo_i_session_send(grobo_session *session)
{
    int64_t deadline_us = GROBO_NEVER_US;

    switch (session->state) {
    case GROBO_SESSION_CHECKING:
    case GROBO_SESSION_UP: {
        bool guarded = grobo_i_session_guard_has_it(session);
        bool free = !guarded && session->line->has_room(session);

        if (!guarded && !free && session->given_bytes > 0 &&
            grobo_robot_stops(&session->robot, grobo_now_us())) {
            take_back(session);
            free = session->line->has_room(session);
        }
        while (free && !grobo_i_session_has_asked(session) &&
               grobo_now_us() < grobo_i_session_estop_deadline(session)) {
            uint8_t frame[GROBO_FRAME_MAX_BYTES];
            int64_t now_us = grobo_now_us();
            bool stops = grobo_robot_stops(&session->robot, now_us);
            int size = grobo_robot_tx(&session->robot, frame, sizeof frame, now_us);

            if (size <= 0) {
                break;
            }
            give(session, frame, (size_t)size, stops);
            free = !grobo_i_session_guard_has_it(session) && session->line->has_room(session);
        }
        grobo_i_session_guard_tell(session);
        deadline_us =
            grobo_i_sooner(deadline_of(session, !free), grobo_i_session_estop_deadline(session));
        break;
    }
    case GROBO_SESSION_WAITING:
        deadline_us = grobo_i_sooner(session->retry_us, grobo_i_session_estop_deadline(session));
        break;
    case GROBO_SESSION_OPENING:
        deadline_us = session->line->deadline(session);
        break;
    case GROBO_SESSION_CLOSED:
        grobo_i_estop_watch_end(&session->estop);
        grobo_i_session_rest(session);
        break;
    }
    /* Cannot fail: the timer's event has been added before, or adding takes no memory. */
    (void)grobo_timer_set(session->timer, deadline_us);
}
