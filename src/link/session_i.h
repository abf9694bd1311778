/* SPDX-License-Identifier: MIT */
/* The inside of a grobo_session: session.c has its states, session_line.c its bytes. */
#ifndef GROBO_LINK_SESSION_I_H
#define GROBO_LINK_SESSION_I_H

#include <grobo/session.h>

/* Serial ports found for GROBO_DEVICE_AUTO. */
typedef struct session_scan {
    int count;
    int at; /* the one that is tried */
    char path[GROBO_SCAN_PORTS_MAX][GROBO_DEVICE_MAX_BYTES];
} session_scan;

struct grobo_session {
    grobo_session_config config;         /* pointers to copied things are NULL */
    char device[GROBO_DEVICE_MAX_BYTES]; /* as configured */
    char used[GROBO_DEVICE_MAX_BYTES];   /* as opened */
    char stable[GROBO_DEVICE_MAX_BYTES]; /* the name it will have when it comes back */
    grobo_robot_config robot_config;     /* in effect while up */
    grobo_os_cause cause;

    grobo_session_state state;
    bool was_up; /* since open: then a failed attempt is not the end, if so configured */
    grobo_robot robot;
    grobo_serial *serial;
    grobo_timer *timer;

    grobo_sim_config sim_config;
    grobo_sim *sim;
    bool is_sim;                            /* the device is the simulator */
    uint8_t backlog[GROBO_FRAME_MAX_BYTES]; /* of a frame that the simulator took in part */
    size_t backlog_bytes;
    uint64_t sim_tx_bytes, sim_rx_bytes;

    session_scan *scan; /* while one goes on */
    int check_job;      /* number of the check that runs, 0 none */
    bool check_ended;
    int check_result;
    int64_t retry_us; /* next attempt while WAITING */
    int64_t pause_us; /* the pause before it */

    unsigned depth; /* calls that may call back, one inside another */
    bool closing;   /* closed in a callback */
    bool freed;     /* freed in a callback */
};

/* ---- session.c ---- */

/* Around everything that may call back; the last leave does what callbacks asked for, and pumps. */
void grobo_i_session_enter(grobo_session *session);
void grobo_i_session_leave(grobo_session *session);

/* Reads what the line has now, and lets the engine's time pass. */
void grobo_i_session_look(grobo_session *session);

/* The line is gone, or cannot be had. */
void grobo_i_session_lost(grobo_session *session, int error);

/* ---- session_line.c ---- */

/* Hands out what the engine wants to send as far as the line takes it, and sets the timer. */
void grobo_i_session_send(grobo_session *session);

/* Takes what the simulator has for us; tells when it hung up. */
void grobo_i_session_take_from_sim(grobo_session *session);

/*
 * Lets the engine's time pass. What the line has for it is read first: a process that was held up
 * must not take for a servo's silence what has been waiting for it.
 */
void grobo_i_session_step(grobo_session *session);

/* Callback of the serial port. */
void grobo_i_session_on_data(grobo_serial *serial, const uint8_t *bytes, size_t size, void *ctx);
void grobo_i_session_on_tap(grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                            size_t size, void *ctx);

/* ---- session_scan.c ---- */

/* Lists the ports to try; GROBO_ERR_NOTFOUND where there are none. */
int grobo_i_session_scan_begin(grobo_session *session);

/* Forgets them. */
void grobo_i_session_scan_end(grobo_session *session);

#endif
