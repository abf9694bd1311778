/* SPDX-License-Identifier: MIT */
/* What a session knows, and its parts. */
#include "src/link/session/session.h"

grobo_session_state grobo_session_get_state(const grobo_session *session)
{
    return session->state;
}

const char *grobo_session_device(const grobo_session *session)
{
    return session->used;
}

const grobo_os_cause *grobo_session_cause(const grobo_session *session)
{
    return &session->cause;
}

grobo_robot *grobo_session_robot(grobo_session *session)
{
    return &session->robot;
}

grobo_sim *grobo_session_sim(grobo_session *session)
{
    return session->sim;
}

grobo_serial *grobo_session_serial(grobo_session *session)
{
    return session->serial;
}

void grobo_session_pump(grobo_session *session)
{
    grobo_i_session_enter(session);
    grobo_i_session_leave(session);
}

void grobo_session_bytes(const grobo_session *session, uint64_t *tx_bytes, uint64_t *rx_bytes)
{
    grobo_serial_counters counters;

    grobo_serial_get_counters(session->serial, &counters);
    *tx_bytes = counters.tx_bytes + session->sim_tx_bytes;
    *rx_bytes = counters.rx_bytes + session->sim_rx_bytes;
}
