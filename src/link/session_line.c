/* SPDX-License-Identifier: MIT */
/* The bytes of a session: engine to line, line to engine, and when to look again. */
#include <string.h>

#include "src/link/session_i.h"

/* How long to leave a line alone that takes no more bytes; it also tells when it does. */
#define BUSY_US 1000

/* How often one step reads at most: a line that never pauses must not keep us. */
#define READS_MAX 16

void grobo_i_session_on_tap(grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                            size_t size, void *ctx)
{
    const grobo_session *session = ctx;

    session->config.on_tap(direction, now_us, bytes, size, session->config.ctx);
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
            if (session->config.on_tap != NULL) {
                session->config.on_tap(GROBO_DIR_RX, now_us, buf, got, session->config.ctx);
            }
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
    if (taken > 0 && session->config.on_tap != NULL) {
        session->config.on_tap(GROBO_DIR_TX, now_us, bytes, taken, session->config.ctx);
    }
    session->backlog_bytes = size - taken;
    memmove(session->backlog, bytes + taken, session->backlog_bytes);
}

static bool line_takes_more(grobo_session *session)
{
    if (!session->is_sim) {
        return grobo_serial_is_open(session->serial) && grobo_serial_pending(session->serial) == 0;
    }
    if (session->backlog_bytes > 0) {
        give_to_sim(session, session->backlog, session->backlog_bytes);
    }
    return session->backlog_bytes == 0;
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
        int64_t sim_us = grobo_sim_deadline(session->sim);

        deadline_us = sim_us < deadline_us ? sim_us : deadline_us;
    }
    return deadline_us;
}

void grobo_i_session_send(grobo_session *session)
{
    int64_t deadline_us = GROBO_NEVER_US;

    switch (session->state) {
    case GROBO_SESSION_CHECKING:
    case GROBO_SESSION_UP: {
        bool free = line_takes_more(session);

        while (free) {
            uint8_t frame[GROBO_FRAME_MAX_BYTES];
            int size = grobo_robot_tx(&session->robot, frame, sizeof frame, grobo_now_us());

            if (size <= 0) {
                break;
            }
            if (session->is_sim) {
                give_to_sim(session, frame, (size_t)size);
            } else {
                /* A failure closes the port, and it tells that from the loop. */
                (void)grobo_serial_send(session->serial, frame, (size_t)size);
            }
            free = line_takes_more(session);
        }
        deadline_us = deadline_of(session, !free);
        break;
    }
    case GROBO_SESSION_WAITING:
        deadline_us = session->retry_us;
        break;
    case GROBO_SESSION_OPENING:
        deadline_us = session->is_sim ? grobo_now_us() : GROBO_NEVER_US;
        break;
    case GROBO_SESSION_CLOSED:
        break;
    }
    /* Cannot fail: the timer's event has been added before, or adding takes no memory. */
    (void)grobo_timer_set(session->timer, deadline_us);
}
