/* SPDX-License-Identifier: MIT */
/* The bytes of a session: engine to line, line to engine, and when to look again. */
#include <string.h>

#include "src/link/serial/serial.h"
#include "src/link/session/session.h"

/* How long to leave a line alone that takes no more bytes; it also tells when it does. */
#define BUSY_US 1000

/* How often one step reads at most: a line that never pauses must not keep us. */
#define READS_MAX 16

void grobo_i_session_on_tap(grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                            size_t size, void *ctx)
{
    grobo_i_session_tell_tap(ctx, direction, now_us, bytes, size);
}

/* ---- line to engine ----------------------------------------------------------------------- */

void grobo_i_session_on_data(grobo_serial *serial, const uint8_t *bytes, size_t size, void *ctx)
{
    grobo_session *session = ctx;

    (void)serial;
    grobo_i_session_enter(session);
    grobo_robot_rx(&session->robot, bytes, size, grobo_now_us());
    grobo_i_session_step(session);
    grobo_i_session_leave(session);
}

void grobo_i_session_take_from_sim(grobo_session *session)
{
    uint8_t buf[256];
    size_t got;

    do {
        int64_t now_us = grobo_now_us();

        got = grobo_sim_tx(session->sim, buf, sizeof buf, now_us);
        if (got > 0) {
            session->sim_rx_bytes += got;
            grobo_i_session_tell_tap(session, GROBO_DIR_RX, now_us, buf, got);
            grobo_robot_rx(&session->robot, buf, got, now_us);
        }
    } while (got == sizeof buf);
    if (grobo_sim_hung_up(session->sim)) {
        grobo_i_session_lost(session, GROBO_ERR_UNPLUGGED);
    }
}

void grobo_i_session_step(grobo_session *session)
{
    uint8_t buf[256];
    int64_t now_us = grobo_now_us();
    int got = session->is_sim ? 0 : 1;

    for (int reads = 0; got > 0 && reads < READS_MAX; reads++) {
        /* The time before the read that finds nothing: what had come until then has been read. */
        now_us = grobo_now_us();
        /* A failure closes the port, and it tells that from the loop. */
        got = grobo_serial_read(session->serial, buf, sizeof buf);
        if (got > 0) {
            grobo_robot_rx(&session->robot, buf, (size_t)got, grobo_now_us());
        }
    }
    grobo_robot_step(&session->robot, now_us);
}

/* ---- engine to line ----------------------------------------------------------------------- */

static void give_to_sim(grobo_session *session, const uint8_t *bytes, size_t size)
{
    int64_t now_us = grobo_now_us();
    size_t taken = grobo_sim_rx(session->sim, bytes, size, now_us);

    session->sim_tx_bytes += taken;
    if (taken > 0) {
        grobo_i_session_tell_tap(session, GROBO_DIR_TX, now_us, bytes, taken);
    }
    session->backlog_bytes = size - taken;
    memmove(session->backlog, bytes + taken, session->backlog_bytes);
}

/* A frame is taken from the engine, which judges it, when nothing is left of the one before. */
static bool line_takes_more(grobo_session *session)
{
    if (!session->is_sim) {
        return grobo_serial_is_open(session->serial) && grobo_serial_unsent(session->serial) == 0;
    }
    if (session->backlog_bytes > 0) {
        give_to_sim(session, session->backlog, session->backlog_bytes);
    }
    return session->backlog_bytes == 0;
}

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
    session->given_bytes = stops ? 0 : size;
    session->given_behind = behind_sum(session, frame, size);
    if (session->is_sim) {
        give_to_sim(session, frame, size);
    } else {
        /* A failure closes the port, and it tells that from the loop. */
        (void)grobo_serial_send(session->serial, frame, size);
    }
}

/* The line holds a frame back that should have left, and the robot is to stop: what has not left of
 * it is from before. */
static void take_back(grobo_session *session)
{
    size_t size = session->given_bytes;
    size_t behind = session->given_behind;

    session->given_bytes = 0;
    if (!session->is_sim) {
        grobo_i_serial_take_back(session->serial, size, behind);
    } else if (session->backlog_bytes == size) {
        session->backlog_bytes = 0;
    } else if (session->backlog_bytes > behind) {
        session->backlog[session->backlog_bytes - 1 - behind] ^= 0xFF;
    }
}

static int64_t earlier(int64_t a_us, int64_t b_us)
{
    return a_us < b_us ? a_us : b_us;
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
    if (session->is_sim) {
        deadline_us = earlier(deadline_us, grobo_sim_packet_deadline(session->sim));
    }
    return deadline_us;
}

void grobo_i_session_send(grobo_session *session)
{
    int64_t deadline_us = GROBO_NEVER_US;

    switch (session->state) {
    case GROBO_SESSION_CHECKING:
    case GROBO_SESSION_UP: {
        bool guarded = grobo_i_session_guard_has_it(session);
        bool free = !guarded && line_takes_more(session);

        if (!guarded && !free && session->given_bytes > 0 &&
            grobo_robot_stops(&session->robot, grobo_now_us())) {
            take_back(session);
            free = line_takes_more(session);
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
            free = !grobo_i_session_guard_has_it(session) && line_takes_more(session);
        }
        grobo_i_session_guard_tell(session);
        deadline_us = earlier(deadline_of(session, !free), grobo_i_session_estop_deadline(session));
        break;
    }
    case GROBO_SESSION_WAITING:
        deadline_us = earlier(session->retry_us, grobo_i_session_estop_deadline(session));
        break;
    case GROBO_SESSION_OPENING:
        deadline_us = session->is_sim ? grobo_now_us() : GROBO_NEVER_US;
        break;
    case GROBO_SESSION_CLOSED:
        grobo_i_estop_watch_end(&session->estop);
        grobo_i_session_rest(session);
        break;
    }
    /* Cannot fail: the timer's event has been added before, or adding takes no memory. */
    (void)grobo_timer_set(session->timer, deadline_us);
}
