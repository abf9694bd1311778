/* SPDX-License-Identifier: MIT */
/* The bytes of a session: engine to line, line to engine, and when to look again. */
#include "src/base/assert.h"
#include "src/base/instant.h"
#include "src/link/serial/loop.h"
#include "src/link/serial/serial.h"
#include "src/link/session/session.h"
#include "src/robot/lines.h"
#include "src/robot/query.h"

/* How long to leave a line alone that takes no more bytes; it also tells when it does. */
#define BUSY_US 1000
/* A line of several is lost: by then what the others move has stopped and was read back, or does
 * not answer. */
#define LOST_BY_US 2600000

/* ---- line to engine ----------------------------------------------------------------------- */

int grobo_i_session_step(grobo_session *session)
{
    int64_t until_us = GROBO_NEVER_US;
    int r = GROBO_OK;

    for (int i = 0; i < session->n_wires; i++) {
        session_wire *wire = &session->wire[i];
        int64_t taken_us = 0;
        int taken = grobo_i_session_is_lost(wire) ? GROBO_OK : session->line->take(wire, &taken_us);

        if (taken < 0 && session->n_wires > 1 && session->state == GROBO_SESSION_UP) {
            grobo_i_session_lose_wire(wire, taken);
        } else if (taken < 0) {
            r = taken;
        } else if (taken_us > 0) {
            until_us = grobo_i_sooner(until_us, taken_us);
        }
    }
    if (r >= 0) {
        grobo_robot_step(&session->robot, until_us == GROBO_NEVER_US ? grobo_now_us() : until_us);
    }
    return r;
}

bool grobo_i_session_is_lost(const session_wire *wire)
{
    return (wire->session->robot.lines_gone & 1u << wire->line) != 0;
}

void grobo_i_session_lose_wire(session_wire *wire, int error)
{
    grobo_session *session = wire->session;

    if (grobo_i_session_is_lost(wire)) {
        return;
    }
    session->lost_by_us =
        session->lost_error == 0 ? grobo_now_us() + LOST_BY_US : session->lost_by_us;
    session->lost_error = session->lost_error == 0 ? error : session->lost_error;
    grobo_robot_line_down(&session->robot, wire->line, grobo_now_us());
}

bool grobo_i_session_has_stopped(const grobo_session *session)
{
    return session->lost_error < 0 &&
           (!grobo_robot_moving(&session->robot) || grobo_now_us() >= session->lost_by_us);
}

void grobo_i_session_on_data(void *ctx, grobo_serial *serial, const uint8_t *bytes, size_t size)
{
    session_wire *wire = ctx;
    grobo_session *session = wire->session;

    grobo_i_session_enter(session);
    session->turn_us = serial->read_us;
    if (serial->more || session->n_wires > 1) {
        grobo_robot_line_rx(&session->robot, wire->line, bytes, size, serial->read_us);
        (void)grobo_i_session_step(session);
    } else {
        /* All that had come by then: another read would find nothing. */
        grobo_robot_rx_step(&session->robot, bytes, size, serial->read_us);
    }
    grobo_i_session_leave(session);
}

/* ---- engine to line ----------------------------------------------------------------------- */

/* Bytes of a frame behind its sum; all of them where it has none. */
static size_t behind_sum(const session_wire *wire, const uint8_t *frame, size_t size)
{
    const grobo_robot *robot = &wire->session->robot;

    if (grobo_driver_wiring(grobo_i_line_driver(robot, wire->line, NULL)) == GROBO_WIRING_BUS ||
        frame[0] == 'S') {
        return 0;
    }
    return frame[0] == 'T' ? 1 : size;
}

static void give(session_wire *wire, const uint8_t *frame, size_t size, bool stops)
{
    GROBO_ASSERT(size > 0 && size <= GROBO_FRAME_MAX_BYTES);
    wire->given_bytes = stops ? 0 : size;
    wire->given_behind = behind_sum(wire, frame, size);
    wire->session->line->give(wire, frame, size);
}

/* The line holds a frame back that should have left, and the robot is to stop: what has not left of
 * it is from before. */
static void take_back(session_wire *wire)
{
    size_t size = wire->given_bytes;

    wire->given_bytes = 0;
    wire->session->line->take_back(wire, size, wire->given_behind);
}

/* The line takes a frame; what it holds back for one that stops the robot is taken back. */
static bool make_room(session_wire *wire, int64_t now_us)
{
    grobo_session *session = wire->session;
    bool has_room = session->line->has_room(wire);

    if (!has_room && wire->given_bytes > 0 && grobo_i_stops(&session->robot, wire->line, now_us)) {
        take_back(wire);
        has_room = session->line->has_room(wire);
    }
    return has_room;
}

/* A frame may leave now, as far as engine and marks are concerned. Where the line is not asked for
 * room by a call of the system, the engine says by its frame whether there is one. */
static bool has_frame(session_wire *wire, int64_t now_us)
{
    grobo_session *session = wire->session;
    bool answered = *grobo_i_answered(&session->robot, wire->line);

    return !grobo_i_session_is_lost(wire) &&
           grobo_i_has_frame(&session->robot, wire->line, answered, now_us) &&
           !grobo_i_session_has_asked(session) && !grobo_i_session_estop_old(session, now_us);
}

/* Where it asks for room the line may call back: not with the engine's lock. */
static bool may_leave(session_wire *wire, int64_t now_us)
{
    grobo_robot *robot = &wire->session->robot;

    grobo_i_unlock(robot);
    bool may = !grobo_i_session_guard_has_it(wire->session) && make_room(wire, now_us);

    grobo_i_lock(robot);
    return may;
}

/* Gives the frame that the engine wants to send now, if there is one; when to look again. The line
 * is asked only where there is something for it: that may be a call of the system. Behind the
 * frame there is none before that time, and what looks at its bytes asks for nothing. */
static int64_t give_on(session_wire *wire)
{
    grobo_session *session = wire->session;
    const int64_t now_us = grobo_i_session_now(session);
    grobo_robot *robot = &session->robot;
    uint8_t frame[GROBO_FRAME_MAX_BYTES];
    int64_t deadline_us = now_us + BUSY_US; /* it cannot leave yet, however long it has been due */
    bool stops = false, may = true;
    int size = 0;

    grobo_i_lock(robot); /* once for all that is asked */
    grobo_i_session_note_latch(session);
    if (has_frame(wire, now_us)) {
        may = may_leave(wire, now_us);
        size = may ? grobo_robot_line_tx(robot, wire->line, frame, sizeof frame, now_us) : 0;
        stops = grobo_i_frame_stops(robot, wire->line);
    }
    if (may) {
        deadline_us = grobo_robot_deadline(robot, now_us);
    }
    grobo_i_unlock(robot);
    if (size > 0) {
        give(wire, frame, (size_t)size, stops);
    }
    return deadline_us;
}

/* On each line. What one has given may be what the engine says next for another: the last to be
 * asked says when to look again. */
static int64_t give_next(grobo_session *session)
{
    int64_t deadline_us = GROBO_NEVER_US, busy_us = GROBO_NEVER_US;

    for (int i = session->n_wires - 1; i >= 0; i--) {
        deadline_us = give_on(&session->wire[i]);
        busy_us = grobo_i_sooner(busy_us, deadline_us);
    }
    return session->n_wires > 1 ? busy_us : deadline_us;
}

static int64_t deadline_of_lines(const grobo_session *session)
{
    int64_t at_us = GROBO_NEVER_US;

    for (int i = 0; i < session->n_wires; i++) {
        if (!grobo_i_session_is_lost(&session->wire[i])) {
            at_us = grobo_i_sooner(at_us, session->line->deadline(&session->wire[i]));
        }
    }
    return session->lost_error < 0 ? grobo_i_sooner(at_us, session->lost_by_us) : at_us;
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
        deadline_us = grobo_i_sooner(deadline_us, deadline_of_lines(session));
        deadline_us = grobo_i_sooner(deadline_us, grobo_i_session_guard_deadline(session));
        deadline_us = grobo_i_sooner(deadline_us, grobo_i_session_estop_deadline(session));
        break;
    case GROBO_SESSION_WAITING:
        deadline_us = grobo_i_sooner(session->retry_us, grobo_i_session_estop_deadline(session));
        break;
    case GROBO_SESSION_OPENING:
        deadline_us = deadline_of_lines(session);
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
