/* SPDX-License-Identifier: MIT */
/* The bytes of a session: engine to line, line to engine, and when to look again. */
#include "src/base/assert.h"
#include "src/base/instant.h"
#include "src/link/serial/loop.h"
#include "src/link/serial/serial.h"
#include "src/link/session/session.h"
#include "src/robot/robot.h"

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

void grobo_i_session_on_data(void *ctx, grobo_serial *serial, const uint8_t *bytes, size_t size)
{
    grobo_session *session = ctx;

    grobo_i_session_enter(session);
    session->turn_us = serial->read_us;
    if (serial->more) {
        grobo_robot_rx(&session->robot, bytes, size, serial->read_us);
        (void)grobo_i_session_step(session);
    } else {
        /* All that had come by then: another read would find nothing. */
        grobo_robot_rx_step(&session->robot, bytes, size, serial->read_us);
    }
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

/* The line takes a frame; what it holds back for one that stops the robot is taken back. */
static bool make_room(grobo_session *session, int64_t now_us)
{
    bool has_room = session->line->has_room(session);

    if (!has_room && session->given_bytes > 0 && grobo_robot_stops(&session->robot, now_us)) {
        take_back(session);
        has_room = session->line->has_room(session);
    }
    return has_room;
}

/* A frame may leave now, as far as engine and marks are concerned. Where the line is not asked for
 * room by a call of the system, the engine says by its frame whether there is one. */
static bool has_frame(const grobo_session *session, int64_t now_us)
{
    return grobo_i_has_frame(&session->robot, 0, session->robot.answered, now_us) &&
           !grobo_i_session_has_asked(session) && !grobo_i_session_estop_old(session, now_us);
}

/* Where it asks for room the line may call back: not with the engine's lock. */
static bool may_leave(grobo_session *session, int64_t now_us)
{
    grobo_robot *robot = &session->robot;

    grobo_i_unlock(robot);
    bool may = !grobo_i_session_guard_has_it(session) && make_room(session, now_us);

    grobo_i_lock(robot);
    return may;
}

/* Gives the frame that the engine wants to send now, if there is one; when to look again. The line
 * is asked only where there is something for it: that may be a call of the system. Behind the
 * frame there is none before that time, and what looks at its bytes asks for nothing. */
static int64_t give_next(grobo_session *session)
{
    const int64_t now_us = grobo_i_session_now(session);
    grobo_robot *robot = &session->robot;
    uint8_t frame[GROBO_FRAME_MAX_BYTES];
    int64_t deadline_us = now_us + BUSY_US; /* it cannot leave yet, however long it has been due */
    bool stops = false, may = true;
    int size = 0;

    grobo_i_lock(robot); /* once for all that is asked */
    grobo_i_session_note_latch(session);
    if (has_frame(session, now_us)) {
        may = may_leave(session, now_us);
        size = may ? grobo_robot_tx(robot, frame, sizeof frame, now_us) : 0;
        stops = grobo_i_frame_stops(robot, 0);
    }
    if (may) {
        deadline_us = grobo_robot_deadline(robot, now_us);
    }
    grobo_i_unlock(robot);
    if (size > 0) {
        give(session, frame, (size_t)size, stops);
    }
    return deadline_us;
}

void grobo_i_session_send(grobo_session *session)
{
    int64_t deadline_us = GROBO_NEVER_US;

    if (session->state != GROBO_SESSION_CHECKING && session->state != GROBO_SESSION_UP) {
        grobo_i_session_note_latch(session);
    }
    switch (session->state) {
    case GROBO_SESSION_CHECKING:
    case GROBO_SESSION_UP:
        deadline_us = give_next(session);
        grobo_i_session_guard_tell(session);
        deadline_us = grobo_i_sooner(deadline_us, session->line->deadline(session));
        deadline_us = grobo_i_sooner(deadline_us, grobo_i_session_guard_deadline(session));
        deadline_us = grobo_i_sooner(deadline_us, grobo_i_session_estop_deadline(session));
        break;
    case GROBO_SESSION_WAITING:
        deadline_us = grobo_i_sooner(session->retry_us, grobo_i_session_estop_deadline(session));
        break;
    case GROBO_SESSION_OPENING:
        deadline_us = session->line->deadline(session);
        break;
    case GROBO_SESSION_CLOSED:
        grobo_i_session_estop_end(session);
        grobo_i_session_rest(session);
        break;
    }
    /* Without memory for it, the wake-up socket has the loop look again at once, and again, until
     * there is some: what is due leaves when it is due. */
    session->untimed =
        grobo_i_timer_set(session->timer, deadline_us, grobo_i_session_now(session)) < 0;
    session->turn_us = 0;
    if (session->untimed) {
        grobo_i_session_wake(session);
    }
}
